//! Normal random numbers that depend on a seed and nothing else.

use std::f64::consts::TAU;

/// A stream of numbers: SplitMix64 (Steele et al. 2014), made normal by Box and Muller's rule.
#[derive(Debug, Clone)]
pub struct Noise {
    state: u64,
    second: Option<f32>,
}

impl Noise {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed, second: None }
    }

    /// Uniform from 0 to below 1, steps of 2^-53.
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        (mix(self.state) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal, mean 0, deviation 1.
    pub fn normal(&mut self) -> f32 {
        if let Some(second) = self.second.take() {
            return second;
        }
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        self.second = Some((radius * sin) as f32);
        (radius * cos) as f32
    }

    /// That many normal numbers.
    pub fn normals(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| self.normal()).collect()
    }
}

/// SplitMix64's way to spread a counter over all bits.
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_normal_and_belong_to_their_seed() {
        let numbers = Noise::new(7).normals(20_000);
        let mean = numbers.iter().sum::<f32>() / 20_000.0;
        let power = numbers.iter().map(|x| x * x).sum::<f32>() / 20_000.0;
        assert!(mean.abs() < 0.02 && (power - 1.0).abs() < 0.03, "{mean} {power}");
        assert_eq!(numbers[..5], Noise::new(7).normals(5));
        assert_ne!(numbers[..5], Noise::new(8).normals(5));
    }
}
