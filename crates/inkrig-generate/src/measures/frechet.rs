//! FID: how far two sets of embeddings are from each other as normal distributions.

use super::eigenvalues::eigenvalues;
use crate::GenerateError;

/// The Frechet distance of two tables with rows of `width` numbers: `|m1 - m2|^2 + tr C1 + tr C2 - 2 tr sqrt(C1 C2)`, with covariances
/// divided by the number of rows less one.
///
/// # Errors
/// [`GenerateError::Length`] when a table has fewer than two rows, or rows that are not whole.
pub fn frechet_distance(real: &[f32], made: &[f32], width: usize) -> Result<f64, GenerateError> {
    let (real, made) = (Normal::of(real, width)?, Normal::of(made, width)?);
    let means: f64 = real.mean.iter().zip(&made.mean).map(|(a, b)| (a - b) * (a - b)).sum();
    let trace = |covariance: &[f64]| (0..width).map(|at| covariance[at * width + at]).sum::<f64>();
    // C1 = L L^T, and L^T C2 L has the eigenvalues of C1 C2, but is symmetric.
    let root = cholesky(&real.covariance, width);
    let product = transposed_times(&root, &times(&made.covariance, &root, width), width);
    let common: f64 = eigenvalues(product, width).into_iter().map(|value| value.max(0.0).sqrt()).sum();
    Ok((means + trace(&real.covariance) + trace(&made.covariance) - 2.0 * common).max(0.0))
}

struct Normal {
    mean: Vec<f64>,
    covariance: Vec<f64>,
}

impl Normal {
    fn of(table: &[f32], width: usize) -> Result<Self, GenerateError> {
        let count = table.len() / width.max(1);
        if count < 2 || count * width != table.len() {
            return Err(GenerateError::Length {
                what: "table of embeddings",
                expected: 2 * width,
                got: table.len(),
            });
        }
        let mut mean = vec![0.0; width];
        for row in table.chunks_exact(width) {
            for (mean, value) in mean.iter_mut().zip(row) {
                *mean += f64::from(*value) / count as f64;
            }
        }
        let mut covariance = vec![0.0; width * width];
        let mut off = vec![0.0; width];
        for row in table.chunks_exact(width) {
            for ((off, value), mean) in off.iter_mut().zip(row).zip(&mean) {
                *off = f64::from(*value) - mean;
            }
            for (line, own) in covariance.chunks_exact_mut(width).zip(&off) {
                for (entry, other) in line.iter_mut().zip(&off) {
                    *entry += own * other / (count - 1) as f64;
                }
            }
        }
        Ok(Self { mean, covariance })
    }
}

/// A lower triangular root. With fewer rows than columns covariances are singular: a column without anything left is zero.
fn cholesky(matrix: &[f64], size: usize) -> Vec<f64> {
    let mut root = vec![0.0; size * size];
    let largest = (0..size).map(|at| matrix[at * size + at]).fold(0.0, f64::max);
    for column in 0..size {
        let own: Vec<f64> = root[column * size..][..column].to_vec();
        let left = matrix[column * size + column] - own.iter().map(|x| x * x).sum::<f64>();
        if left <= 1e-13 * largest {
            continue;
        }
        let pivot = left.sqrt();
        root[column * size + column] = pivot;
        for row in column + 1..size {
            let line = &mut root[row * size..(row + 1) * size];
            let done: f64 = line[..column].iter().zip(&own).map(|(a, b)| a * b).sum();
            line[column] = (matrix[row * size + column] - done) / pivot;
        }
    }
    root
}

fn times(a: &[f64], b: &[f64], size: usize) -> Vec<f64> {
    let mut out = vec![0.0; size * size];
    for (out, a) in out.chunks_exact_mut(size).zip(a.chunks_exact(size)) {
        for (a, b) in a.iter().zip(b.chunks_exact(size)) {
            for (out, b) in out.iter_mut().zip(b) {
                *out += a * b;
            }
        }
    }
    out
}

fn transposed_times(a: &[f64], b: &[f64], size: usize) -> Vec<f64> {
    let mut out = vec![0.0; size * size];
    for (a, b) in a.chunks_exact(size).zip(b.chunks_exact(size)) {
        for (out, a) in out.chunks_exact_mut(size).zip(a) {
            for (out, b) in out.iter_mut().zip(b) {
                *out += a * b;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::Noise;

    #[test]
    fn a_set_is_no_distance_from_itself_and_as_far_as_it_is_moved() {
        let set = Noise::new(5).normals(300 * 6);
        assert!(frechet_distance(&set, &set, 6).unwrap() < 1e-9);
        let moved: Vec<f32> = set.iter().map(|x| x + 0.5).collect();
        assert!((frechet_distance(&set, &moved, 6).unwrap() - 6.0 * 0.25).abs() < 1e-5);
        // Twice as wide: tr C + 4 tr C - 4 tr C.
        let wide: Vec<f32> = set.iter().map(|x| x * 2.0).collect();
        let trace = frechet_distance(&set, &wide, 6).unwrap();
        assert!((5.0..8.0).contains(&trace), "{trace}");
        // Fewer rows than columns.
        assert!(frechet_distance(&set[..60], &set[..60], 20).unwrap() < 1e-6);
        assert!(frechet_distance(&set[..6], &set, 6).is_err());
    }
}
