//! Cubic Hermite pieces between keys.

/// Up to four numbers; of a translation the last stays 0.
pub(super) type Numbers = [f64; 4];

/// Samples a frame at which a curve is compared with the motion: on it and half way to the next.
pub(super) const SAMPLES: usize = 2;

/// What the two ends of a piece count at a part (0 to 1) of its way: the first value, the first slope, the second
/// value, the second slope; slopes by the length of the piece.
pub(super) fn hermite(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, 3.0 * t2 - 2.0 * t3, t3 - t2]
}

/// A key while keys are being chosen. Slopes are a frame's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Knot {
    pub(super) frame: usize,
    pub(super) value: Numbers,
    pub(super) slope_in: Numbers,
    pub(super) slope_out: Numbers,
}

/// A curve between two keys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Frames.
    pub(super) length: usize,
    pub(super) from: Numbers,
    pub(super) to: Numbers,
    /// A frame's, at the two ends.
    pub(super) slopes: [Numbers; 2],
}

impl Piece {
    pub(super) fn between(from: &Knot, to: &Knot) -> Self {
        let slopes = [from.slope_out, to.slope_in];
        Self { length: to.frame - from.frame, from: from.value, to: to.value, slopes }
    }

    /// Its values from one end to the other, both included, at [`SAMPLES`] a frame.
    pub(super) fn samples(&self) -> impl Iterator<Item = Numbers> + '_ {
        let count = self.length * SAMPLES;
        (0..=count).map(move |sample| self.at(sample as f64 / count as f64))
    }

    fn at(&self, part: f64) -> Numbers {
        let [a, m, b, n] = hermite(part);
        let (m, n) = (m * self.length as f64, n * self.length as f64);
        let [out, into] = &self.slopes;
        std::array::from_fn(|i| a * self.from[i] + m * out[i] + b * self.to[i] + n * into[i])
    }

    /// Sets the slopes so that the piece comes as near as can be to `target` (weighted least squares), one number and one
    /// weight a sample, the ends' own included. False where there are too few to tell.
    pub(super) fn fit(&mut self, target: &[Numbers], weights: &[f64]) -> bool {
        let count = self.length * SAMPLES;
        let (mut mm, mut mn, mut nn) = (0.0, 0.0, 0.0);
        let (mut right_m, mut right_n) = ([0.0; 4], [0.0; 4]);
        let inner = target.iter().zip(weights).enumerate().take(count).skip(1);
        for (sample, (target, weight)) in inner {
            let [a, m, b, n] = hermite(sample as f64 / count as f64);
            let (m, n) = (m * self.length as f64, n * self.length as f64);
            mm += weight * m * m;
            mn += weight * m * n;
            nn += weight * n * n;
            for i in 0..4 {
                let rest = target[i] - a * self.from[i] - b * self.to[i];
                right_m[i] += weight * m * rest;
                right_n[i] += weight * n * rest;
            }
        }
        let determinant = mm * nn - mn * mn;
        if determinant <= 1e-9 * mm * nn || determinant.is_nan() {
            return false;
        }
        self.slopes = [
            std::array::from_fn(|i| (nn * right_m[i] - mn * right_n[i]) / determinant),
            std::array::from_fn(|i| (mm * right_n[i] - mn * right_m[i]) / determinant),
        ];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is its own piece.
    #[test]
    fn a_cubic_is_found_again() {
        let cubic = |x: f64| [0.01 * x * x * x - 0.2 * x * x + 0.3 * x - 4.0, x, 0.0, 0.0];
        let slope = |x: f64| 0.03 * x * x - 0.4 * x + 0.3;
        let target: Vec<Numbers> = (0..=14).map(|sample| cubic(f64::from(sample) / 2.0)).collect();
        let mut piece = Piece { length: 7, from: cubic(0.0), to: cubic(7.0), slopes: [[9.0; 4]; 2] };
        assert!(piece.fit(&target, &[1.0; 15]));
        let [out, into] = piece.slopes;
        assert!((out[0] - slope(0.0)).abs() < 1e-9 && (into[0] - slope(7.0)).abs() < 1e-9);
        assert!((out[1] - 1.0).abs() < 1e-9 && out[2].abs() < 1e-9);
        assert!(piece.samples().zip(&target).all(|(a, b)| (a[0] - b[0]).abs() < 1e-9));
    }

    #[test]
    fn a_piece_of_one_frame_keeps_its_slopes() {
        let mut piece = Piece { length: 1, from: [0.0; 4], to: [1.0; 4], slopes: [[1.0; 4]; 2] };
        assert!(!piece.fit(&[[0.0; 4], [0.6; 4], [1.0; 4]], &[1.0; 3]));
        assert_eq!(piece.slopes, [[1.0; 4]; 2]);
    }
}
