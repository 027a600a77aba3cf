//! Points on a plane whose distances are as given: classical scaling (Torgerson), then stress majorisation (SMACOF).

use inkrig_transport::Mat;

/// Rounds of power iteration; the plane's directions are wanted, not their last digit.
const POWER_ROUNDS: usize = 200;
/// Rounds of stress majorisation.
const STRESS_ROUNDS: usize = 100;
/// Rounds for a point among placed ones.
const POINT_ROUNDS: usize = 40;

/// Places n points by their distances (n x n, symmetric).
pub(super) fn place(distances: &Mat<f32>) -> Vec<[f64; 2]> {
    let axes = principal_axes(distances, 2, POWER_ROUNDS);
    let points = axes[0].iter().zip(&axes[1]).map(|(&x, &y)| [x, y]).collect();
    let mut points = majorise(distances, points);
    to_principal_axes(&mut points);
    points
}

/// Places one more point by its distances to points that stay. `start` is where to begin to look.
pub(super) fn place_one(points: &[[f64; 2]], distances: &[f32], start: [f64; 2]) -> [f64; 2] {
    let mut at = start;
    for _ in 0..POINT_ROUNDS {
        let mut sum = [0.0; 2];
        for (point, &distance) in points.iter().zip(distances) {
            let pulled = pull(at, *point, f64::from(distance));
            sum = [sum[0] + pulled[0], sum[1] + pulled[1]];
        }
        at = sum.map(|value| value / points.len().max(1) as f64);
    }
    at
}

/// sqrt(sum (d - D)^2 / sum D^2) over all pairs, d on the plane and D as given: 0 when the plane shows all.
pub(super) fn stress(points: &[[f64; 2]], distances: &Mat<f32>) -> f64 {
    let (mut errors, mut all) = (0.0, 0.0);
    for (i, &a) in points.iter().enumerate() {
        for (&b, &distance) in points.iter().zip(distances.row(i)).skip(i + 1) {
            let distance = f64::from(distance);
            errors += (apart(a, b) - distance).powi(2);
            all += distance * distance;
        }
    }
    if all > 0.0 { (errors / all).sqrt() } else { 0.0 }
}

/// Coordinates along the `count` directions in which the points differ most, from their doubly centred squared distances
/// (Torgerson): one vector of n a direction, widest first; zeros where there are no more. `distances` is n x n, symmetric;
/// `rounds` of power iteration.
pub fn principal_axes(distances: &Mat<f32>, count: usize, rounds: usize) -> Vec<Vec<f64>> {
    let n = distances.rows();
    let squared = |i: usize, j: usize| f64::from(distances.row(i)[j]).powi(2);
    let means: Vec<f64> = (0..n).map(|i| (0..n).map(|j| squared(i, j)).sum::<f64>() / n as f64).collect();
    let mean = means.iter().sum::<f64>() / n.max(1) as f64;
    let gram = |i: usize, j: usize| -0.5 * (squared(i, j) - means[i] - means[j] + mean);
    let table: Vec<f64> = (0..n * n).map(|index| gram(index / n, index % n)).collect();
    let times = |vector: &[f64]| -> Vec<f64> {
        table.chunks_exact(n.max(1)).map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
    };
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for axis in 0..count {
        // Any start that is not at right angles to the axis will do; the same for every clip.
        let mut vector: Vec<f64> = (0..n).map(|i| ((i + 1) as f64 * (1.7 + axis as f64)).sin()).collect();
        let mut size = 0.0;
        for _ in 0..rounds {
            for other in &axes {
                let (along, own) = (dot(&vector, other), dot(other, other));
                let part = if own > 0.0 { along / own } else { 0.0 };
                vector.iter_mut().zip(other).for_each(|(value, o)| *value -= part * o);
            }
            let length = dot(&vector, &vector).sqrt();
            vector.iter_mut().for_each(|value| *value /= length.max(f64::MIN_POSITIVE));
            vector = times(&vector);
            size = dot(&vector, &vector).sqrt();
        }
        // `vector` is the direction times its eigenvalue; coordinates want the root of that.
        let root = size.sqrt().max(f64::MIN_POSITIVE);
        axes.push(vector.into_iter().map(|value| value / root).collect());
    }
    axes
}

/// Moves every point to the mean of where all others would have it, again and again: the stress never grows (de Leeuw).
fn majorise(distances: &Mat<f32>, mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let n = points.len();
    for _ in 0..STRESS_ROUNDS {
        points = (0..n)
            .map(|i| {
                let mut sum = [0.0; 2];
                for (j, (&point, &distance)) in points.iter().zip(distances.row(i)).enumerate() {
                    let pulled = if i == j { point } else { pull(points[i], point, f64::from(distance)) };
                    sum = [sum[0] + pulled[0], sum[1] + pulled[1]];
                }
                sum.map(|value| value / n as f64)
            })
            .collect();
    }
    points
}

/// The place at `distance` from `point` in the direction of `at`.
fn pull(at: [f64; 2], point: [f64; 2], distance: f64) -> [f64; 2] {
    let length = apart(at, point);
    let part = if length > 1e-12 { distance / length } else { 0.0 };
    [0, 1].map(|axis: usize| point[axis] + part * (at[axis] - point[axis]))
}

/// Centres the points and turns them so that they are widest along x; on each axis the point farthest out is on the
/// positive side. Without this the same clip, a little longer, could come out mirrored.
fn to_principal_axes(points: &mut [[f64; 2]]) {
    let n = points.len().max(1) as f64;
    let mean = [0, 1].map(|axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / n);
    points.iter_mut().for_each(|point| *point = [point[0] - mean[0], point[1] - mean[1]]);
    let moment = |a: usize, b: usize| points.iter().map(|point| point[a] * point[b]).sum::<f64>();
    let angle = 0.5 * (2.0 * moment(0, 1)).atan2(moment(0, 0) - moment(1, 1));
    let (sine, cosine) = angle.sin_cos();
    points.iter_mut().for_each(|[x, y]| (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x));
    for axis in 0..2 {
        let far = points
            .iter()
            .map(|point| point[axis])
            .fold(0.0, |far: f64, value| if value.abs() > far.abs() { value } else { far });
        if far < 0.0 {
            points.iter_mut().for_each(|point| point[axis] = -point[axis]);
        }
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: &[[f64; 2]]) -> Mat<f32> {
        Mat::from_fn(points.len(), points.len(), |i, j| apart(points[i], points[j]) as f32)
    }

    #[test]
    fn what_lies_on_a_plane_is_found_again() {
        let points: Vec<[f64; 2]> = (0..40)
            .map(|i| [(i as f64 * 0.7).sin() * 3.0, (i as f64 * 1.1).cos() + 0.02 * i as f64])
            .collect();
        let distances = table(&points);
        let placed = place(&distances);
        assert!(stress(&placed, &distances) < 1e-5, "{}", stress(&placed, &distances));
        let widest = [0, 1].map(|axis: usize| placed.iter().map(|p| p[axis].powi(2)).sum::<f64>());
        assert!(widest[0] > widest[1]);
        let one = place_one(&placed[1..], &distances.row(0)[1..], placed[1]);
        assert!(apart(one, placed[0]) < 1e-3, "{one:?} {:?}", placed[0]);
    }

    #[test]
    fn a_flat_cloud_is_found_again_along_its_axes() {
        let place = |i: usize| [3.0 * (i as f64 * 0.7).sin(), (i as f64 * 1.3).cos()];
        let points: Vec<[f64; 2]> = (0..60).map(place).collect();
        let distances = table(&points);
        let axes = principal_axes(&distances, 3, 40);
        let spread: Vec<f64> = axes.iter().map(|axis| dot(axis, axis)).collect();
        let total: f64 = spread.iter().sum();
        assert!(spread[0] > 0.8 * total && spread[2] < 1e-4 * total, "{spread:?}");
        for i in 0..60 {
            for j in 0..60 {
                let square: f64 = axes.iter().map(|axis| (axis[i] - axis[j]).powi(2)).sum();
                assert!((square.sqrt() - f64::from(distances.row(i)[j])).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn mirrored_points_come_out_the_same() {
        let points: Vec<[f64; 2]> = (0..25).map(|i| [(i * i % 17) as f64, (i * 7 % 11) as f64]).collect();
        let mirrored: Vec<[f64; 2]> = points.iter().map(|p| [-p[0], p[1]]).collect();
        let (a, b) = (place(&table(&points)), place(&table(&mirrored)));
        assert!(a.iter().zip(&b).all(|(a, b)| apart(*a, *b) < 1e-9));
    }

    #[test]
    fn a_simplex_does_not_fit_and_says_so() {
        let equal = Mat::from_fn(20, 20, |i, j| if i == j { 0.0 } else { 1.0 });
        let placed = place(&equal);
        assert!(placed.iter().flatten().all(|value| value.is_finite()));
        assert!(stress(&placed, &equal) > 0.3);
    }
}
