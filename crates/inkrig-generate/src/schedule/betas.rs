//! The noise that training adds at each of a thousand steps.

/// Steps of noise in training.
pub const STEPS: usize = 1000;

/// Square roots of the first and last rate of noise.
const ROOTS: [f32; 2] = [0.029_154_76, 0.109_544_516];

/// The "scaled linear" schedule: roots of the rates rise evenly, rates from 0.00085 to 0.012.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseSchedule {
    betas: Vec<f32>,
    alphas: Vec<f32>,
}

impl Default for NoiseSchedule {
    fn default() -> Self {
        let betas: Vec<f32> = (0..STEPS).map(|step| root(step) * root(step)).collect();
        let left = betas.iter().scan(1.0_f64, |product, &beta| {
            *product *= f64::from(1.0 - beta);
            Some(*product as f32)
        });
        Self { alphas: left.collect(), betas }
    }
}

impl NoiseSchedule {
    /// The rate of noise of each step.
    pub fn betas(&self) -> &[f32] {
        &self.betas
    }

    /// How much of the signal's power is left after each step: products of 1 - beta.
    pub fn alphas(&self) -> &[f32] {
        &self.alphas
    }

    /// That after `step`; steps beyond the last are the last.
    pub fn alpha(&self, step: usize) -> f32 {
        self.alphas[step.min(STEPS - 1)]
    }

    /// A latent with noise as after `step`.
    pub fn add_noise(&self, latent: &mut [f32], noise: &[f32], step: usize) {
        let alpha = self.alpha(step);
        let (keep, add) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        for (value, noise) in latent.iter_mut().zip(noise) {
            *value = keep * *value + add * noise;
        }
    }

    /// What a noisy latent would be without the noise that was predicted in it.
    pub fn clean(&self, latent: &[f32], noise: &[f32], step: usize, out: &mut [f32]) {
        let alpha = self.alpha(step);
        let (keep, add) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        for ((out, value), noise) in out.iter_mut().zip(latent).zip(noise) {
            *out = (value - add * noise) / keep;
        }
    }
}

/// Evenly spaced from both ends in single precision, as in PyTorch, whose sums the published weights were trained with.
fn root(step: usize) -> f32 {
    let width = (ROOTS[1] - ROOTS[0]) / (STEPS - 1) as f32;
    if step < STEPS / 2 {
        ROOTS[0] + width * step as f32
    } else {
        ROOTS[1] - width * (STEPS - 1 - step) as f32
    }
}
