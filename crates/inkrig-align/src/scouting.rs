//! The first plan, from structure alone, at the coarsest level.

use crate::coarse_to_fine::Buffers;
use crate::{AlignError, Options};
use inkrig_transport::{MmSinkhorn, Plan, Problem, Start, TransportError, Workspace, for_each};

/// Solves the first problem, structure alone, and leaves the plan in the workspace; returns the gradients taken. The
/// independent plan is close to a saddle of the objective, and which way a run leaves it is chance: several starts
/// are scouted, the best goes on.
pub(crate) fn first_plan(
    problem: &Problem<'_, f32>,
    options: &Options,
    b: &mut Buffers,
    mut tell: impl FnMut(usize) -> Result<(), AlignError>,
) -> Result<usize, AlignError> {
    let mut best: Option<(f64, Plan<f32>)> = None;
    let at_once = options.threads.min(options.starts);
    b.scouts.resize_with(at_once, || Workspace::new(1));
    for first in (0..options.starts).step_by(at_once) {
        let count = at_once.min(options.starts - first);
        let mut scouts: Vec<_> =
            b.scouts.iter_mut().take(count).map(|scout| (scout, Ok(f64::INFINITY))).collect();
        for_each(options.threads, &mut scouts, &|index, (workspace, objective)| {
            *objective = scout(problem, options, (first + index) as u64, workspace);
        });
        for (workspace, objective) in scouts {
            let objective = objective?;
            if best.as_ref().is_none_or(|(least, _)| objective < *least) {
                best = Some((objective, workspace.take_plan()));
            }
        }
        tell((first + count) * options.scouting)?;
    }
    if let Some((_, plan)) = best {
        b.transport.resume(&plan);
    }
    let iterations = options.first_iterations;
    MmSinkhorn { iterations, start: Start::Continue, ..MmSinkhorn::default() }
        .solve(problem, &mut b.transport)?;
    Ok(options.starts * options.scouting + iterations)
}

/// The objective that one start reaches.
fn scout(
    problem: &Problem<'_, f32>,
    options: &Options,
    number: u64,
    workspace: &mut Workspace<f32>,
) -> Result<f64, TransportError> {
    // Seed 0 is the independent plan itself; other seeds look elsewhere.
    let start = Start::Perturbed(options.seed.wrapping_mul(options.starts as u64).wrapping_add(number));
    let solver =
        MmSinkhorn { iterations: options.scouting, start, trace: usize::MAX, ..MmSinkhorn::default() };
    Ok(solver.solve(problem, workspace)?.last().map_or(f64::INFINITY, |terms| terms.objective))
}
