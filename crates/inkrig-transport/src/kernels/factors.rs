//! Passes that go with products by low-rank factors.

use super::Kernel;
use crate::Real;

/// `out -= diag(weights) x`, rows `stride` apart.
pub(crate) struct LessRows<'a, T> {
    pub(crate) out: &'a mut [T],
    pub(crate) x: &'a [T],
    pub(crate) weights: &'a [T],
    pub(crate) stride: usize,
}

impl<T: Real> Kernel for LessRows<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let rows = self.out.chunks_exact_mut(self.stride).zip(self.x.chunks_exact(self.stride));
        for ((out, x), &weight) in rows.zip(self.weights) {
            out.iter_mut().zip(x).for_each(|(out, &x)| *out = (-weight).fma::<FMA>(x, *out));
        }
    }
}

/// `out -= x diag(weights)`, rows `stride` apart.
pub(crate) struct LessColumns<'a, T> {
    pub(crate) out: &'a mut [T],
    pub(crate) x: &'a [T],
    pub(crate) weights: &'a [T],
    pub(crate) stride: usize,
}

impl<T: Real> Kernel for LessColumns<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let weights = &self.weights[..self.stride];
        for (out, x) in self.out.chunks_exact_mut(self.stride).zip(self.x.chunks_exact(self.stride)) {
            for ((out, &x), &weight) in out.iter_mut().zip(x).zip(weights) {
                *out = (-weight).fma::<FMA>(x, *out);
            }
        }
    }
}

/// `out_j += sum_k a_kj b_kj`, rows `stride` apart.
pub(crate) struct ColumnDots<'a, T> {
    pub(crate) a: &'a [T],
    pub(crate) b: &'a [T],
    pub(crate) stride: usize,
    pub(crate) out: &'a mut [T],
}

impl<T: Real> Kernel for ColumnDots<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (a, b) in self.a.chunks_exact(self.stride).zip(self.b.chunks_exact(self.stride)) {
            for ((out, &a), &b) in self.out.iter_mut().zip(a).zip(b) {
                *out = a.fma::<FMA>(b, *out);
            }
        }
    }
}
