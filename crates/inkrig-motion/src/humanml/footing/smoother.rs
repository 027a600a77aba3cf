//! Whittaker's smoother: a curve that is near weighted values and bends little.

/// What a curve has little of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Little {
    /// Second differences: it goes on straight where nothing is known.
    Bend,
    /// Third differences: it starts and stops gently.
    Jerk,
}

/// Places beside the diagonal.
const BAND: usize = 3;

/// The curve x of least `sum weight (x - value)^2 + stiffness sum (difference of x)^2`. Where weights are nothing it goes on as smoothly as
/// it can. See [`Little::stiffness`].
///
/// # Panics
/// When there are fewer weights than values.
pub(super) fn smooth(values: &[f64], weights: &[f64], little: Little, stiffness: f64) -> Vec<f64> {
    let count = values.len();
    // The matrix by its diagonals: itself, the next, the ones after.
    let mut rows: Vec<[f64; BAND + 1]> =
        weights[..count].iter().map(|weight| [weight + 1e-9, 0.0, 0.0, 0.0]).collect();
    let difference: &[f64] = match little {
        Little::Bend => &[1.0, -2.0, 1.0],
        Little::Jerk => &[1.0, -3.0, 3.0, -1.0],
    };
    for begin in 0..(count + 1).saturating_sub(difference.len()) {
        for (i, first) in difference.iter().enumerate() {
            for (beside, second) in difference[i..].iter().enumerate() {
                rows[begin + i][beside] += stiffness * first * second;
            }
        }
    }
    let mut x: Vec<f64> = values.iter().zip(weights).map(|(value, weight)| weight * value).collect();
    // Cholesky's method without roots.
    for at in 0..count {
        let own = rows[at];
        for step in 1..=BAND.min(count - 1 - at) {
            let share = own[step] / own[0];
            for beside in step..=BAND {
                rows[at + step][beside - step] -= share * own[beside];
            }
            x[at + step] -= share * x[at];
        }
    }
    for at in (0..count).rev() {
        let beyond = |step: usize| x.get(at + step).map_or(0.0, |x| rows[at][step] * x);
        let known: f64 = (1..=BAND).map(beyond).sum();
        x[at] = (x[at] - known) / rows[at][0];
    }
    x
}

/// How often [`smooth_above`] looks for places in which the curve is too low, and how much these count.
const ROUNDS: usize = 8;
const SOLID: f64 = 1e3;

/// As [`smooth`], but hardly below `least`, except where a weight is larger than that of such places.
pub(super) fn smooth_above(
    values: &[f64],
    weights: &[f64],
    least: &[f64],
    little: Little,
    stiffness: f64,
) -> Vec<f64> {
    let (mut values, mut weights) = (values.to_vec(), weights.to_vec());
    let mut x = smooth(&values, &weights, little, stiffness);
    for _ in 0..ROUNDS {
        let mut low = false;
        for (at, x) in x.iter().enumerate() {
            if weights[at] < SOLID && *x < least[at] - 1e-4 {
                (values[at], weights[at], low) = (least[at], SOLID, true);
            }
        }
        if !low {
            break;
        }
        x = smooth(&values, &weights, little, stiffness);
    }
    x
}

impl Little {
    /// The stiffness at which movements of so many seconds keep half of their size, where all weights are 1.
    pub(super) fn stiffness(self, seconds: f64, rate: f64) -> f64 {
        let order = if self == Self::Bend { 4 } else { 6 };
        (seconds * rate / std::f64::consts::TAU).powi(order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_and_gaps_are_bridged() {
        let line: Vec<f64> = (0..30).map(|i| 2.0 - 0.1 * f64::from(i)).collect();
        let mut holed = line.clone();
        let mut weights = vec![1.0; 30];
        for at in 8..15 {
            (holed[at], weights[at]) = (70.0, 0.0);
        }
        for (x, value) in smooth(&holed, &weights, Little::Bend, 1e3).iter().zip(&line) {
            assert!((x - value).abs() < 1e-6, "{x} {value}");
        }
    }

    #[test]
    fn half_of_a_movement_of_that_time_stays() {
        let wave: Vec<f64> = (0..400).map(|i| (f64::from(i) * std::f64::consts::TAU / 20.0).cos()).collect();
        for little in [Little::Bend, Little::Jerk] {
            let left = smooth(&wave, &[1.0; 400], little, little.stiffness(1.0, 20.0));
            assert!((left[200] - 0.5).abs() < 0.02, "{}", left[200]);
        }
    }

    #[test]
    fn few_values_are_no_matter() {
        for little in [Little::Bend, Little::Jerk] {
            assert!(smooth(&[], &[], little, 1.0).is_empty());
            assert!((smooth(&[3.0], &[1.0], little, 1.0)[0] - 3.0).abs() < 1e-6);
            assert!(smooth(&[3.0, 1.0], &[1.0, 0.0], little, 1.0).iter().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn a_curve_over_a_post_is_not_below_it() {
        let (mut least, zeros) = (vec![-1.0; 40], vec![0.0; 40]);
        least[20] = 0.1;
        let over = smooth_above(&zeros, &[1.0; 40], &least, Little::Jerk, 100.0);
        assert!((over[20] - 0.1).abs() < 0.01 && over[18] > 0.03 && over[2].abs() < 0.01, "{over:?}");
    }
}
