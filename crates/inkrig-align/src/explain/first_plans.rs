//! Other first plans: where a run could have gone instead, at the coarsest level.

use super::symmetry::Reflection;
use crate::coarse_to_fine::Buffers;
use crate::level::Level;
use crate::{AlignError, Layout, Options};
use inkrig_transport::{Mat, MmSinkhorn, Plan, Problem, Start, terms};

/// Starts that are looked at beside the reflections.
const MORE_STARTS: u64 = 4;
/// Reflections that are tried, the truest first.
const REFLECTIONS: usize = 4;
/// Two first plans may become two solutions when their motions differ by this much, in mean distances of the clip's
/// moments. First motions are means of many poses and so nearer to each other than what comes of them: 0.4 here became
/// 0.8 to 1.3 in finished motions.
const DISTINCT: f64 = 0.2;
/// A plan is as good as the best when its objective is worse by no more than this share of what the best gains over the
/// independent plan.
const AS_GOOD: f64 = 0.15;

/// What a run is told and tells about its first plan.
#[derive(Debug, Default)]
pub(crate) struct FirstPlans {
    /// Begin with this one: nothing is scouted.
    pub(crate) given: Option<Plan<f32>>,
    /// How many others are wanted.
    pub(crate) wanted: usize,
    /// Others that are as good and differ, best first.
    pub(crate) others: Vec<FirstPlan>,
    /// The objective of the one that was taken, where others were wanted.
    pub(crate) objective: f64,
    /// Whether to measure the control's symmetry.
    pub(crate) measure: bool,
    /// How nearly the control is a mirror image of itself, 0..=1, where it was measured.
    pub(crate) symmetry: Option<f64>,
}

/// A first plan and how good it is.
#[derive(Debug, Clone)]
pub(crate) struct FirstPlan {
    pub(crate) plan: Plan<f32>,
    /// Structure alone; lower is better.
    pub(crate) objective: f64,
    motion: Mat<f32>,
}

/// Replaces the plan in the workspace by the best of its mirror images that differs from it; leaves it where there is
/// none. Returns the gradients taken.
pub(crate) fn mirrored(
    level: &Level<'_>,
    problem: &Problem<'_, f32>,
    options: &Options,
    b: &mut Buffers,
) -> Result<usize, AlignError> {
    let first = FirstPlan::taken(level, problem, options, b)?;
    let images = images(&first, level, problem, options, b)?;
    let gradients = images.len() * options.first_iterations;
    let different = images.into_iter().filter(|image| image.distance(&first, level) >= DISTINCT);
    let best = different.min_by(|a, b| a.objective.total_cmp(&b.objective));
    b.transport.resume(&best.unwrap_or(first).plan);
    Ok(gradients)
}

/// Looks for the plans that are wanted beside the one in the workspace, and leaves them in the buffers. The workspace
/// stays as it is, so that the run goes on as if nobody had asked.
pub(crate) fn others(
    level: &Level<'_>,
    problem: &Problem<'_, f32>,
    options: &Options,
    b: &mut Buffers,
) -> Result<(), AlignError> {
    let asked = &mut b.first;
    let first = FirstPlan::of(b.transport.plan().clone(), level, problem, options)?;
    let b = &mut Buffers::new(options.threads);
    let mut found = images(&first, level, problem, options, b)?;
    let starts = options.starts as u64;
    for number in starts..starts + MORE_STARTS {
        let seed = options.seed.wrapping_mul(starts + MORE_STARTS).wrapping_add(number);
        let iterations = options.scouting + options.first_iterations;
        let start = Start::Perturbed(seed);
        MmSinkhorn { iterations, start, ..MmSinkhorn::default() }.solve(problem, &mut b.transport)?;
        found.push(FirstPlan::taken(level, problem, options, b)?);
    }
    found.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    let best = found.first().map_or(first.objective, |other| other.objective.min(first.objective));
    let most = best + AS_GOOD * (independent(level, options) - best).max(0.0);
    let mut kept = vec![first];
    for plan in found {
        let differs = kept.iter().all(|other| plan.distance(other, level) >= DISTINCT);
        if plan.objective <= most && differs && kept.len() <= asked.wanted {
            kept.push(plan);
        }
    }
    asked.objective = kept[0].objective;
    asked.others = kept.split_off(1);
    Ok(())
}

/// The truest mirror images of a plan, each solved on from there.
fn images(
    first: &FirstPlan,
    level: &Level<'_>,
    problem: &Problem<'_, f32>,
    options: &Options,
    b: &mut Buffers,
) -> Result<Vec<FirstPlan>, AlignError> {
    let solver =
        MmSinkhorn { iterations: options.first_iterations, start: Start::Continue, ..MmSinkhorn::default() };
    let plan = first.plan.dense().to_mat();
    let reflections = Reflection::all(&level.control.distances).into_iter().take(REFLECTIONS);
    reflections
        .map(|reflection| {
            b.transport.resume(&Plan::from_mat(reflection.of_plan(&plan)));
            solver.solve(problem, &mut b.transport)?;
            FirstPlan::taken(level, problem, options, b)
        })
        .collect()
}

impl FirstPlan {
    /// The plan in the workspace.
    fn taken(
        level: &Level<'_>,
        problem: &Problem<'_, f32>,
        options: &Options,
        b: &mut Buffers,
    ) -> Result<Self, AlignError> {
        Self::of(b.transport.take_plan(), level, problem, options)
    }

    fn of(
        plan: Plan<f32>,
        level: &Level<'_>,
        problem: &Problem<'_, f32>,
        options: &Options,
    ) -> Result<Self, AlignError> {
        let objective = terms(problem, plan.dense())?.objective;
        let (mut weights, mut motion) = (Mat::default(), Mat::default());
        level.blend(plan.dense(), &mut weights, &mut motion, options.threads)?;
        Ok(Self { plan, objective, motion })
    }

    /// Mean distance of the patches that two plans make, in mean distances of the clip's.
    fn distance(&self, other: &Self, level: &Level<'_>) -> f64 {
        f64::from(level.source.scale) * mean_distance(&self.motion, &other.motion, &level.control.layout)
    }
}

/// Mean distance of the patches of two tables of frames that stand in the same place.
pub(crate) fn mean_distance(a: &Mat<f32>, b: &Mat<f32>, layout: &Layout) -> f64 {
    let square = |frame: usize| -> f64 {
        a.row(frame).iter().zip(b.row(frame)).map(|(x, y)| f64::from(x - y).powi(2)).sum()
    };
    let squares: Vec<f64> = (0..a.rows().min(b.rows())).map(square).collect();
    let mut total = 0.0;
    for run in layout.runs() {
        for patch in squares[run.frame..].windows(layout.patch()).take(run.count) {
            total += patch.iter().sum::<f64>().sqrt();
        }
    }
    total / layout.patches().max(1) as f64
}

/// The objective of the independent plan, structure alone, without what keys ask.
fn independent(level: &Level<'_>, options: &Options) -> f64 {
    let moments = |table: &Mat<f32>| {
        let count = table.as_slice().len().max(1) as f64;
        let sum = |power| table.as_slice().iter().map(|&d| f64::from(d).powi(power)).sum::<f64>() / count;
        (sum(1), sum(2))
    };
    let ((control, control_squared), (source, source_squared)) =
        (moments(&level.control.distances), moments(&level.source.distances));
    let entries = (level.control.distances.rows() * level.source.distances.rows()).max(1) as f64;
    control_squared + source_squared - 2.0 * control * source - options.epsilon * entries.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_of_motions_is_the_mean_over_patches() {
        let a = Mat::from_fn(20, 2, |row, _| row as f32);
        let b = Mat::from_fn(20, 2, |row, column| row as f32 + if column == 0 { 3.0 } else { 4.0 });
        let distance = mean_distance(&a, &b, &Layout::clips(&[12, 8], 4));
        assert!((distance - 10.0).abs() < 1e-9, "{distance}: four frames, each five apart");
        assert_eq!(mean_distance(&a, &a, &Layout::open(20, 4)), 0.0);
    }
}
