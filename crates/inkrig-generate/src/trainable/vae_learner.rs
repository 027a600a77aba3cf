//! One step of the autoencoder on a device.

use super::device::TrainingDevice;
use super::mask::FrameMask;
use super::named::{add_gradients, number};
use super::vae::TrainableVae;
use super::vae_loss::{VaeLoss, VaeLossWeights};
use crate::GenerateError;
use crate::learning::{VaeLosses, VaeObjective};
use crate::networks::Sizes;
use crate::weights::Tensors;
use burn::tensor::{Device, Tensor, TensorData};
use inkrig_motion::humanml::WIDTH;

/// As [`crate::learning::VaeLearner`], with the same numbers in and out, by burn on a device. Weights and gradient travel at every step.
#[derive(Debug)]
pub struct DeviceVaeLearner {
    sizes: Sizes,
    weights: Tensors,
    device: Device,
}

impl DeviceVaeLearner {
    /// For a network of these sizes; `weights` holds the tensors of the VAE and no others.
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors, device: &TrainingDevice) -> Result<Self, GenerateError> {
        let device = device.burn().clone().autodiff();
        TrainableVae::new(sizes, weights, 0.0, &device)?;
        Ok(Self { sizes: sizes.clone(), weights: weights.clone(), device })
    }

    /// The loss of a batch at the weights `row`, and its gradient, which replaces what is in `gradient`: see
    /// [`crate::learning::VaeLearner::step`].
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
        let (tokens, width) = (self.sizes.latent_tokens, self.sizes.width);
        check(lengths, self.sizes.most_frames())?;
        let frames: usize = lengths.iter().sum();
        for (what, got, expected) in [
            ("features of clips", features.len(), frames * WIDTH),
            ("noise of latents", noise.len(), lengths.len() * tokens * width),
            ("statistics of features", objective.statistics.mean().len(), WIDTH),
        ] {
            if got != expected {
                return Err(GenerateError::Length { what, expected, got });
            }
        }
        let vae = TrainableVae::new(&self.sizes, &self.weights.with_row(row)?, 0.0, &self.device)?;
        let (mask, features) = self.padded(features, lengths);
        let (mean, log_variance) = vae.encode(features.clone(), &mask);
        let noise = TensorData::new(noise.to_vec(), [lengths.len(), tokens, width]);
        let noise = Tensor::from_data(noise, &self.device);
        let latents = TrainableVae::sample(mean.clone(), log_variance.clone(), noise, objective.noise);
        let decoded = vae.decode(&latents, &mask);
        let weights = VaeLossWeights {
            features: objective.features,
            places: objective.places,
            divergence: objective.divergence,
            padding_counts: false,
        };
        let loss =
            VaeLoss::new(decoded, features, (mean, log_variance), &mask, objective.statistics, &weights);
        let grads = loss.total.backward();
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        add_gradients(&vae, "vae", &grads, &self.weights, gradient)?;
        Ok(VaeLosses {
            total: number(loss.total)?,
            features: number(loss.features)?,
            places: number(loss.places)?,
            divergence: number(loss.divergence)?,
        })
    }

    /// Clips as long as the longest, zeros behind the ends of the others.
    fn padded(&self, features: &[f32], lengths: &[usize]) -> (FrameMask, Tensor<3>) {
        let (clips, most) = (lengths.len(), lengths.iter().copied().max().unwrap_or(0));
        let mut numbers = Vec::with_capacity(clips * most * WIDTH);
        let mut rest = features;
        for (clip, &length) in lengths.iter().enumerate() {
            let (own, others) = rest.split_at(length * WIDTH);
            rest = others;
            numbers.extend_from_slice(own);
            numbers.resize((clip + 1) * most * WIDTH, 0.0);
        }
        let table = TensorData::new(numbers, [clips, most, WIDTH]);
        (FrameMask::new(lengths, most), Tensor::from_data(table, &self.device))
    }
}

/// Clips have 1 to `most` frames, and there are some.
fn check(lengths: &[usize], most: usize) -> Result<(), GenerateError> {
    let what = "features of a clip";
    let wrong = lengths.iter().copied().find(|length| !(1..=most).contains(length));
    match wrong.or_else(|| lengths.is_empty().then_some(0)) {
        Some(length) => Err(GenerateError::Rows { what, numbers: length * WIDTH, width: WIDTH, most }),
        None => Ok(()),
    }
}
