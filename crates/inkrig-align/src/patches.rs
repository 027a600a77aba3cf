//! Distances between patches: overlapping windows of frames (MAMM Sec. 3.2.1, 3.2.2).

use crate::{Layout, Norm};
use inkrig_transport::{Mat, MatRef, Real, TransportError, for_rows, matmul_transposed};

/// Buffers that are kept between calls.
#[derive(Debug, Clone)]
pub struct PatchScratch<T> {
    frames: Mat<T>,
    norms: Vec<T>,
}

impl<T: Real> PatchScratch<T> {
    /// Empty buffers; they grow as needed.
    pub fn new() -> Self {
        Self { frames: Mat::zeros(0, 0), norms: Vec::new() }
    }
}

impl<T: Real> Default for PatchScratch<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// L2 distances between the patches of two frame tables of equal width, times `scale`.
///
/// `a` has the rows of its layout and r columns, `b` likewise; `out` becomes patches of `a` x patches of `b`. A patch
/// distance is a sum of squared frame distances along a diagonal, so one matrix product of frames and `patch`
/// additions an entry do for what would otherwise be products of patches.
///
/// # Errors
/// When the tables differ in width.
pub fn patch_distances<T: Real>(
    (a, rows): (MatRef<'_, T>, &Layout),
    (b, columns): (MatRef<'_, T>, &Layout),
    scale: T,
    scratch: &mut PatchScratch<T>,
    out: &mut Mat<T>,
    threads: usize,
) -> Result<(), TransportError> {
    squared_frame_distances(a, b, scratch, threads)?;
    out.resize(rows.patches(), columns.patches());
    let (frames, scale_squared, width) = (&scratch.frames, scale * scale, out.cols());
    let firsts: Vec<usize> = rows.runs().flat_map(|run| run.frame..run.frame + run.count).collect();
    for_rows(threads, out.as_mut_slice(), width, &|first, block| {
        for (sums, &top) in block.chunks_exact_mut(width).zip(&firsts[first..]) {
            for across in columns.runs() {
                let sums = &mut sums[across.patch..across.patch + across.count];
                for offset in 0..rows.patch() {
                    let from = across.frame + offset;
                    let squares = &frames.row(top + offset)[from..from + across.count];
                    sums.iter_mut().zip(squares).for_each(|(sum, &square)| *sum += square);
                }
            }
            sums.iter_mut().for_each(|sum| *sum = (*sum * scale_squared).sqrt());
        }
    });
    Ok(())
}

/// The same between the patches of one table, with an exact zero diagonal and divided by their [`Norm`]. Returns the
/// factor that was applied, or `None` when all patches are alike.
///
/// # Errors
/// As for [`patch_distances`].
pub fn normalised_self_distances<T: Real>(
    frames: MatRef<'_, T>,
    layout: &Layout,
    norm: Norm,
    scratch: &mut PatchScratch<T>,
    out: &mut Mat<T>,
    threads: usize,
) -> Result<Option<T>, TransportError> {
    patch_distances((frames, layout), (frames, layout), T::ONE, scratch, out, threads)?;
    (0..out.rows()).for_each(|i| out.row_mut(i)[i] = T::ZERO);
    Ok(normalise(out, norm, scratch.norms.iter().copied()))
}

/// Divides distances between the patches of one table by their [`Norm`], and makes them symmetric; `squares` are the
/// squared lengths of its frames. Returns the factor, or `None`, when all patches are alike.
pub(crate) fn normalise<T: Real>(
    distances: &mut Mat<T>,
    norm: Norm,
    squares: impl Iterator<Item = T>,
) -> Option<T> {
    let count = distances.rows();
    let total: f64 =
        (0..count).map(|i| distances.row(i).iter().map(|value| value.to_f64()).sum::<f64>()).sum();
    let mean = total / (count * count) as f64;
    // Rounding leaves distances of this size between equal patches.
    let noise = 1e-6 * (1.0 + squares.map(Real::to_f64).fold(0.0, f64::max).sqrt());
    if !(mean.is_finite() && mean > noise) {
        return None;
    }
    let size = match norm {
        Norm::Mean | Norm::Learned => mean,
        Norm::Max => quantile(distances, 1.0),
        Norm::Quantile => quantile(distances, 0.9).max(mean),
    };
    // A float product is symmetric only up to rounding; the solver's gradient takes symmetry as given.
    let scale = T::from_f64(1.0 / size);
    for i in 0..count {
        for j in 0..i {
            let value = distances.row(j)[i] * scale;
            distances.row_mut(j)[i] = value;
            distances.row_mut(i)[j] = value;
        }
    }
    Some(scale)
}

/// The distance below which a share of all distances lies.
fn quantile<T: Real>(distances: &Mat<T>, share: f64) -> f64 {
    let mut values: Vec<f64> = distances.as_slice().iter().map(|value| value.to_f64()).collect();
    let rank = ((values.len() - 1) as f64 * share) as usize;
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// |a_i - b_j|^2 by the expansion |a|^2 + |b|^2 - 2 a.b, never below 0.
fn squared_frame_distances<T: Real>(
    a: MatRef<'_, T>,
    b: MatRef<'_, T>,
    scratch: &mut PatchScratch<T>,
    threads: usize,
) -> Result<(), TransportError> {
    let square = |row: &[T]| row.iter().fold(T::ZERO, |sum, &value| sum + value * value);
    scratch.norms.clear();
    scratch.norms.extend((0..b.rows()).map(|j| square(b.row(j))));
    matmul_transposed(a, b, &mut scratch.frames, threads)?;
    let two = T::from_f64(2.0);
    let PatchScratch { frames, norms } = scratch;
    let width = frames.cols();
    for_rows(threads, frames.as_mut_slice(), width, &|first, block| {
        for (i, row) in block.chunks_exact_mut(width).enumerate() {
            let own = square(a.row(first + i));
            for (value, &norm) in row.iter_mut().zip(norms.iter()) {
                let distance = own + norm - two * *value;
                *value = if distance > T::ZERO { distance } else { T::ZERO };
            }
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blend::{Window, frame_weights};

    fn table(rows: usize, seed: f64) -> Mat<f64> {
        Mat::from_fn(rows, 5, |row, column| (seed + row as f64 * 0.37 + column as f64 * 1.9).sin() * 3.0)
    }

    #[test]
    fn running_sums_equal_whole_patches() {
        let (a, b) = (table(30, 0.1), table(41, 2.0));
        let mut out = Mat::zeros(0, 0);
        let (rows, columns) = (Layout::open(30, 11), Layout::open(41, 11));
        let (a_table, b_table) = ((a.view(), &rows), (b.view(), &columns));
        patch_distances(a_table, b_table, 0.5, &mut PatchScratch::new(), &mut out, 1).unwrap();
        assert_eq!((out.rows(), out.cols()), (20, 31));
        for i in 0..20 {
            for j in 0..31 {
                let patches = (0..11).flat_map(|t| a.row(i + t).iter().zip(b.row(j + t)));
                let naive = patches.map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt() * 0.5;
                assert!((naive - out.row(i)[j]).abs() < 1e-10 * (1.0 + naive), "{naive} {}", out.row(i)[j]);
            }
        }
    }

    #[test]
    fn blending_by_weights_equals_averaging_patches() {
        let source = table(25, 0.4);
        let (patch, rows) = (7, 13);
        let columns = source.rows() + 1 - patch;
        let plan = Mat::from_fn(rows, columns, |i, j| {
            let weight = |j: usize| 1.0 + (i as f64 * 0.7 + j as f64 * 1.3).sin();
            weight(j) / (0..columns).map(weight).sum::<f64>() / rows as f64
        });
        let mut weights = Mat::zeros(0, 0);
        let layouts = (&Layout::open(rows + patch - 1, patch), &Layout::open(source.rows(), patch));
        frame_weights(plan.view(), layouts, Window::Box, &mut weights, 2);
        for t in 0..rows + patch - 1 {
            let (mut sum, mut count) = ([0.0; 5], 0.0);
            for i in (0..rows).filter(|&i| i <= t && t < i + patch) {
                count += 1.0;
                for j in 0..columns {
                    for (total, value) in sum.iter_mut().zip(source.row(j + t - i)) {
                        *total += rows as f64 * plan.row(i)[j] * value;
                    }
                }
            }
            for (column, total) in sum.iter().enumerate() {
                let got: f64 =
                    weights.row(t).iter().enumerate().map(|(s, w)| w * source.row(s)[column]).sum();
                assert!((got - total / count).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn self_distances_are_symmetric_with_mean_one_and_still_tables_have_none() {
        let mut out = Mat::zeros(0, 0);
        let frames = Mat::from_fn(60, 3, |row, column| ((row * row) as f32 * 0.01 + column as f32).sin());
        let scale = normalised_self_distances(
            frames.view(),
            &Layout::open(60, 11),
            Norm::Mean,
            &mut PatchScratch::new(),
            &mut out,
            1,
        )
        .unwrap();
        assert!(scale.is_some_and(|scale| scale > 0.0));
        let mean = out.as_slice().iter().map(|&v| f64::from(v)).sum::<f64>() / 2500.0;
        assert!((mean - 1.0).abs() < 1e-5);
        assert!((0..50).all(|i| out.row(i)[i] == 0.0 && (0..50).all(|j| out.row(i)[j] == out.row(j)[i])));
        let still = Mat::from_fn(60, 3, |_, column| 1000.0 + column as f32);
        let none = normalised_self_distances(
            still.view(),
            &Layout::open(60, 11),
            Norm::Mean,
            &mut PatchScratch::new(),
            &mut out,
            1,
        )
        .unwrap();
        assert_eq!(none, None);
    }
}
