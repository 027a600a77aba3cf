//! The linear path beside the autoencoder's blocks, as in [`crate::networks`]. It takes part in training, but is not learned.

use super::layers::Source;
use super::mask::FrameMask;
use super::named::parameter;
use crate::GenerateError;
use burn::module::{Module, Param};
use burn::nn::Linear;
use burn::tensor::Tensor;
use inkrig_motion::humanml::WIDTH;

#[derive(Module, Debug)]
pub(crate) struct LinearPath {
    encoder: Linear,
    decoder: Linear,
    log_variance: Param<Tensor<1>>,
    cosines: usize,
}

impl LinearPath {
    /// None where the sizes say so.
    pub(crate) fn new(source: Source<'_>) -> Result<Option<Self>, GenerateError> {
        let sizes = source.sizes;
        if sizes.cosines == 0 {
            return Ok(None);
        }
        let (latent, spectrum) = (sizes.latent_tokens * sizes.width, sizes.cosines * WIDTH);
        let name = "vae.linear_path";
        let path = Self {
            encoder: source.linear(&format!("{name}.encoder"), latent, spectrum)?,
            decoder: source.linear(&format!("{name}.decoder"), spectrum, latent)?,
            log_variance: parameter(
                source.weights,
                &format!("{name}.log_variance"),
                [latent],
                source.device,
            )?,
            cosines: sizes.cosines,
        };
        Ok(Some(path.no_grad()))
    }

    /// Adds its share to means and logarithms of variances, clips x latent tokens x width each.
    pub(crate) fn encode(
        &self,
        features: Tensor<3>,
        mask: &FrameMask,
        (mean, log_variance): (Tensor<3>, Tensor<3>),
    ) -> (Tensor<3>, Tensor<3>) {
        let device = features.device();
        let waves = mask.waves(self.cosines, &device) * mask.amplitudes(self.cosines, &device);
        let spectra: Tensor<2> =
            waves.swap_dims(1, 2).matmul(features).reshape([mask.clips(), self.cosines * WIDTH]);
        let [_, tokens, width] = mean.dims();
        let means = self.encoder.forward(spectra).reshape([mask.clips(), tokens, width]);
        (mean + means, log_variance + self.log_variance.val().reshape([1, tokens, width]))
    }

    /// Its share of decoded features, clips x frames x [`WIDTH`].
    pub(crate) fn decode(&self, latents: Tensor<3>, mask: &FrameMask) -> Tensor<3> {
        let device = latents.device();
        let [clips, tokens, width] = latents.dims();
        let spectra: Tensor<2> = self.decoder.forward(latents.reshape([clips, tokens * width]));
        mask.waves(self.cosines, &device).matmul(spectra.reshape([clips, self.cosines, WIDTH]))
    }
}
