//! A linear path beside the autoencoder's blocks: a clip's features as cosines over its time, and a matrix from these to the
//! latent and one back.
//!
//! Not in the papers. With an hour of motion instead of 28, the blocks alone had not found in 3,500 steps what principal
//! components know at once; with this path they learn what is left over. Clips of any length have the same cosines, so
//! the path takes them all. It is not learned by descent: its matrices come from the corpus before the first step.

use super::Sizes;
use super::linear::Linear;
use super::vae::Encoded;
use crate::GenerateError;
use crate::weights::Tensors;
use inkrig_motion::humanml::WIDTH;
use std::f64::consts::PI;

/// Both matrices, and what is added to the logarithm of the latent's variance.
#[derive(Debug, Clone)]
pub(super) struct LinearPath {
    cosines: usize,
    encoder: Linear,
    decoder: Linear,
    log_variance: Vec<f32>,
}

impl LinearPath {
    /// None where the sizes say so.
    pub(super) fn new(sizes: &Sizes, weights: &Tensors) -> Result<Option<Self>, GenerateError> {
        let (latent, spectrum) = (sizes.latent_tokens * sizes.width, sizes.cosines * WIDTH);
        if sizes.cosines == 0 {
            return Ok(None);
        }
        let layer = |name: &str, outputs, inputs| -> Result<Linear, GenerateError> {
            let weight = weights.expect(&format!("{name}.weight"), &[outputs, inputs])?;
            let bias = weights.expect(&format!("{name}.bias"), &[outputs])?;
            // Always in full precision: it costs nothing beside the blocks, and they are to learn no rounding.
            Ok(Linear::of(weight, bias, inputs))
        };
        Ok(Some(Self {
            cosines: sizes.cosines,
            encoder: layer("vae.linear_path.encoder", latent, spectrum)?,
            decoder: layer("vae.linear_path.decoder", spectrum, latent)?,
            log_variance: weights.expect("vae.linear_path.log_variance", &[latent])?.to_vec(),
        }))
    }

    /// Adds its share to what the blocks say of clips.
    pub(super) fn encode(&self, features: &[f32], lengths: &[usize], encoded: &mut Encoded) {
        let mut spectra = Vec::with_capacity(lengths.len() * self.cosines * WIDTH);
        let mut rest = features;
        for &frames in lengths {
            let (own, others) = rest.split_at(frames * WIDTH);
            rest = others;
            spectra.extend(spectrum(own, self.cosines));
        }
        let means = self.encoder.apply(&spectra);
        encoded.mean.iter_mut().zip(means).for_each(|(mean, more)| *mean += more);
        for clip in encoded.log_variance.chunks_exact_mut(self.log_variance.len()) {
            clip.iter_mut().zip(&self.log_variance).for_each(|(own, more)| *own += more);
        }
    }

    /// Adds its share to decoded features.
    pub(super) fn decode(&self, latents: &[f32], lengths: &[usize], features: &mut [f32]) {
        let spectra = self.decoder.apply(latents);
        let mut rest = features;
        for (&frames, spectrum) in lengths.iter().zip(spectra.chunks_exact(self.cosines * WIDTH)) {
            let (own, others) = rest.split_at_mut(frames * WIDTH);
            rest = others;
            let waves = waves(frames, self.cosines);
            for (row, waves) in own.chunks_exact_mut(WIDTH).zip(waves.chunks_exact(self.cosines)) {
                for (wave, amplitudes) in waves.iter().zip(spectrum.chunks_exact(WIDTH)) {
                    row.iter_mut().zip(amplitudes).for_each(|(x, amplitude)| *x += wave * amplitude);
                }
            }
        }
    }

    /// From the gradient of decoded features to that of the latents, added.
    pub(super) fn backward(&self, grad_features: &[f32], lengths: &[usize], grad_latents: &mut [f32]) {
        let mut spectra = vec![0.0; lengths.len() * self.cosines * WIDTH];
        let mut rest = grad_features;
        for (&frames, spectrum) in lengths.iter().zip(spectra.chunks_exact_mut(self.cosines * WIDTH)) {
            let (own, others) = rest.split_at(frames * WIDTH);
            rest = others;
            add_products(own, &waves(frames, self.cosines), spectrum);
        }
        self.decoder.backward(&spectra, grad_latents, true);
    }
}

/// Amplitudes of `cosines` cosines over a clip's time, for each of its features: the sum of all, at every frame, is the clip
/// with what is quicker than the last of them left out. `features` are frames x [`WIDTH`] numbers, the result is
/// `cosines` x [`WIDTH`]. A clip of fewer frames than cosines has 0 for the rest.
pub fn spectrum(features: &[f32], cosines: usize) -> Vec<f32> {
    let frames = features.len() / WIDTH;
    let mut waves = waves(frames, cosines);
    for row in waves.chunks_exact_mut(cosines) {
        for (at, wave) in row.iter_mut().enumerate() {
            *wave *= if at == 0 { 1.0 } else { 2.0 } / frames as f32;
        }
    }
    let mut spectrum = vec![0.0; cosines * WIDTH];
    add_products(features, &waves, &mut spectrum);
    spectrum
}

/// Frames x `cosines`: `cos(pi k (t + 1/2) / frames)`, 0 where a clip is too short for a wave.
pub(crate) fn waves(frames: usize, cosines: usize) -> Vec<f32> {
    let mut waves = Vec::with_capacity(frames * cosines);
    for frame in 0..frames {
        let wave = |k: usize| (PI * k as f64 * (frame as f64 + 0.5) / frames as f64).cos() as f32;
        waves.extend((0..cosines).map(|k| if k < frames { wave(k) } else { 0.0 }));
    }
    waves
}

/// Adds, for each wave, the frames' rows times its values at them.
fn add_products(rows: &[f32], waves: &[f32], out: &mut [f32]) {
    let cosines = out.len() / WIDTH;
    for (row, waves) in rows.chunks_exact(WIDTH).zip(waves.chunks_exact(cosines.max(1))) {
        for (wave, out) in waves.iter().zip(out.chunks_exact_mut(WIDTH)) {
            out.iter_mut().zip(row).for_each(|(out, x)| *out += wave * x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::testing::{apart, numbers};

    #[test]
    fn as_many_cosines_as_frames_lose_nothing() {
        for (frames, cosines) in [(9, 9), (5, 8)] {
            let features = numbers(1, frames * WIDTH);
            let spectrum = spectrum(&features, cosines);
            let mut back = vec![0.0; features.len()];
            let waves = waves(frames, cosines);
            for (row, waves) in back.chunks_exact_mut(WIDTH).zip(waves.chunks_exact(cosines)) {
                for (wave, own) in waves.iter().zip(spectrum.chunks_exact(WIDTH)) {
                    row.iter_mut().zip(own).for_each(|(x, own)| *x += wave * own);
                }
            }
            assert!(apart(&back, &features) < 1e-5, "{frames}");
        }
    }

    #[test]
    fn a_steady_feature_has_the_first_cosine_alone_at_any_length() {
        for frames in [20, 120] {
            let spectrum = spectrum(&vec![3.0; frames * WIDTH], 12);
            assert!(spectrum[..WIDTH].iter().all(|x| (x - 3.0).abs() < 1e-5));
            assert!(spectrum[WIDTH..].iter().all(|x| x.abs() < 1e-5));
        }
    }
}
