//! `inkrig align`: a clip and a control in, a clip that follows the control out.

use super::control::control;
use super::keys::{self, Kept};
use super::record::{self, Explained, Record, Solution};
use super::settings::options;
use crate::bake::{self, BakeRecord};
use crate::cli::{AlignArgs, BakeMode, ImportArgs, RootMode};
use crate::console::Console;
use crate::error::CliError;
use crate::guide::{CANDIDATES, Origin, Suggestions, guide};
use crate::map_picture::Canvas;
use crate::over_ground::OverGround;
use crate::provenance::{Facts, Run};
use crate::results::{self, Made, Places};
use crate::span::Span;
use crate::{clip_path, load, names, printable, span};
use inkrig_align::{
    Alternative, Control, Norm, Options, align, alternatives, at_frame_rate, exact_frames, keys_on_map,
};
use inkrig_formats::{Import, SourceInfo};
use inkrig_motion::{Clip, MotionError, Takes, cycle, time};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &AlignArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    bake::check(&args.bake)?;
    let mut options = options(args);
    options.validate()?;
    let wishes = keys::all(args)?;
    let mut inputs = args.inputs();
    inputs.extend(keys::files(&wishes, args));
    let mut named = BTreeSet::new();
    inputs.retain(|file| named.insert(file.clone()));
    check_names(args, &inputs, run)?;
    let over_ground = OverGround::of(&args.root)?;
    let mut warnings = Vec::new();
    let Sources { takes: source, first, parts } =
        source(&args.clips, args.range, args.laps, &args.import, console, &mut warnings)?;
    let control = control(args, &options, console, &mut warnings)?;
    let rate = args.fps.unwrap_or_else(|| source.clip().frame_rate());
    let clips = keys::Clips { takes: &source, parts: &parts, rate };
    // Poses are of the same character, and so in the same unit and axes; which clip and what rate is of the first file.
    let beside = ImportArgs { clip: None, source_fps: None, ..args.import.clone() };
    let read = |path: &Path| motion(path, &beside, console, &mut warnings);
    let (keys, kept) = keys::resolve(&wishes, &clips, &control, read)?;
    if kept.is_some() && (args.root.root != RootMode::Travel || args.root.path.is_some()) {
        let cause =
            "--path and --root move all of the motion over the ground: leave them out, or --fix".to_string();
        return Err(CliError::Fix { path: args.fix_from.clone().unwrap_or_default(), cause });
    }
    if kept.is_some() && load::extension(&args.out).as_deref() != Some("bvh") {
        let cause = "what stays to the byte is written to BVH files only: give -o a name that ends in .bvh"
            .to_string();
        return Err(CliError::Fix { path: args.fix_from.clone().unwrap_or_default(), cause });
    }
    if kept.is_some() && args.bake.bake != BakeMode::Dense {
        let cause = "--bake makes other keys of all frames: leave it out, or --fix".to_string();
        return Err(CliError::Fix { path: args.fix_from.clone().unwrap_or_default(), cause });
    }
    options.keys = keys;
    // The result is written as the earlier one whose rows it keeps.
    let (kept, first) = kept.map_or((Vec::new(), first), |kept: Kept| (kept.rows, kept.source));
    let mut suggestions = None;
    if args.on_map {
        let found = Suggestions::of(&source, options.threads, CANDIDATES)?;
        draw_on_map(args, &found, &mut options);
        suggestions = Some(found);
    }
    let mut solutions = solve(args, &source, &control, &options, console)?;
    let format = results::format_of(&args.out)?;
    let mut grounds = Vec::with_capacity(solutions.len());
    for Alternative { alignment, .. } in &mut solutions {
        let mut written_as = first.clone();
        let (clip, ground) = over_ground.apply(alignment.clip.clone(), &mut written_as, args.cyclic)?;
        alignment.clip = clip;
        alignment.report.notes.extend(ground.notes());
        if let Some(rate) = args.fps {
            // Before anything is told or shown of it, so that all results are of the clip that is written.
            let keys = &mut alignment.report.keys;
            alignment.clip = at_frame_rate(&alignment.clip, keys, rate, args.cyclic)?;
        }
        let exact = exact_frames(&alignment.clip, &alignment.report.keys);
        let baked = bake::bake(alignment.clip.clone(), &args.bake, &exact, (format, &written_as))?;
        alignment.clip = baked.clip;
        alignment.report.notes.extend(baked.record.as_ref().map(BakeRecord::note));
        grounds.push((written_as, ground, baked.keys, baked.record));
    }
    let told = console.json || args.report.is_some() || args.preview.is_some();
    if told && suggestions.is_none() {
        suggestions = Some(Suggestions::of(&source, options.threads, CANDIDATES)?);
    }
    let suggestions = suggestions.as_ref();
    let origin = Origin::of(&parts);
    let listed: Vec<Solution> =
        solutions.iter().enumerate().map(|(index, one)| Solution::of(&args.out_of(index), one)).collect();
    let mut first_record = None;
    for (index, (Alternative { alignment, .. }, (written_as, ground, few, baked))) in
        solutions.iter().zip(grounds).enumerate()
    {
        let names = clip_names(args);
        let guide = suggestions.map(|found| guide(alignment, found, &options, &names, origin.first_frame));
        let title =
            title(args) + &if index > 0 { format!(", solution {}", index + 1) } else { String::new() };
        let made = Made {
            title: &title,
            alignment,
            control: &control,
            source: &written_as,
            kept: kept.clone(),
            keys: few,
            guide: guide.as_ref(),
        };
        let names = Numbered::of(args, index);
        let record = results::write(
            &made,
            names.places(),
            console,
            |more| {
                let mut explained = Explained::of(alignment, &options, suggestions, &origin);
                explained.solutions.clone_from(&listed);
                Record::of(
                    args,
                    (&inputs, names.places()),
                    &options,
                    alignment,
                    explained,
                    (ground, baked),
                    [warnings.clone(), more].concat(),
                )
            },
            &mut |path, bytes| {
                if path == names.motion {
                    let facts = Facts {
                        files: &args.clips,
                        solution: index + 1,
                        seed: Some(args.seed),
                        gradients: Some(alignment.report.gradients),
                        engine: Some(record::engine(args, &options)?),
                    };
                    run.write_motion(path, bytes, &args.sidecar, &facts)
                } else {
                    run.write(path, bytes)
                }
            },
        )?;
        run.say(&names.motion, &args.sidecar, console)?;
        first_record.get_or_insert(record);
    }
    if args.solutions > 1 && solutions.len() == 1 {
        console.say("no other solution fits as well")?;
    }
    console.result(&first_record)
}

/// The solutions that were asked for, at least one.
fn solve(
    args: &AlignArgs,
    source: &Takes,
    control: &Control,
    options: &Options,
    console: &Console,
) -> Result<Vec<Alternative>, CliError> {
    let bar = console.bar("aligning");
    let observer = &mut |progress| bar.update(progress);
    let solutions = if args.solutions > 1 {
        alternatives(source, control, options, args.solutions, observer)?
    } else {
        let alignment = align(source, control, options, observer)?;
        vec![Alternative { alignment, objective: 0.0, distance: 0.0 }]
    };
    bar.finish()?;
    Ok(solutions)
}

/// Ties the drawing to the clip's map. An SVG is drawn over the picture of the map, anything else holds its coordinates.
fn draw_on_map(args: &AlignArgs, suggestions: &Suggestions, options: &mut Options) {
    let mut keys = keys_on_map(&suggestions.map, &suggestions.candidates);
    let svg = |path: &PathBuf| load::extension(path).as_deref() == Some("svg");
    if args.control.curve.as_ref().is_some_and(svg) {
        Canvas::of(&suggestions.map).move_keys(&mut keys);
    }
    options.keys.extend(keys);
    if args.norm.is_none() {
        options.control_norm = Norm::Learned;
    }
}

/// Names of the files of one solution: the first has those that were given.
struct Numbered {
    motion: PathBuf,
    report: Option<PathBuf>,
    preview: Option<PathBuf>,
    sheet: Option<PathBuf>,
}

impl Numbered {
    fn of(args: &AlignArgs, index: usize) -> Self {
        let name = |path: &PathBuf| numbered(path, index);
        Self {
            motion: name(&args.out),
            report: args.report.as_ref().map(name),
            preview: args.preview.as_ref().map(name),
            sheet: args.sheet.as_ref().map(name),
        }
    }

    fn places(&self) -> Places<'_> {
        Places {
            motion: &self.motion,
            report: self.report.as_ref(),
            preview: self.preview.as_ref(),
            sheet: self.sheet.as_ref(),
        }
    }
}

/// `new.bvh`, `new-2.bvh`, `new-3.bvh`.
fn numbered(path: &Path, index: usize) -> PathBuf {
    if index == 0 {
        return path.to_path_buf();
    }
    let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    path.with_file_name(format!("{}-{}{ending}", name(path), index + 1))
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

    /// The motion file of a solution, counted from 0.
    fn out_of(&self, index: usize) -> PathBuf {
        numbered(&self.out, index)
    }
}

/// The clips to arrange.
pub(super) struct Sources {
    pub(super) takes: Takes,
    /// Where the first came from.
    pub(super) first: SourceInfo,
    /// Path, frames a second and first frame that is used of every clip.
    pub(super) parts: Vec<(PathBuf, f64, usize)>,
}

/// Reads the clips to arrange; those that are loops are played `laps` times.
pub(super) fn source(
    paths: &[PathBuf],
    range: Option<Span>,
    laps: usize,
    options: &ImportArgs,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Sources, CliError> {
    let paths = &clip_path::expand(paths, options)?;
    let mut first = None;
    let mut parts = Vec::with_capacity(paths.len());
    let mut clips = Vec::with_capacity(paths.len());
    for path in paths {
        let import = motion(path, options, console, warnings)?;
        let rate = import.clip.frame_rate();
        let start = range.and_then(|range| range.start).map_or(0, |start| start.frames(rate));
        parts.push((path.clone(), rate, start));
        let clip = cut(import.clip, path, range)?;
        let again = if laps > 1 { cycle::laps(&clip, laps)? } else { None };
        if laps > 1 && again.is_none() {
            console.say(format!("{} is no loop: it is used once", printable::path(path)))?;
        }
        clips.push(again.unwrap_or(clip));
        first.get_or_insert(import.source);
    }
    let takes = Takes::join(&clips).map_err(|error| match error {
        MotionError::OtherSkeleton { clip, .. } => {
            CliError::Clip { path: paths.get(clip).cloned().unwrap_or_default(), cause: error }
        }
        other => other.into(),
    })?;
    Ok(Sources { takes, first: first.ok_or(MotionError::NoFrames)?, parts })
}

/// Reads a motion and says what is odd in it.
pub(super) fn motion(
    path: &Path,
    options: &ImportArgs,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Import, CliError> {
    let stage = console.stage(format!("reading {}", printable::path(path)));
    let import = load::motion(path, options)?;
    drop(stage);
    tell(&import, path, console, warnings);
    Ok(import)
}

/// Reads who shall move, and says what is odd in the file.
pub(super) fn character(
    path: &Path,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Import, CliError> {
    let stage = console.stage(format!("reading {}", printable::path(path)));
    let import = load::character(path)?;
    drop(stage);
    tell(&import, path, console, warnings);
    Ok(import)
}

fn tell(import: &Import, path: &Path, console: &Console, warnings: &mut Vec<String>) {
    for warning in load::warnings(&import.findings, path) {
        console.warn(&warning);
        warnings.push(warning);
    }
}

/// The part of a clip that was asked for.
pub(super) fn cut(clip: Clip, path: &Path, range: Option<Span>) -> Result<Clip, CliError> {
    let Some(range) = range else { return Ok(clip) };
    let frames = range.frames(clip.frame_rate(), clip.frames());
    if frames.is_empty() {
        let (seconds, frames) = (span::seconds(&clip), clip.frames());
        return Err(CliError::Range { path: path.to_path_buf(), range, seconds, frames });
    }
    time::trim(&clip, frames).map_err(|cause| CliError::Clip { path: path.to_path_buf(), cause })
}

/// Says before any work whether the results can be written, each to a file of its own that is no input.
fn check_names(args: &AlignArgs, inputs: &[PathBuf], run: &Run<'_>) -> Result<(), CliError> {
    bake::check_format(&args.bake, results::format_of(&args.out)?, &args.out)?;
    let names: Vec<Numbered> = (0..args.solutions).map(|index| Numbered::of(args, index)).collect();
    let places = || names.iter().flat_map(|names| names.places().all());
    let inputs = clip_path::files(inputs.iter().map(PathBuf::as_path));
    names::results_differ(inputs.iter().map(PathBuf::as_path), places())?;
    results::check_picture(args.sheet.as_ref())?;
    for names in &names {
        run.check_motion(&names.motion, &args.sidecar)?;
    }
    for path in places() {
        run.check(path)?;
    }
    Ok(())
}

fn title(args: &AlignArgs) -> String {
    let control = match args.control.file() {
        Some(path) => clip_path::name(&path),
        None => args.control.text().unwrap_or_default().to_string(),
    };
    format!("{} follows {control}", clip_names(args).join(", "))
}

fn clip_names(args: &AlignArgs) -> Vec<String> {
    args.clips.iter().map(|path| clip_path::name(path)).collect()
}

fn name(path: &Path) -> String {
    path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
