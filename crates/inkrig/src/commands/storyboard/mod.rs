//! `inkrig storyboard`: drawn frames become one animation.

mod read;
mod record;
mod sheet;

use super::generate::{HUMANOID, Model, about, named_model, sampling};
use crate::cli::{BlendArg, ExactArg, StoryboardArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::printable;
use crate::provenance::{Facts, Run};
use crate::{load, names, readers, results};
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_generate::blending::BlendOptions;
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::sampling::{Sampler, SamplingOptions};
use inkrig_generate::text::TextEncoder;
use inkrig_motion::Clip;
use inkrig_motion::humanml::{FRAME_RATE, skeleton, to_clip};
use inkrig_sketch::storyboard::Storyboard;
use inkrig_storyboard::{
    Blender, Generated, Goal, Joined, Maker, MakerOptions, MeetOptions, Met, StoryboardError, Understood,
    meet, read_figure, sequence, understand,
};
use record::Record;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) fn run(args: &StoryboardArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    let format = results::format_of(&args.out)?;
    let named = named_model(args.model.as_ref());
    let more = || [&args.report, &args.sheet].into_iter().flatten().map(PathBuf::as_path);
    let inputs = [Some(&args.board), named.as_ref()].into_iter().flatten();
    names::results_differ(inputs.map(PathBuf::as_path), std::iter::once(args.out.as_path()).chain(more()))?;
    run.check_motion(&args.out, &args.sidecar)?;
    more().try_for_each(|path| run.check(path))?;

    let board = read::board(&args.board)?;
    let clips: Vec<PathBuf> =
        (1..=board.frames.len()).filter(|_| args.clips).map(|number| numbered(&args.out, number)).collect();
    clips.iter().try_for_each(|path| run.check(path))?;
    let stage = console.stage("reading the model");
    let mut model = match &named {
        Some(path) => Model::open(path)?,
        None => Model::shipped(args.steps)?,
    };
    let encoder = model.read(args.text_model.as_deref())?;
    drop(stage);
    let stage = console.stage("reading the drawings");
    let understood = frames(&board, &model, args)?;
    drop(stage);
    let made = make(&understood, &model, encoder.as_ref(), args, console)?;

    let mut warnings: Vec<String> = understood
        .iter()
        .enumerate()
        .flat_map(|(at, frame)| frame.notes.iter().map(move |note| format!("frame {}: {note}", at + 1)))
        .collect();
    let name = if board.title.is_empty() { "storyboard" } else { &board.title };
    let export = |name: &str| ExportOptions {
        name: Some(name.to_owned()),
        humanoid: HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec(),
        ..ExportOptions::default()
    };
    let written = write_motion(&made.clip, format, &export(name))?;
    warnings.extend(load::warnings(&written.findings, &args.out));
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    for ((path, clip), frame) in clips.iter().zip(&made.clips).zip(&understood) {
        files.push((path, clip_bytes(clip, &made, format, &export(&frame.plan.word))?));
    }
    let record = Record::of(args, &model, &understood, &made, warnings);
    if let Some(path) = &args.report {
        files.push((path, serde_json::to_vec_pretty(&record)?));
    }
    if let Some(path) = &args.sheet {
        files.push((path, sheet::png(&board, &understood, &made)?));
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
    run.write_motion(&args.out, &written.bytes, &args.sidecar, &facts)?;
    for (path, bytes) in &files {
        run.write(path, bytes)?;
    }
    console.say(record.text())?;
    run.say(&args.out, &args.sidecar, console)?;
    for (path, _) in &files {
        console.say(format!("wrote {}", printable::path(path)))?;
    }
    console.result(&record)
}

/// What came of all frames.
pub(super) struct Made {
    /// The whole.
    pub(super) clip: Clip,
    /// Of each frame, before they were joined.
    pub(super) clips: Vec<Generated>,
    pub(super) joined: Joined,
    /// What the frames ask of the whole.
    pub(super) goals: Vec<Vec<Goal>>,
    /// Where goals were met after sampling.
    pub(super) met: Option<Met>,
}

fn wrong(path: &Path) -> impl Fn(StoryboardError) -> CliError + '_ {
    |cause| CliError::Storyboard { path: path.into(), cause: Box::new(cause) }
}

/// Reads what is drawn.
fn frames(board: &Storyboard, model: &Model, args: &StoryboardArgs) -> Result<Vec<Understood>, CliError> {
    let wrong = wrong(&args.board);
    let reader = readers::sketch(None)?;
    let lettered = |board: &Storyboard| {
        board.frames.iter().any(|frame| frame.word.trim().is_empty() && !frame.lettering.is_empty())
    };
    let words = if lettered(board) { Some(readers::word(None)?) } else { None };
    let mut understood = Vec::new();
    for (at, frame) in board.frames.iter().enumerate() {
        let number = at + 1;
        let figure = read_figure(frame, number, &reader).map_err(&wrong)?;
        let read = understand(frame, number, figure, &model.body, words.as_ref()).map_err(&wrong)?;
        let most = model.header.sizes.most_frames();
        if read.plan.frames > most {
            return Err(wrong(StoryboardError::Frame {
                frame: number,
                problem: format!(
                    "it lasts {} s, but the model makes at most {} s",
                    printable::fixed(read.plan.frames as f64 / FRAME_RATE, 1),
                    printable::fixed(most as f64 / FRAME_RATE, 1)
                ),
                todo: "Make it shorter, or two frames of it".into(),
            }));
        }
        understood.push(read);
    }
    Ok(understood)
}

fn make(
    understood: &[Understood],
    model: &Model,
    encoder: &dyn TextEncoder,
    args: &StoryboardArgs,
    console: &Console,
) -> Result<Made, CliError> {
    let wrong = wrong(&args.board);
    let usual = sampling(&model.header, args.steps, &model.path)?;
    let options = MakerOptions {
        sampling: SamplingOptions {
            text_weight: args.text_weight.map_or(usual.text_weight, |weight| weight as f32),
            guidance: usual.guidance.clone().filter(|_| args.exact != ExactArg::Off),
            guide_every: usize::from(args.guide_every),
            settle: Some(SettleOptions::default()),
            ..usual
        },
        candidates: usize::from(args.candidates),
        seed: args.seed,
    };
    let no_text = encoder.encode("").map_err(|cause| about(&model.path, cause))?;
    let text = |number: usize, word: &str| {
        let description = if word.is_empty() { String::new() } else { model.description(word) };
        let failed = |cause| wrong(StoryboardError::Generate { frame: number, cause: Box::new(cause) });
        encoder.encode(&description).map_err(failed)
    };
    let texts: Vec<Vec<f32>> = understood
        .iter()
        .enumerate()
        .map(|(at, frame)| text(at + 1, &frame.plan.word))
        .collect::<Result<_, _>>()?;
    let networks = model.networks()?;
    let maker =
        Maker { networks, features: &model.features, no_text: &no_text, usual_frames: model.usual_frames() };
    let mut clips = Vec::new();
    for (at, (frame, text)) in understood.iter().zip(&texts).enumerate() {
        let _stage = console.stage(format!("frame {} of {}", at + 1, understood.len()));
        clips.push(maker.clip(at + 1, &frame.plan, text, &options).map_err(&wrong)?);
    }
    let stage = console.stage("joining");
    let sampler = Sampler { networks, features: &model.features, no_text: &no_text };
    let both: Vec<Vec<f32>> = texts
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| 0.5 * (a + b)).collect())
        .collect();
    let blending = BlendOptions {
        text_weight: options.sampling.text_weight,
        guide_every: 10,
        ..BlendOptions::default()
    };
    let blender = Blender { sampler: &sampler, texts: &both, options: &blending };
    let joined = sequence(&clips, Some(blender).filter(|_| args.blend == BlendArg::Model)).map_err(&wrong)?;
    let rig = Arc::new(skeleton(&model.body, &joined.motion)?);
    let mut clip = to_clip(&joined.motion, &rig, FRAME_RATE)?;
    let goals = goals(&clips, &joined);
    drop(stage);
    let mut met = None;
    if args.exact == ExactArg::Pin {
        let _stage = console.stage("meeting the lines");
        let all: Vec<Goal> = goals.iter().flatten().copied().collect();
        let done = meet(&clip, &all, &MeetOptions::default());
        clip = to_clip(&done.motion, &rig, FRAME_RATE)?;
        met = Some(done);
    }
    Ok(Made { clip, clips, joined, goals, met })
}

/// What every frame asks of the whole.
fn goals(clips: &[Generated], joined: &Joined) -> Vec<Vec<Goal>> {
    let each = clips.iter().zip(&joined.starts).zip(&joined.placements);
    each.map(|((clip, start), placement)| {
        let plan = &clip.plan;
        let goal = |ask: &inkrig_generate::guidance::Ask| {
            let at = ask.place.truncate();
            Goal::placed(start + ask.frame, ask.joint, at, &plan.camera, *placement, true)
        };
        plan.asks().iter().map(goal).collect()
    })
    .collect()
}

/// A frame's own motion as a file.
fn clip_bytes(
    clip: &Generated,
    made: &Made,
    format: Format,
    export: &ExportOptions,
) -> Result<Vec<u8>, CliError> {
    let own = to_clip(&clip.motion, made.clip.skeleton(), FRAME_RATE)?;
    Ok(write_motion(&own, format, export)?.bytes)
}

/// `out.bvh` becomes `out-1.bvh`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    path.with_file_name(format!("{stem}-{number}.{ending}"))
}
