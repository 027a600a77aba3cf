//! `inkrig train`: weights out of a corpus.

use crate::cli::{RunArgs, TrainArgs, TrainStage};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, fixed};
use inkrig_train::training::{Report, Row, VaeSettings, train_vae};
use std::ops::ControlFlow;
use std::time::Instant;

pub(super) fn run(args: &TrainArgs, console: &Console) -> Result<(), CliError> {
    match &args.stage {
        TrainStage::Vae { run } => vae(run, console),
    }
}

fn vae(run: &RunArgs, console: &Console) -> Result<(), CliError> {
    let settings = run.config.as_deref().map(VaeSettings::read).transpose()?.unwrap_or_default();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let replicas = run.replicas.unwrap_or(cores);
    let began = Instant::now();
    let bar = console.bar("training");
    let mut late = false;
    let report = train_vae(&run.corpus, &run.out, &settings, replicas, &mut |step, steps, row| {
        if let Some(row) = row {
            bar.note(&line(row));
        }
        late = run.minutes.is_some_and(|minutes| began.elapsed().as_secs_f64() > 60.0 * minutes);
        if late { ControlFlow::Break(()) } else { bar.at(step as usize, steps as usize) }
    })?;
    drop(bar);
    console.say(summary(&report, run))?;
    console.result(&serde_json::json!({
        "complete": report.complete,
        "held_out": report.held_out,
        "rows": report.rows,
    }))
}

fn line(row: &Row) -> String {
    format!(
        "step {:>6}  loss {}  held out {} mm, aligned {} mm  ({} min)",
        row.step,
        fixed(row.loss, 4),
        fixed(row.held_out_mm, 1),
        fixed(row.held_out_aligned_mm, 1),
        fixed(row.seconds / 60.0, 0)
    )
}

fn summary(report: &Report, run: &RunArgs) -> String {
    let mut text = String::new();
    for row in &report.held_out {
        text += &format!(
            "held-out clips of {} frames: {} mm, {} mm with the pelvis at its place ({} windows)\n",
            row.frames,
            fixed(row.global_mm, 1),
            fixed(row.aligned_mm, 1),
            row.windows
        );
    }
    let folder = printable::path(&run.out);
    if report.complete {
        format!("{text}done: {folder} holds the weights (best.safetensors, last.safetensors)")
    } else {
        format!("{text}stopped; the same command goes on from the checkpoint in {folder}")
    }
}
