//! The first plan, from structure alone, at the coarsest level.

use crate::{AlignError, Options};
use inkrig_transport::{MmSinkhorn, Plan, Problem, Start, Workspace};

/// Solves the first problem, structure alone, and leaves the plan in the workspace; returns the gradients taken. The
/// independent plan is close to a saddle of the objective, and which way a run leaves it is chance: several starts
/// are scouted, the best goes on.
pub(crate) fn first_plan(
    problem: &Problem<'_, f32>,
    options: &Options,
    transport: &mut Workspace<f32>,
    mut tell: impl FnMut(usize) -> Result<(), AlignError>,
) -> Result<usize, AlignError> {
    let starts = options.starts as u64;
    let mut best: Option<(f64, Plan<f32>)> = None;
    for number in 0..starts {
        // Seed 0 is the independent plan itself; other seeds look elsewhere.
        let start = Start::Perturbed(options.seed.wrapping_mul(starts).wrapping_add(number));
        let scout =
            MmSinkhorn { iterations: options.scouting, start, trace: usize::MAX, ..MmSinkhorn::default() };
        let trace = scout.solve(problem, transport)?;
        let objective = trace.last().map_or(f64::INFINITY, |terms| terms.objective);
        if best.as_ref().is_none_or(|(least, _)| objective < *least) {
            best = Some((objective, transport.take_plan()));
        }
        tell((number as usize + 1) * options.scouting)?;
    }
    if let Some((_, plan)) = best {
        transport.resume(&plan);
    }
    let iterations = options.first_iterations;
    MmSinkhorn { iterations, start: Start::Continue, ..MmSinkhorn::default() }.solve(problem, transport)?;
    Ok(options.starts * options.scouting + iterations)
}
