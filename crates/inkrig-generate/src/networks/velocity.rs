//! From what comes out of the denoiser's blocks to the noise in latents, and back.
//!
//! As published, it is the noise. Blocks end in a layer norm, so that no token can have a mean, or another length than the others: at the
//! last timesteps, where a thousandth of the noise decides about the motion, that alone is an error of 1/100 of its power and
//! makes clips come apart. Of the velocity `v = sqrt(a) noise - sqrt(1 - a) clean` (Salimans and Ho 2022, Progressive distillation) the
//! noise is `sqrt(1 - a) noisy + sqrt(a) v`: what is known of it is not predicted, and a linear layer frees it of the norm.

use super::Sizes;
use super::block::WeightGradients;
use super::branch::Branch;
use super::linear::Linear;
use crate::GenerateError;
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;

/// The layer that says the velocity.
#[derive(Debug, Clone)]
pub(super) struct Velocity {
    layer: Linear,
    schedule: NoiseSchedule,
}

impl Velocity {
    /// None where the sizes say so.
    pub(super) fn new(sizes: &Sizes, weights: &Tensors) -> Result<Option<Self>, GenerateError> {
        if !sizes.velocity {
            return Ok(None);
        }
        let layer = Linear::new(weights, "denoiser.denoiser.velocity", sizes.width, sizes.width)?;
        Ok(Some(Self { layer, schedule: NoiseSchedule::default() }))
    }
}

/// Turns velocities into the noise in latents, in place.
pub(super) fn to_noise(schedule: &NoiseSchedule, velocity: &mut [f32], latents: &[f32], timesteps: &[usize]) {
    let each = (latents.len() / timesteps.len().max(1)).max(1);
    let rows = velocity.chunks_exact_mut(each).zip(latents.chunks_exact(each));
    for ((velocity, noisy), &step) in rows.zip(timesteps) {
        let alpha = schedule.alpha(step);
        let (keep, add) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        velocity.iter_mut().zip(noisy).for_each(|(x, noisy)| *x = keep * *x + add * noisy);
    }
}

/// Turns the gradient of a noise into that of the velocity that it was made of, in place.
pub(super) fn to_noise_back(schedule: &NoiseSchedule, grad: &mut [f32], timesteps: &[usize]) {
    let each = (grad.len() / timesteps.len().max(1)).max(1);
    for (grad, &step) in grad.chunks_exact_mut(each).zip(timesteps) {
        let keep = schedule.alpha(step).sqrt();
        grad.iter_mut().for_each(|grad| *grad *= keep);
    }
}

/// The denoiser as published: blocks with attention, and what comes out of them.
#[derive(Debug, Clone)]
pub(super) struct Attending {
    pub(super) branch: Branch,
    pub(super) velocity: Option<Velocity>,
}

impl Attending {
    /// The noise in latents, of what came out of the blocks (samples x tokens x width).
    pub(super) fn noise_of(&self, x: &[f32], latents: &[f32], timesteps: &[usize]) -> Vec<f32> {
        let own = self.own(x);
        let Some(velocity) = &self.velocity else { return own };
        let mut noise = velocity.layer.apply(&own);
        to_noise(&velocity.schedule, &mut noise, latents, timesteps);
        noise
    }

    /// From the gradient of the noise to that of what came out of the blocks; what the layer gets of it is added to its place.
    pub(super) fn noise_gradient(
        &self,
        x: &[f32],
        grad: &[f32],
        timesteps: &[usize],
        weights: Option<&mut WeightGradients<'_>>,
    ) -> Vec<f32> {
        let mut grad = grad.to_vec();
        if let Some(velocity) = &self.velocity {
            to_noise_back(&velocity.schedule, &mut grad, timesteps);
            let of_velocity = grad.clone();
            if let Some(to) = weights {
                velocity.layer.weight_gradient(&self.own(x), &of_velocity, to.row, to.work);
            }
            velocity.layer.backward(&of_velocity, &mut grad, false);
        }
        let latent = self.branch.sizes.latent_tokens * self.branch.sizes.width;
        let mut all = vec![0.0; x.len()];
        let rows = all.chunks_exact_mut(latent + 2 * self.branch.sizes.width);
        rows.zip(grad.chunks_exact(latent)).for_each(|(all, grad)| all[..latent].copy_from_slice(grad));
        all
    }

    /// The tokens of the latents among all.
    fn own(&self, x: &[f32]) -> Vec<f32> {
        let latent = self.branch.sizes.latent_tokens * self.branch.sizes.width;
        let samples = x.chunks_exact(latent + 2 * self.branch.sizes.width);
        samples.flat_map(|sample| &sample[..latent]).copied().collect()
    }
}
