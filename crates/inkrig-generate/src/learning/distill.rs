//! One step of distilling the denoiser for few steps (latent consistency, Luo et al. 2023; MotionLCM).

use crate::GenerateError;
use crate::networks::{Denoiser, DenoiserTape, Samples, Sizes, WaveTable, WeightGradients, guidance_waves};
use crate::numeric::product::OuterWork;
use crate::schedule::{NoiseSchedule, boundary};
use crate::weights::Tensors;

/// Samples of a batch, one after the other.
#[derive(Debug, Clone, Copy)]
pub struct DistillBatch<'a> {
    /// Latents with noise as after `starts`, samples x latent tokens x width.
    pub noisy: &'a [f32],
    /// Timesteps that the student goes from.
    pub starts: &'a [usize],
    /// Timesteps that the teacher goes to, each below its start.
    pub ends: &'a [usize],
    /// Samples x text width.
    pub texts: &'a [f32],
    /// How much more each text counts than nothing does.
    pub text_weights: &'a [f32],
}

/// Student, teacher, and buffers of a step.
#[derive(Debug)]
pub struct DistillLearner {
    sizes: Sizes,
    weights: Tensors,
    teacher: Denoiser,
    no_text: Vec<f32>,
    schedule: NoiseSchedule,
    waves: WaveTable,
    tape: DenoiserTape,
    other: DenoiserTape,
    work: OuterWork,
    /// Where the Huber distance turns from a square to a length.
    huber: f32,
}

impl DistillLearner {
    /// `sizes` are those of the student, whose weights `weights` holds, and no others; the teacher has no guidance embedding.
    ///
    /// # Errors
    /// When a weight is missing or of another shape, or the student takes no guidance weight.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        teacher: &Tensors,
        no_text: &[f32],
        huber: f32,
    ) -> Result<Self, GenerateError> {
        if sizes.guidance_width == 0 {
            let (setting, value) = ("guidance_width", "0".into());
            return Err(GenerateError::Setting { setting, value, needed: "above 0 for a distilled model" });
        }
        Denoiser::new(sizes, weights)?;
        let plain = Sizes { guidance_width: 0, ..sizes.clone() };
        Ok(Self {
            sizes: sizes.clone(),
            weights: weights.clone(),
            teacher: Denoiser::new(&plain, teacher)?,
            no_text: no_text.to_vec(),
            schedule: NoiseSchedule::default(),
            waves: WaveTable::new(sizes.text_width),
            tape: DenoiserTape::for_learning(),
            other: DenoiserTape::for_inputs(),
            work: OuterWork::default(),
            huber,
        })
    }

    /// The distance between what the student says of a latent and what the `target`, a mean of its weights along the way, says of the
    /// same latent after a step of the teacher; and its gradient, which replaces what is in `gradient`.
    ///
    /// # Errors
    /// When numbers do not fit each other.
    pub fn step(
        &mut self,
        row: &[f32],
        target: &[f32],
        batch: &DistillBatch<'_>,
        gradient: &mut Vec<f32>,
    ) -> Result<f64, GenerateError> {
        let count = batch.starts.len();
        let latent = self.sizes.latent_tokens * self.sizes.width;
        for (what, expected, got) in [
            ("latents", count * latent, batch.noisy.len()),
            ("ends of steps", count, batch.ends.len()),
            ("texts", count * self.sizes.text_width, batch.texts.len()),
            ("weights of texts", count, batch.text_weights.len()),
        ] {
            if expected != got || count == 0 {
                return Err(GenerateError::Length { what, expected, got });
            }
        }
        let guidance: Vec<f32> = batch
            .text_weights
            .iter()
            .flat_map(|&weight| guidance_waves(weight, self.sizes.guidance_width))
            .collect();
        let ahead = self.teach(batch);
        let samples =
            Samples { latents: &ahead, timesteps: batch.ends, texts: batch.texts, guidance: Some(&guidance) };
        let network = Denoiser::new(&self.sizes, &self.weights.with_row(target)?)?;
        let noise = network.forward_batch(&samples, &self.waves, None, &mut self.other);
        let wanted = self.consistent(&noise, &ahead, batch.ends);

        let student = Denoiser::new(&self.sizes, &self.weights.with_row(row)?)?;
        let samples = Samples { latents: batch.noisy, timesteps: batch.starts, ..samples };
        let mut noise = student.forward_batch(&samples, &self.waves, None, &mut self.tape);
        let said = self.consistent(&noise, batch.noisy, batch.starts);
        let (mut sum, huber) = (0.0, self.huber);
        let numbers = said.len() as f32;
        let rows = noise.chunks_exact_mut(latent);
        let pairs = said.chunks_exact(latent).zip(wanted.chunks_exact(latent));
        for ((x, (said, wanted)), &start) in rows.zip(pairs).zip(batch.starts) {
            let (_, out) = boundary(start);
            let alpha = self.schedule.alpha(start);
            // By how much the answer changes with the noise that is predicted.
            let factor = -out * ((1.0 - alpha) / alpha).sqrt() / numbers;
            for ((x, said), wanted) in x.iter_mut().zip(said).zip(wanted) {
                let apart = said - wanted;
                let length = (apart * apart + huber * huber).sqrt();
                sum += f64::from(length - huber);
                *x = factor * apart / length;
            }
        }
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        let mut to = WeightGradients { row: gradient, work: &mut self.work };
        student.backward_batch(noise, &samples, &mut self.tape, &mut to);
        Ok(sum / f64::from(numbers))
    }

    /// One step of the teacher, with text weighted, from start to end (DDIM).
    fn teach(&mut self, batch: &DistillBatch<'_>) -> Vec<f32> {
        let latent = self.sizes.latent_tokens * self.sizes.width;
        let nothing = self.no_text.repeat(batch.starts.len());
        let [with, without] = [batch.texts, &nothing].map(|texts| {
            let samples = Samples { latents: batch.noisy, timesteps: batch.starts, texts, guidance: None };
            self.teacher.forward_batch(&samples, &self.waves, None, &mut self.other)
        });
        let mut ahead = batch.noisy.to_vec();
        let rows = with.chunks_exact(latent).zip(without.chunks_exact(latent)).zip(batch.text_weights);
        let steps = batch.starts.iter().zip(batch.ends);
        for ((ahead, ((with, without), weight)), (&start, &end)) in
            ahead.chunks_exact_mut(latent).zip(rows).zip(steps)
        {
            let (from, to) = (self.schedule.alpha(start), self.schedule.alpha(end));
            for ((value, with), without) in ahead.iter_mut().zip(with).zip(without) {
                let noise = without + weight * (with - without);
                let clean = (*value - (1.0 - from).sqrt() * noise) / from.sqrt();
                *value = to.sqrt() * clean + (1.0 - to).sqrt() * noise;
            }
        }
        ahead
    }

    /// What a consistency model says of latents whose noise it predicts.
    fn consistent(&self, noise: &[f32], latents: &[f32], timesteps: &[usize]) -> Vec<f32> {
        let latent = self.sizes.latent_tokens * self.sizes.width;
        let rows = noise.chunks_exact(latent).zip(latents.chunks_exact(latent));
        let mut said = Vec::with_capacity(latents.len());
        for ((x, latents), &step) in rows.zip(timesteps) {
            let ((skip, out), alpha) = (boundary(step), self.schedule.alpha(step));
            let clean = |value: f32, noise: f32| (value - (1.0 - alpha).sqrt() * noise) / alpha.sqrt();
            said.extend(
                latents.iter().zip(x).map(|(&value, &noise)| out * clean(value, noise) + skip * value),
            );
        }
        said
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::check_gradient;
    use super::*;
    use crate::networks::Parts;
    use crate::schedule::Noise;
    use crate::weights::hashed;

    #[test]
    fn the_gradient_is_a_difference_in_every_tensor_and_a_step_of_nothing_is_none() {
        let attending = Sizes { latent_tokens: 2, velocity: true, ..Sizes::tiny() };
        let feeding = Sizes { trunk: 24, ..attending.clone() };
        [attending, feeding].iter().for_each(check);
    }

    fn check(sizes: &Sizes) {
        let parts = Parts { vae: false, denoiser: true, control: false, control_2d: false };
        let weights = hashed(sizes, parts);
        let no_text = Noise::new(6).normals(sizes.text_width);
        let plain = Sizes { guidance_width: 0, ..sizes.clone() };
        let teacher = hashed(&plain, parts);
        let mut learner = DistillLearner::new(sizes, &weights, &teacher, &no_text, 0.01).unwrap();
        let noisy = Noise::new(1).normals(2 * 2 * sizes.width);
        let texts = Noise::new(2).normals(2 * sizes.text_width);
        let batch = DistillBatch {
            noisy: &noisy,
            starts: &[39, 199],
            ends: &[19, 179],
            texts: &texts,
            text_weights: &[5.0, 9.0],
        };
        let target = weights.row();
        check_gradient(&weights, &[], |row| {
            let mut gradient = Vec::new();
            let loss = learner.step(row, &target, &batch, &mut gradient).unwrap();
            (loss, gradient)
        });
        let still = DistillBatch { ends: batch.starts, ..batch };
        let loss = learner.step(&target, &target, &still, &mut Vec::new()).unwrap();
        assert!(loss < 1e-6, "{loss}");
        assert!(DistillLearner::new(&plain, &teacher, &teacher, &no_text, 0.01).is_err());
    }
}
