//! One step of the denoiser and the vectors of verbs: loss and gradient of a batch.

use crate::GenerateError;
use crate::networks::{Denoiser, DenoiserTape, Dropout, Samples, Sizes, WaveTable, WeightGradients};
use crate::numeric::elementwise::add;
use crate::numeric::product::OuterWork;
use crate::text::VerbTable;
use crate::weights::Tensors;

/// Noisy latents with the verbs that they are of.
#[derive(Debug, Clone, Copy)]
pub struct NoisyVerbs<'a> {
    /// Samples x latent tokens x width.
    pub latents: &'a [f32],
    /// The noise in them.
    pub noise: &'a [f32],
    /// One for each sample, from 0 to 999.
    pub timesteps: &'a [usize],
    /// Places in the list of verbs; none for samples without text.
    pub verbs: &'a [Option<usize>],
}

/// Buffers of a step.
#[derive(Debug)]
pub struct DenoiserLearner {
    sizes: Sizes,
    weights: Tensors,
    waves: WaveTable,
    tape: DenoiserTape,
    work: OuterWork,
}

impl DenoiserLearner {
    /// For a network of these sizes; `weights` holds the tensors of the denoiser and of the verbs, and no others.
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        Denoiser::new(sizes, weights)?;
        VerbTable::new(weights, sizes.text_width)?;
        Ok(Self {
            sizes: sizes.clone(),
            weights: weights.clone(),
            waves: WaveTable::new(sizes.text_width),
            tape: DenoiserTape::for_learning(),
            work: OuterWork::default(),
        })
    }

    /// The mean squared error of what is predicted (noise, or velocity where the sizes say so) at the weights `row`, and its gradient, which replaces what is in
    /// `gradient`. `dropout` is the share of numbers that blocks drop, and which they are.
    ///
    /// # Errors
    /// When numbers do not fit each other.
    pub fn step(
        &mut self,
        row: &[f32],
        batch: &NoisyVerbs<'_>,
        dropout: Option<(f32, u64)>,
        gradient: &mut Vec<f32>,
    ) -> Result<f64, GenerateError> {
        let weights = self.weights.with_row(row)?;
        let denoiser = Denoiser::new(&self.sizes, &weights)?;
        let (count, text) = (batch.timesteps.len(), self.sizes.text_width);
        let latent = self.sizes.latent_tokens * self.sizes.width;
        for (what, expected, got) in [
            ("latents", count * latent, batch.latents.len()),
            ("noise of latents", count * latent, batch.noise.len()),
            ("verbs of samples", count, batch.verbs.len()),
        ] {
            if expected != got || count == 0 {
                return Err(GenerateError::Length { what, expected, got });
            }
        }
        let of_verbs = weights.place(VerbTable::VERBS);
        let nothing = weights.place(VerbTable::NOTHING);
        let rows = weights.get(VerbTable::VERBS).map_or(0, |table| table.data().len() / text);
        let place = |verb: &Option<usize>| {
            verb.filter(|verb| *verb < rows).map_or(nothing, |verb| of_verbs + verb * text)
        };
        let places: Vec<usize> = batch.verbs.iter().map(place).collect();
        let texts: Vec<f32> = places.iter().flat_map(|&place| &row[place..place + text]).copied().collect();
        let (latents, timesteps) = (batch.latents, batch.timesteps);
        let samples = Samples { latents, timesteps, texts: &texts, guidance: None };
        self.tape.set_dropout(dropout.map(|(share, seed)| Dropout { share, seed }));
        let mut predicted = denoiser.forward_batch(&samples, &self.waves, None, &mut self.tape);
        let mut sum = 0.0;
        let rows = predicted.chunks_exact_mut(latent).zip(batch.noise.chunks_exact(latent));
        for ((predicted, noise), &timestep) in rows.zip(timesteps) {
            let weight = denoiser.loss_weight(timestep);
            let scale = 2.0 * weight / (count * latent) as f32;
            for (x, noise) in predicted.iter_mut().zip(noise) {
                let apart = *x - noise;
                sum += f64::from(weight * apart) * f64::from(apart);
                *x = scale * apart;
            }
        }
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        let mut to = WeightGradients { row: gradient, work: &mut self.work };
        let texts = denoiser.backward_batch(predicted, &samples, &mut self.tape, &mut to);
        for (place, grad) in places.into_iter().zip(texts.chunks_exact(text)) {
            add(&mut gradient[place..place + text], grad);
        }
        Ok(sum / (count * latent) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::check_gradient;
    use super::*;
    use crate::networks::Parts;
    use crate::schedule::Noise;
    use crate::weights::{Tensor, hashed};

    #[test]
    fn the_gradient_is_a_difference_in_every_tensor() {
        let attending = Sizes { latent_tokens: 2, guidance_width: 0, velocity: true, ..Sizes::tiny() };
        let feeding = Sizes { trunk: 24, ..attending.clone() };
        [attending, feeding].iter().for_each(check);
    }

    fn check(sizes: &Sizes) {
        let parts = Parts { vae: false, denoiser: true, control: false, control_2d: false };
        let mut weights = hashed(sizes, parts);
        let text = sizes.text_width;
        weights
            .insert(VerbTable::VERBS, Tensor::new(vec![3, text], Noise::new(5).normals(3 * text)).unwrap());
        weights.insert(VerbTable::NOTHING, Tensor::new(vec![text], Noise::new(6).normals(text)).unwrap());
        let mut learner = DenoiserLearner::new(sizes, &weights).unwrap();
        let numbers = 3 * 2 * sizes.width;
        let (latents, noise) = (Noise::new(1).normals(numbers), Noise::new(2).normals(numbers));
        let batch = NoisyVerbs {
            latents: &latents,
            noise: &noise,
            timesteps: &[10, 500, 999],
            verbs: &[Some(0), None, Some(2)],
        };
        for dropout in [None, Some((0.2, 7))] {
            check_gradient(&weights, &[], |row| {
                let mut gradient = Vec::new();
                let loss = learner.step(row, &batch, dropout, &mut gradient).unwrap();
                (loss, gradient)
            });
        }
        let short = NoisyVerbs { verbs: &[None], ..batch };
        assert!(learner.step(&weights.row(), &short, None, &mut Vec::new()).is_err());
    }
}
