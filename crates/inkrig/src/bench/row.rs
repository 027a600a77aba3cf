//! One row of the table: one way to make a motion, on one case.

use super::baselines::{nearest_patch, random_chunks, time_warp};
use super::{Case, Clock, Spent};
use inkrig_align::{AlignError, Comparison, Observer, Options, Quality, align};
use inkrig_motion::Clip;
use serde::Serialize;

/// Random arrangements that are averaged.
const DRAWS: u64 = 5;

/// Ways to make a motion of a clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Align as a user gets it.
    Inkrig,
    /// Align at the finest level only, with as many gradients.
    OneStage,
    /// The nearest patch along principal axes; no transport.
    NearestPatch,
    /// The clip stretched evenly.
    TimeWarp,
    /// Pieces of two seconds from anywhere; the mean of five draws.
    RandomChunks,
}

impl Method {
    /// All of them, as they stand in the table.
    pub const ALL: [Self; 5] =
        [Self::Inkrig, Self::OneStage, Self::NearestPatch, Self::TimeWarp, Self::RandomChunks];

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inkrig => "inkrig",
            Self::OneStage => "one stage",
            Self::NearestPatch => "nearest patch",
            Self::TimeWarp => "time warp",
            Self::RandomChunks => "random chunks",
        }
    }
}

/// Quality and time of one method on one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The case.
    pub case: String,
    /// The method.
    pub method: Method,
    /// Frames of the clip at the matching rate.
    pub source_frames: usize,
    /// Frames of the control at the matching rate.
    pub control_frames: usize,
    /// What came out.
    #[serde(flatten)]
    pub quality: Quality,
    /// Structure less that of the evenly stretched clip.
    pub structure_gain: f64,
    /// Which of the limits that a good result keeps were broken: `structure`, `nearest`, `jump`, `speed`.
    pub misses: Vec<&'static str>,
    /// Solver gradients; 0 where there is no solver.
    pub gradients: usize,
    /// From clip and control in memory to the finished clip and its numbers, the least of all repeats.
    #[serde(flatten)]
    pub spent: Spent,
}

/// Runs every method on a case, each `repeats` times for the clock, and gives each row to `done` as it is there.
///
/// # Errors
/// As for [`align`].
pub fn rows(
    case: &Case,
    repeats: usize,
    observer: Observer<'_>,
    mut done: impl FnMut(Row),
) -> Result<(), AlignError> {
    for method in Method::ALL {
        let mut best: Option<(Outcome, Spent)> = None;
        for _ in 0..repeats.max(1) {
            let clock = Clock::start();
            let outcome = run(case, method, observer)?;
            let spent = clock.spent();
            best = Some((outcome, best.map_or(spent, |(_, least)| least.least(spent))));
        }
        if let Some((outcome, spent)) = best {
            done(row(case, method, &outcome, spent));
        }
    }
    Ok(())
}

/// What a run gives, but for its time.
struct Outcome {
    quality: Quality,
    gradients: usize,
    frames: [usize; 2],
    /// Motions that were made; the time is theirs together.
    draws: u64,
}

fn run(case: &Case, method: Method, observer: Observer<'_>) -> Result<Outcome, AlignError> {
    let options = match method {
        Method::OneStage => one_stage(&case.options),
        _ => case.options.clone(),
    };
    if matches!(method, Method::Inkrig | Method::OneStage) {
        let report = align(&case.source, &case.control, &options, observer)?.report;
        let frames = [report.source_frames, report.control_frames];
        return Ok(Outcome { quality: report.quality(), gradients: report.gradients, frames, draws: 1 });
    }
    let comparison = Comparison::new(&case.source, &case.control, &options)?;
    let frames = [comparison.columns().frames(), comparison.rows().frames()];
    let [columns, rows] = frames;
    let measured = |clip: Clip| comparison.measure(&clip);
    let (quality, draws) = match method {
        Method::NearestPatch => {
            let [control, source] = comparison.distances()?;
            let plan = nearest_patch(&control, &source, options.patch());
            (measured(comparison.clip_of_plan(plan.view())?)?, 1)
        }
        Method::RandomChunks => {
            let draw = |draw| {
                let seed = options.seed.wrapping_mul(DRAWS).wrapping_add(draw);
                measured(comparison.clip_of_weights(&random_chunks(rows, comparison.columns(), seed))?)
            };
            (mean(&(0..DRAWS).map(draw).collect::<Result<Vec<_>, _>>()?), DRAWS)
        }
        _ => (measured(comparison.clip_of_weights(&time_warp(rows, columns))?)?, 1),
    };
    Ok(Outcome { quality, gradients: 0, frames, draws })
}

/// The same number of gradients, all of them at the full length.
fn one_stage(options: &Options) -> Options {
    Options { levels: 1, rounds: options.levels * options.rounds, ..options.clone() }
}

fn row(case: &Case, method: Method, outcome: &Outcome, spent: Spent) -> Row {
    let &Outcome { quality, gradients, frames: [source_frames, control_frames], draws } = outcome;
    let draws = draws as f64;
    let spent = Spent {
        cpu_seconds: spent.cpu_seconds.map(|seconds| seconds / draws),
        wall_seconds: spent.wall_seconds / draws,
    };
    let structure_gain = quality.structure_pearson - quality.structure_pearson_warp;
    let limits = [
        ("structure", structure_gain >= 0.4),
        ("nearest", quality.nearest_patch <= case.most_nearest_patch()),
        ("jump", quality.jump_q999_ratio <= 2.0),
        ("speed", (0.45..=2.0).contains(&quality.speed_mean_ratio)),
    ];
    let misses = limits.iter().filter(|(_, kept)| !kept).map(|(name, _)| *name).collect();
    Row {
        case: case.name.clone(),
        method,
        source_frames,
        control_frames,
        quality,
        structure_gain,
        misses,
        gradients,
        spent,
    }
}

fn mean(all: &[Quality]) -> Quality {
    let of = |value: fn(&Quality) -> f64| all.iter().map(value).sum::<f64>() / all.len().max(1) as f64;
    Quality {
        structure_pearson: of(|quality| quality.structure_pearson),
        structure_spearman: of(|quality| quality.structure_spearman),
        structure_pearson_warp: of(|quality| quality.structure_pearson_warp),
        nearest_patch: of(|quality| quality.nearest_patch),
        coverage: of(|quality| quality.coverage),
        speed_mean_ratio: of(|quality| quality.speed_mean_ratio),
        jump_q999_ratio: of(|quality| quality.jump_q999_ratio),
        jerk_ratio: of(|quality| quality.jerk_ratio),
        freeze: of(|quality| quality.freeze),
        freeze_source: of(|quality| quality.freeze_source),
        loop_seam_ratio: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stage_takes_as_many_gradients() {
        let options = Options::default();
        assert_eq!(one_stage(&options).gradients(), options.gradients());
        assert_eq!(one_stage(&options).levels, 1);
    }
}
