//! Principal subspace of a clip's frames: fewer numbers a frame with (almost) the same distances.
//!
//! Every aligned motion is a mean of source frames and so lies in their affine span; distances there need no more
//! than the directions in which the clip varies.

use inkrig_transport::{Mat, MatRef, TransportError, matmul_transposed};

/// Share of the variance of frame features that matching has to see.
pub const FEATURE_ENERGY: f64 = 0.995;

/// Frames in the coordinates of their principal subspace.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// frames x rank, centred.
    pub frames: Mat<f32>,
    /// Share of the variance that was kept, 0..=1.
    pub energy: f64,
    /// What brings other frames of the same features beside them.
    pub subspace: Subspace,
}

/// The mean that was taken off and the directions that were kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Subspace {
    mean: Vec<f64>,
    /// rank x d, orthonormal rows; `None`: all directions were kept as they are.
    basis: Option<Mat<f32>>,
}

impl Subspace {
    /// Coordinates of other rows (n x d) as n x rank, and the distance of each row to the subspace.
    ///
    /// # Errors
    /// When the rows have another width.
    pub fn project(
        &self,
        table: MatRef<'_, f32>,
        threads: usize,
    ) -> Result<(Mat<f32>, Vec<f32>), TransportError> {
        let centred = off_mean(table, &self.mean);
        let Some(basis) = &self.basis else {
            let off = vec![0.0; centred.rows()];
            return Ok((centred, off));
        };
        let mut coordinates = Mat::zeros(0, 0);
        matmul_transposed(centred.view(), basis.view(), &mut coordinates, threads)?;
        let square = |row: &[f32]| row.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>();
        let off = (0..centred.rows())
            .map(|row| (square(centred.row(row)) - square(coordinates.row(row))).max(0.0).sqrt() as f32);
        let off = off.collect();
        Ok((coordinates, off))
    }
}

/// Projects the rows of a table (n x d) to the smallest of the tried subspaces that keeps `energy` of their
/// variance. Subspace iteration from evenly spread frames: deterministic, a few products of n x d with d x rank.
///
/// # Errors
/// When the table is empty.
pub fn reduce(table: MatRef<'_, f32>, energy: f64, threads: usize) -> Result<Reduced, TransportError> {
    /// Clips of people need 64 to 90 directions for 99.6 to 99.95 % of the variance.
    const RANKS: [usize; 3] = [64, 96, 160];
    let mean = mean(table);
    let centred = off_mean(table, &mean);
    let total: f64 = centred.as_slice().iter().map(|&value| f64::from(value) * f64::from(value)).sum();
    for rank in RANKS {
        if rank >= centred.cols().min(centred.rows()) {
            break;
        }
        let (frames, basis) = project(&centred, rank, threads)?;
        let kept: f64 = frames.as_slice().iter().map(|&value| f64::from(value) * f64::from(value)).sum();
        if kept >= energy * total {
            let subspace = Subspace { mean, basis: Some(basis) };
            return Ok(Reduced { frames, energy: kept / total, subspace });
        }
    }
    Ok(Reduced { frames: centred, energy: 1.0, subspace: Subspace { mean, basis: None } })
}

fn mean(table: MatRef<'_, f32>) -> Vec<f64> {
    let mut means = vec![0.0_f64; table.cols()];
    for row in 0..table.rows() {
        for (mean, &value) in means.iter_mut().zip(table.row(row)) {
            *mean += f64::from(value);
        }
    }
    let count = table.rows().max(1) as f64;
    means.iter().map(|sum| sum / count).collect()
}

fn off_mean(table: MatRef<'_, f32>, mean: &[f64]) -> Mat<f32> {
    Mat::from_fn(table.rows(), table.cols(), |row, column| {
        (f64::from(table.row(row)[column]) - mean[column]) as f32
    })
}

/// Coordinates of the rows of `table` in a subspace of `rank` directions, and those directions.
fn project(table: &Mat<f32>, rank: usize, threads: usize) -> Result<(Mat<f32>, Mat<f32>), TransportError> {
    const ROUNDS: usize = 3;
    let transposed = transpose(table);
    let mut basis = Mat::from_fn(rank, table.cols(), |direction, column| {
        table.row(direction * (table.rows() - 1) / (rank - 1).max(1))[column]
    });
    let mut coordinates = Mat::zeros(0, 0);
    for _ in 0..ROUNDS {
        orthonormalise(&mut basis);
        matmul_transposed(basis.view(), table.view(), &mut coordinates, threads)?;
        matmul_transposed(coordinates.view(), transposed.view(), &mut basis, threads)?;
    }
    orthonormalise(&mut basis);
    matmul_transposed(table.view(), basis.view(), &mut coordinates, threads)?;
    Ok((coordinates, basis))
}

fn transpose(table: &Mat<f32>) -> Mat<f32> {
    Mat::from_fn(table.cols(), table.rows(), |row, column| table.row(column)[row])
}

/// Gram-Schmidt on the rows, twice for f32. A row that depends on those before it becomes zero: it adds nothing.
fn orthonormalise(basis: &mut Mat<f32>) {
    let width = basis.cols();
    for index in 0..basis.rows() {
        let (before, rest) = basis.as_mut_slice().split_at_mut(index * width);
        let row = &mut rest[..width];
        let length_before = norm(row);
        for _ in 0..2 {
            for other in before.chunks_exact(width) {
                let along = dot(row, other);
                row.iter_mut().zip(other).for_each(|(value, &direction)| *value -= along * direction);
            }
        }
        let length = norm(row);
        let scale = if length > 1e-5 * length_before { 1.0 / length } else { 0.0 };
        row.iter_mut().for_each(|value| *value *= scale);
    }
}

fn norm(row: &[f32]) -> f32 {
    dot(row, row).sqrt()
}

/// In eight sums, which the compiler can keep in one vector.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0; 8];
    let (whole_a, whole_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = whole_a.remainder().iter().zip(whole_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in whole_a.zip(whole_b) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
    }
    sums.iter().sum::<f32>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 frames of 120 numbers that vary in 12 directions, and a little noise.
    fn table(noise: f64) -> Mat<f32> {
        Mat::from_fn(200, 120, |row, column| {
            let (t, c) = (row as f64 * 0.07, column as f64);
            let smooth: f64 = (1..7).map(|k| (t * k as f64 + c).sin() * (c * 0.3 * k as f64).cos()).sum();
            (smooth + noise * (t * 91.7 * (c + 1.3)).sin()) as f32
        })
    }

    #[test]
    fn distances_are_kept() {
        let table = table(0.01);
        let reduced = reduce(table.view(), 0.999, 1).unwrap();
        assert_eq!(reduced.frames.cols(), 64);
        assert!(reduced.energy > 0.999 && reduced.energy <= 1.0 + 1e-6);
        let distance = |mat: &Mat<f32>, a: usize, b: usize| {
            mat.row(a).iter().zip(mat.row(b)).map(|(x, y)| (x - y) * (x - y)).sum::<f32>().sqrt()
        };
        for (a, b) in [(0, 199), (3, 77), (50, 52)] {
            let (full, less) = (distance(&table, a, b), distance(&reduced.frames, a, b));
            assert!((full - less).abs() < 2e-2 * full, "{full} became {less}");
        }
    }

    #[test]
    fn other_rows_are_brought_beside_with_what_is_left_out() {
        let (other, table) = (table(0.5), table(0.01));
        let reduced = reduce(table.view(), 0.999, 1).unwrap();
        let (same, off) = reduced.subspace.project(table.view(), 1).unwrap();
        let close = same.as_slice().iter().zip(reduced.frames.as_slice());
        assert!(close.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) < 1e-4);
        assert!(off.iter().all(|&off| off < 0.1));
        // Frame 3 to a frame that lies off the subspace: both parts of the distance together.
        let (coordinates, off) = reduced.subspace.project(other.view(), 1).unwrap();
        let distance = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f32>();
        let whole = distance(table.row(3), other.row(80)).sqrt();
        let parts = (distance(reduced.frames.row(3), coordinates.row(80)) + off[80].powi(2)).sqrt();
        assert!(off[80] > 1.0 && (whole - parts).abs() < 0.02 * whole, "{whole} became {parts}");
    }

    #[test]
    fn small_tables_stay_whole() {
        let table = Mat::from_fn(5, 3, |row, column| (row * column) as f32);
        let reduced = reduce(table.view(), 0.999, 1).unwrap();
        assert_eq!((reduced.frames.rows(), reduced.frames.cols(), reduced.energy), (5, 3, 1.0));
    }
}
