//! Distances between rows of any length, and sums of such rows.

use super::Kernel;
use super::rows::lanes_sum;
use super::sparse::Block;
use crate::Real;
use crate::padded::LANES;

/// `out = scale |a - b|` for each pair of rows.
pub(crate) struct PairDistances<'a, I, T> {
    pub(crate) pairs: I,
    pub(crate) scale: T,
    pub(crate) out: &'a mut [T],
}

impl<'b, I: Iterator<Item = (&'b [T], &'b [T])>, T: Real> Kernel for PairDistances<'_, I, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, (a, b)) in self.out.iter_mut().zip(self.pairs) {
            let whole = a.len() / LANES * LANES;
            let mut sum = lanes_sum::<T>(
                &a[..whole],
                &b[..whole],
                #[inline(always)]
                |sum, a, b| (a - b).fma::<FMA>(a - b, sum),
            );
            for (&a, &b) in a[whole..].iter().zip(&b[whole..]) {
                sum = (a - b).fma::<FMA>(a - b, sum);
            }
            *out = self.scale * sum.sqrt();
        }
    }
}

/// Each row of `out` is the sum of a table's rows, `width` long, by the weights of a sparse row.
pub(crate) struct WeightedRows<'a, T> {
    pub(crate) block: Block<'a>,
    pub(crate) weights: &'a [T],
    pub(crate) table: &'a [T],
    pub(crate) width: usize,
    pub(crate) out: &'a mut [T],
}

impl<T: Real> Kernel for WeightedRows<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let width = self.width;
        for (range, out) in self.block.rows().zip(self.out.chunks_exact_mut(width)) {
            out.fill(T::ZERO);
            for (&weight, &j) in self.weights[range.clone()].iter().zip(&self.block.columns[range]) {
                let row = &self.table[j as usize * width..][..width];
                out.iter_mut().zip(row).for_each(|(s, &x)| *s = weight.fma::<FMA>(x, *s));
            }
        }
    }
}
