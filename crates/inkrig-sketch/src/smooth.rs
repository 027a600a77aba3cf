//! Gaussian smoothing of a control: the sketch is smoothed before it is followed (MAMM, SIGGRAPH 2025, Sec. 4.1).

use crate::SketchError;
use crate::limits::MAX_SIGMA;

/// The Gaussian is cut off this many sigmas from its centre.
const TRUNCATE: f64 = 4.0;

/// What lies beyond the first and last frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ends {
    /// The curve continues as its own reflection through its end points: the ends stay where they are, and a line
    /// travelled at constant speed stays exactly itself.
    Open,
    /// The curve is a loop. If the last point repeats the first, it counts once, and the result closes again.
    Cyclic,
}

/// Smooths frames of N numbers with a Gaussian whose standard deviation is `sigma` frames; 0 leaves them as they are.
///
/// Returns as many points as it is given.
///
/// # Errors
/// [`SketchError::Sigma`]: a width that is negative, not a number, or above [`MAX_SIGMA`].
pub fn smooth<const N: usize>(
    points: &[[f64; N]],
    sigma: f64,
    ends: Ends,
) -> Result<Vec<[f64; N]>, SketchError> {
    if !(0.0..=MAX_SIGMA).contains(&sigma) {
        return Err(SketchError::Sigma { sigma });
    }
    let kernel = half_kernel(sigma);
    if kernel.len() < 2 || points.len() < 2 {
        return Ok(points.to_vec());
    }
    let reach = kernel.len() as isize - 1;
    match ends {
        Ends::Open => {
            let padded = extend(points.len(), reach, |index| reflected(points, index));
            Ok(convolve(&padded, &kernel))
        }
        Ends::Cyclic => {
            let repeated = points.len() > 2 && points.first() == points.last();
            let loop_len = points.len() - usize::from(repeated);
            let padded = extend(loop_len, reach, |index| {
                points.get(index.rem_euclid(loop_len as isize) as usize).copied().unwrap_or([0.0; N])
            });
            let mut smoothed = convolve(&padded, &kernel);
            if repeated {
                smoothed.extend(smoothed.first().copied());
            }
            Ok(smoothed)
        }
    }
}

/// Weights of the centre and of one side; centre plus twice the side sums to 1.
fn half_kernel(sigma: f64) -> Vec<f64> {
    let radius = (TRUNCATE * sigma).ceil() as usize;
    let mut weights: Vec<f64> =
        (0..=radius).map(|k| if k == 0 { 1.0 } else { (-0.5 * (k as f64 / sigma).powi(2)).exp() }).collect();
    let total = 2.0 * weights.iter().sum::<f64>() - 1.0;
    for weight in &mut weights {
        *weight /= total;
    }
    weights
}

fn extend<const N: usize>(count: usize, reach: isize, at: impl Fn(isize) -> [f64; N]) -> Vec<[f64; N]> {
    (-reach..count as isize + reach).map(at).collect()
}

/// The point at any index of a curve that is reflected through its end points again and again.
fn reflected<const N: usize>(points: &[[f64; N]], index: isize) -> [f64; N] {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else { return [0.0; N] };
    let span = points.len() as isize - 1;
    let period = 2 * span;
    let (rounds, within) = (index.div_euclid(period) as f64, index.rem_euclid(period));
    let point = |index: isize| points.get(index as usize).copied().unwrap_or([0.0; N]);
    let base = if within <= span {
        point(within)
    } else {
        let mirrored = point(period - within);
        each(last, mirrored, |last, mirrored| 2.0 * last - mirrored)
    };
    let way = each(last, first, |last, first| rounds * 2.0 * (last - first));
    each(base, way, |base, way| base + way)
}

/// Weighs each window symmetrically about its centre, so that the result is exact for a reflected line.
fn convolve<const N: usize>(padded: &[[f64; N]], kernel: &[f64]) -> Vec<[f64; N]> {
    let reach = kernel.len() - 1;
    padded
        .windows(2 * reach + 1)
        .map(|window| {
            let (before, from_centre) = window.split_at(reach);
            let centre = from_centre.first().copied().unwrap_or([0.0; N]);
            let pairs = before.iter().rev().zip(from_centre.iter().skip(1)).zip(kernel.iter().skip(1));
            // Offsets from the centre: what is far from the origin keeps its precision.
            pairs.fold(centre, |sum, ((a, b), weight)| {
                let off = |point: &[f64; N]| each(*point, centre, |own, centre| own - centre);
                let pull = each(off(a), off(b), |before, after| before + after);
                each(sum, pull, |sum, pull| sum + weight * pull)
            })
        })
        .collect()
}

/// Two points to one, number by number.
fn each<const N: usize>(mut a: [f64; N], b: [f64; N], with: impl Fn(f64, f64) -> f64) -> [f64; N] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a = with(*a, b));
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy_line(count: usize) -> Vec<[f64; 2]> {
        (0..count).map(|i| [i as f64, if i % 2 == 0 { 0.5 } else { -0.5 }]).collect()
    }

    #[test]
    fn no_width_changes_nothing() {
        let points = noisy_line(9);
        assert_eq!(smooth(&points, 0.0, Ends::Open).unwrap(), points);
    }

    #[test]
    fn ends_stay_and_a_line_stays_itself() {
        let line: Vec<[f64; 2]> = (0..40).map(|i| [10.0 + i as f64, 7.0 - 2.0 * i as f64]).collect();
        for sigma in [0.7, 3.0, 100.0] {
            for (got, want) in smooth(&line, sigma, Ends::Open).unwrap().iter().zip(&line) {
                assert!(
                    (got[0] - want[0]).abs() < 1e-9 && (got[1] - want[1]).abs() < 1e-9,
                    "{got:?} {want:?}"
                );
            }
        }
        let jitter = noisy_line(31);
        let smoothed = smooth(&jitter, 2.0, Ends::Open).unwrap();
        assert!(
            (smoothed[0][1] - jitter[0][1]).abs() < 1e-12 && (smoothed[30][1] - jitter[30][1]).abs() < 1e-12
        );
        assert!(smoothed[15][1].abs() < 0.01, "jitter is gone: {:?}", smoothed[15]);
    }

    #[test]
    fn it_is_a_gaussian() {
        let mut impulse = vec![[0.0, 0.0]; 41];
        impulse[20] = [1.0, 0.0];
        let smoothed = smooth(&impulse, 3.0, Ends::Open).unwrap();
        let total: f64 = smoothed.iter().map(|p| p[0]).sum();
        let variance: f64 = smoothed.iter().enumerate().map(|(i, p)| p[0] * (i as f64 - 20.0).powi(2)).sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert!((variance.sqrt() - 3.0).abs() < 0.01, "{}", variance.sqrt());
    }

    #[test]
    fn a_loop_has_no_seam() {
        let circle = |n: usize, turn: usize| {
            let angle = std::f64::consts::TAU * turn as f64 / n as f64;
            [angle.cos(), angle.sin()]
        };
        let open: Vec<_> = (0..24).map(|i| circle(24, i)).collect();
        let radius = |p: &[f64; 2]| p[0].hypot(p[1]);
        let smoothed = smooth(&open, 2.0, Ends::Cyclic).unwrap();
        assert!(smoothed.iter().all(|p| (radius(p) - radius(&smoothed[0])).abs() < 1e-12));
        let mut closed = open.clone();
        closed.push(open[0]);
        let closed = smooth(&closed, 2.0, Ends::Cyclic).unwrap();
        assert_eq!(closed[..24], smoothed[..]);
        assert_eq!(closed[24], closed[0]);
    }

    #[test]
    fn a_width_beyond_the_curve_still_works() {
        let points = [[0.0, 0.0], [1.0, 1.0], [0.0, 2.0]];
        for ends in [Ends::Open, Ends::Cyclic] {
            let smoothed = smooth(&points, 50.0, ends).unwrap();
            assert!(smoothed.iter().flatten().all(|v| v.is_finite()));
        }
        assert_eq!(smooth::<2>(&[], 2.0, Ends::Open).unwrap(), Vec::<[f64; 2]>::new());
    }

    #[test]
    fn impossible_widths_are_refused() {
        for sigma in [-1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(matches!(smooth(&[[0.0; 2]; 3], sigma, Ends::Open), Err(SketchError::Sigma { .. })));
        }
    }
}
