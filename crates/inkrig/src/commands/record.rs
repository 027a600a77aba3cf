//! The report file: the numbers first, flat, then all that is needed to make the result again.

use crate::bake::BakeRecord;
use crate::cli::{AlignArgs, PresetArg, Up};
use crate::error::CliError;
use crate::guide::{CandidateFacts, Origin, Suggestions, round};
use crate::over_ground::OverGroundRecord;
use crate::printable::json_path;
use crate::results::Places;
use crate::span::seconds;
use inkrig_align::{AMBIGUOUS, Alignment, Alternative, Explanation, Options, Solver};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What `--report` and `--json` hold; the names are stable.
#[derive(Serialize)]
pub(super) struct Record<'a> {
    #[serde(flatten)]
    report: &'a inkrig_align::Report,
    /// Of the motion that was written.
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    /// What carries the travel, and the path.
    root: OverGroundRecord,
    /// Keys before and after, where they are not one a frame.
    bake: Option<BakeRecord>,
    program: &'static str,
    inputs: Vec<String>,
    /// A wave or labels, where they were given as text.
    control: Option<String>,
    /// Keys as they were given on the command line; `keys` says how each was met.
    key_arguments: Vec<String>,
    outputs: Vec<String>,
    #[serde(flatten)]
    explained: Explained,
    /// What was odd in the inputs, and what the output could not hold.
    warnings: Vec<String>,
    parameters: Parameters,
}

impl<'a> Record<'a> {
    /// The record of a run; `alignment` holds the clip as it was written.
    pub(super) fn of(
        args: &AlignArgs,
        (inputs, outputs): (&[PathBuf], Places<'_>),
        options: &Options,
        alignment: &'a Alignment,
        explained: Explained,
        (root, bake): (OverGroundRecord, Option<BakeRecord>),
        warnings: Vec<String>,
    ) -> Self {
        let clip = &alignment.clip;
        Self {
            report: &alignment.report,
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(clip),
            root,
            bake,
            program: concat!("inkrig ", env!("CARGO_PKG_VERSION")),
            inputs: inputs.iter().map(|path| json_path(path)).collect(),
            control: args.control.text().map(str::to_string),
            key_arguments: key_arguments(args),
            outputs: outputs.all().map(json_path).collect(),
            explained,
            warnings,
            parameters: Parameters::of(args, options),
        }
    }
}

/// What the engine made of what was said.
pub(super) fn engine(args: &AlignArgs, options: &Options) -> Result<serde_json::Value, CliError> {
    let mut parameters = serde_json::to_value(Parameters::of(args, options))?;
    // The only one that takes no part in the result.
    parameters.as_object_mut().map(|parameters| parameters.remove("threads"));
    Ok(parameters)
}

/// Why the result is as it is, and what else may be asked for.
#[derive(Serialize)]
pub(super) struct Explained {
    /// Whether the control is so nearly its own mirror image that other solutions fit as well.
    ambiguous: bool,
    /// Which frame of the source every sample of the result uses most, and how surely.
    used: Explanation,
    /// Poses worth a keyframe.
    candidates: Vec<CandidateFacts>,
    /// How much of the clip's distances its map does not show: where `x` and `y` of candidates are.
    map_stress: f64,
    /// All solutions, where more than one was asked for and found.
    #[serde(skip_serializing_if = "only_one")]
    pub(super) solutions: Vec<Solution>,
}

fn only_one(solutions: &[Solution]) -> bool {
    solutions.len() < 2
}

/// One of several solutions.
#[derive(Clone, Serialize)]
pub(super) struct Solution {
    /// Its motion file.
    motion: String,
    /// Of the first plan, structure alone; lower is better.
    objective: f64,
    /// From the first solution, in mean distances of the clip's moments.
    distance: f64,
    structure_pearson: f64,
}

impl Solution {
    pub(super) fn of(motion: &Path, solution: &Alternative) -> Self {
        Self {
            motion: json_path(motion),
            objective: solution.objective,
            distance: round(solution.distance, 4),
            structure_pearson: solution.alignment.report.structure_pearson,
        }
    }
}

impl Explained {
    /// What is said of a result.
    pub(super) fn of(
        alignment: &Alignment,
        options: &Options,
        suggestions: Option<&Suggestions>,
        origin: &Origin,
    ) -> Self {
        let mut used = Explanation::of(alignment, options);
        used.frame.iter_mut().for_each(|frame| *frame += origin.first_frame);
        Self {
            ambiguous: alignment.report.mirror_symmetry >= AMBIGUOUS,
            used,
            candidates: suggestions.map(|found| found.facts(origin)).unwrap_or_default(),
            map_stress: suggestions.map_or(0.0, |found| round(found.map.stress, 4)),
            solutions: Vec::new(),
        }
    }
}

fn key_arguments(args: &AlignArgs) -> Vec<String> {
    let flags = [("--key", &args.keys), ("--avoid", &args.avoids), ("--never", &args.nevers)];
    let said =
        flags.into_iter().flat_map(|(flag, texts)| texts.iter().map(move |text| format!("{flag} {text}")));
    said.chain(args.fixes.iter().map(|span| format!("--fix {span}"))).collect()
}

/// What was asked for, in the words of the command line (`null` where nothing was said), and what the engine made of
/// it.
#[derive(Serialize)]
struct Parameters {
    preset: &'static str,
    range: Option<String>,
    laps: usize,
    length: Option<String>,
    fps: Option<f64>,
    uniform: bool,
    path: Option<String>,
    path_scale: Option<f64>,
    sway: f64,
    #[serde(rename = "loop")]
    cyclic: bool,
    unit: Option<f64>,
    up: Option<&'static str>,
    source_fps: Option<f64>,
    clip: Option<String>,
    skeleton: Option<String>,
    /// What was asked for; `solver` at the top says what it was.
    solver: Solver,
    alpha: f64,
    lambda: f64,
    epsilon: f64,
    patch_seconds: f64,
    levels: usize,
    ratio: f64,
    rounds: usize,
    iterations: usize,
    starts: usize,
    scouting: usize,
    first_iterations: usize,
    polish: usize,
    matching_rate: f64,
    smooth: Option<f64>,
    seed: u64,
    mirror: bool,
    on_map: bool,
    norm: String,
    rotations: String,
    velocity: String,
    threads: usize,
}

impl Parameters {
    fn of(args: &AlignArgs, options: &Options) -> Self {
        Self {
            preset: match args.preset {
                PresetArg::Follow => "follow",
                PresetArg::Natural => "natural",
            },
            range: args.range.map(|range| range.to_string()),
            laps: args.laps,
            length: args.length.map(|length| length.to_string()),
            fps: args.fps,
            uniform: args.uniform,
            path: args.root.path.clone(),
            path_scale: args.root.path_scale,
            sway: args.root.sway,
            cyclic: args.cyclic,
            unit: args.import.unit,
            up: args.import.up.map(|up| match up {
                Up::Y => "y",
                Up::Z => "z",
            }),
            source_fps: args.import.source_fps,
            clip: args.import.clip.clone(),
            skeleton: args.import.skeleton.as_deref().map(json_path),
            solver: options.solver,
            alpha: options.alpha,
            lambda: options.lambda,
            epsilon: options.epsilon,
            patch_seconds: options.patch_seconds,
            levels: options.levels,
            ratio: options.ratio,
            rounds: options.rounds,
            iterations: options.iterations,
            starts: options.starts,
            scouting: options.scouting,
            first_iterations: options.first_iterations,
            polish: options.polish,
            matching_rate: options.matching_rate,
            smooth: args.smooth,
            seed: options.seed,
            mirror: options.mirror,
            on_map: args.on_map,
            norm: format!("source={:?},control={:?}", options.source_norm, options.control_norm)
                .to_lowercase(),
            rotations: format!("{:?}", options.features.rotation_space).to_lowercase(),
            velocity: format!("{:?}", options.features.velocity_frame).to_lowercase(),
            threads: options.threads,
        }
    }
}
