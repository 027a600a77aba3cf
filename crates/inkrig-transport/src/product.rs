// The `gemm` crate takes raw pointers; `product` below is the one place that calls it.
#![allow(unsafe_code)]

use crate::parallel::{self, Chunk, for_blocks};
use crate::{Mat, MatRef, Real, TransportError};

/// A matrix as the `gemm` crate sees it: a slice, and how far apart its rows and columns are.
#[derive(Clone, Copy)]
pub(crate) struct Strided<'a, T> {
    pub(crate) data: &'a [T],
    pub(crate) row: usize,
    pub(crate) col: usize,
}

impl<'a, T> Strided<'a, T> {
    pub(crate) fn rows(data: &'a [T], stride: usize) -> Self {
        Self { data, row: stride, col: 1 }
    }

    fn transposed(self) -> Self {
        Self { data: self.data, row: self.col, col: self.row }
    }

    fn fits(&self, rows: usize, cols: usize) -> bool {
        rows == 0 || cols == 0 || (rows - 1) * self.row + (cols - 1) * self.col < self.data.len()
    }
}

/// `out = a b`. `a` is m x k, `b` is k x n; rows of `out` are `stride` apart.
/// Single-threaded; sizes that do not fit the slices leave `out` as it is.
#[allow(clippy::too_many_arguments)]
pub(crate) fn product<T: Real>(
    m: usize,
    n: usize,
    k: usize,
    a: Strided<'_, T>,
    b: Strided<'_, T>,
    out: &mut [T],
    stride: usize,
) {
    let fits = a.fits(m, k) && b.fits(k, n) && Strided::rows(out, stride).fits(m, n) && n <= stride;
    debug_assert!(fits);
    if !fits || m == 0 || n == 0 {
        return;
    }
    // SAFETY: `fits` bounds every element that the sizes and strides reach by the slices' lengths, rows of `out` do not
    // overlap as n <= stride, and `out` is borrowed mutably so that it shares no element with `a` or `b`.
    unsafe {
        gemm::gemm(
            m,
            n,
            k,
            out.as_mut_ptr(),
            1,
            stride as isize,
            false,
            a.data.as_ptr(),
            a.col as isize,
            a.row as isize,
            b.data.as_ptr(),
            b.col as isize,
            b.row as isize,
            T::ONE,
            T::ONE,
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

/// `out = a b`; `out` takes the shape it needs. Rows are cut into blocks that do not depend on `threads`, so neither does
/// the result.
///
/// # Errors
/// [`TransportError::Shape`] when `b` has not as many rows as `a` has columns.
///
/// ```
/// use inkrig_transport::{Mat, matmul};
/// let a = Mat::from_vec(1, 2, vec![1.0f32, 2.0])?;
/// let b = Mat::from_vec(2, 2, vec![1.0f32, 0.0, 3.0, 4.0])?;
/// let mut out = Mat::zeros(0, 0);
/// matmul(a.view(), b.view(), &mut out, 1)?;
/// assert_eq!(out.as_slice(), [7.0, 8.0]);
/// # Ok::<(), inkrig_transport::TransportError>(())
/// ```
pub fn matmul<T: Real>(
    a: MatRef<'_, T>,
    b: MatRef<'_, T>,
    out: &mut Mat<T>,
    threads: usize,
) -> Result<(), TransportError> {
    check("b", b, a.cols(), b.cols())?;
    out.reshape(a.rows(), b.cols());
    blocked(a, Strided::rows(b.as_slice(), b.cols()), out, threads);
    Ok(())
}

/// `out = a b^T`: inner products of the rows of `a` with the rows of `b`, as pairwise squared distances need them.
///
/// # Errors
/// [`TransportError::Shape`] when `a` and `b` differ in their columns.
pub fn matmul_transposed<T: Real>(
    a: MatRef<'_, T>,
    b: MatRef<'_, T>,
    out: &mut Mat<T>,
    threads: usize,
) -> Result<(), TransportError> {
    check("b", b, b.rows(), a.cols())?;
    out.reshape(a.rows(), b.rows());
    blocked(a, Strided::rows(b.as_slice(), b.cols()).transposed(), out, threads);
    Ok(())
}

fn check<T: Real>(
    name: &'static str,
    mat: MatRef<'_, T>,
    expected_rows: usize,
    expected_cols: usize,
) -> Result<(), TransportError> {
    let (rows, cols) = (mat.rows(), mat.cols());
    if (rows, cols) == (expected_rows, expected_cols) {
        return Ok(());
    }
    let hint = "the inner sizes of a product must agree";
    Err(TransportError::Shape { name, rows, cols, expected_rows, expected_cols, hint })
}

fn blocked<T: Real>(a: MatRef<'_, T>, b: Strided<'_, T>, out: &mut Mat<T>, threads: usize) {
    let (m, n, k) = (out.rows(), out.cols(), a.cols());
    if m == 0 || n == 0 {
        return;
    }
    let work = Chunk::new(out.as_mut_slice(), n);
    parallel::with_threads(threads, || {
        // Each call packs its right side anew: few blocks.
        let block = m.div_ceil(4).next_multiple_of(4).clamp(32, 192);
        for_blocks(threads, m, block, work, &|first, rows, out: Chunk<'_, T>| {
            let a = Strided::rows(&a.as_slice()[first * k..(first + rows) * k], k);
            product(rows, n, k, a, b, out.data, n);
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plain(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(a.rows(), b.cols(), |i, j| (0..a.cols()).map(|k| a.row(i)[k] * b.row(k)[j]).sum())
    }

    fn close(a: &Mat<f64>, b: &Mat<f64>) -> bool {
        a.rows() == b.rows()
            && a.cols() == b.cols()
            && a.as_slice().iter().zip(b.as_slice()).all(|(x, y)| (x - y).abs() < 1e-11)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn agrees_with_the_definition(m in 1usize..140, n in 1usize..70, k in 1usize..70, threads in 1usize..4) {
            let a = Mat::from_fn(m, k, |i, j| ((i * 7 + j * 3) % 11) as f64 - 5.0);
            let b = Mat::from_fn(k, n, |i, j| ((i * 5 + j * 13) % 17) as f64 * 0.25);
            let b_transposed = Mat::from_fn(n, k, |i, j| b.row(j)[i]);
            let want = plain(&a, &b);
            let mut out = Mat::zeros(0, 0);
            matmul(a.view(), b.view(), &mut out, threads).unwrap();
            prop_assert!(close(&out, &want));
            matmul_transposed(a.view(), b_transposed.view(), &mut out, threads).unwrap();
            prop_assert!(close(&out, &want));
        }
    }

    #[test]
    fn shapes_that_disagree_are_refused() {
        let (a, b) = (Mat::<f32>::zeros(2, 3), Mat::<f32>::zeros(2, 3));
        let mut out = Mat::zeros(2, 2);
        assert!(
            matmul(a.view(), b.view(), &mut out, 1)
                .unwrap_err()
                .to_string()
                .contains("`b` is 2 x 3, expected 3 x 3")
        );
        assert!(matmul_transposed(a.view(), Mat::zeros(2, 4).view(), &mut out, 1).is_err());
    }
}
