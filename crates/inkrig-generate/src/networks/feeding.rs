//! A denoiser of feed-forward blocks on whole latents.
//!
//! Not in the papers. A latent of two tokens has nothing for attention to find: one row that holds latent, timestep and text is
//! denoised as well by blocks without it, which learn in minutes what the others take an hour for (docs/training.md has the figures). It says the
//! velocity (see `velocity.rs`). ControlNet and adapter copy blocks with attention, so control of it is by an estimate.

use super::Sizes;
use super::block::WeightGradients;
use super::branch_gradient::Samples;
use super::denoiser::Noisy;
use super::embedding::timestep_waves;
use super::linear::Linear;
use super::tokens::check_length;
use super::trunk::{Trunk, TrunkTape};
use super::velocity::{to_noise, to_noise_back};
use crate::GenerateError;
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;

/// Numbers that say the timestep.
const WAVES: usize = 128;

/// The layers.
#[derive(Debug, Clone)]
pub(super) struct Feeding {
    trunk: Trunk,
    velocity: Linear,
    schedule: NoiseSchedule,
    latent: usize,
    text: usize,
    guidance: usize,
}

/// What the way back needs of a forward pass.
#[derive(Debug, Clone, Default)]
pub(crate) struct FeedingTape {
    pub(super) trunk: TrunkTape,
    hidden: Vec<f32>,
}

impl Feeding {
    /// Takes `denoiser.denoiser.trunk.*` and `denoiser.denoiser.velocity`.
    pub(super) fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        sizes.check()?;
        let (latent, name) = (sizes.latent_tokens * sizes.width, "denoiser.denoiser");
        Ok(Self {
            trunk: Trunk::new(weights, &format!("{name}.trunk"), Self::inputs(sizes), sizes.trunk)?,
            velocity: Linear::new(weights, &format!("{name}.velocity"), latent, sizes.trunk)?,
            schedule: NoiseSchedule::default(),
            latent,
            text: sizes.text_width,
            guidance: sizes.guidance_width,
        })
    }

    /// Noisy latent, timestep, text; in distilled models the text's weight.
    pub(super) fn inputs(sizes: &Sizes) -> usize {
        sizes.latent_tokens * sizes.width + WAVES + sizes.text_width + sizes.guidance_width
    }

    /// The noise in each latent.
    ///
    /// # Errors
    /// When the numbers of latents, timesteps, texts or guidance do not fit each other.
    pub(super) fn run(&self, noisy: &Noisy<'_>) -> Result<Vec<f32>, GenerateError> {
        let samples = noisy.timesteps.len();
        for (what, numbers, width) in
            [("latents", noisy.latents.len(), self.latent), ("texts", noisy.texts.len(), self.text)]
        {
            if check_length(what, numbers, width, samples)? != samples {
                return Err(GenerateError::Length { what, expected: samples * width, got: numbers });
            }
        }
        let guidance = noisy.guidance.unwrap_or_default();
        if self.guidance > 0 && !guidance.is_empty() && guidance.len() != self.guidance {
            let (what, expected) = ("guidance embedding", self.guidance);
            return Err(GenerateError::Length { what, expected, got: guidance.len() });
        }
        let guidance = guidance.repeat(samples);
        let Noisy { latents, timesteps, texts, .. } = *noisy;
        let samples = Samples { latents, timesteps, texts, guidance: Some(&guidance) };
        Ok(self.forward(&samples, &mut FeedingTape::default()))
    }

    /// The noise in each latent. Numbers that do not fit each other are the caller's mistake.
    pub(super) fn forward(&self, samples: &Samples<'_>, tape: &mut FeedingTape) -> Vec<f32> {
        let each = self.latent + WAVES + self.text + self.guidance;
        let mut input = Vec::with_capacity(samples.timesteps.len() * each);
        let mut guidance = samples.guidance.unwrap_or_default().chunks_exact(self.guidance.max(1));
        let rows = samples.latents.chunks_exact(self.latent).zip(samples.texts.chunks_exact(self.text));
        for ((latent, text), &timestep) in rows.zip(samples.timesteps) {
            let end = input.len() + each;
            input.extend_from_slice(latent);
            input.extend(timestep_waves(timestep, WAVES));
            input.extend_from_slice(text);
            if self.guidance > 0 {
                input.extend_from_slice(guidance.next().unwrap_or_default());
            }
            // No weight is said.
            input.resize(end, 0.0);
        }
        tape.hidden = self.trunk.forward(input, &mut tape.trunk);
        let mut noise = self.velocity.apply(&tape.hidden);
        to_noise(&self.schedule, &mut noise, samples.latents, samples.timesteps);
        noise
    }

    /// From the gradient of the noise, which is used up, to those of the weights, added to theirs, and of the texts.
    pub(super) fn backward(
        &self,
        mut grad: Vec<f32>,
        timesteps: &[usize],
        tape: &FeedingTape,
        to: &mut WeightGradients<'_>,
    ) -> Vec<f32> {
        to_noise_back(&self.schedule, &mut grad, timesteps);
        self.velocity.weight_gradient(&tape.hidden, &grad, to.row, to.work);
        let mut hidden = vec![0.0; tape.hidden.len()];
        self.velocity.backward(&grad, &mut hidden, false);
        let input = self.trunk.backward(hidden, &tape.trunk, to);
        let rows = input.chunks_exact(self.latent + WAVES + self.text + self.guidance);
        rows.flat_map(|row| &row[self.latent + WAVES..][..self.text]).copied().collect()
    }
}
