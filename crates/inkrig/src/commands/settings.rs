//! The engine's options, as the command line says them.

use crate::cli::{AlignArgs, PresetArg, RotationArg, SolverArg, VelocityArg};
use inkrig_align::{ControlKind, Options, Preset, Solver};
use inkrig_motion::{RotationSpace, VelocityFrame};

/// The number of threads that was asked for.
pub(super) fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or(Options::default().threads)
}

/// The preset's options with everything that was given by hand.
pub(super) fn options(args: &AlignArgs) -> Options {
    let preset = match args.preset {
        PresetArg::Follow => Preset::Follow,
        PresetArg::Natural => Preset::Natural,
    };
    let asked = &args.control;
    let kind = match asked {
        _ if asked.wave.is_some() => ControlKind::Wave,
        _ if asked.labels.is_some() => ControlKind::Labels,
        _ if asked.sound.is_some() => ControlKind::Sound,
        _ if asked.like.is_some() => ControlKind::Motion,
        _ => ControlKind::Curve,
    };
    let mut options = Options::for_control(kind, preset);
    let norms = args.norm.unwrap_or_default();
    options.source_norm = norms.source.unwrap_or(options.source_norm);
    options.control_norm = norms.control.unwrap_or(options.control_norm);
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
    options.mirror = args.mirror;
    options.solver = match args.solver {
        None | Some(SolverArg::Auto) => Solver::Auto,
        Some(SolverArg::Dense) => Solver::Dense,
        Some(SolverArg::LowRank) => Solver::LowRank,
        Some(SolverArg::Sparse) => Solver::Sparse,
    };
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
