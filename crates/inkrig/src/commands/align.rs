//! `inkrig align`: a clip and a control in, a clip that follows the control out.

use super::control::control;
use super::keys;
use super::record::{Explained, Record};
use super::settings::options;
use crate::cli::AlignArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::guide::{CANDIDATES, Suggestions, guide};
use crate::output::Output;
use crate::over_ground::OverGround;
use crate::results::{self, Made, Places};
use crate::{load, names, printable, span};
use inkrig_align::align;
use inkrig_formats::{Import, SourceInfo};
use inkrig_motion::{Clip, MotionError, Takes, cycle, time};
use std::path::{Path, PathBuf};

pub(super) fn run(args: &AlignArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    let mut options = options(args);
    options.validate()?;
    options.keys = keys::all(args)?;
    check_names(args, output)?;
    let over_ground = OverGround::of(&args.root)?;
    let mut warnings = Vec::new();
    let (source, mut first) = source(args, console, &mut warnings)?;
    keys::count_from_range(&mut options.keys, args, source.clip().frame_rate())?;
    let control = control(args, &options, |path| Ok(motion(path, args, console, &mut warnings)?.clip))?;
    let bar = console.bar("aligning");
    let mut alignment = align(&source, &control, &options, &mut |progress| bar.update(progress))?;
    bar.finish()?;
    let (clip, ground) = over_ground.apply(alignment.clip, &mut first, args.cyclic)?;
    alignment.clip = clip;
    alignment.report.notes.extend(ground.notes());
    if let Some(rate) = args.fps {
        // Before anything is told or shown of it, so that all results are of the clip that is written.
        alignment.clip = if args.cyclic {
            cycle::resample_loop(&alignment.clip, rate)?
        } else {
            time::resample(&alignment.clip, rate)?
        };
    }
    let suggestions = Suggestions::of(&source, &options, CANDIDATES)?;
    let first_frame = keys::first_frame(args, source.clip().frame_rate());
    let guide = guide(&alignment, &suggestions, &options, &clip_names(args), first_frame);
    let made = Made {
        title: &title(args),
        alignment: &alignment,
        control: &control,
        source: &first,
        guide: Some(&guide),
    };
    let record = results::write(
        &made,
        args.places(),
        console,
        |more| {
            let explained = Explained::of(&alignment, &options, &suggestions, first_frame);
            Record::of(args, &options, &alignment, explained, ground, [warnings, more].concat())
        },
        &mut |path, bytes| Ok(output.write(path, bytes)?),
    )?;
    console.result(&record)
}

impl AlignArgs {
    /// Files that are read.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.clips
            .iter()
            .cloned()
            .chain(self.control.file())
            .chain(self.key_file.clone())
            .chain(self.root.file())
            .collect()
    }

    /// Files that are written.
    pub(super) fn places(&self) -> Places<'_> {
        Places {
            motion: &self.out,
            report: self.report.as_ref(),
            preview: self.preview.as_ref(),
            sheet: self.sheet.as_ref(),
        }
    }
}

/// The clips to arrange, and where the first came from.
fn source(
    args: &AlignArgs,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<(Takes, SourceInfo), CliError> {
    let mut first = None;
    let mut clips = Vec::with_capacity(args.clips.len());
    for path in &args.clips {
        let import = motion(path, args, console, warnings)?;
        clips.push(cut(import.clip, path, args)?);
        first.get_or_insert(import.source);
    }
    let takes = Takes::join(&clips).map_err(|error| match error {
        MotionError::OtherSkeleton { clip, .. } => {
            CliError::Clip { path: args.clips.get(clip).cloned().unwrap_or_default(), cause: error }
        }
        other => other.into(),
    })?;
    Ok((takes, first.ok_or(MotionError::NoFrames)?))
}

/// Reads a motion and says what is odd in it.
fn motion(
    path: &Path,
    args: &AlignArgs,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Import, CliError> {
    let stage = console.stage(format!("reading {}", printable::path(path)));
    let import = load::motion(path, &args.import)?;
    drop(stage);
    for warning in load::warnings(&import.findings, path) {
        console.warn(&warning);
        warnings.push(warning);
    }
    Ok(import)
}

/// The part of a clip that was asked for.
fn cut(clip: Clip, path: &Path, args: &AlignArgs) -> Result<Clip, CliError> {
    let Some(range) = args.range else { return Ok(clip) };
    let frames = range.frames(clip.frame_rate(), clip.frames());
    if frames.is_empty() {
        let (seconds, frames) = (span::seconds(&clip), clip.frames());
        return Err(CliError::Range { path: path.to_path_buf(), range, seconds, frames });
    }
    time::trim(&clip, frames).map_err(|cause| CliError::Clip { path: path.to_path_buf(), cause })
}

/// Says before any work whether the results can be written, each to a file of its own.
fn check_names(args: &AlignArgs, output: Output) -> Result<(), CliError> {
    if args.out.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("bvh")) {
        return Err(CliError::Kind { path: args.out.clone(), known: "results are written as .bvh" });
    }
    let inputs = args.inputs();
    names::all_differ(inputs.iter().map(PathBuf::as_path).chain(args.places().all()))?;
    for path in args.places().all() {
        output.check(path)?;
    }
    Ok(())
}

fn title(args: &AlignArgs) -> String {
    let control = match args.control.file() {
        Some(path) => name(&path),
        None => args.control.text().unwrap_or_default().to_string(),
    };
    format!("{} follows {control}", clip_names(args).join(", "))
}

fn clip_names(args: &AlignArgs) -> Vec<String> {
    args.clips.iter().map(|path| name(path)).collect()
}

fn name(path: &Path) -> String {
    path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
