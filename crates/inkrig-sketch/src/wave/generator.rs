//! The waveforms themselves: one period of each, and noise.

use std::f64::consts::TAU;

use super::expression::{Moment, Sweep};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    Sine,
    Triangle,
    Square {
        /// Part of the period that is high, between 0 and 1.
        duty: f64,
    },
    Saw,
    Noise {
        seed: u64,
    },
}

/// A waveform that repeats, or noise with a new height each period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Oscillator {
    pub(super) shape: Shape,
    /// In hertz, above 0.
    pub(super) hertz: Sweep,
    pub(super) amplitude: Sweep,
    pub(super) centre: Sweep,
    /// Periods that have passed at the start, -1 to 1.
    pub(super) phase: f64,
}

impl Oscillator {
    pub(super) fn new(shape: Shape) -> Self {
        let [hertz, amplitude, centre] = [1.0, 1.0, 0.0].map(Sweep::constant);
        Self { shape, hertz, amplitude, centre, phase: 0.0 }
    }

    pub(super) fn value(&self, moment: Moment) -> f64 {
        // The integral of the frequency: a sweep never jumps in phase.
        let periods = self.phase + self.hertz.mean_until(moment.part) * moment.time;
        self.centre.at(moment.part) + self.amplitude.at(moment.part) * self.shape.height(periods)
    }
}

impl Shape {
    /// The height, -1 to 1, after a number of periods.
    pub(super) fn height(self, periods: f64) -> f64 {
        let within = periods - periods.floor();
        match self {
            Self::Sine => (TAU * within).sin(),
            Self::Triangle => 1.0 - (4.0 * (within + 0.25).fract() - 2.0).abs(),
            Self::Square { duty } => {
                // A border that rounding puts just before a frame is at the frame.
                if (periods + 1e-9).rem_euclid(1.0) < duty { 1.0 } else { -1.0 }
            }
            Self::Saw => 2.0 * (periods + 1e-9).rem_euclid(1.0) - 1.0,
            Self::Noise { seed } => {
                let index = periods.floor() as i64;
                let (from, to) = (lattice(seed, index), lattice(seed, index.wrapping_add(1)));
                // Perlin's fade (2002): first and second derivative vanish at both ends.
                let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
                from * (1.0 - fade) + to * fade
            }
        }
    }
}

/// A height for each whole number of periods, uniform in -1 to 1: splitmix64.
fn lattice(seed: u64, index: i64) -> f64 {
    let mut state = mix(seed).wrapping_add(index as u64);
    state = mix(state);
    (state >> 11) as f64 / ((1_u64 << 53) - 1) as f64 * 2.0 - 1.0
}

fn mix(value: u64) -> u64 {
    let mut value = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_of_a_period_are_where_they_belong() {
        let quarters =
            |shape: Shape| [0.0, 0.25, 0.5, 0.75, 1.0].map(|p| (shape.height(p) * 1e9).round() / 1e9);
        assert_eq!(quarters(Shape::Sine), [0.0, 1.0, 0.0, -1.0, 0.0]);
        assert_eq!(quarters(Shape::Triangle), [0.0, 1.0, 0.0, -1.0, 0.0]);
        assert_eq!(quarters(Shape::Square { duty: 0.5 }), [1.0, 1.0, -1.0, -1.0, 1.0]);
        assert_eq!(quarters(Shape::Square { duty: 0.75 }), [1.0, 1.0, 1.0, -1.0, 1.0]);
        let saw = quarters(Shape::Saw);
        assert!(
            saw.iter().zip([-1.0, -0.5, 0.0, 0.5, -1.0]).all(|(got, want)| (got - want).abs() < 1e-8),
            "{saw:?}"
        );
        assert!((Shape::Triangle.height(0.125) - 0.5).abs() < 1e-12, "flanks are straight");
        assert_eq!(Shape::Triangle.height(-0.25), -1.0, "before the start as well");
    }

    #[test]
    fn noise_is_smooth_and_follows_its_seed() {
        let at = |seed, p: f64| Shape::Noise { seed }.height(p);
        let steps = (0..10_000).map(|i| f64::from(i) * 1e-3);
        assert!(
            steps.clone().all(|p| (at(1, p + 1e-3) - at(1, p)).abs() < 2.0 * 1.875 * 1.01e-3),
            "steepest slope"
        );
        assert!(steps.clone().all(|p| at(1, p).abs() <= 1.0));
        assert!(steps.clone().any(|p| (at(1, p) - at(2, p)).abs() > 0.5), "seeds differ");
        let heights: Vec<f64> = (0..1000).map(|i| at(7, f64::from(i))).collect();
        let mean = heights.iter().sum::<f64>() / 1000.0;
        assert!(mean.abs() < 0.06, "{mean}: three standard errors of a uniform mean");
        // Written down once: the same text must give the same motion in every version.
        assert_eq!(at(0, 0.0), 0.304_896_972_748_064_6);
    }
}
