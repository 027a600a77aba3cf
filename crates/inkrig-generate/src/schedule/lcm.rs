//! Few steps by a model that was distilled for them (latent consistency, Luo et al. 2023).

use super::betas::{NoiseSchedule, STEPS};
use crate::GenerateError;

/// Steps of the teacher, of which a few are chosen.
const ORIGIN: usize = 50;

/// One to fifty steps; 2 when nothing else is said: 999, 499.
#[derive(Debug, Clone, PartialEq)]
pub struct Lcm {
    schedule: NoiseSchedule,
    steps: usize,
}

impl Lcm {
    /// `steps` from 1 to 50.
    ///
    /// # Errors
    /// [`GenerateError::Setting`] for any other number.
    pub fn new(steps: usize) -> Result<Self, GenerateError> {
        if !(1..=ORIGIN).contains(&steps) {
            let (setting, value) = ("the number of denoising steps", steps.to_string());
            return Err(GenerateError::Setting { setting, value, needed: "1 to 50" });
        }
        Ok(Self { schedule: NoiseSchedule::default(), steps })
    }

    /// The steps of training at which noise is predicted, from most noise to least.
    pub fn timesteps(&self) -> Vec<usize> {
        let stride = STEPS / ORIGIN;
        (0..self.steps).map(|step| STEPS - 1 - step * ORIGIN / self.steps * stride).collect()
    }

    /// From the latent at `timestep` to the next, in place. `next` is the next timestep and fresh noise of the latent's
    /// length; without it this is the last step, and the latent is the result.
    pub fn step(&self, latent: &mut [f32], noise: &[f32], timestep: usize, next: Option<(usize, &[f32])>) {
        let alpha = self.schedule.alpha(timestep);
        let (keep, add) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        let (skip, out) = boundary(timestep);
        for (value, &noise) in latent.iter_mut().zip(noise) {
            *value = out * ((*value - add * noise) / keep) + skip * *value;
        }
        if let Some((next, fresh)) = next {
            self.schedule.add_noise(latent, fresh, next);
        }
    }

    /// Noise of each step of training.
    pub fn schedule(&self) -> &NoiseSchedule {
        &self.schedule
    }
}

/// How much of a latent, and of what is reckoned to be behind its noise, a consistency model's answer is made of: at no noise it is the
/// latent itself.
pub(crate) fn boundary(timestep: usize) -> (f32, f32) {
    let scaled = 10.0 * timestep as f32;
    (0.25 / (scaled * scaled + 0.25), scaled / (scaled * scaled + 0.25).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_chosen_from_the_teachers() {
        assert_eq!(Lcm::new(1).unwrap().timesteps(), [999]);
        assert_eq!(Lcm::new(2).unwrap().timesteps(), [999, 499]);
        assert_eq!(Lcm::new(4).unwrap().timesteps(), [999, 759, 499, 259]);
        assert_eq!(Lcm::new(50).unwrap().timesteps()[49], 19);
        assert!(Lcm::new(0).is_err() && Lcm::new(51).is_err());
    }
}
