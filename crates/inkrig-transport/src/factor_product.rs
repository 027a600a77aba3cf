//! Products with low-rank distances, `D = A B^T - diag(excess)`: each is a product with thin matrices and one pass for the
//! diagonal.

use crate::kernels::{ColumnDots, LessColumns, LessRows, Product, dispatch};
use crate::padded::Padded;
use crate::parallel::{Chunk, for_blocks};
use crate::product::{Strided, product};
use crate::{Isa, LowRank, Real};

/// Buffers of the products; empty as long as distances are dense.
#[derive(Debug, Default)]
pub(crate) struct FactorBuffers<T> {
    /// By^T T, k x M.
    pub(crate) gathered: Padded<T>,
    /// Dy T Ax, N x k.
    pub(crate) tall: Padded<T>,
    /// For Dx^2 c: k x M, k x k, k x M.
    pub(crate) weighted: Padded<T>,
    pub(crate) moments: Padded<T>,
    pub(crate) applied: Padded<T>,
}

/// Rows of `B^T` for one thread: few, as there are not many.
pub(crate) const GATHER_ROWS: usize = 24;

impl<T: Real> LowRank<T> {
    /// `gathered = B^T T` for a padded plan T of n rows.
    pub(crate) fn gather(&self, isa: Isa, threads: usize, plan: &Padded<T>, gathered: &mut Padded<T>) {
        let (k, n) = (self.right.rows(), self.len());
        gathered.shape(k, plan.cols());
        let (stride, a_stride) = (gathered.stride(), self.right.stride());
        let out = Chunk::new(gathered.all_mut(), stride);
        for_blocks(threads, k, GATHER_ROWS, out, &|first, _, out: Chunk<'_, T>| {
            let a = &self.right.all()[first * a_stride..];
            Product { a, a_stride, b: plan.all(), k: n, out: out.data, stride }.multiply(isa);
        });
    }

    /// `out = D T` for the rows from `first` on; `plan` are these rows of T.
    pub(crate) fn rows_of_product(
        &self,
        isa: Isa,
        first: usize,
        gathered: &[T],
        plan: &[T],
        out: &mut [T],
        stride: usize,
    ) {
        let (k, a_stride) = (self.left.cols(), self.left.stride());
        let a = &self.left.all()[first * a_stride..];
        Product { a, a_stride, b: gathered, k, out: &mut *out, stride }.multiply(isa);
        dispatch(isa, LessRows { out, x: plan, weights: &self.excess.row(0)[first..], stride });
    }

    /// `out = x D` for some rows x; `tall` takes as many rows of k.
    pub(crate) fn product_of_rows(&self, isa: Isa, x: &[T], tall: &mut [T], out: &mut [T], stride: usize) {
        let (k, narrow) = (self.left.cols(), self.left.stride());
        let left = self.left.all();
        Product { a: x, a_stride: stride, b: left, k: self.len(), out: &mut *tall, stride: narrow }
            .multiply(isa);
        let right = self.right.all();
        Product { a: tall, a_stride: narrow, b: right, k, out: &mut *out, stride }.multiply(isa);
        dispatch(isa, LessColumns { out, x, weights: self.excess.all(), stride });
    }

    /// `out = D^2 c`, squares elementwise: `D_ij^2 = B_i^T (A_j A_j^T) B_i`.
    pub(crate) fn square_product(&self, isa: Isa, mass: &[T], buffers: &mut FactorBuffers<T>, out: &mut [T]) {
        let (k, n) = (self.left.cols(), self.len());
        let FactorBuffers { weighted, moments, applied, .. } = buffers;
        weighted.shape(k, n);
        moments.shape(k, k);
        applied.shape(k, n);
        let minus_two = T::from_f64(-2.0);
        for t in 0..k {
            // A = [g, 1, -2 Phi] read from B^T = [1, g, Phi]^T.
            let (from, scale) = match t {
                0 => (1, T::ONE),
                1 => (0, T::ONE),
                _ => (t, minus_two),
            };
            let row = weighted.row_mut(t).iter_mut().zip(self.right.row(from).iter().zip(mass));
            row.for_each(|(w, (&b, &c))| *w = scale * b * c);
        }
        let (narrow, wide) = (moments.stride(), self.right.stride());
        let a = weighted.all();
        Product { a, a_stride: wide, b: self.left.all(), k: n, out: moments.all_mut(), stride: narrow }
            .multiply(isa);
        let a = moments.all();
        Product { a, a_stride: narrow, b: self.right.all(), k, out: applied.all_mut(), stride: wide }
            .multiply(isa);
        out.fill(T::ZERO);
        dispatch(isa, ColumnDots { a: applied.all(), b: self.right.all(), stride: wide, out: &mut *out });
        for ((out, &excess), &c) in out.iter_mut().zip(self.excess.row(0)).zip(mass) {
            *out = (*out - excess * excess * c).greater(T::ZERO);
        }
    }

    /// `out = D x` for a plain n x m matrix, without a workspace.
    pub(crate) fn times(&self, x: &[T], m: usize, out: &mut [T]) {
        let (n, k) = (self.len(), self.left.cols());
        let mut gathered = vec![T::ZERO; k * m];
        let (left, right) = self.strided();
        product(k, m, n, right, Strided::rows(x, m), &mut gathered, m);
        product(n, m, k, left, Strided::rows(&gathered, m), out, m);
        for ((out, x), &excess) in out.chunks_exact_mut(m).zip(x.chunks_exact(m)).zip(self.excess.row(0)) {
            out.iter_mut().zip(x).for_each(|(out, &x)| *out -= excess * x);
        }
    }

    /// `out = x D` for a plain matrix of n columns, without a workspace.
    pub(crate) fn times_from_right(&self, x: &[T], out: &mut [T]) {
        let (n, k) = (self.len(), self.left.cols());
        let rows = x.len() / n;
        let mut tall = vec![T::ZERO; rows * k];
        let (left, right) = self.strided();
        product(rows, k, n, Strided::rows(x, n), left, &mut tall, k);
        product(rows, n, k, Strided::rows(&tall, k), right, out, n);
        for (out, x) in out.chunks_exact_mut(n).zip(x.chunks_exact(n)) {
            let terms = x.iter().zip(self.excess.row(0));
            out.iter_mut().zip(terms).for_each(|(out, (&x, &excess))| *out -= excess * x);
        }
    }

    fn strided(&self) -> (Strided<'_, T>, Strided<'_, T>) {
        let (left, right) = (self.left.stride(), self.right.stride());
        (Strided::rows(self.left.all(), left), Strided::rows(self.right.all(), right))
    }
}
