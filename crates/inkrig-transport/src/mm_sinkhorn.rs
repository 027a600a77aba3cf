use crate::gradient::{products, reduce, square_product};
use crate::kernels::{Gibbs, PlanRows, Scaling, Sweep, dispatch};
use crate::objective::terms_with_product;
use crate::padded::Padded;
use crate::parallel::{Chunk, PerBlock, SMALL, for_blocks, with_threads};
use crate::{Params, Problem, Real, Record, Start, Trace, TransportError, Workspace};

/// The solver to use: majorise-minimise with Sinkhorn sweeps.
///
/// Each outer iteration linearises the Gromov-Wasserstein term at the current plan (gradient `G0`) and solves
///
/// `min <G0, T> + lambda KL(c || q) + mu KL(c || c_old) - epsilon H(T)`  subject to  `T 1 = p`,
///
/// where `c` is the column mass of `T`, by scaling: `T = diag(u) K diag(v)`, `K = exp(-G0 / epsilon)`, `u = p / (K v)`,
/// `v = (target / (K^T u))^w`, `target = (q^lambda c_old^mu)^(1/(lambda + mu))`, `w = (lambda + mu)/(lambda + mu + epsilon)`.
/// `mu` keeps the column mass from jumping. Unlike [`MirrorDescent`](crate::MirrorDescent) it has no step and stays
/// stable for every `lambda`. `v` is carried over to the next outer iteration inside `K`, which keeps all numbers in range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MmSinkhorn {
    /// Outer iterations: one gradient (two matrix products) each.
    pub iterations: usize,
    /// Most sweeps per outer iteration, at least 1; each costs about 1 % of a gradient.
    pub sweeps: usize,
    /// Sweeps end early once the column masses change by less than this (L1; they sum to 1). 0 does all sweeps.
    pub sweep_tolerance: f64,
    /// Proximal weight, at least 0.
    pub mu: f64,
    /// Where to begin.
    pub start: Start,
    /// Record the objective's terms after every this many iterations, and at the end; 0 records nothing. A record costs a gradient.
    pub trace: usize,
    /// Stop once the plan changes by less than this in one iteration (L1; a plan sums to 1), but not before
    /// `min_iterations`: the objective can rest on a plateau and then fall again. 0 never stops early.
    pub tolerance: f64,
    /// Iterations to do in any case.
    pub min_iterations: usize,
}

impl Default for MmSinkhorn {
    fn default() -> Self {
        Self {
            iterations: 50,
            sweeps: 20,
            sweep_tolerance: 1e-2,
            mu: 0.05,
            start: Start::Independent,
            trace: 0,
            tolerance: 0.0,
            min_iterations: 20,
        }
    }
}

impl MmSinkhorn {
    /// Solves; the plan is then in [`Workspace::plan`]. With `iterations` 0 it is the start.
    ///
    /// # Errors
    /// [`TransportError::Parameter`] for a setting out of its range, [`TransportError::NothingToContinue`].
    pub fn solve<T: Real>(
        &self,
        problem: &Problem<'_, T>,
        workspace: &mut Workspace<T>,
    ) -> Result<Trace, TransportError> {
        self.validate()?;
        workspace.prepare(problem, self.start)?;
        let mut trace = Trace::default();
        trace.records.reserve(self.iterations.checked_div(self.trace).map_or(0, |records| records + 1));
        with_threads(workspace.threads, || self.run(problem, workspace, &mut trace));
        workspace.finish();
        Ok(trace)
    }

    pub(crate) fn validate(&self) -> Result<(), TransportError> {
        let check = |name, value: f64, good: bool, range| {
            if good && value.is_finite() {
                Ok(())
            } else {
                Err(TransportError::Parameter { name, value, range })
            }
        };
        check("sweeps", self.sweeps as f64, self.sweeps >= 1, "at least 1")?;
        check("sweep_tolerance", self.sweep_tolerance, self.sweep_tolerance >= 0.0, "at least 0")?;
        check("tolerance", self.tolerance, self.tolerance >= 0.0, "at least 0")?;
        check("mu", self.mu, (0.0..=1e6).contains(&self.mu), "between 0 and 1e6")
    }

    fn run<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>, trace: &mut Trace) {
        let recorded = |k: usize| self.trace > 0 && k > 0 && k.is_multiple_of(self.trace);
        for k in 0..self.iterations {
            if recorded(k) {
                record(problem, workspace, trace, k);
            }
            self.target(problem, workspace);
            self.kernel(problem, workspace);
            self.sweep(problem, workspace, trace);
            let change = self.plan(problem, workspace);
            trace.iterations = k + 1;
            if self.tolerance > 0.0 {
                trace.change = Some(change);
                if k + 1 >= self.min_iterations && change < self.tolerance {
                    break;
                }
            }
        }
        if self.trace > 0 {
            record(problem, workspace, trace, trace.iterations);
        }
    }

    /// `workspace.log_target`, and `workspace.column`: the gradient's column term less the scaling to hold.
    fn target<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>) {
        square_product(problem, workspace);
        let Workspace { sums, held, column, log_target, mass, .. } = workspace;
        let (params, allowed) = (problem.params(), problem.allowed());
        set_target(params, self.mu, allowed, sums.row(0), held.row(0), mass.row(0), column, log_target);
        for &j in problem.mask().map_or(&[][..], |mask| &mask.columns) {
            (column.row_mut(0)[j], log_target.row_mut(0)[j]) = (T::HUGE, -T::HUGE);
        }
    }

    /// `workspace.kernel` = K, `workspace.sums` = K^T u for v = 1.
    fn kernel<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>) {
        let params = problem.params();
        let scale = T::from_f64(-4.0 * params.alpha);
        let inverse_epsilon = T::from_f64(1.0 / params.epsilon);
        let p = T::from_f64(1.0 / problem.rows() as f64);
        let (cols, isa, mask) = (problem.cols(), workspace.isa, problem.mask());
        let column = std::mem::take(&mut workspace.column);
        let linear = std::mem::take(&mut workspace.linear);
        let (stride, terms) = (linear.stride(), linear.all());
        products(problem, workspace, &|first, count, rows, sums| {
            let linear = &terms[first * stride..(first + count) * stride];
            let column = column.all();
            let gibbs =
                Gibbs { rows: &mut *rows, linear, column, scale, inverse_epsilon, p, stride, cols, sums };
            dispatch(isa, gibbs);
            if let Some(mask) = mask {
                mask.settle(rows, stride, first, count, T::ONE);
            }
        });
        workspace.column = column;
        workspace.linear = linear;
        reduce(workspace.partial.all(), workspace.sums.all_mut());
        workspace.scaling.row_mut(0).fill(T::ONE);
    }

    fn sweep<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>, trace: &mut Trace) {
        let sum = problem.params().lambda + self.mu;
        let weight = T::from_f64(sum / (sum + problem.params().epsilon));
        let p = T::from_f64(1.0 / problem.rows() as f64);
        let (n, cols, block) = (problem.rows(), problem.cols(), workspace.block());
        let Workspace { kernel, partial, sums, log_target, held, scaling, log_scaling, threads, isa, .. } =
            workspace;
        let stride = kernel.stride();
        let threads = if n * stride >= SMALL { *threads } else { 1 };
        for done in 1.. {
            let change = dispatch(
                *isa,
                Scaling {
                    sums: sums.all(),
                    log_target: log_target.all(),
                    held: held.all(),
                    weight,
                    v: scaling.all_mut(),
                    log_v: log_scaling.all_mut(),
                    cols,
                },
            );
            // With a scaling of 0, what the exponent's floor has left in a forbidden column never comes into the plan.
            for &j in problem.mask().map_or(&[][..], |mask| &mask.columns) {
                (scaling.row_mut(0)[j], log_scaling.row_mut(0)[j]) = (T::ZERO, T::ZERO);
            }
            trace.sweeps += 1;
            if done >= self.sweeps || change.to_f64() < self.sweep_tolerance {
                break;
            }
            let (all, v) = (kernel.all(), scaling.all());
            let work = PerBlock::new(partial.all_mut(), stride, block);
            for_blocks(threads, n, block, work, &|first, count, sums: PerBlock<'_, T>| {
                let rows = &all[first * stride..(first + count) * stride];
                dispatch(*isa, Sweep { rows, v, p, stride, sums: sums.first() });
            });
            reduce(partial.all(), sums.all_mut());
        }
        held.row_mut(0).iter_mut().zip(log_scaling.row(0)).for_each(|(held, &log)| *held += log);
    }

    /// `workspace.transport` and its column mass; returns the L1 change when it is watched.
    fn plan<T: Real>(&self, problem: &Problem<'_, T>, workspace: &mut Workspace<T>) -> f64 {
        let p = T::from_f64(1.0 / problem.rows() as f64);
        let (n, block, watch) = (problem.rows(), workspace.block(), self.tolerance > 0.0);
        let Workspace { kernel, transport, partial, partial_change, mass, scaling, threads, isa, .. } =
            workspace;
        let (stride, all, v) = (kernel.stride(), kernel.all(), scaling.all());
        let threads = if n * stride >= SMALL { *threads } else { 1 };
        let work = (
            Chunk::new(transport.all_mut(), stride),
            PerBlock::new(partial.all_mut(), stride, block),
            PerBlock::new(partial_change, 1, block),
        );
        type Piece<'a, T> = (Chunk<'a, T>, PerBlock<'a, T>, PerBlock<'a, f64>);
        for_blocks(threads, n, block, work, &|first, count, (plan, sums, change): Piece<'_, T>| {
            let rows = &all[first * stride..(first + count) * stride];
            let kernel = PlanRows { rows, v, p, stride, plan: &mut *plan.data, sums: sums.first(), watch };
            change.first()[0] = dispatch(*isa, kernel);
            if let Some(mask) = problem.mask() {
                mask.settle(plan.data, stride, first, count, p);
            }
        });
        reduce(partial.all(), mass.all_mut());
        partial_change[..n.div_ceil(block)].iter().sum()
    }
}

/// `log_target` from the column `mass`, and `column` from `sums` = Dx^2 c less the scaling `held`.
#[allow(clippy::too_many_arguments)]
pub(crate) fn set_target<T: Real>(
    params: Params,
    mu: f64,
    allowed: usize,
    sums: &[T],
    held: &[T],
    mass: &[T],
    column: &mut Padded<T>,
    log_target: &mut Padded<T>,
) {
    let sum = params.lambda + mu;
    let share = if sum > 0.0 { mu / sum } else { 0.0 };
    let (share, constant) = (T::from_f64(share), T::from_f64((share - 1.0) * (allowed as f64).ln()));
    let (two_alpha, epsilon) = (T::from_f64(2.0 * params.alpha), T::from_f64(params.epsilon));
    let out = column.row_mut(0).iter_mut().zip(log_target.row_mut(0));
    for (j, (column, log_target)) in out.enumerate() {
        *column = two_alpha * sums[j] - epsilon * held[j];
        *log_target = constant + share * mass[j].greater(T::TINY).ln();
    }
}

/// Appends the terms of the current plan; costs a gradient.
pub(crate) fn record<T: Real>(
    problem: &Problem<'_, T>,
    workspace: &mut Workspace<T>,
    trace: &mut Trace,
    iteration: usize,
) {
    products(problem, workspace, &|_, _, _, _| ());
    let (plan, product) = (&workspace.transport, &workspace.kernel);
    let terms = terms_with_product(problem, |i| plan.row(i), |i| product.row(i));
    trace.records.push(Record { iteration, terms });
}
