use crate::gradient::{products, reduce, square_product};
use crate::kernels::{Mirror, dispatch};
use crate::mm_sinkhorn::record;
use crate::parallel::{Chunk, PerBlock, for_blocks, with_threads};
use crate::{Problem, Real, Start, Trace, TransportError, Workspace};

/// The step of [`MirrorDescent`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Step {
    /// `min(4 / range, 1 / epsilon, 1 / lambda)`, where `range` is the largest (max - min) over the rows of the first
    /// gradient: never negative, and within the stability limits of the entropy and of the column term.
    #[default]
    Safe,
    /// This step, greater than 0.
    Fixed(f64),
}

/// The reference solver: projected mirror descent, `T <- T exp(-step G)` with rows scaled back to `p`, after "Xu & Gould
/// 2024 (ASOT)". Kept in logarithms, so that no entry is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorDescent {
    /// Iterations: one gradient each.
    pub iterations: usize,
    /// The step.
    pub step: Step,
    /// Where to begin.
    pub start: Start,
    /// Record the objective's terms after every this many iterations, and at the end; 0 records nothing. A record costs a gradient.
    pub trace: usize,
}

impl Default for MirrorDescent {
    fn default() -> Self {
        Self { iterations: 400, step: Step::Safe, start: Start::Independent, trace: 0 }
    }
}

impl MirrorDescent {
    /// Solves; the plan is then in [`Workspace::plan`]. With `iterations` 0 it is the start.
    ///
    /// # Errors
    /// [`TransportError::Parameter`] for a step out of its range, [`TransportError::NothingToContinue`].
    pub fn solve<T: Real>(
        &self,
        problem: &Problem<'_, T>,
        workspace: &mut Workspace<T>,
    ) -> Result<Trace, TransportError> {
        if let Step::Fixed(value) = self.step
            && !(value > 0.0 && value.is_finite())
        {
            return Err(TransportError::Parameter {
                name: "step",
                value,
                range: "finite and greater than 0",
            });
        }
        workspace.prepare(problem, self.start)?;
        set_log_plan(workspace);
        let mut trace = Trace::default();
        trace.records.reserve(self.iterations.checked_div(self.trace).map_or(0, |records| records + 1));
        with_threads(workspace.threads, || self.run(problem, workspace, &mut trace));
        workspace.finish();
        Ok(trace)
    }

    fn run<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>, trace: &mut Trace) {
        let mut step = 0.0;
        for k in 0..self.iterations {
            if self.trace > 0 && k > 0 && k.is_multiple_of(self.trace) {
                record(problem, workspace, trace, k);
            }
            column_term(problem, workspace);
            products(problem, workspace, &|_, _, _, _| ());
            if k == 0 {
                step = match self.step {
                    Step::Fixed(step) => step,
                    Step::Safe => safe_step(problem, workspace),
                };
                trace.step = Some(step);
            }
            descend(problem, workspace, step);
            trace.iterations = k + 1;
        }
        if self.trace > 0 {
            record(problem, workspace, trace, trace.iterations);
        }
    }
}

/// `workspace.log_plan = log T`, which the steps then keep.
fn set_log_plan<T: Real>(workspace: &mut Workspace<T>) {
    let (n, m) = (workspace.transport.rows(), workspace.transport.cols());
    workspace.log_plan.reset(n, m, T::ZERO);
    for i in 0..n {
        let row = workspace.log_plan.row_mut(i);
        row.iter_mut().zip(workspace.transport.row(i)).for_each(|(log, &t)| *log = t.greater(T::TINY).ln());
    }
    // A later `Start::Continue` of the other solver starts from this plan with no scaling held.
    workspace.held.all_mut().fill(T::ZERO);
}

/// `workspace.column = 2 alpha Dx^2 c + lambda log(c / q)`.
fn column_term<T: Real>(problem: &Problem<'_, T>, workspace: &mut Workspace<T>) {
    square_product(problem, workspace);
    let (two_alpha, lambda) =
        (T::from_f64(2.0 * problem.params().alpha), T::from_f64(problem.params().lambda));
    let m = T::from_f64(problem.allowed() as f64);
    let inputs = workspace.sums.row(0).iter().zip(workspace.mass.row(0));
    for (column, (&sum, &mass)) in workspace.column.row_mut(0).iter_mut().zip(inputs) {
        *column = two_alpha * sum + lambda * (mass.greater(T::TINY) * m).ln();
    }
    for &j in problem.mask().map_or(&[][..], |mask| &mask.columns) {
        workspace.column.row_mut(0)[j] = T::HUGE;
    }
}

fn safe_step<T: Real>(problem: &Problem<'_, T>, workspace: &Workspace<T>) -> f64 {
    let params = problem.params();
    let scale = T::from_f64(-4.0 * params.alpha);
    let excluded = 0.5 * T::HUGE.to_f64();
    let mut range = 0.0f64;
    for i in 0..problem.rows() {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let terms = workspace.linear.row(i).iter().zip(workspace.column.row(0));
        for (&product, (&linear, &column)) in workspace.kernel.row(i).iter().zip(terms) {
            let x = (linear + column + scale * product).to_f64();
            least = least.min(x);
            // Excluded entries are no part of the range.
            most = if x < excluded { most.max(x) } else { most };
        }
        range = range.max(most - least);
    }
    // A range of 0 gives infinity, which the cap by 1 / epsilon ends.
    (4.0 / range).min(1.0 / params.epsilon).min(1.0 / params.lambda)
}

fn descend<T: Real>(problem: &Problem<'_, T>, workspace: &mut Workspace<T>, step: f64) {
    let params = problem.params();
    let scale = T::from_f64(-4.0 * params.alpha);
    let (decay, step) = (T::from_f64(1.0 - step * params.epsilon), T::from_f64(step));
    let p = T::from_f64(1.0 / problem.rows() as f64);
    let (n, cols, block) = (problem.rows(), problem.cols(), workspace.block());
    let Workspace { kernel, linear, column, log_plan, transport, partial, mass, threads, isa, .. } =
        workspace;
    let (stride, linear, column) = (kernel.stride(), linear.all(), column.all());
    let work = (
        Chunk::new(kernel.all_mut(), stride),
        (Chunk::new(log_plan.all_mut(), stride), Chunk::new(transport.all_mut(), stride)),
        PerBlock::new(partial.all_mut(), stride, block),
    );
    type Piece<'a, T> = (Chunk<'a, T>, (Chunk<'a, T>, Chunk<'a, T>), PerBlock<'a, T>);
    for_blocks(*threads, n, block, work, &|first, count, (rows, (log_plan, plan), sums): Piece<'_, T>| {
        let linear = &linear[first * stride..(first + count) * stride];
        let (rows, log_plan, plan, sums) = (rows.data, log_plan.data, plan.data, sums.first());
        let plan_rows = &mut *plan;
        let step = Mirror {
            rows,
            linear,
            column,
            scale,
            decay,
            step,
            p,
            stride,
            cols,
            log_plan,
            plan: plan_rows,
            sums,
        };
        dispatch(*isa, step);
        if let Some(mask) = problem.mask() {
            mask.settle(plan, stride, first, count, p);
        }
    });
    reduce(partial.all(), mass.all_mut());
}
