//! Timestep and guidance weight as vectors.

use super::Sizes;
use super::linear::Linear;
use crate::GenerateError;
use crate::numeric::elementwise::{add, silu};
use crate::weights::Tensors;

/// Ratio of the slowest wave to the quickest.
const PERIOD: f32 = 10_000.0;

/// Cosines of the timestep at `width / 2` frequencies, then sines.
pub fn timestep_waves(timestep: usize, width: usize) -> Vec<f32> {
    let half = width / 2;
    // Single precision in the order of the published code: weights were trained with these roundings.
    let frequency = |wave: usize| (-PERIOD.ln() * wave as f32 / half as f32).exp();
    let angle = |wave: usize| timestep as f32 * frequency(wave);
    (0..half).map(|wave| angle(wave).cos()).chain((0..half).map(|wave| angle(wave).sin())).collect()
}

/// Sines of a guidance weight at `width / 2` frequencies, then cosines. A distilled model takes the weight so, instead
/// of being run twice.
pub fn guidance_waves(weight: f32, width: usize) -> Vec<f32> {
    let half = width / 2;
    let step = (f64::from(PERIOD).ln() / (half as f64 - 1.0).max(1.0)) as f32;
    let angle = |wave: usize| 1000.0 * (weight - 1.0) * (-step * wave as f32).exp();
    (0..half).map(|wave| angle(wave).sin()).chain((0..half).map(|wave| angle(wave).cos())).collect()
}

/// Waves through two layers to a token.
#[derive(Debug, Clone)]
pub(crate) struct TimeEmbedding {
    pub(super) waves: usize,
    pub(super) guidance: Option<Linear>,
    pub(super) first: Linear,
    pub(super) second: Linear,
}

impl TimeEmbedding {
    pub(crate) fn new(weights: &Tensors, name: &str, sizes: &Sizes) -> Result<Self, GenerateError> {
        let (width, waves) = (sizes.width, sizes.text_width);
        let guidance = match sizes.guidance_width {
            0 => None,
            inputs => {
                let weight = weights.expect(&format!("{name}.cond_proj.weight"), &[waves, inputs])?;
                Some(Linear::of(weight, &vec![0.0; waves], inputs).at(weights, &format!("{name}.cond_proj")))
            }
        };
        Ok(Self {
            waves,
            guidance,
            first: Linear::new(weights, &format!("{name}.linear_1"), width, waves)?,
            second: Linear::new(weights, &format!("{name}.linear_2"), width, width)?,
        })
    }

    /// One token. `guidance` is the weight's waves, where the model takes them.
    pub(crate) fn token(&self, timestep: usize, guidance: Option<&[f32]>) -> Vec<f32> {
        let mut waves = timestep_waves(timestep, self.waves);
        if let (Some(projection), Some(guidance)) = (&self.guidance, guidance) {
            add(&mut waves, &projection.apply(guidance));
        }
        let mut token = self.first.apply(&waves);
        silu(&mut token);
        self.second.apply(&token)
    }
}
