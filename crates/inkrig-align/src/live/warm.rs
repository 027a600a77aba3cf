//! Beginning with what the last update found.

use super::control_side::Unchanged;
use crate::coarse_to_fine::Buffers;
use crate::level::Level;
use crate::scouting::first_plan;
use crate::{AlignError, Layout, Options};
use inkrig_transport::{Mat, MmSinkhorn, Plan, Start, Workspace, terms};
use std::sync::Arc;

/// A new first plan takes over when its objective is lower by this share: small gains are not worth a jump.
const BETTER: f64 = 0.02;

/// The last first plan: which of the equally good solutions the motion follows is settled by it.
///
/// Finer levels begin anew at every update. Going on from their own last plans was tried: ten small changes later the
/// structure was .07 to .09 lower than a fresh run's, for each solve draws the plan nearer to what it has.
#[derive(Debug)]
pub(super) struct FirstPlan {
    workspace: Workspace<f32>,
    plan: Plan<f32>,
    /// The control, in full and in its own domain, that this was for.
    drawn: Arc<Mat<f32>>,
}

/// How an update began.
pub(super) struct Begun {
    /// With the last one's plan.
    pub(super) warm: bool,
    pub(super) gradients: usize,
}

impl FirstPlan {
    pub(super) fn new(threads: usize) -> Self {
        Self { workspace: Workspace::new(threads), plan: Plan::default(), drawn: Arc::default() }
    }

    /// Solves the first problem, structure alone: from the last plan and its scaling and, as the control may have become
    /// another, from new starts too. The better plan is kept, and left in the buffers' workspace.
    pub(super) fn find(
        &mut self,
        level: &Level<'_>,
        (drawn, options): (&Arc<Mat<f32>>, &Options),
        b: &mut Buffers,
        tell: &mut dyn FnMut(usize) -> Result<(), AlignError>,
    ) -> Result<Begun, AlignError> {
        let bias = level.bias(1.0);
        let problem = level.problem(&level.control.distances, None, bias.as_ref(), 1.0, options)?;
        let mut begun = Begun { warm: false, gradients: first_plan(&problem, options, b, tell)? };
        if self.plan.rows() > 0 && self.plan.cols() == problem.cols() {
            if (self.plan.rows(), self.drawn.rows()) != (problem.rows(), drawn.rows()) {
                self.workspace.resume(&moved(&self.plan, &level.control.layout, &self.drawn, drawn));
            }
            let iterations = options.first_iterations;
            let solver = MmSinkhorn { iterations, start: Start::Continue, ..MmSinkhorn::default() };
            solver.solve(&problem, &mut self.workspace)?;
            begun.gradients += iterations;
            let fresh = terms(&problem, b.transport.plan().dense())?.objective;
            let warm = terms(&problem, self.workspace.plan().dense())?.objective;
            begun.warm = fresh >= warm - BETTER * warm.abs();
        }
        if begun.warm {
            b.transport.resume(self.workspace.plan());
        } else {
            self.workspace.resume(b.transport.plan());
        }
        self.plan.clone_from(self.workspace.plan());
        self.drawn = Arc::clone(drawn);
        Ok(begun)
    }
}

/// A plan for another state of the control: rows stay with the samples that are the same; between these, they are
/// stretched.
fn moved(plan: &Plan<f32>, rows: &Layout, old: &Mat<f32>, new: &Mat<f32>) -> Plan<f32> {
    let unchanged = Unchanged::between(old.view(), new.view());
    let (count, before) = (rows.patches(), plan.rows());
    let scale = before as f32 / count as f32;
    let dense = plan.dense();
    let mut out = Mat::zeros(count, plan.cols());
    for row in 0..count {
        let place = row as f64 / (count - 1).max(1) as f64 * (new.rows() - 1) as f64;
        let from = former_place(place, unchanged, old.rows(), new.rows());
        let from = from / (old.rows() - 1).max(1) as f64 * (before - 1) as f64;
        let old = dense.row((from.round() as usize).min(before - 1));
        out.row_mut(row).iter_mut().zip(old).for_each(|(value, &old)| *value = scale * old);
    }
    Plan::from_mat(out)
}

/// Where in the old control a place of the new one was.
fn former_place(place: f64, unchanged: Unchanged, old: usize, new: usize) -> f64 {
    let Unchanged { first, last } = unchanged;
    if place < first as f64 {
        place
    } else if place >= (new - last) as f64 {
        place + old as f64 - new as f64
    } else {
        let (span, old_span) = ((new - last - first) as f64, (old - last - first) as f64);
        (first as f64 + (place - first as f64) / span * old_span).min(old as f64 - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stay_with_the_samples_that_are_the_same() {
        let unchanged = Unchanged { first: 50, last: 30 };
        assert_eq!(former_place(20.0, unchanged, 100, 120), 20.0);
        assert_eq!(former_place(110.0, unchanged, 100, 120), 90.0);
        assert_eq!(former_place(70.0, unchanged, 100, 120), 60.0);
        let grown = Unchanged { first: 100, last: 0 };
        assert_eq!(former_place(99.0, grown, 100, 120), 99.0);
        assert_eq!(former_place(119.0, grown, 100, 120), 99.0, "what is new begins with the last row");
    }
}
