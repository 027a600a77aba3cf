//! `inkrig train`: weights out of a corpus, or out of fonts.

mod readers;

use crate::cli::{RunArgs, TrainArgs, TrainStage};
use crate::console::Console;
use crate::error::CliError;
use crate::output::Output;
use crate::printable::{self, fixed};
use inkrig_train::TrainError;
use inkrig_train::training::{
    AlignSettings, ControlSettings, DenoiserSettings, DistillSettings, OnStep, Place, Reconstruction, Report,
    Row, VaeSettings, check_folder, curves, train_align, train_control, train_denoiser, train_distill,
    train_vae,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

pub(super) fn run(args: &TrainArgs, console: &Console) -> Result<(), CliError> {
    match &args.stage {
        TrainStage::Vae { run } => {
            let settings = settings(run, VaeSettings::read)?;
            let (report, held_out) =
                watched(run, console, |place, progress| train_vae(place, &settings, progress))?;
            finish(run, console, &report, &held_out)
        }
        TrainStage::Denoiser { vae, run } => {
            let settings = settings(run, DenoiserSettings::read)?;
            let report =
                watched(run, console, |place, progress| train_denoiser(place, vae, &settings, progress))?;
            finish(run, console, &report, &[])
        }
        TrainStage::Control { model, run } => {
            let settings = settings(run, ControlSettings::read)?;
            let report =
                watched(run, console, |place, progress| train_control(place, model, &settings, progress))?;
            finish(run, console, &report, &[])
        }
        TrainStage::Align { model, run } => {
            let settings = settings(run, AlignSettings::read)?;
            let report =
                watched(run, console, |place, progress| train_align(place, model, &settings, progress))?;
            finish(run, console, &report, &[])
        }
        TrainStage::Distill { model, run } => {
            let settings = settings(run, DistillSettings::read)?;
            let report =
                watched(run, console, |place, progress| train_distill(place, model, &settings, progress))?;
            finish(run, console, &report, &[])
        }
        TrainStage::Sketch { corpus, pace } => readers::sketch(corpus, pace, console),
        TrainStage::Word { fonts, pace } => readers::word(fonts, pace, console),
        TrainStage::Curves { run, out, force } => {
            let output = Output { force: *force };
            output.check(out)?;
            output.write(out, curves(run)?.as_bytes())?;
            console.say(format!("wrote {}", printable::path(out)))
        }
    }
}

fn settings<S: Default>(run: &RunArgs, read: impl Fn(&Path) -> Result<S, TrainError>) -> Result<S, CliError> {
    Ok(run.config.as_deref().map(read).transpose()?.unwrap_or_default())
}

/// Runs a stage with a bar and its measurements, until the minutes are over.
fn watched<T>(
    run: &RunArgs,
    console: &Console,
    stage: impl FnOnce(&Place<'_>, &mut OnStep<'_>) -> Result<T, TrainError>,
) -> Result<T, CliError> {
    check_folder(&run.out)?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let place = Place {
        corpus: &run.corpus,
        folder: &run.out,
        from: run.from.as_deref(),
        replicas: run.replicas.unwrap_or(cores),
    };
    let began = Instant::now();
    let bar = console.bar("training");
    let report = stage(&place, &mut |step, steps, row| {
        if let Some(row) = row {
            bar.note(&line(row));
        }
        let late = run.minutes.is_some_and(|minutes| began.elapsed().as_secs_f64() > 60.0 * minutes);
        if late { ControlFlow::Break(()) } else { bar.at(step as usize, steps as usize) }
    })?;
    drop(bar);
    Ok(report)
}

fn line(row: &Row) -> String {
    let mut text = format!("step {:>6}  loss {}", row.step, fixed(row.loss, 4));
    for (name, value) in row.values.iter().filter(|(name, _)| name.starts_with("held_out")) {
        let digits = if name.ends_with("mm") { 1 } else { 4 };
        text += &format!("  {} {}", name.replace('_', " "), fixed(*value, digits));
    }
    format!("{text}  ({} min)", fixed(row.seconds / 60.0, 0))
}

fn finish(
    run: &RunArgs,
    console: &Console,
    report: &Report,
    held_out: &[Reconstruction],
) -> Result<(), CliError> {
    console.say(summary(report, held_out, run))?;
    console.result(&serde_json::json!({
        "complete": report.complete,
        "best": report.best,
        "held_out": held_out,
        "rows": report.rows,
    }))
}

fn summary(report: &Report, held_out: &[Reconstruction], run: &RunArgs) -> String {
    let mut text = String::new();
    for row in held_out {
        text += &format!(
            "held-out clips of {} frames: {} mm, {} mm with the pelvis at its place ({} windows)\n",
            row.frames,
            fixed(row.global_mm, 1),
            fixed(row.aligned_mm, 1),
            row.windows
        );
    }
    if let Some((value, step)) = report.best {
        text += &format!("best measurement: {} at step {step}\n", fixed(value, 4));
    }
    let folder = printable::path(&run.out);
    if report.complete {
        format!("{text}done: {folder} holds the weights (best.safetensors, last.safetensors)")
    } else {
        format!("{text}stopped; the same command goes on from the checkpoint in {folder}")
    }
}
