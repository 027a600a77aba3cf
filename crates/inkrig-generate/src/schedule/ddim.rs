//! Denoising without new noise (Song et al. 2021), and the way back.

use super::betas::{NoiseSchedule, STEPS};
use crate::GenerateError;

/// Steps spaced evenly: 981, 961, ... 1 when there are 50.
#[derive(Debug, Clone, PartialEq)]
pub struct Ddim {
    schedule: NoiseSchedule,
    steps: usize,
}

impl Ddim {
    /// `steps` from 1 to 1000.
    ///
    /// # Errors
    /// [`GenerateError::Setting`] for any other number.
    pub fn new(steps: usize) -> Result<Self, GenerateError> {
        if !(1..=STEPS).contains(&steps) {
            let (setting, value) = ("the number of denoising steps", steps.to_string());
            return Err(GenerateError::Setting { setting, value, needed: "1 to 1000" });
        }
        Ok(Self { schedule: NoiseSchedule::default(), steps })
    }

    /// The steps of training at which noise is predicted, from most noise to least.
    pub fn timesteps(&self) -> Vec<usize> {
        (0..self.steps).rev().map(|step| (step * self.stride() + 1).min(STEPS - 1)).collect()
    }

    /// From the latent at `timestep` to the one before it, in place.
    pub fn step(&self, latent: &mut [f32], noise: &[f32], timestep: usize) {
        // The last step ends at the first of training, not at no noise at all.
        let next = timestep.saturating_sub(self.stride());
        self.go(latent, noise, self.schedule.alpha(timestep), self.schedule.alpha(next));
    }

    /// The other way: from the latent before `timestep` to the one at `timestep`, in place (Eq. 17).
    pub fn invert(&self, latent: &mut [f32], noise: &[f32], timestep: usize) {
        let before = timestep.saturating_sub(self.stride());
        self.go(latent, noise, self.schedule.alpha(before), self.schedule.alpha(timestep));
    }

    /// Noise of each step of training.
    pub fn schedule(&self) -> &NoiseSchedule {
        &self.schedule
    }

    fn stride(&self) -> usize {
        STEPS / self.steps
    }

    fn go(&self, latent: &mut [f32], noise: &[f32], from: f32, to: f32) {
        for (value, &noise) in latent.iter_mut().zip(noise) {
            let clean = (*value - (1.0 - from).sqrt() * noise) / from.sqrt();
            *value = to.sqrt() * clean + (1.0 - to).sqrt() * noise;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_the_same_noise_there_and_back_is_nothing() {
        let ddim = Ddim::new(50).unwrap();
        let (latent, noise) = ([0.3, -1.0], [0.5, 0.25]);
        for timestep in [981, 501, 1] {
            let mut there = latent;
            ddim.step(&mut there, &noise, timestep);
            ddim.invert(&mut there, &noise, timestep);
            assert!((there[0] - latent[0]).abs() < 1e-5 && (there[1] - latent[1]).abs() < 1e-5);
        }
        assert!(Ddim::new(0).is_err() && Ddim::new(1001).is_err());
    }
}
