use crate::factor_product::FactorBuffers;
use crate::padded::Padded;
use crate::parallel::{block_rows, blocks};
use crate::{Distances, Isa, MatRef, Plan, Problem, Real, TransportError};

/// Where a solve begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// The independent plan `p q^T`.
    #[default]
    Independent,
    /// The independent plan, each entry times 1 plus noise of up to 5 % drawn from this seed: another seed may find
    /// another of several equally good plans. Seed 0 is [`Start::Independent`].
    Perturbed(u64),
    /// The plan and the column scaling that the last solve left in the workspace. The shape must be the same; the
    /// matrices and weights may differ.
    Continue,
}

/// Every buffer of a solve. It grows on demand and is kept between solves, so that solving the same or a smaller shape
/// again allocates nothing.
#[derive(Debug)]
pub struct Workspace<T: Real> {
    pub(crate) threads: usize,
    pub(crate) isa: Isa,
    /// Whether `transport`, and with it `held`, is the result of a solve.
    pub(crate) solved: bool,
    /// T, N x M.
    pub(crate) transport: Padded<T>,
    /// Dy T, N x M.
    pub(crate) half: Padded<T>,
    /// Dy T Dx, then the Gibbs kernel, N x M.
    pub(crate) kernel: Padded<T>,
    /// (1 - alpha) C and whatever else is linear in T, N x M; HUGE where a settled row may not go.
    pub(crate) linear: Padded<T>,
    /// log T, N x M; mirror descent only.
    pub(crate) log_plan: Padded<T>,
    /// A copy of Dx with padded rows, M x M; of a former solve when distances come by factors.
    pub(crate) source: Padded<T>,
    /// What products with low-rank distances need.
    pub(crate) factors: FactorBuffers<T>,
    /// Vectors of M: the gradient's part that depends on the column only, the column mass of T, sums over rows,
    /// log of the target mass, the scaling held in the kernel (as a logarithm), the scaling, its logarithm.
    pub(crate) column: Padded<T>,
    pub(crate) mass: Padded<T>,
    pub(crate) sums: Padded<T>,
    pub(crate) log_target: Padded<T>,
    pub(crate) held: Padded<T>,
    pub(crate) scaling: Padded<T>,
    pub(crate) log_scaling: Padded<T>,
    /// Sums over the rows of each block, one row of M per block.
    pub(crate) partial: Padded<T>,
    /// One number per block.
    pub(crate) partial_change: Vec<f64>,
    plan: Plan<T>,
}

impl<T: Real> Workspace<T> {
    /// An empty workspace whose solves use up to `threads` threads of the current rayon pool; 0 and 1 use none. The
    /// results do not depend on it.
    pub fn new(threads: usize) -> Self {
        Self {
            threads: threads.max(1),
            isa: Isa::current(),
            solved: false,
            transport: Padded::default(),
            half: Padded::default(),
            kernel: Padded::default(),
            linear: Padded::default(),
            log_plan: Padded::default(),
            source: Padded::default(),
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

    /// The plan of the last solve; 0 x 0 before any.
    pub fn plan(&self) -> &Plan<T> {
        &self.plan
    }

    /// The plan of the last solve, by move. The workspace can still continue from it; its next solve allocates a new one.
    pub fn take_plan(&mut self) -> Plan<T> {
        std::mem::take(&mut self.plan)
    }

    /// Takes a plan as if a solve had just ended with it, for [`Start::Continue`]: another solve's, or one put together
    /// by hand. Rows are taken as they are; a solver's first iteration makes them sum to 1/N again.
    pub fn resume(&mut self, plan: &Plan<T>) {
        let (n, m) = (plan.rows(), plan.cols());
        self.transport.reset(n, m, T::ZERO);
        self.held.reset(1, m, T::ZERO);
        self.mass.reset(1, m, T::ZERO);
        for i in 0..n {
            plan.row_into(i, self.transport.row_mut(i));
        }
        self.mass.row_mut(0).copy_from_slice(plan.column_mass());
        self.finish();
    }

    /// Shapes the buffers and puts the start in place.
    pub(crate) fn prepare(&mut self, problem: &Problem<'_, T>, start: Start) -> Result<(), TransportError> {
        let (n, m) = (problem.rows(), problem.cols());
        let same = (self.transport.rows(), self.transport.cols()) == (n, m);
        if start == Start::Continue && !(self.solved && same) {
            let (have_rows, have_cols) =
                if self.solved { (self.transport.rows(), self.transport.cols()) } else { (0, 0) };
            return Err(TransportError::NothingToContinue { have_rows, have_cols, rows: n, cols: m });
        }
        self.solved = false;
        self.half.shape(n, m);
        self.kernel.shape(n, m);
        self.partial.shape(blocks(n), m);
        self.partial_change.resize(blocks(n).max(blocks(m)), 0.0);
        for vector in
            [&mut self.column, &mut self.sums, &mut self.log_target, &mut self.scaling, &mut self.log_scaling]
        {
            vector.reset(1, m, T::ZERO);
        }
        if start != Start::Continue {
            self.held.reset(1, m, T::ZERO);
            self.mass.reset(1, m, T::ZERO);
            self.transport.reset(n, m, T::ZERO);
            self.fill_start(if let Start::Perturbed(seed) = start { seed } else { 0 });
        }
        if let Some(mask) = problem.mask()
            && mask.apply(&mut self.transport, problem.allowed())
        {
            self.sum_columns();
        }
        self.set_linear(problem);
        match problem.source() {
            Distances::Dense(source) => self.set_source(source),
            Distances::LowRank(low) => self.factors.tall.shape(n, low.left.cols()),
        }
        Ok(())
    }

    /// Puts the result where the caller sees it.
    pub(crate) fn finish(&mut self) {
        let transport = &self.transport;
        self.plan.write(transport.rows(), transport.cols(), |i| transport.row(i), self.mass.row(0));
        self.solved = true;
    }

    fn fill_start(&mut self, seed: u64) {
        let (n, m) = (self.transport.rows(), self.transport.cols());
        let p = 1.0 / n as f64;
        let entry = p / m as f64;
        let mut state = seed;
        for i in 0..n {
            let row = self.transport.row_mut(i);
            row.fill(T::from_f64(entry));
            if seed != 0 {
                row.iter_mut().for_each(|t| *t = T::from_f64(entry * (1.0 + 0.05 * noise(&mut state))));
                let scale = T::from_f64(p / row.iter().map(|t| t.to_f64()).sum::<f64>());
                row.iter_mut().for_each(|t| *t *= scale);
            }
        }
        self.sum_columns();
    }

    /// `mass = T^T 1`, in the blocks and the order in which a solver sums them.
    fn sum_columns(&mut self) {
        let (rows, block) = (self.transport.rows(), self.block());
        let Self { transport, mass, sums, .. } = self;
        let (mass, sums) = (mass.row_mut(0), sums.row_mut(0));
        mass.fill(T::ZERO);
        for first in (0..rows).step_by(block) {
            sums.fill(T::ZERO);
            for i in first..(first + block).min(rows) {
                sums.iter_mut().zip(transport.row(i)).for_each(|(sum, &t)| *sum += t);
            }
            mass.iter_mut().zip(sums.iter()).for_each(|(c, &sum)| *c += sum);
        }
    }

    fn set_linear(&mut self, problem: &Problem<'_, T>) {
        let (n, m) = (problem.rows(), problem.cols());
        self.linear.shape(n, m);
        let stride = self.linear.stride();
        let weight = T::from_f64(1.0 - problem.params().alpha);
        for (i, row) in self.linear.all_mut().chunks_exact_mut(stride).enumerate() {
            match problem.cost() {
                Some(cost) => row.iter_mut().zip(cost.row(i)).for_each(|(l, &c)| *l = weight * c),
                None => row[..m].fill(T::ZERO),
            }
            if let Some(bias) = problem.linear() {
                row.iter_mut().zip(bias.row(i)).for_each(|(l, &b)| *l += b);
            }
            row[m..].fill(T::HUGE);
        }
        for &(i, j) in problem.mask().map_or(&[][..], |mask| &mask.rows) {
            let row = &mut self.linear.all_mut()[i * stride..][..stride];
            row.fill(T::HUGE);
            row[j] = T::ZERO;
        }
    }

    fn set_source(&mut self, source: MatRef<'_, T>) {
        let m = source.rows();
        self.source.shape(m, m);
        let stride = self.source.stride();
        for (j, row) in self.source.all_mut().chunks_exact_mut(stride).enumerate() {
            row[..m].copy_from_slice(source.row(j));
            row[m..].fill(T::ZERO);
        }
    }

    /// Rows of a block of the plan.
    pub(crate) fn block(&self) -> usize {
        block_rows(self.transport.rows())
    }
}

/// Uniform in -1..1: splitmix64.
pub(crate) fn noise(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
