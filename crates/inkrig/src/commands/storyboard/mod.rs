//! `inkrig storyboard`: drawn frames become one animation.

mod creature;
mod engines;
mod examples;
mod landing;
mod making;
mod marks;
mod onto;
mod page;
mod read;
mod record;
mod scene;
mod sheet;
mod space;
mod takes;
mod video;

use super::generate::{HUMANOID, Model, named_model};
use crate::cli::{EngineArg, StoryboardArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::printable;
use crate::provenance::{Facts, Run};
use crate::{load, names, results};
use engines::Engines;
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_motion::humanml::{FRAME_RATE, Joints, to_clip};
use inkrig_storyboard::NO_TAKE;
use onto::Character;
use record::Record;
use serde::Serialize;
use std::path::{Path, PathBuf};

pub(super) use making::{
    Asked, CANDIDATES, GUIDE_EVERY, Made, Next, Reader, Settings, Workshop, all, frames, lasting, shown,
};
pub(super) use page::{page, pose, ways};
pub(super) use record::{Part, parts, poses};
pub(super) use sheet::png;
pub(super) use takes::Takes;

pub(super) fn run(args: &StoryboardArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    let format = results::format_of(&args.out)?;
    let named = named_model(args.model.as_ref());
    let more = || {
        [&args.report, &args.sheet, &args.preview, &args.video].into_iter().flatten().map(PathBuf::as_path)
    };
    let inputs = [Some(&args.board), named.as_ref(), args.onto.as_ref()].into_iter().flatten();
    names::results_differ(inputs.map(PathBuf::as_path), std::iter::once(args.out.as_path()).chain(more()))?;
    results::check_picture(args.sheet.as_ref())?;
    run.check_motion(&args.out, &args.sidecar)?;
    more().try_for_each(|path| run.check(path))?;
    args.video.as_deref().map_or(Ok(()), video::check)?;
    engines::check(args)?;

    let mut board = read::board(&args.board)?;
    let mut warnings = Vec::new();
    let examples = match &args.examples {
        Some(folder) => {
            let examples = examples::examples(folder, console, &mut warnings)?;
            let read = examples.files.iter().map(PathBuf::as_path);
            names::results_differ(read, std::iter::once(args.out.as_path()).chain(more()))?;
            Some(examples)
        }
        None => None,
    };
    if let Some(examples) = examples.as_ref().filter(|examples| !examples.library.of_person()) {
        return creature::run(args, run, console, (&board, examples), warnings);
    }
    for frame in board.frames.iter_mut().filter(|frame| !frame.edits.is_empty()) {
        frame.lock_ends |= args.lock_ends;
    }
    let clips: Vec<PathBuf> =
        (1..=board.frames.len()).filter(|_| args.clips).map(|number| numbered(&args.out, number)).collect();
    clips.iter().try_for_each(|path| run.check(path))?;
    let character =
        args.onto.as_ref().map(|path| Character::read(path, console, &mut warnings)).transpose()?;
    let stage = console.stage("reading the model");
    let mut model = Model::asked(named.as_deref(), args.steps)?;
    model.body()?;
    let encoder = model.read(args.text_model.as_deref())?;
    drop(stage);
    let stage = console.stage("reading the drawings");
    let understood = frames(&board, &model, &args.board)?;
    drop(stage);
    let settings = Settings::of(args);
    let workshop =
        Workshop { model: &model, encoder: encoder.as_ref(), settings: &settings, path: &args.board };
    let asked = all(&board, understood.iter().map(Some));
    let library = examples.as_ref().map(|examples| &examples.library);
    let Engines { made, retrieved, compared } =
        engines::made(args.engine, &workshop, &asked, (library, character.as_ref()), console)?;
    if args.engine == EngineArg::Example {
        let chosen = asked.iter().filter(|asked| asked.frame.take > 0);
        warnings.extend(chosen.map(|asked| format!("frame {}: {NO_TAKE}", asked.number)));
    }

    warnings.extend(
        understood
            .iter()
            .enumerate()
            .flat_map(|(at, frame)| frame.notes.iter().map(move |note| format!("frame {}: {note}", at + 1))),
    );
    let name = if board.title.is_empty() { "storyboard" } else { &board.title };
    let export = |name: &str| ExportOptions {
        name: Some(name.to_owned()),
        humanoid: HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec(),
        ..ExportOptions::default()
    };
    let clip = &made.animation.clip;
    let (written, moved, certificate) = match &character {
        Some(character) => {
            let (moved, certificate) = character.carry(clip)?;
            let written = write_motion(&moved, format, &character.export(format, name))?;
            (written, Some(moved), Some(certificate))
        }
        None => (write_motion(clip, format, &export(name))?, None, None),
    };
    warnings.extend(load::warnings(&written.findings, &args.out));
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    for ((path, motion), frame) in clips.iter().zip(&made.animation.clips).zip(&understood) {
        files.push((path, clip_bytes(motion, &made, format, &export(&frame.plan.word))?));
    }
    let mut record = Record::of(args, &model, (&asked, &made), certificate, warnings);
    record.add_engines(&retrieved, compared);
    if let Some(path) = &args.video {
        let scene = scene::Scene::of_person(&board, &understood, &made);
        files.push((path, video::video(path, &scene, console, &mut record.warnings)?));
    }
    if let Some(path) = &args.report {
        files.push((path, serde_json::to_vec_pretty(&record)?));
    }
    if let Some(path) = &args.preview {
        let page =
            page(name, &board, (&understood, &made), moved.as_ref(), (&record.figures(), &record.warnings));
        files.push((path, page.into_bytes()));
    }
    if let Some(path) = &args.sheet {
        files.push((path, png(&board, &understood, &made)?));
    }
    for warning in &record.warnings {
        console.warn(warning);
    }
    let arguments = match &named {
        Some(path) => run.arguments.with_option("model", path, args.model.is_none()),
        None => run.arguments.clone(),
    };
    let inputs = [args.board.clone()];
    let facts = Facts { seed: Some(args.seed), ..Facts::of_files(&inputs) };
    let run = Run { arguments: &arguments, sink: run.sink };
    let results = Results { motion: &written.bytes, facts: &facts, beside: &files };
    finish(args, &run, &results, (record.text(), &record), console)
}

/// What is written.
struct Results<'a> {
    motion: &'a [u8],
    facts: &'a Facts<'a>,
    beside: &'a [(&'a Path, Vec<u8>)],
}

/// Writes the motion and what is beside it, and says so.
fn finish(
    args: &StoryboardArgs,
    run: &Run<'_>,
    results: &Results<'_>,
    (text, record): (String, &impl Serialize),
    console: &Console,
) -> Result<(), CliError> {
    run.write_motion(&args.out, results.motion, &args.sidecar, results.facts)?;
    for (path, bytes) in results.beside {
        run.write(path, bytes)?;
    }
    console.say(text)?;
    run.say(&args.out, &args.sidecar, console)?;
    for (path, _) in results.beside {
        console.say(format!("wrote {}", printable::path(path)))?;
    }
    console.result(record)
}

/// A frame's own motion as a file.
fn clip_bytes(
    motion: &[Joints],
    made: &Made,
    format: Format,
    export: &ExportOptions,
) -> Result<Vec<u8>, CliError> {
    let own = to_clip(motion, made.animation.clip.skeleton(), FRAME_RATE)?;
    Ok(write_motion(&own, format, export)?.bytes)
}

/// `out.bvh` becomes `out-1.bvh`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    path.with_file_name(format!("{stem}-{number}.{ending}"))
}
