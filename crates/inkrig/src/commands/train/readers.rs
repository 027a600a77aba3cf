//! `inkrig train sketch` and `word`: the readers of drawings.

use crate::cli::PaceArgs;
use crate::commands::settings::threads;
use crate::console::{Bar, Console};
use crate::error::CliError;
use crate::printable::{self, fixed};
use inkrig_train::TrainError;
use inkrig_train::reading::{
    OnStep, SketchRow, SketchSettings, WordRow, WordSettings, train_sketch, train_word,
};
use inkrig_train::training::check_folder;
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

pub(super) fn sketch(corpus: &Path, pace: &PaceArgs, console: &Console) -> Result<(), CliError> {
    let settings = pace.config.as_deref().map(SketchSettings::read).transpose()?.unwrap_or_default();
    let line = |row: &SketchRow| {
        format!(
            "step {:>6}  loss {}  PCK@0.1 {} % ({} % either side), unseen style {} %, characters {} %  ({} min)",
            row.step,
            fixed(row.loss, 3),
            fixed(100.0 * row.pck, 1),
            fixed(100.0 * row.pck_either_side, 1),
            fixed(100.0 * row.pck_unseen, 1),
            fixed(100.0 * row.pck_characters, 1),
            fixed(row.seconds / 60.0, 0)
        )
    };
    teach(pace, console, line, |progress| {
        train_sketch(corpus, &pace.out, &settings, threads(pace.threads), progress)
    })
}

pub(super) fn word(fonts: &Path, pace: &PaceArgs, console: &Console) -> Result<(), CliError> {
    let settings = pace.config.as_deref().map(WordSettings::read).transpose()?.unwrap_or_default();
    let line = |row: &WordRow| {
        format!(
            "step {:>6}  loss {}  read rightly {} %  ({} min)",
            row.step,
            fixed(row.loss, 3),
            fixed(100.0 * row.top_1, 1),
            fixed(row.seconds / 60.0, 0)
        )
    };
    teach(pace, console, line, |progress| {
        train_word(fonts, &pace.out, &settings, threads(pace.threads), progress)
    })
}

/// Runs a training under a bar, until it is done or its minutes are over.
fn teach<R: Serialize>(
    pace: &PaceArgs,
    console: &Console,
    line: impl Fn(&R) -> String,
    train: impl FnOnce(&mut OnStep<'_, R>) -> Result<(Vec<R>, bool), TrainError>,
) -> Result<(), CliError> {
    check_folder(&pace.out)?;
    let began = Instant::now();
    let bar: Bar = console.bar("training");
    let (rows, complete) = train(&mut |step, steps, row| {
        if let Some(row) = row {
            bar.note(&line(row));
        }
        let late = pace.minutes.is_some_and(|minutes| began.elapsed().as_secs_f64() > 60.0 * minutes);
        if late { ControlFlow::Break(()) } else { bar.at(step as usize, steps as usize) }
    })?;
    drop(bar);
    let folder = printable::path(&pace.out);
    console.say(if complete {
        format!("done: {folder} holds the weights (best.safetensors, last.safetensors)")
    } else {
        format!("stopped; the same command goes on from the checkpoint in {folder}")
    })?;
    console.result(&serde_json::json!({ "complete": complete, "rows": rows }))
}
