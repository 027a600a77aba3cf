//! Several pieces fitted at once.

use super::fit::{Knot, Numbers, SAMPLES, hermite};

/// Numbers that are free in a row of [`KNOTS`] keys: the slopes between them, and the values of all but the first and the last.
const FREE: usize = 3 * KNOTS - 4;
/// Most keys that are fitted at once.
pub(super) const KNOTS: usize = 7;

/// How much slopes are held where samples say nothing about them, against what a sample weighs in the mean.
const HOLD: f64 = 1e-4;

/// Sets the values of the keys between the first and the last of a row of at most [`KNOTS`], and the slopes between all of
/// them, so that the curve comes as near as can be to `target` (weighted least squares): one number and one weight a
/// sample, from the first key to the last. Keys are as they were where nothing can be told.
pub(super) fn fit(knots: &mut [Knot], target: &[Numbers], weights: &[f64]) -> bool {
    let last = knots.len().saturating_sub(1);
    if last == 0 || last >= KNOTS {
        return false;
    }
    let mut matrix = [[0.0; FREE]; FREE];
    let mut right = [[0.0; 4]; FREE];
    let hold = HOLD * weights.iter().sum::<f64>() / weights.len().max(1) as f64;
    let mut sample = 0;
    for place in 0..last {
        let (from, to) = (&knots[place], &knots[place + 1]);
        let frames = to.frame - from.frame;
        let (length, count) = (frames as f64, frames * SAMPLES);
        let indices = [value(place, last), Some(3 * place), value(place + 1, last), Some(3 * place + 1)];
        let held = [&from.value, &from.slope_out, &to.value, &to.slope_in];
        // The sample on the last key is exact.
        for step in 1..=count - usize::from(place + 1 == last) {
            let [a, m, b, n] = hermite(step as f64 / count as f64);
            let parts = [a, m * length, b, n * length];
            let (Some(target), Some(weight)) = (target.get(sample + step), weights.get(sample + step)) else {
                return false;
            };
            let fixed = indices.iter().zip(parts).zip(held).filter(|((index, _), _)| index.is_none());
            let mut rest = *target;
            for ((_, part), held) in fixed {
                (0..4).for_each(|i| rest[i] -= part * held[i]);
            }
            for (row, part) in indices.iter().zip(parts) {
                let Some(row) = *row else { continue };
                for (column, other) in indices.iter().zip(parts) {
                    if let Some(column) = *column {
                        matrix[row][column] += weight * part * other;
                    }
                }
                (0..4).for_each(|i| right[row][i] += weight * part * rest[i]);
            }
        }
        for (index, slope) in [(3 * place, &from.slope_out), (3 * place + 1, &to.slope_in)] {
            let weight = hold * length * length;
            matrix[index][index] += weight;
            (0..4).for_each(|i| right[index][i] += weight * slope[i]);
        }
        sample += count;
    }
    if !solve(&mut matrix, &mut right, 3 * last - 1) {
        return false;
    }
    for place in 0..last {
        knots[place].slope_out = right[3 * place];
        knots[place + 1].slope_in = right[3 * place + 1];
        if let Some(index) = value(place, last) {
            knots[place].value = right[index];
        }
    }
    true
}

/// Place of a key's value among the free numbers: after the slopes of the piece before it.
fn value(place: usize, last: usize) -> Option<usize> {
    (place > 0 && place < last).then(|| 3 * place - 1)
}

/// Solves for several right sides in place (Cholesky); false where the matrix is not positive.
fn solve(matrix: &mut [[f64; FREE]; FREE], right: &mut [[f64; 4]; FREE], count: usize) -> bool {
    for row in 0..count {
        for column in 0..=row {
            let known: f64 = (0..column).map(|k| matrix[row][k] * matrix[column][k]).sum();
            let rest = matrix[row][column] - known;
            if row == column {
                if rest.is_nan() || rest <= 1e-12 * matrix[row][row] {
                    return false;
                }
                matrix[row][row] = rest.sqrt();
            } else {
                matrix[row][column] = rest / matrix[column][column];
            }
        }
        right[row] = std::array::from_fn(|i| {
            let known: f64 = (0..row).map(|k| matrix[row][k] * right[k][i]).sum();
            (right[row][i] - known) / matrix[row][row]
        });
    }
    for row in (0..count).rev() {
        right[row] = std::array::from_fn(|i| {
            let known: f64 = (row + 1..count).map(|k| matrix[k][row] * right[k][i]).sum();
            (right[row][i] - known) / matrix[row][row]
        });
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is found again from keys that know only its ends.
    #[test]
    fn one_cubic_is_found_across_keys() {
        let cubic = |x: f64| [0.01 * x * x * x - 0.2 * x * x + 0.3 * x - 4.0, x, 0.0, 0.0];
        let target: Vec<Numbers> = (0..=24).map(|sample| cubic(f64::from(sample) / 2.0)).collect();
        let key = |frame: usize, value| Knot { frame, value, slope_in: [0.0; 4], slope_out: [0.0; 4] };
        let mut knots = [key(3, cubic(0.0)), key(7, [9.0; 4]), key(10, [1.0; 4]), key(15, cubic(12.0))];
        assert!(fit(&mut knots, &target, &[1.0; 25]));
        assert!((knots[1].value[0] - cubic(4.0)[0]).abs() < 0.02 && (knots[2].value[1] - 7.0).abs() < 0.02);
        assert!((knots[1].slope_in[1] - 1.0).abs() < 0.02 && (knots[2].slope_out[1] - 1.0).abs() < 0.02);
        assert_eq!((knots[0].value, knots[3].value), (cubic(0.0), cubic(12.0)));
    }
}
