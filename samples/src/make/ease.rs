//! Timing: eases, keyed curves, and smoothing that shifts nothing in time.

use std::f64::consts::PI;

/// The minimum-jerk ease from 0 to 1 (Flash and Hogan 1985): speed and acceleration are 0 at both ends.
/// `part` outside of 0..=1 is clamped.
pub fn min_jerk(part: f64) -> f64 {
    let x = part.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// The cubic ease from 0 to 1: speed is 0 at both ends. `part` outside of 0..=1 is clamped.
pub fn smooth_step(part: f64) -> f64 {
    let x = part.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// An ease from 0 to 1 that coasts at even speed between two ramps, each `ramp` (0..=0.5) of the way long: the speed is
/// a cosine-tapered (Tukey) window. Speed and acceleration are 0 at both ends and never jump; the highest speed,
/// 1 / (1 - ramp), stays below that of [`min_jerk`]. `part` outside of 0..=1 is clamped.
pub fn coast(part: f64, ramp: f64) -> f64 {
    let x = part.clamp(0.0, 1.0);
    if x > 0.5 {
        return 1.0 - coast(1.0 - x, ramp);
    }
    if x < ramp {
        0.5 * (x - ramp / PI * (PI * x / ramp).sin()) / (1.0 - ramp)
    } else {
        (x - 0.5 * ramp) / (1.0 - ramp)
    }
}

/// How far `time` is from `start` to `end`, 0..=1.
pub fn part(time: f64, start: f64, end: f64) -> f64 {
    ((time - start) / (end - start)).clamp(0.0, 1.0)
}

/// Rises from 0 to 1 in the `rise` seconds after `start` and falls back in the `fall` seconds before `end`.
pub fn window(time: f64, start: f64, end: f64, rise: f64, fall: f64) -> f64 {
    min_jerk(part(time, start, start + rise)) * (1.0 - min_jerk(part(time, end - fall, end)))
}

/// A bump from 0 over 1 in the middle to 0; its slope is 0 at both ends.
pub fn bump(part: f64) -> f64 {
    let x = part.clamp(0.0, 1.0);
    16.0 * x * x * (1.0 - x) * (1.0 - x)
}

/// A curve through keys (seconds, value): monotone cubic interpolation (Fritsch and Carlson 1980), so that it is
/// smooth, never overshoots a key, and stays flat between equal keys. Constant outside of the keys.
#[derive(Debug, Clone)]
pub struct Keys {
    keys: Vec<(f64, f64)>,
    slopes: Vec<f64>,
}

impl Keys {
    /// Through `keys`, which stand in the order of time.
    pub fn new(keys: &[(f64, f64)]) -> Self {
        let chords: Vec<f64> =
            keys.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
        let mut slopes = vec![0.0; keys.len()];
        for (index, pair) in chords.windows(2).enumerate() {
            // The harmonic mean, 0 at a turning point: sufficient for monotony.
            if pair[0] * pair[1] > 0.0 {
                slopes[index + 1] = 2.0 * pair[0] * pair[1] / (pair[0] + pair[1]);
            }
        }
        Self { keys: keys.to_vec(), slopes }
    }

    /// The value at `time`; 0 when there is no key.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.keys.partition_point(|key| key.0 <= time);
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else { return 0.0 };
        if next == 0 {
            return first.1;
        }
        if next == self.keys.len() {
            return last.1;
        }
        let ((t0, v0), (t1, v1)) = (self.keys[next - 1], self.keys[next]);
        let (m0, m1) = (self.slopes[next - 1], self.slopes[next]);
        let span = t1 - t0;
        let x = (time - t0) / span;
        let (x2, x3) = (x * x, x * x * x);
        (2.0 * x3 - 3.0 * x2 + 1.0) * v0
            + (x3 - 2.0 * x2 + x) * span * m0
            + (3.0 * x2 - 2.0 * x3) * v1
            + (x3 - x2) * span * m1
    }
}

/// The values under a Gaussian window of `sigma` samples, cut at four sigma. The ends count as going on unchanged.
pub fn gaussian(values: &[f64], sigma: f64) -> Vec<f64> {
    let reach = (4.0 * sigma).ceil() as isize;
    let weights: Vec<f64> = (-reach..=reach).map(|i| (-0.5 * (i as f64 / sigma).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let last = values.len() as isize - 1;
    (0..values.len() as isize)
        .map(|centre| {
            let terms = weights.iter().zip(centre - reach..);
            terms.map(|(weight, at)| weight * values[at.clamp(0, last) as usize]).sum::<f64>() / total
        })
        .collect()
}

/// The smallest value within `reach` samples to both sides. Smoothed afterwards it stays (almost) below the values.
pub fn lowest(values: &[f64], reach: usize) -> Vec<f64> {
    (0..values.len())
        .map(|index| {
            let near = &values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())];
            near.iter().copied().fold(f64::INFINITY, f64::min)
        })
        .collect()
}

/// The values as they were `samples` ago (fractions allowed, negative looks ahead), linearly interpolated.
pub fn lag(values: &[f64], samples: f64) -> Vec<f64> {
    let last = values.len() as f64 - 1.0;
    (0..values.len())
        .map(|index| {
            let place = (index as f64 - samples).clamp(0.0, last);
            let low = place.floor();
            let high = (low + 1.0).min(last);
            values[low as usize] + (place - low) * (values[high as usize] - values[low as usize])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_met_and_never_overshot() {
        let keys = Keys::new(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, -2.0)]);
        for (time, value) in
            [(0.0, 0.0), (1.0, 1.0), (1.5, 1.0), (2.0, 1.0), (3.0, -2.0), (-1.0, 0.0), (9.0, -2.0)]
        {
            assert!((keys.at(time) - value).abs() < 1e-12, "at {time}");
        }
        let values: Vec<f64> = (0..=300).map(|i| keys.at(0.01 * f64::from(i))).collect();
        assert!(values.iter().all(|&value| (-2.0..=1.0).contains(&value)));
        assert!(values.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.06));
    }

    #[test]
    fn smoothing_keeps_straight_lines_and_lag_moves_them() {
        let line: Vec<f64> = (0..60).map(f64::from).collect();
        assert!((gaussian(&line, 3.0)[30] - 30.0).abs() < 1e-9);
        assert!((lag(&line, 2.5)[30] - 27.5).abs() < 1e-12);
        assert!((lag(&line, -2.5)[30] - 32.5).abs() < 1e-12);
    }

    #[test]
    fn the_lowest_smoothed_stays_below() {
        let values: Vec<f64> = (0..90).map(|i| (0.3 * f64::from(i)).sin()).collect();
        let below = gaussian(&lowest(&values, 4), 1.5);
        assert!(below.iter().zip(&values).all(|(below, value)| *below < value + 5e-3));
    }

    #[test]
    fn a_coast_has_an_even_middle_and_no_jump_of_acceleration() {
        const STEP: f64 = 1e-3;
        let values: Vec<f64> = (-3..=1003).map(|i| coast(STEP * f64::from(i), 0.35)).collect();
        let speeds: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]) / STEP).collect();
        assert!(speeds.iter().all(|&speed| speed > -1e-9 && speed < 1.0 / 0.65 + 1e-9));
        let changes: Vec<f64> = speeds.windows(2).map(|pair| (pair[1] - pair[0]) / STEP).collect();
        let jump = changes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        // The smooth step's acceleration jumps by 6 at its ends.
        assert!(jump < 0.1, "{jump}");
    }

    #[test]
    fn eases_begin_and_end_still() {
        for ease in [min_jerk, smooth_step, |part| coast(part, 0.35)] {
            assert_eq!((ease(-1.0), ease(0.0), ease(1.0), ease(2.0)), (0.0, 0.0, 1.0, 1.0));
            assert!(ease(1e-4) < 1e-6 && 1.0 - ease(1.0 - 1e-4) < 1e-6);
        }
        assert!((bump(0.5) - 1.0).abs() < 1e-12 && (window(1.0, 0.0, 2.0, 0.5, 0.5) - 1.0).abs() < 1e-12);
    }
}
