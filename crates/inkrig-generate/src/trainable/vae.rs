//! The variational autoencoder, for training.

use super::layers::{Positions, Source, Stack};
use super::linear_path::LinearPath;
use super::mask::FrameMask;
use super::named::{parameter, to_tensors};
use crate::GenerateError;
use crate::networks::Sizes;
use crate::weights::Tensors;
use burn::module::{Module, Param};
use burn::nn::Linear;
use burn::tensor::{Device, Tensor};
use inkrig_motion::humanml::WIDTH;

/// Encoder and decoder, equal to [`crate::networks::Vae`] when nothing is dropped out.
#[derive(Module, Debug)]
pub struct TrainableVae {
    global_motion_token: Param<Tensor<2>>,
    query_pos_encoder: Positions,
    encoder: Stack,
    query_pos_decoder: Positions,
    decoder: Stack,
    skel_embedding: Linear,
    final_layer: Linear,
    linear_path: Option<LinearPath>,
    latent_tokens: usize,
}

impl TrainableVae {
    /// Takes the weights that are named `vae.*`; `dropout` from 0 to below 1 is the share of numbers that training drops.
    /// On a device with `autodiff()` it can be trained.
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        sizes.check()?;
        if !(0.0..1.0).contains(&dropout) {
            let (setting, value) = ("dropout", dropout.to_string());
            return Err(GenerateError::Setting { setting, value, needed: "from 0 to below 1" });
        }
        let source = Source { weights, sizes, dropout, device };
        let tokens = [2 * sizes.latent_tokens, sizes.width];
        Ok(Self {
            global_motion_token: parameter(weights, "vae.global_motion_token", tokens, device)?,
            query_pos_encoder: source.positions("vae.query_pos_encoder")?,
            encoder: source.stack("vae.encoder", sizes.vae_blocks, false)?,
            query_pos_decoder: source.positions("vae.query_pos_decoder")?,
            decoder: source.stack("vae.decoder", sizes.vae_blocks, true)?,
            skel_embedding: source.linear("vae.skel_embedding", sizes.width, WIDTH)?,
            final_layer: source.linear("vae.final_layer", WIDTH, sizes.width)?,
            linear_path: LinearPath::new(source)?,
            latent_tokens: sizes.latent_tokens,
        })
    }

    /// Means and logarithms of variances, clips x latent tokens x width each, of normalised features: clips x frames x
    /// [`WIDTH`]. What padded frames hold is of no consequence.
    pub fn encode(&self, features: Tensor<3>, mask: &FrameMask) -> (Tensor<3>, Tensor<3>) {
        let device = features.device();
        let [clips, frames, _] = features.dims();
        let tokens = 2 * self.latent_tokens;
        let own = self.global_motion_token.val().unsqueeze::<3>().repeat_dim(0, clips);
        let x = Tensor::cat(vec![own, self.skel_embedding.forward(features.clone())], 1);
        let x = x + self.query_pos_encoder.rows(tokens + frames);
        let x = self.encoder.forward(x, mask.bias(tokens, &device).as_ref(), None);
        let n = self.latent_tokens;
        let (mean, log_variance) = (x.clone().narrow(1, 0, n), x.narrow(1, n, n));
        match &self.linear_path {
            Some(path) => path.encode(features, mask, (mean, log_variance)),
            None => (mean, log_variance),
        }
    }

    /// Features of latents; padded frames are zero.
    pub fn decode(&self, latents: &Tensor<3>, mask: &FrameMask) -> Tensor<3> {
        let device = latents.device();
        let clips = latents.dims()[0];
        let x = self.query_pos_decoder.rows(mask.frames()).repeat_dim(0, clips);
        let x = self.decoder.forward(x, mask.bias(0, &device).as_ref(), Some(latents));
        let features = self.final_layer.forward(x);
        let features = match &self.linear_path {
            Some(path) => features + path.decode(latents.clone(), mask),
            None => features,
        };
        match mask.keep(&device) {
            Some(keep) => features * keep,
            None => features,
        }
    }

    /// A latent drawn from what [`Self::encode`] gave: the mean plus `scale` times deviation times `noise`, which is
    /// normal and of the mean's shape. `scale` is 1 in the paper; training may begin with less.
    pub fn sample(mean: Tensor<3>, log_variance: Tensor<3>, noise: Tensor<3>, scale: f64) -> Tensor<3> {
        mean + (log_variance * 0.5).exp() * noise * scale
    }

    /// All weights by their published names, for [`crate::networks::Vae`] or a file.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self) -> Result<Tensors, GenerateError> {
        to_tensors(self, "vae")
    }
}
