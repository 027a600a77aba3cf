use crate::factor_product::FactorBuffers;
use crate::padded::Padded;
use crate::workspace::noise;
use crate::{Isa, LowRank, Plan, Real, SparseProblem, Start, Support, TransportError};

/// Every buffer of a sparse solve, as [`Workspace`](crate::Workspace) for dense ones. Takes about 16 bytes for each entry
/// of the support (in `f32`), and memory in proportion to (N + 10 M) times the rank; it grows on demand and is kept.
#[derive(Debug)]
pub struct SparseWorkspace<T: Real> {
    pub(crate) threads: usize,
    pub(crate) isa: Isa,
    solved: bool,
    /// The support less what is masked, and the plan on it.
    pub(crate) entries: Support,
    pub(crate) transport: Vec<T>,
    /// The plan before, while it is brought to another support.
    old_entries: Support,
    old_transport: Vec<T>,
    /// Dy T Dx at the entries, then the Gibbs kernel.
    pub(crate) kernel: Vec<T>,
    /// What is linear in T, at the entries.
    pub(crate) linear: Vec<T>,
    /// Columns without entries.
    pub(crate) idle: Vec<usize>,
    /// [By | -excess T Ax], N x 2 k, and [Dx T^T Ay | Bx], M x 2 k: `Dy T Dx` is their product, but for the diagonals.
    pub(crate) left: Padded<T>,
    pub(crate) right: Padded<T>,
    /// T^T Ay, M x k; its parts by block; Bx^T T^T Ay, k x k; Dx T^T Ay, M x k; a row of T Ax per block.
    pub(crate) gathered: Padded<T>,
    pub(crate) gathered_parts: Vec<T>,
    pub(crate) core: Padded<T>,
    pub(crate) spread: Padded<T>,
    pub(crate) tall: Padded<T>,
    pub(crate) factors: FactorBuffers<T>,
    /// Vectors of M, as in the dense workspace.
    pub(crate) column: Padded<T>,
    pub(crate) mass: Padded<T>,
    pub(crate) sums: Padded<T>,
    pub(crate) log_target: Padded<T>,
    pub(crate) held: Padded<T>,
    pub(crate) scaling: Padded<T>,
    pub(crate) log_scaling: Padded<T>,
    pub(crate) partial: Padded<T>,
    pub(crate) partial_change: Vec<f64>,
    plan: Plan<T>,
}

impl<T: Real> SparseWorkspace<T> {
    /// An empty workspace whose solves use up to `threads` threads of the current rayon pool; 0 and 1 use none. The
    /// results do not depend on it.
    pub fn new(threads: usize) -> Self {
        Self {
            threads: threads.max(1),
            isa: Isa::current(),
            solved: false,
            entries: Support::default(),
            transport: Vec::new(),
            old_entries: Support::default(),
            old_transport: Vec::new(),
            kernel: Vec::new(),
            linear: Vec::new(),
            idle: Vec::new(),
            left: Padded::default(),
            right: Padded::default(),
            gathered: Padded::default(),
            gathered_parts: Vec::new(),
            core: Padded::default(),
            spread: Padded::default(),
            tall: Padded::default(),
            factors: FactorBuffers::default(),
            column: Padded::default(),
            mass: Padded::default(),
            sums: Padded::default(),
            log_target: Padded::default(),
            held: Padded::default(),
            scaling: Padded::default(),
            log_scaling: Padded::default(),
            partial: Padded::default(),
            partial_change: Vec::new(),
            plan: Plan::default(),
        }
    }

    /// The threads that solves use.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Uses another number of threads from the next solve on.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads.max(1);
    }

    /// Lowers the instruction level for this workspace; a level above the processor's falls to the processor's.
    pub fn set_isa(&mut self, isa: Isa) {
        self.isa = isa.min(Isa::detect());
    }

    /// The plan of the last solve, sparse; a dense one of 0 x 0 before any.
    pub fn plan(&self) -> &Plan<T> {
        &self.plan
    }

    /// The plan of the last solve, by move. The workspace can still continue from it.
    pub fn take_plan(&mut self) -> Plan<T> {
        std::mem::take(&mut self.plan)
    }

    /// Takes a plan, dense or sparse, as if a solve had just ended with it, for [`Start::Continue`]. That solve brings it
    /// to its own support: what lies outside goes, and the rest of the row is scaled up to 1/N.
    pub fn resume(&mut self, plan: &Plan<T>) {
        self.entries.copy_plan(plan, &mut self.transport);
        self.held.reset(1, plan.cols(), T::ZERO);
        self.plan.clone_from(plan);
        self.solved = true;
    }

    /// Shapes the buffers and puts the start in place.
    pub(crate) fn prepare(
        &mut self,
        problem: &SparseProblem<'_, T>,
        start: Start,
    ) -> Result<(), TransportError> {
        let (n, m) = (problem.rows(), problem.cols());
        let (have_rows, have_cols) =
            if self.solved { (self.entries.rows(), self.entries.cols()) } else { (0, 0) };
        if start == Start::Continue && (have_rows, have_cols) != (n, m) {
            return Err(TransportError::NothingToContinue { have_rows, have_cols, rows: n, cols: m });
        }
        self.solved = false;
        std::mem::swap(&mut self.entries, &mut self.old_entries);
        std::mem::swap(&mut self.transport, &mut self.old_transport);
        self.entries.restrict(problem.support, problem.mask);
        self.transport.resize(self.entries.len(), T::ZERO);
        self.kernel.resize(self.entries.len(), T::ZERO);
        let parts = blocks(n);
        self.partial.shape(parts, m);
        self.partial_change.resize(parts, 0.0);
        for vector in [
            &mut self.column,
            &mut self.sums,
            &mut self.log_target,
            &mut self.scaling,
            &mut self.log_scaling,
            &mut self.mass,
        ] {
            vector.reset(1, m, T::ZERO);
        }
        match start {
            Start::Continue => self.move_plan(),
            Start::Independent => self.fill_start(0),
            Start::Perturbed(seed) => self.fill_start(seed),
        }
        if start != Start::Continue {
            self.held.reset(1, m, T::ZERO);
        }
        let mass = self.mass.row_mut(0);
        let mut used = vec![false; m];
        for (&j, &t) in self.entries.columns().iter().zip(&self.transport) {
            mass[j as usize] += t;
            used[j as usize] = true;
        }
        self.idle.clear();
        self.idle.extend((0..m).filter(|&j| !used[j]));
        self.set_linear(problem);
        self.set_factors(problem.control, problem.source);
        Ok(())
    }

    /// Puts the result where the caller sees it.
    pub(crate) fn finish(&mut self) {
        self.plan.write_sparse(&self.entries, &self.transport, self.mass.row(0));
        self.solved = true;
    }

    fn fill_start(&mut self, seed: u64) {
        let p = 1.0 / self.entries.rows() as f64;
        let mut state = seed;
        for i in 0..self.entries.rows() {
            let row = &mut self.transport[self.entries.range(i)];
            row.fill(T::from_f64(p / row.len() as f64));
            if seed != 0 {
                row.iter_mut().for_each(|t| *t = T::from_f64(1.0 + 0.05 * noise(&mut state)));
                scale_to(row, p);
            }
        }
    }

    /// Brings the plan from its old support to the new one.
    fn move_plan(&mut self) {
        if self.entries == self.old_entries {
            self.transport.copy_from_slice(&self.old_transport);
            return;
        }
        let p = 1.0 / self.entries.rows() as f64;
        for i in 0..self.entries.rows() {
            let row = &mut self.transport[self.entries.range(i)];
            row.fill(T::ZERO);
            let columns = self.entries.row(i);
            let (mut at, mut lost) = (0, false);
            for (j, &t) in self.old_entries.row(i).iter().zip(&self.old_transport[self.old_entries.range(i)])
            {
                at += columns[at..].partition_point(|column| column < j);
                match columns.get(at) {
                    Some(column) if column == j => row[at] = t,
                    _ => lost |= t > T::ZERO,
                }
            }
            if lost || row.len() == 1 || row.iter().all(|&t| t == T::ZERO) {
                scale_to(row, p);
            }
        }
    }

    fn set_linear(&mut self, problem: &SparseProblem<'_, T>) {
        let weight = T::from_f64(1.0 - problem.params.alpha);
        self.linear.clear();
        if problem.mask.is_none() {
            let all = 0..self.entries.len();
            self.linear.extend(all.map(|e| linear(problem, weight, e)));
            return;
        }
        for i in 0..self.entries.rows() {
            let (from, columns) = (problem.support.range(i).start, problem.support.row(i));
            for j in self.entries.row(i) {
                // A settled row's entry may lie outside of the support; its cost then changes nothing and counts as 0.
                let at = columns.binary_search(j).map(|at| linear(problem, weight, from + at));
                self.linear.push(at.unwrap_or(T::ZERO));
            }
        }
    }

    fn set_factors(&mut self, control: &LowRank<T>, source: &LowRank<T>) {
        let (n, m) = (control.len(), source.len());
        let (ky, kx) = (control.left.cols(), source.left.cols());
        self.left.reset(n, ky + kx, T::ZERO);
        self.right.reset(m, ky + kx, T::ZERO);
        for i in 0..n {
            let row = self.left.row_mut(i);
            row[..ky].iter_mut().enumerate().for_each(|(k, b)| *b = control.right.row(k)[i]);
        }
        for j in 0..m {
            let row = self.right.row_mut(j);
            row[ky..].iter_mut().enumerate().for_each(|(k, b)| *b = source.right.row(k)[j]);
        }
        self.gathered.shape(m, ky);
        self.gathered_parts.resize(blocks(n) * m * self.gathered.stride(), T::ZERO);
        self.core.shape(kx, ky);
        self.spread.shape(m, ky);
        self.tall.shape(blocks(n), kx);
    }
}

fn linear<T: Real>(problem: &SparseProblem<'_, T>, weight: T, entry: usize) -> T {
    let cost = problem.cost.map_or(T::ZERO, |cost| weight * cost[entry]);
    cost + problem.linear.map_or(T::ZERO, |bias| bias[entry])
}

/// Scales a row to the sum `p`, exactly when it has one entry; a row of zeros becomes even.
fn scale_to<T: Real>(row: &mut [T], p: f64) {
    let sum: f64 = row.iter().map(|t| t.to_f64()).sum();
    if sum > 0.0 && row.len() > 1 {
        let scale = T::from_f64(p / sum);
        row.iter_mut().for_each(|t| *t *= scale);
    } else {
        row.fill(T::from_f64(p / row.len() as f64));
    }
}

/// Rows of a block: blocks are few, as each has a sum of M x k.
pub(crate) fn block_rows(rows: usize) -> usize {
    rows.div_ceil(8).max(64)
}

fn blocks(rows: usize) -> usize {
    rows.div_ceil(block_rows(rows))
}
