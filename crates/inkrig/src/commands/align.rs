//! `inkrig align`: a clip and a curve in, a clip that follows the curve out.

use crate::cli::{AlignArgs, NormArg, PresetArg, RotationArg, VelocityArg};
use crate::console::Console;
use crate::error::CliError;
use crate::output::Output;
use crate::{load, show};
use inkrig_align::{AlignError, Alignment, Control, ControlKind, CurveOptions, Norm, Options, Preset, align};
use inkrig_formats::{ExportOptions, Finding, Severity, SourceInfo, write_motion};
use inkrig_motion::{MotionError, RotationSpace, Takes, VelocityFrame, time};
use inkrig_sketch::Timing;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &AlignArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    check_names(args, output)?;
    let options = options(args);
    let (source, first) = source(args, console)?;
    let control = control(args, &options)?;
    let alignment = {
        let bar = console.bar("aligning");
        align(&source, &control, &options, &mut |progress| bar.update(progress))?
    };
    let clip = match args.fps {
        None => alignment.clip.clone(),
        Some(rate) => time::resample(&alignment.clip, rate)?,
    };

    let written = write_motion(&clip, first.format, &ExportOptions::like(&first))?;
    say_warnings(&written.findings, &args.out, console);
    output.write(&args.out, &written.bytes)?;
    let record = Record::of(args, &options, &alignment);
    if let Some(path) = &args.report {
        output.write(path, serde_json::to_string_pretty(&record)?.as_bytes())?;
    }
    if let Some(path) = &args.preview {
        let title = title(args);
        output.write(path, show::page(&title, &alignment, &control).as_bytes())?;
    }
    if let Some(path) = &args.sheet {
        output.write(path, &show::sheet(&alignment, &control)?)?;
    }
    console.say(show::summary(&alignment, &args.out));
    for path in [&args.report, &args.preview, &args.sheet].into_iter().flatten() {
        console.say(format!("wrote {}", path.display()));
    }
    console.result(&record)?;
    Ok(())
}

/// The clips to arrange, and where the first came from.
fn source(args: &AlignArgs, console: &Console) -> Result<(Takes, SourceInfo), CliError> {
    let mut first = None;
    let mut clips = Vec::with_capacity(args.clips.len());
    for path in &args.clips {
        let import = load::motion(path, &args.import)?;
        say_warnings(&import.findings, path, console);
        clips.push(match args.range {
            None => import.clip,
            Some(span) => {
                let range = span.frames(import.clip.frame_rate(), import.clip.frames());
                time::trim(&import.clip, range)
                    .map_err(|source| CliError::Clip { path: path.clone(), source })?
            }
        });
        first.get_or_insert(import.source);
    }
    let takes = Takes::join(&clips).map_err(|error| match error {
        MotionError::OtherSkeleton { clip, .. } => {
            CliError::Clip { path: args.clips.get(clip).cloned().unwrap_or_default(), source: error }
        }
        other => other.into(),
    })?;
    Ok((takes, first.ok_or(MotionError::NoFrames)?))
}

/// What the motion shall follow.
fn control(args: &AlignArgs, options: &Options) -> Result<Control, CliError> {
    let mut control = if let Some(path) = &args.control.curve {
        let curve_options = CurveOptions {
            samples: args.length.map(|length| length.frames(options.matching_rate)),
            rate: options.matching_rate,
            smooth: args.smooth,
            timing: args.uniform.then_some(Timing::ArcLength),
        };
        Control::from_curve(&load::curve(path)?, &curve_options).map_err(|error| match error {
            AlignError::Sketch(source) => CliError::Curve { path: path.clone(), source },
            other => other.into(),
        })?
    } else if let Some(path) = &args.control.like {
        let motion = load::motion(path, &args.import)?.clip;
        let mut control = Control::from_motion(&motion, options.matching_rate, &options.features)?;
        if let Some(length) = args.length {
            control.rate = control.features.frames() as f64 * options.matching_rate
                / length.frames(options.matching_rate).max(1) as f64;
        }
        control
    } else {
        // Clap asks for one of them.
        return Err(AlignError::StillControl.into());
    };
    control.cyclic = args.cyclic;
    Ok(control)
}

/// What was odd in a file, without mere remarks: `inkrig inspect` has those.
fn say_warnings(findings: &[Finding], path: &Path, console: &Console) {
    for finding in findings.iter().filter(|finding| finding.severity == Severity::Warning) {
        console.say(format!("{}: {finding}", path.display()));
    }
}

/// Says before any work whether the results can be written, each to a file of its own.
fn check_names(args: &AlignArgs, output: Output) -> Result<(), CliError> {
    let inputs = args.clips.iter().map(Some).chain([args.control.file()]);
    let results = [Some(&args.out), args.report.as_ref(), args.preview.as_ref(), args.sheet.as_ref()];
    let mut seen = BTreeSet::new();
    for path in inputs.chain(results).flatten() {
        let same = path.canonicalize().unwrap_or_else(|_| path.clone());
        if !seen.insert(same) {
            return Err(CliError::SameFile(path.clone()));
        }
    }
    for path in results.into_iter().flatten() {
        output.check(path)?;
    }
    if args.out.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("bvh")) {
        return Err(CliError::Kind { path: args.out.clone(), known: "results are written as .bvh" });
    }
    Ok(())
}

fn options(args: &AlignArgs) -> Options {
    let preset = match args.preset {
        PresetArg::Follow => Preset::Follow,
        PresetArg::Natural => Preset::Natural,
    };
    let kind = if args.control.like.is_some() { ControlKind::Motion } else { ControlKind::Curve };
    let mut options = Options::for_control(kind, preset);
    if let Some(norm) = args.norm {
        let norm = match norm {
            NormArg::Mean => Norm::Mean,
            NormArg::Max => Norm::Max,
            NormArg::Quantile => Norm::Quantile,
            NormArg::Learned => Norm::Learned,
        };
        options.source_norm = norm;
        options.control_norm = norm;
    }
    let set = |slot: &mut f64, given: Option<f64>| *slot = given.unwrap_or(*slot);
    set(&mut options.alpha, args.alpha);
    set(&mut options.lambda, args.lambda);
    set(&mut options.epsilon, args.epsilon);
    set(&mut options.patch_seconds, args.patch);
    set(&mut options.ratio, args.ratio);
    let set = |slot: &mut usize, given: Option<usize>| *slot = given.unwrap_or(*slot);
    set(&mut options.levels, args.levels);
    set(&mut options.iterations, args.iterations);
    set(&mut options.threads, args.threads);
    options.seed = args.seed;
    if let Some(velocity) = args.velocity {
        let frame = match velocity {
            VelocityArg::World => VelocityFrame::World,
            VelocityArg::Heading => VelocityFrame::Heading,
        };
        options.features.velocity_frame = frame;
        options.travel = frame;
    }
    if let Some(rotations) = args.rotations {
        options.features.rotation_space = match rotations {
            RotationArg::Local => RotationSpace::Local,
            RotationArg::Root => RotationSpace::Root,
        };
    }
    options
}

fn title(args: &AlignArgs) -> String {
    let name =
        |path: &Path| path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let clips: Vec<String> = args.clips.iter().map(|path| name(path)).collect();
    let control = args.control.file().map(|path| name(path)).unwrap_or_default();
    format!("{} follows {control}", clips.join(", "))
}

/// The report file: the numbers first, flat, then what they came from.
#[derive(Serialize)]
struct Record<'a> {
    #[serde(flatten)]
    report: &'a inkrig_align::Report,
    program: &'static str,
    inputs: Vec<&'a PathBuf>,
    outputs: Vec<&'a PathBuf>,
    parameters: Parameters,
}

#[derive(Serialize)]
struct Parameters {
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
    smooth: f64,
    seed: u64,
    norm: String,
    rotations: String,
    velocity: String,
}

impl<'a> Record<'a> {
    fn of(args: &'a AlignArgs, options: &Options, alignment: &'a Alignment) -> Self {
        let outputs = [Some(&args.out), args.report.as_ref(), args.preview.as_ref(), args.sheet.as_ref()];
        Self {
            report: &alignment.report,
            program: concat!("inkrig ", env!("CARGO_PKG_VERSION")),
            inputs: args.clips.iter().chain(args.control.file()).collect(),
            outputs: outputs.into_iter().flatten().collect(),
            parameters: Parameters {
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
                norm: format!("{:?}", options.control_norm).to_lowercase(),
                rotations: format!("{:?}", options.features.rotation_space).to_lowercase(),
                velocity: format!("{:?}", options.features.velocity_frame).to_lowercase(),
            },
        }
    }
}
