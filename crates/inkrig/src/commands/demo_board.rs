//! The demo's storyboard: three drawn frames become one dance.

use super::demo_files::DemoFiles;
use super::generate::{HUMANOID, Model};
use super::storyboard::{Settings, Takes, Workshop, all, frames, page as board_page, png, shown};
use crate::cli::{BlendArg, ExactArg};
use crate::console::Console;
use crate::error::CliError;
use crate::printable;
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_samples::Sample;
use inkrig_sketch::storyboard::read_storyboard;

/// Which one.
const NAME: &str = "dance";
/// The motion, the page and the sheet.
pub(super) const RESULTS: [&str; 3] =
    ["dance-storyboard.bvh", "dance-storyboard.html", "dance-storyboard.png"];

pub(super) fn sample() -> Option<&'static Sample> {
    inkrig_samples::storyboards().iter().find(|sample| sample.name == NAME)
}

/// Makes it with few steps: a demo is to be seen soon.
pub(super) fn make_board(
    sample: &Sample,
    files: &mut DemoFiles<'_>,
    console: &Console,
) -> Result<(), CliError> {
    let path = files.path(sample.file_name);
    let board = read_storyboard(sample.bytes)
        .map_err(|cause| CliError::Curve { path: path.clone(), cause: Box::new(cause) })?;
    let settings = Settings {
        exact: ExactArg::Pin,
        blend: BlendArg::Smooth,
        steps: None,
        text_weight: None,
        candidates: 2,
        guide_every: 10,
        seed: 0,
    };
    let mut model = Model::shipped(settings.steps)?;
    let encoder = model.read(None)?;
    let understood = frames(&board, &model, &path)?;
    let workshop = Workshop { model: &model, encoder: encoder.as_ref(), settings: &settings, path: &path };
    let watch = &mut shown(console, understood.len());
    let asked = all(&board, understood.iter().map(Some));
    let made = workshop.make(&asked, &mut Takes::default(), watch)?;
    let export = ExportOptions {
        name: Some(board.title.clone()),
        humanoid: HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec(),
        ..ExportOptions::default()
    };
    let [motion, page, sheet] = RESULTS;
    files.write(motion, &write_motion(&made.animation.clip, Format::Bvh, &export)?.bytes)?;
    let read = (&understood[..], &made);
    let html = board_page(&board.title, &board, read, None, (&[], &[]));
    files.write(page, html.as_bytes())?;
    files.write(sheet, &png(&board, &understood, &made)?)?;
    console.say(format!(
        "wrote {}, {} and {}: three drawn frames as one motion",
        printable::path(&files.path(motion)),
        printable::path(&files.path(page)),
        printable::path(&files.path(sheet))
    ))?;
    Ok(())
}
