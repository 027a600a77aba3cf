//! One step of the autoencoder (MLD, `train_vae_forward`): loss and gradient of a batch.

use crate::GenerateError;
use crate::guidance::Places;
use crate::networks::{Sizes, Vae, VaeTape};
use crate::weights::Tensors;
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH};

/// What the autoencoder is trained for. Frames that are not there do not count.
#[derive(Debug, Clone)]
pub struct VaeObjective<'a> {
    /// Weight of the smooth L1 distance of normalised features.
    pub features: f64,
    /// Of that of the joints' places, metres.
    pub places: f64,
    /// Of the Kullback-Leibler divergence from a normal distribution, a mean over all numbers of the latents.
    pub divergence: f64,
    /// Share of its noise that a latent gets; 1 in the paper.
    pub noise: f64,
    /// Of the features.
    pub statistics: &'a Statistics,
}

/// The weighted loss, and its parts without their weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VaeLosses {
    /// What is made small.
    pub total: f64,
    /// See [`VaeObjective::features`].
    pub features: f64,
    /// See [`VaeObjective::places`].
    pub places: f64,
    /// See [`VaeObjective::divergence`].
    pub divergence: f64,
}

/// Buffers of a step, and the weights as a row.
#[derive(Debug)]
pub struct VaeLearner {
    sizes: Sizes,
    weights: Tensors,
    tape: VaeTape,
    latents: Vec<f32>,
    grad_latents: Vec<f32>,
    grad_encoded: Vec<f32>,
    grad_features: Vec<f32>,
    places: [Places; 2],
    of_places: Vec<f64>,
    row: Vec<f32>,
}

impl VaeLearner {
    /// For a network of these sizes; `weights` holds the tensors of the VAE and no others. They may
    /// [prefer half precision](Tensors::prefer_half_precision).
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        Vae::new(sizes, weights)?;
        Ok(Self {
            sizes: sizes.clone(),
            weights: weights.clone(),
            tape: VaeTape::default(),
            latents: Vec::new(),
            grad_latents: Vec::new(),
            grad_encoded: Vec::new(),
            grad_features: Vec::new(),
            places: Default::default(),
            of_places: Vec::new(),
            row: Vec::new(),
        })
    }

    /// The loss of a batch at the weights `row`, and its gradient, which replaces what is in `gradient`.
    ///
    /// `features` are the normalised frames of one clip after the other, `lengths` says how many each has; `noise` are normal numbers, as
    /// many as the clips' latents have.
    ///
    /// # Errors
    /// When a row or a clip is of another length than it has to be.
    pub fn step(
        &mut self,
        row: &[f32],
        (features, lengths): (&[f32], &[usize]),
        noise: &[f32],
        objective: &VaeObjective<'_>,
        gradient: &mut Vec<f32>,
    ) -> Result<VaeLosses, GenerateError> {
        let vae = Vae::new(&self.sizes, &self.weights.with_row(row)?)?;
        let encoded = vae.encode_batch(features, lengths, &mut self.tape)?;
        if noise.len() != encoded.mean.len() {
            let (what, expected) = ("noise of latents", encoded.mean.len());
            return Err(GenerateError::Length { what, expected, got: noise.len() });
        }
        let share = objective.noise as f32;
        let rows = encoded.mean.iter().zip(&encoded.log_variance).zip(noise);
        self.latents.clear();
        self.latents.extend(
            rows.map(|((mean, log_variance), noise)| mean + share * (0.5 * log_variance).exp() * noise),
        );
        vae.decode_batch(&self.latents, lengths, &mut self.tape)?;

        let mut losses = self.features_and_places(features, lengths, objective)?;
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        self.grad_latents.clear();
        self.grad_latents.resize(self.latents.len(), 0.0);
        vae.decoder_gradient(
            &self.grad_features,
            &self.latents,
            lengths,
            &mut self.grad_latents,
            &mut self.tape,
            gradient,
        );
        let numbers = encoded.mean.len() as f64;
        let scale = (0.5 * objective.divergence / numbers) as f32;
        let mut sum = 0.0;
        self.grad_encoded.clear();
        let rows = encoded.mean.iter().zip(&encoded.log_variance).zip(noise).zip(&self.grad_latents);
        self.row.clear();
        for (((mean, log_variance), noise), grad) in rows {
            let variance = log_variance.exp();
            sum += f64::from(mean * mean + variance - log_variance - 1.0);
            self.grad_encoded.push(grad + scale * 2.0 * mean);
            self.row.push(0.5 * grad * share * variance.sqrt() * noise + scale * (variance - 1.0));
        }
        losses.divergence = 0.5 * sum / numbers;
        vae.encoder_gradient(features, lengths, (&self.grad_encoded, &self.row), &mut self.tape, gradient);
        losses.total = objective.features * losses.features
            + objective.places * losses.places
            + objective.divergence * losses.divergence;
        Ok(losses)
    }

    /// Both distances, and the gradient of what was decoded.
    fn features_and_places(
        &mut self,
        features: &[f32],
        lengths: &[usize],
        objective: &VaeObjective<'_>,
    ) -> Result<VaeLosses, GenerateError> {
        let mut losses = VaeLosses::default();
        let frames: usize = lengths.iter().sum();
        let counted = (frames * WIDTH) as f64;
        let scale = (objective.features / counted) as f32;
        self.grad_features.clear();
        for (decoded, wanted) in self.tape.features().iter().zip(features) {
            let apart = decoded - wanted;
            losses.features += f64::from(smooth_l1(apart));
            self.grad_features.push(scale * apart.clamp(-1.0, 1.0));
        }
        losses.features /= counted;

        let counted = (frames * 3 * JOINTS) as f64;
        let mut first = 0;
        for &length in lengths {
            let range = first * WIDTH..(first + length) * WIDTH;
            first += length;
            let [decoded, wanted] = &mut self.places;
            decoded.recover(&self.tape.features()[range.clone()], objective.statistics)?;
            wanted.recover(&features[range.clone()], objective.statistics)?;
            self.of_places.clear();
            for (decoded, wanted) in decoded.joints.iter().zip(&wanted.joints) {
                let apart = decoded - wanted;
                losses.places += f64::from(smooth_l1(apart as f32));
                self.of_places.push(objective.places / counted * apart.clamp(-1.0, 1.0));
            }
            decoded.gradient(&self.of_places, objective.statistics, &mut self.row);
            for (grad, more) in self.grad_features[range].iter_mut().zip(&self.row) {
                *grad += more;
            }
        }
        losses.places /= counted;
        Ok(losses)
    }
}

/// Half the square of a small difference, the size of a large one less one half.
fn smooth_l1(apart: f32) -> f32 {
    let size = apart.abs();
    let small = size.min(1.0);
    small * (size - 0.5 * small)
}

#[cfg(test)]
mod tests {
    use super::super::testing::check_gradient;
    use super::*;
    use crate::networks::Parts;
    use crate::schedule::Noise;
    use crate::weights::hashed;

    #[test]
    fn the_gradient_of_the_whole_loss_is_a_difference_in_every_tensor() {
        for latent_tokens in [1, 3] {
            let sizes = Sizes { latent_tokens, cosines: 5 * (latent_tokens - 1), ..Sizes::tiny() };
            let weights = hashed(&sizes, Parts::VAE);
            let mut learner = VaeLearner::new(&sizes, &weights).unwrap();
            let lengths = [7, 4];
            let features: Vec<f32> = Noise::new(1).normals(11 * WIDTH);
            let noise = Noise::new(2).normals(2 * latent_tokens * sizes.width);
            let deviation = Noise::new(9).normals(WIDTH).iter().map(|x| 0.1 + 0.1 * x.abs()).collect();
            let statistics = Statistics::new(vec![0.0; WIDTH], deviation).unwrap();
            let objective = VaeObjective {
                features: 1.0,
                places: 20.0,
                divergence: 0.1,
                noise: 0.7,
                statistics: &statistics,
            };
            let mut run = |row: &[f32]| {
                let mut gradient = Vec::new();
                let losses =
                    learner.step(row, (&features, &lengths), &noise, &objective, &mut gradient).unwrap();
                (losses.total, gradient)
            };
            // Keys have no say in a softmax over one, nor does their bias in any; the linear path is not learned.
            check_gradient(&weights, &["multihead_attn.in_proj", ".pe", "linear_path"], &mut run);
        }
    }
}
