//! [`MmSinkhorn`] on a support: the same steps as for dense plans, on compressed rows.

use crate::gradient::reduce;
use crate::kernels::{Block, Scaling, SparseGibbs, SparsePlanRows, SparseSweep, dispatch};
use crate::mm_sinkhorn::set_target;
use crate::parallel::{PerBlock, Ragged, for_blocks, with_threads};
use crate::sparse_gradient::{products, terms};
use crate::sparse_workspace::block_rows;
use crate::{MmSinkhorn, Real, Record, SparseProblem, SparseWorkspace, Trace, TransportError};

impl MmSinkhorn {
    /// Solves for a plan on a support; it is then in [`SparseWorkspace::plan`]. With `iterations` 0 it is the start:
    /// [`Start::Independent`](crate::Start::Independent) is even over each row of the support.
    ///
    /// # Errors
    /// [`TransportError::Parameter`] for a setting out of its range, [`TransportError::NothingToContinue`].
    ///
    /// ```
    /// use inkrig_transport::{MmSinkhorn, Nystrom, Params, SparseProblem, SparseWorkspace, Support};
    /// // 400 points on a line and the same points again; each may go to the 31 nearest in place.
    /// let line = |i: usize, out: &mut [f32]| {
    ///     out.iter_mut().enumerate().for_each(|(j, d)| *d = (i as f32 - j as f32).abs() / 133.0);
    /// };
    /// let distances = Nystrom::default().fit(400, line)?;
    /// let support = Support::from_rows(400, 400, |i, out| out.extend(i.saturating_sub(15)..(i + 16).min(400)))?;
    /// let params = Params { alpha: 1.0, ..Params::default() };
    /// let problem = SparseProblem::new(&distances, &distances, &support, None, params)?;
    /// let mut workspace = SparseWorkspace::new(1);
    /// MmSinkhorn::default().solve_sparse(&problem, &mut workspace)?;
    /// assert!(workspace.plan().best_source(200).abs_diff(200) <= 5);
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn solve_sparse<T: Real>(
        &self,
        problem: &SparseProblem<'_, T>,
        workspace: &mut SparseWorkspace<T>,
    ) -> Result<Trace, TransportError> {
        self.validate()?;
        workspace.prepare(problem, self.start)?;
        let mut trace = Trace::default();
        with_threads(workspace.threads, || self.run_sparse(problem, workspace, &mut trace));
        workspace.finish();
        Ok(trace)
    }

    fn run_sparse<T: Real>(
        &self,
        problem: &SparseProblem<'_, T>,
        workspace: &mut SparseWorkspace<T>,
        trace: &mut Trace,
    ) {
        for k in 0..self.iterations {
            if self.trace > 0 && k > 0 && k.is_multiple_of(self.trace) {
                trace.records.push(Record { iteration: k, terms: terms(problem, workspace) });
            }
            self.target_sparse(problem, workspace);
            kernel(problem, workspace);
            self.sweep_sparse(problem, workspace, trace);
            let change = plan(problem, workspace);
            trace.iterations = k + 1;
            if self.tolerance > 0.0 {
                trace.change = Some(change);
                if k + 1 >= self.min_iterations && change < self.tolerance {
                    break;
                }
            }
        }
        if self.trace > 0 {
            trace.records.push(Record { iteration: trace.iterations, terms: terms(problem, workspace) });
        }
    }

    fn target_sparse<T: Real>(&self, problem: &SparseProblem<'_, T>, workspace: &mut SparseWorkspace<T>) {
        let SparseWorkspace { sums, held, column, log_target, mass, factors, isa, .. } = workspace;
        problem.source.square_product(*isa, mass.row(0), factors, sums.row_mut(0));
        let (params, allowed) = (problem.params, problem.allowed);
        set_target(params, self.mu, allowed, sums.row(0), held.row(0), mass.row(0), column, log_target);
    }

    fn sweep_sparse<T: Real>(
        &self,
        problem: &SparseProblem<'_, T>,
        workspace: &mut SparseWorkspace<T>,
        trace: &mut Trace,
    ) {
        let sum = problem.params.lambda + self.mu;
        let weight = T::from_f64(sum / (sum + problem.params.epsilon));
        let p = T::from_f64(1.0 / problem.rows() as f64);
        let (n, cols, block) = (problem.rows(), problem.cols(), block_rows(problem.rows()));
        let SparseWorkspace {
            entries,
            kernel,
            partial,
            sums,
            log_target,
            held,
            scaling,
            log_scaling,
            idle,
            threads,
            isa,
            ..
        } = workspace;
        let (starts, columns, stride) = (entries.starts(), entries.columns(), partial.stride());
        for done in 1.. {
            let scale = Scaling {
                sums: sums.all(),
                log_target: log_target.all(),
                held: held.all(),
                weight,
                v: scaling.all_mut(),
                log_v: log_scaling.all_mut(),
                cols,
            };
            let change = dispatch(*isa, scale);
            // Without entries a column's scaling would grow without bound.
            for &j in idle.iter() {
                (scaling.row_mut(0)[j], log_scaling.row_mut(0)[j]) = (T::ZERO, T::ZERO);
            }
            trace.sweeps += 1;
            if done >= self.sweeps || change.to_f64() < self.sweep_tolerance {
                break;
            }
            let (kernel, v) = (&kernel[..], scaling.row(0));
            let work = PerBlock::new(partial.all_mut(), stride, block);
            for_blocks(*threads, n, block, work, &|first, rows, sums: PerBlock<'_, T>| {
                let at = starts[first]..starts[first + rows];
                let block = Block { starts: &starts[first..=first + rows], columns: &columns[at.clone()] };
                dispatch(*isa, SparseSweep { block, values: &kernel[at], v, p, sums: sums.first() });
            });
            reduce(partial.all(), sums.all_mut());
        }
        held.row_mut(0).iter_mut().zip(log_scaling.row(0)).for_each(|(held, &log)| *held += log);
    }
}

/// `workspace.kernel` = K, `workspace.sums` = K^T u for v = 1.
fn kernel<T: Real>(problem: &SparseProblem<'_, T>, workspace: &mut SparseWorkspace<T>) {
    let scale = T::from_f64(-4.0 * problem.params.alpha);
    let inverse_epsilon = T::from_f64(1.0 / problem.params.epsilon);
    let p = T::from_f64(1.0 / problem.rows() as f64);
    let isa = workspace.isa;
    let column = std::mem::take(&mut workspace.column);
    let linear = std::mem::take(&mut workspace.linear);
    products(problem, workspace, &|block, first, values, sums| {
        let (linear, column) = (&linear[first..], column.row(0));
        dispatch(isa, SparseGibbs { block, values, linear, column, scale, inverse_epsilon, p, sums });
    });
    workspace.column = column;
    workspace.linear = linear;
    reduce(workspace.partial.all(), workspace.sums.all_mut());
    workspace.scaling.row_mut(0).fill(T::ONE);
}

/// `workspace.transport` and its column mass; returns the L1 change.
fn plan<T: Real>(problem: &SparseProblem<'_, T>, workspace: &mut SparseWorkspace<T>) -> f64 {
    let p = T::from_f64(1.0 / problem.rows() as f64);
    let (n, block) = (problem.rows(), block_rows(problem.rows()));
    let SparseWorkspace {
        entries,
        kernel,
        transport,
        partial,
        partial_change,
        mass,
        scaling,
        threads,
        isa,
        ..
    } = workspace;
    let (starts, columns, stride) = (entries.starts(), entries.columns(), partial.stride());
    let (kernel, v) = (&kernel[..], scaling.row(0));
    let work = (
        Ragged { data: transport, starts },
        PerBlock::new(partial.all_mut(), stride, block),
        PerBlock::new(partial_change, 1, block),
    );
    type Piece<'a, T> = (Ragged<'a, T>, PerBlock<'a, T>, PerBlock<'a, f64>);
    for_blocks(*threads, n, block, work, &|first, rows, (plan, sums, change): Piece<'_, T>| {
        let at = starts[first]..starts[first + rows];
        let block = Block { starts: &starts[first..=first + rows], columns: &columns[at.clone()] };
        let step = SparsePlanRows { block, values: &kernel[at], v, p, plan: plan.data, sums: sums.first() };
        change.first()[0] = dispatch(*isa, step);
    });
    reduce(partial.all(), mass.all_mut());
    partial_change.iter().sum()
}
