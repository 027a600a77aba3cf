//! Loops over rows of a sparse plan: entry e of the block stands in column `columns[e]`; row i has the entries
//! `starts[i] - starts[0] .. starts[i + 1] - starts[0]`.

use super::Kernel;
use super::rows::{dot, exp_row};
use crate::Real;

/// The rows of one block.
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    pub(crate) starts: &'a [usize],
    pub(crate) columns: &'a [u32],
}

impl<'a> Block<'a> {
    /// For each row its range of entries.
    #[inline(always)]
    pub(super) fn rows(self) -> impl Iterator<Item = std::ops::Range<usize>> + 'a {
        let first = self.starts[0];
        self.starts.windows(2).map(move |pair| pair[0] - first..pair[1] - first)
    }
}

/// `T Ax` and `Ay^T T`: thin products with the plan from both sides, in one pass.
pub(crate) struct Gather<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) plan: &'a [T],
    /// Ay of these rows, `rows_stride` apart.
    pub(crate) control: &'a [T],
    pub(crate) rows_stride: usize,
    /// Ax, `columns_stride` apart.
    pub(crate) source: &'a [T],
    pub(crate) columns_stride: usize,
    /// What Dy's factors have too much on the diagonal, for these rows.
    pub(crate) excess: &'a [T],
    /// Room for a row of `T Ax`.
    pub(crate) tall: &'a mut [T],
    /// Out, `left_stride` apart, at `place` in each row: `-excess T Ax`.
    pub(crate) left: &'a mut [T],
    pub(crate) left_stride: usize,
    pub(crate) place: std::ops::Range<usize>,
    /// Out: `T^T Ay`, M rows, `rows_stride` apart.
    pub(crate) gathered: &'a mut [T],
}

impl<T: Real> Kernel for Gather<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let (wide, narrow) = (self.rows_stride, self.columns_stride);
        self.gathered.fill(T::ZERO);
        let rows = self.block.rows().zip(self.control.chunks_exact(wide));
        let outs = self.left.chunks_exact_mut(self.left_stride).zip(self.excess);
        for ((range, control), (left, &excess)) in rows.zip(outs) {
            let tall = &mut self.tall[..narrow];
            tall.fill(T::ZERO);
            for (&t, &j) in self.plan[range.clone()].iter().zip(&self.block.columns[range]) {
                if t == T::ZERO {
                    continue;
                }
                let j = j as usize;
                let source = &self.source[j * narrow..][..narrow];
                tall.iter_mut().zip(source).for_each(|(s, &a)| *s = t.fma::<FMA>(a, *s));
                let gathered = &mut self.gathered[j * wide..][..wide];
                gathered.iter_mut().zip(control).for_each(|(s, &a)| *s = t.fma::<FMA>(a, *s));
            }
            left[self.place.clone()].iter_mut().zip(tall).for_each(|(left, s)| *left = -excess * *s);
        }
    }
}

/// `Dy T Dx` at the entries: `left_i . right_j + excess_i excess_j T_ij`.
pub(crate) struct EntryDots<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) plan: &'a [T],
    pub(crate) left: &'a [T],
    pub(crate) right: &'a [T],
    pub(crate) stride: usize,
    pub(crate) row_excess: &'a [T],
    pub(crate) column_excess: &'a [T],
    pub(crate) out: &'a mut [T],
}

impl<T: Real> Kernel for EntryDots<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let rows = self.block.rows().zip(self.left.chunks_exact(self.stride)).zip(self.row_excess);
        for ((range, left), &excess) in rows {
            let entries = self.plan[range.clone()].iter().zip(&self.block.columns[range.clone()]);
            for (out, (&t, &j)) in self.out[range].iter_mut().zip(entries) {
                let j = j as usize;
                let right = &self.right[j * self.stride..][..self.stride];
                *out = (excess * self.column_excess[j]).fma::<FMA>(t, dot::<T, FMA>(left, right));
            }
        }
    }
}

/// As [`Gibbs`](super::Gibbs), at the entries.
pub(crate) struct SparseGibbs<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) values: &'a mut [T],
    pub(crate) linear: &'a [T],
    pub(crate) column: &'a [T],
    pub(crate) scale: T,
    pub(crate) inverse_epsilon: T,
    pub(crate) p: T,
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for SparseGibbs<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.sums.fill(T::ZERO);
        for range in self.block.rows() {
            let columns = &self.block.columns[range.clone()];
            let values = &mut self.values[range.clone()];
            let mut least = T::HUGE;
            for ((x, &linear), &j) in values.iter_mut().zip(&self.linear[range]).zip(columns) {
                *x = self.scale.fma::<FMA>(*x, linear + self.column[j as usize]);
                least = least.lesser(*x);
            }
            let u = self.p / exp_row::<T, FMA>(values, least, self.inverse_epsilon);
            for (&k, &j) in values.iter().zip(columns) {
                let sum = &mut self.sums[j as usize];
                *sum = u.fma::<FMA>(k, *sum);
            }
        }
    }
}

/// As [`Sweep`](super::Sweep), at the entries.
pub(crate) struct SparseSweep<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) values: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) p: T,
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for SparseSweep<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.sums.fill(T::ZERO);
        for range in self.block.rows() {
            let (values, columns) = (&self.values[range.clone()], &self.block.columns[range]);
            let u = self.p / row_sum::<T, FMA>(values, columns, self.v);
            for (&k, &j) in values.iter().zip(columns) {
                let sum = &mut self.sums[j as usize];
                *sum = u.fma::<FMA>(k, *sum);
            }
        }
    }
}

/// As [`PlanRows`](super::PlanRows), at the entries. A row of one entry gets exactly `p`.
pub(crate) struct SparsePlanRows<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) values: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) p: T,
    pub(crate) plan: &'a mut [T],
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for SparsePlanRows<'_, T> {
    /// L1 distance to the plan before.
    type Output = f64;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        self.sums.fill(T::ZERO);
        let mut change = 0.0;
        for range in self.block.rows() {
            let (values, columns) = (&self.values[range.clone()], &self.block.columns[range.clone()]);
            let u = self.p / row_sum::<T, FMA>(values, columns, self.v);
            let plan = &mut self.plan[range];
            let (single, mut row) = (plan.len() == 1, T::ZERO);
            for ((t, &k), &j) in plan.iter_mut().zip(values).zip(columns) {
                let x = if single { self.p } else { u * k * self.v[j as usize] };
                let x = if x < T::FLUSH { T::ZERO } else { x };
                row += (x - *t).magnitude();
                *t = x;
                self.sums[j as usize] += x;
            }
            change += row.to_f64();
        }
        change
    }
}

/// `K v` of one row, in four chains.
#[inline(always)]
fn row_sum<T: Real, const FMA: bool>(values: &[T], columns: &[u32], v: &[T]) -> T {
    let mut sums = [T::ZERO; 4];
    let (quads, rest) = (values.chunks_exact(4), values.chunks_exact(4).remainder());
    let tail = &columns[values.len() - rest.len()..];
    for (k, j) in quads.zip(columns.chunks_exact(4)) {
        for l in 0..4 {
            sums[l] = k[l].fma::<FMA>(v[j[l] as usize], sums[l]);
        }
    }
    for (&k, &j) in rest.iter().zip(tail) {
        sums[0] = k.fma::<FMA>(v[j as usize], sums[0]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
