//! Principal axes of points of which only distances are known (classical multidimensional scaling): for Euclidean
//! distances these are the principal components of the points.

use inkrig_transport::Mat;

/// Rounds of subspace iteration; the axes of clips and drawings settle in far fewer.
const ROUNDS: usize = 40;

/// Coordinates of every point on the first `count` axes, the widest first, and each axis' share of the spread of all
/// those axes. `distances` is N x N, symmetric.
pub(super) fn principal_axes(distances: &Mat<f32>, count: usize) -> Vec<(Vec<f64>, f64)> {
    let points = distances.rows();
    let gram = centred_gram(distances);
    let mut axes: Vec<Vec<f64>> = (0..count)
        .map(|axis| (0..points).map(|point| ((axis + 1) as f64 * (point as f64 + 0.5) * 1.7).sin()).collect())
        .collect();
    let mut widths = vec![0.0; count];
    for _ in 0..ROUNDS {
        for axis in 0..count {
            let mut image: Vec<f64> = gram.chunks_exact(points).map(|row| dot(row, &axes[axis])).collect();
            for before in &axes[..axis] {
                let along = dot(&image, before);
                image.iter_mut().zip(before).for_each(|(value, direction)| *value -= along * direction);
            }
            widths[axis] = dot(&image, &image).sqrt();
            let scale = if widths[axis] > 0.0 { 1.0 / widths[axis] } else { 0.0 };
            image.iter_mut().for_each(|value| *value *= scale);
            axes[axis] = image;
        }
    }
    let total: f64 = widths.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    axes.into_iter()
        .zip(&widths)
        .map(|(axis, &width)| (axis.iter().map(|value| value * width.sqrt()).collect(), width / total))
        .collect()
}

/// -1/2 of the squared distances, rows and columns made to sum to 0.
fn centred_gram(distances: &Mat<f32>) -> Vec<f64> {
    let points = distances.rows();
    let mut gram: Vec<f64> =
        distances.as_slice().iter().map(|&distance| -0.5 * f64::from(distance).powi(2)).collect();
    let means: Vec<f64> =
        gram.chunks_exact(points.max(1)).map(|row| row.iter().sum::<f64>() / points as f64).collect();
    let mean = means.iter().sum::<f64>() / points.max(1) as f64;
    for (row, own) in gram.chunks_exact_mut(points.max(1)).zip(&means) {
        row.iter_mut().zip(&means).for_each(|(value, other)| *value += mean - own - other);
    }
    gram
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_cloud_is_found_again() {
        let place = |i: usize| [3.0 * (i as f64 * 0.7).sin(), (i as f64 * 1.3).cos()];
        let distances = Mat::from_fn(60, 60, |i, j| {
            let ([a, b], [c, d]) = (place(i), place(j));
            (a - c).hypot(b - d) as f32
        });
        let axes = principal_axes(&distances, 3);
        assert!(
            axes[0].1 > 0.8 && axes[2].1 < 1e-4,
            "{:?}",
            axes.iter().map(|axis| axis.1).collect::<Vec<_>>()
        );
        for i in 0..60 {
            for j in 0..60 {
                let square: f64 = axes.iter().map(|(axis, _)| (axis[i] - axis[j]).powi(2)).sum();
                assert!((square.sqrt() - f64::from(distances.row(i)[j])).abs() < 1e-3);
            }
        }
    }
}
