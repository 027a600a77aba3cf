//! Smoothing that leaves straight lines as they are.

use glam::DVec2;

/// A value has a say in those up to so many times `half` away.
pub(super) const REACH: usize = 6;

/// Three passes of a running line fit over `2 half + 1` values: about a Gaussian whose standard deviation is `half`.
/// What that takes away is smoothed likewise and given back (Tukey's twicing), or every curve would come out tighter.
///
/// A steady movement comes back unchanged, and turning or moving all values turns and moves the result. At the ends
/// the window stays whole, so the first and last `half` values come to lie near one line; fewer values than a window
/// become one line.
pub(super) fn low_pass(values: &[DVec2], half: usize) -> Vec<DVec2> {
    if half == 0 || values.len() < 3 {
        return values.to_vec();
    }
    let smooth = three_fits(values, half);
    let rest: Vec<DVec2> = values.iter().zip(&smooth).map(|(value, smooth)| *value - *smooth).collect();
    smooth.iter().zip(three_fits(&rest, half)).map(|(smooth, rest)| *smooth + rest).collect()
}

/// [`low_pass`] of single numbers.
pub(super) fn low_pass_numbers(values: &[f64], half: usize) -> Vec<f64> {
    let pairs: Vec<DVec2> = values.iter().map(|&value| DVec2::new(value, 0.0)).collect();
    low_pass(&pairs, half).into_iter().map(|pair| pair.x).collect()
}

fn three_fits(values: &[DVec2], half: usize) -> Vec<DVec2> {
    let once = line_fits(values, half);
    line_fits(&line_fits(&once, half), half)
}

fn line_fits(values: &[DVec2], half: usize) -> Vec<DVec2> {
    let count = values.len();
    let width = (2 * half + 1).min(count);
    let span = width as f64;
    // Sums from the first value on, relative to it, so that far-away places keep their digits.
    let origin = values[0];
    let mut sums = Vec::with_capacity(count + 1);
    let (mut sum, mut moment) = (DVec2::ZERO, DVec2::ZERO);
    sums.push((sum, moment));
    for (index, value) in values.iter().enumerate() {
        sum += *value - origin;
        moment += (*value - origin) * index as f64;
        sums.push((sum, moment));
    }
    (0..count)
        .map(|index| {
            let begin = index.saturating_sub(half).min(count - width);
            let middle = begin as f64 + 0.5 * (span - 1.0);
            let (low, high) = (sums[begin], sums[begin + width]);
            let total = high.0 - low.0;
            let slope = (high.1 - low.1 - total * middle) * 12.0 / (span * (span * span - 1.0));
            origin + total / span + slope * (index as f64 - middle)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_and_waves_go() {
        let line: Vec<f64> = (0..100).map(|i| 1e3 + 0.5 * f64::from(i)).collect();
        for half in [0, 1, 15, 80] {
            for (a, b) in low_pass_numbers(&line, half).iter().zip(&line) {
                assert!((a - b).abs() < 1e-8, "{half}");
            }
        }
        let wave: Vec<f64> = (0..300).map(|i| (f64::from(i) * 0.21).sin()).collect();
        let left = low_pass_numbers(&wave, 15);
        assert!(left[91..209].iter().all(|value| value.abs() < 0.01), "a wave of a second at 30 a second");
        assert!(left.iter().all(|value| value.abs() < 1.1), "near the ends no more than there was");
    }

    #[test]
    fn a_circle_keeps_its_size() {
        let circle: Vec<DVec2> = (0..400).map(|i| DVec2::from_angle(f64::from(i) * 0.02)).collect();
        for point in &low_pass(&circle, 15)[90..310] {
            assert!((point.length() - 1.0).abs() < 5e-3, "{}", point.length());
        }
    }

    #[test]
    fn a_handful_of_values_becomes_a_line() {
        assert_eq!(low_pass_numbers(&[1.0, 5.0], 9), [1.0, 5.0]);
        let smooth = low_pass_numbers(&[0.0, 3.0, 0.0, 3.0], 9);
        let steps: Vec<f64> = smooth.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 1e-12));
    }
}
