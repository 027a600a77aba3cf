//! What one alignment leaves on the disk: the motion, and what else was asked for.

use crate::console::Console;
use crate::error::CliError;
use crate::preview::Guide;
use crate::{load, show};
use inkrig_align::{Alignment, Control};
use inkrig_formats::{ExportOptions, Format, KeptRow, SourceInfo, write_motion};
use inkrig_motion::keyframes::KeyedClip;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What was made.
#[derive(Debug)]
pub(crate) struct Made<'a> {
    /// Stands at the top of the page.
    pub(crate) title: &'a str,
    /// The result; all files show this clip.
    pub(crate) alignment: &'a Alignment,
    /// What it follows.
    pub(crate) control: &'a Control,
    /// How the source was written, and so how the result is.
    pub(crate) source: &'a SourceInfo,
    /// What the page says of why.
    pub(crate) guide: Option<&'a Guide>,
    /// Rows of an earlier result that are written as they stand there.
    pub(crate) kept: Vec<KeptRow>,
    /// The motion as few keys.
    pub(crate) keys: Option<KeyedClip>,
}

/// Where it goes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places<'a> {
    /// The motion.
    pub(crate) motion: &'a Path,
    /// The record as JSON.
    pub(crate) report: Option<&'a PathBuf>,
    /// The page.
    pub(crate) preview: Option<&'a PathBuf>,
    /// The contact sheet.
    pub(crate) sheet: Option<&'a PathBuf>,
}

impl<'a> Places<'a> {
    /// All of them, the motion first.
    pub(crate) fn all(self) -> impl Iterator<Item = &'a Path> {
        let more = [self.report, self.preview, self.sheet].into_iter().flatten();
        std::iter::once(self.motion).chain(more.map(PathBuf::as_path))
    }
}

/// Writes a file whole, or says why not.
pub(crate) type Put<'a> = &'a mut dyn FnMut(&Path, &[u8]) -> Result<(), CliError>;

/// Makes all files, writes them by `put`, and says so. `record` is told the warnings of writing the motion.
///
/// Nothing is written before everything is made: a sheet that cannot be drawn leaves no half of a result.
pub(crate) fn write<R: Serialize>(
    made: &Made<'_>,
    places: Places<'_>,
    console: &Console,
    record: impl FnOnce(Vec<String>) -> R,
    put: Put<'_>,
) -> Result<R, CliError> {
    let (alignment, control) = (made.alignment, made.control);
    let stage = console.stage("writing the motion");
    let format = format_of(places.motion)?;
    let written = write_motion(
        &alignment.clip,
        format,
        &ExportOptions {
            name: Some(made.title.to_string()),
            kept: made.kept.clone(),
            keys: made.keys.clone(),
            ..ExportOptions::in_format(format, made.source)
        },
    )?;
    drop(stage);
    let warnings = load::warnings(&written.findings, places.motion);
    for warning in &warnings {
        console.warn(warning);
    }
    let record = record(warnings);
    let mut files = vec![(places.motion, written.bytes)];
    if let Some(path) = places.report {
        files.push((path, serde_json::to_string_pretty(&record)?.into_bytes()));
    }
    if let Some(path) = places.preview {
        let _stage = console.stage("making the preview");
        files.push((path, show::page(made.title, alignment, control, made.guide).into_bytes()));
    }
    if let Some(path) = places.sheet {
        let _stage = console.stage("drawing the sheet");
        files.push((path, show::sheet(alignment, control)?));
    }
    let stage = console.stage("writing the files");
    for (path, bytes) in &files {
        put(path, bytes)?;
    }
    drop(stage);
    console.say(show::summary(alignment, places.motion))?;
    for path in places.all().skip(1) {
        console.say(format!("wrote {}", crate::printable::path(path)))?;
    }
    Ok(record)
}

/// The format of a result, by its name.
///
/// # Errors
/// When the name says none that is written.
pub(crate) fn format_of(path: &Path) -> Result<Format, CliError> {
    let known =
        "results are written as .bvh, .glb, .fbx, .usda, .vrma, and into a .gltf or .vrm that was read";
    let format = path.extension().and_then(|extension| Format::from_extension(extension.to_str()?));
    format
        .filter(|format| format.is_written())
        .ok_or_else(|| CliError::Kind { path: path.to_path_buf(), known })
}

/// Refuses a name that ends in another kind of file than is written to it.
///
/// # Errors
/// [`CliError::Ending`] with the name.
pub(crate) fn check_ending(path: &Path, ending: &'static str, what: &'static str) -> Result<(), CliError> {
    if load::extension(path).as_deref() == Some(ending) {
        return Ok(());
    }
    Err(CliError::Ending { path: path.to_path_buf(), what, ending })
}

/// The same for a picture.
///
/// # Errors
/// As [`check_ending`].
pub(crate) fn check_picture(path: Option<&PathBuf>) -> Result<(), CliError> {
    path.map_or(Ok(()), |path| check_ending(path, "png", "a picture"))
}
