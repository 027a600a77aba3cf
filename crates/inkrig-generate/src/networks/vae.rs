//! The variational autoencoder: a clip becomes a few latent tokens, and these a clip.

use super::Sizes;
use super::block::Layout;
use super::linear::Linear;
use super::linear_path::LinearPath;
use super::names::Parts;
use super::stack::{Ending, Stack, StackTape};
use super::tokens::{check_length, positions};
use crate::GenerateError;
use crate::weights::Tensors;
use inkrig_motion::humanml::WIDTH;

/// Encoder and decoder. Features are normalised rows of [`WIDTH`] numbers, a latent is `latent_tokens x width` numbers.
#[derive(Debug, Clone)]
pub struct Vae {
    pub(super) sizes: Sizes,
    pub(super) tokens: Vec<f32>,
    pub(super) encoder_positions: Vec<f32>,
    pub(super) embed: Linear,
    pub(super) encoder: Stack,
    pub(super) decoder_positions: Vec<f32>,
    pub(super) decoder: Stack,
    pub(super) last: Linear,
    pub(super) path: Option<LinearPath>,
    pub(super) places: TablePlaces,
}

/// Where the gradients of tables that are no layers begin in the row of all.
#[derive(Debug, Clone, Copy)]
pub(super) struct TablePlaces {
    pub(super) tokens: usize,
    pub(super) encoder_positions: usize,
    pub(super) decoder_positions: usize,
}

/// What the encoder says of a clip: a normal distribution for each number of the latent.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoded {
    /// Its mean.
    pub mean: Vec<f32>,
    /// The logarithm of its variance.
    pub log_variance: Vec<f32>,
}

/// Buffers of a decoding, kept from one to the next; after it, what its gradient needs.
#[derive(Debug, Clone, Default)]
pub struct Decoding {
    tape: StackTape,
    tokens: Vec<f32>,
    features: Vec<f32>,
    latent: Vec<f32>,
    gradient: Vec<f32>,
    lengths: Vec<usize>,
}

impl Decoding {
    /// What was decoded: frames x [`WIDTH`] numbers, normalised, of one clip after the other.
    pub fn features(&self) -> &[f32] {
        &self.features
    }
}

impl Vae {
    /// Takes the weights that are named `vae.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        sizes.check()?;
        let tokens = weights.expect("vae.global_motion_token", &[2 * sizes.latent_tokens, sizes.width])?;
        let stack = |name, memory| Stack::new(weights, name, sizes, sizes.vae_blocks, memory, Ending::Norm);
        Ok(Self {
            tokens: tokens.to_vec(),
            encoder_positions: positions(weights, "vae.query_pos_encoder.pe", sizes)?,
            embed: Linear::new(weights, "vae.skel_embedding", sizes.width, WIDTH)?,
            encoder: stack("vae.encoder", false)?,
            decoder_positions: positions(weights, "vae.query_pos_decoder.pe", sizes)?,
            decoder: stack("vae.decoder", true)?,
            last: Linear::new(weights, "vae.final_layer", WIDTH, sizes.width)?,
            path: LinearPath::new(sizes, weights)?,
            places: TablePlaces {
                tokens: weights.place("vae.global_motion_token"),
                encoder_positions: weights.place("vae.query_pos_encoder.pe"),
                decoder_positions: weights.place("vae.query_pos_decoder.pe"),
            },
            sizes: sizes.clone(),
        })
    }

    /// The tensors that [`Self::new`] takes.
    pub const PARTS: Parts = Parts::VAE;

    /// The sizes that it was made with.
    pub fn sizes(&self) -> &Sizes {
        &self.sizes
    }

    /// Decodes by the linear path alone, where there is one: nearly the same for a hundredth of the work.
    ///
    /// # Errors
    /// As [`Self::decode`].
    pub(crate) fn decode_quickly(
        &self,
        latents: &[f32],
        lengths: &[usize],
        decoding: &mut Decoding,
    ) -> Result<(), GenerateError> {
        let Some(path) = &self.path else { return self.decode(latents, lengths, decoding) };
        for &frames in lengths {
            check_length("frames of a clip", frames, 1, self.sizes.most_frames())?;
        }
        let expected = lengths.len() * self.latent_width();
        if latents.len() != expected {
            return Err(GenerateError::Length { what: "latents of clips", expected, got: latents.len() });
        }
        decoding.features.clear();
        decoding.features.resize(lengths.iter().sum::<usize>() * WIDTH, 0.0);
        decoding.lengths.clear();
        decoding.lengths.extend_from_slice(lengths);
        path.decode(latents, lengths, &mut decoding.features);
        Ok(())
    }

    /// From the gradient of what was decoded so to that of the latents.
    ///
    /// # Errors
    /// As [`Self::gradient`].
    pub(crate) fn gradient_quickly(
        &self,
        grad_features: &[f32],
        decoding: &mut Decoding,
    ) -> Result<Vec<f32>, GenerateError> {
        let Some(path) = &self.path else { return Ok(self.gradient(grad_features, decoding)?.to_vec()) };
        let mut latents = vec![0.0; decoding.lengths.len() * self.latent_width()];
        path.backward(grad_features, &decoding.lengths, &mut latents);
        Ok(latents)
    }

    /// Numbers of a clip's latent.
    pub fn latent_width(&self) -> usize {
        self.sizes.latent_tokens * self.sizes.width
    }

    /// Encodes one clip.
    ///
    /// # Errors
    /// When the rows are not whole, or there are none or more than the positional table has.
    pub fn encode(&self, features: &[f32]) -> Result<Encoded, GenerateError> {
        let frames = check_length("features of a clip", features.len(), WIDTH, self.sizes.most_frames())?;
        let mut x = self.tokens.clone();
        x.extend(self.embed.apply(features));
        x.iter_mut().zip(&self.encoder_positions).for_each(|(x, position)| *x += position);
        let lengths = [2 * self.sizes.latent_tokens + frames];
        let layout = Layout { lengths: &lengths, memory: None };
        self.encoder.forward(&mut x, layout, None, None, &mut StackTape::default());
        x.truncate(2 * self.latent_width());
        let log_variance = x.split_off(self.latent_width());
        let mut encoded = Encoded { mean: x, log_variance };
        if let Some(path) = &self.path {
            path.encode(features, &[frames], &mut encoded);
        }
        Ok(encoded)
    }

    /// Decodes latents, one after the other in `latents`, each to as many frames as `frames` says.
    ///
    /// # Errors
    /// When the numbers of latents and lengths differ, or a length is 0 or more than the positional table has.
    pub fn decode(
        &self,
        latents: &[f32],
        frames: &[usize],
        work: &mut Decoding,
    ) -> Result<(), GenerateError> {
        let most = self.sizes.most_frames();
        for &frames in frames {
            check_length("frames of a clip", frames, 1, most)?;
        }
        let width = self.latent_width();
        let clips = check_length("latent of a clip", latents.len(), width, frames.len())?;
        check_length("lengths of clips", frames.len(), 1, clips)?;
        let (x, per_frame) = (&mut work.tokens, self.sizes.width);
        x.clear();
        for &frames in frames {
            x.extend_from_slice(&self.decoder_positions[..frames * per_frame]);
        }
        work.lengths.clear();
        work.lengths.extend_from_slice(frames);
        work.latent.clear();
        work.latent.extend_from_slice(latents);
        let layout =
            Layout { lengths: &work.lengths, memory: Some((&work.latent, self.sizes.latent_tokens)) };
        self.decoder.forward(x, layout, None, None, &mut work.tape);
        work.features.resize(x.len() / per_frame * WIDTH, 0.0);
        self.last.forward(x, &mut work.features);
        if let Some(path) = &self.path {
            path.decode(latents, frames, &mut work.features);
        }
        Ok(())
    }

    /// From the gradient of the features that [`Self::decode`] made, which are as many numbers, to that of the latents.
    /// May follow each decoding once.
    ///
    /// # Errors
    /// When the numbers differ.
    pub fn gradient<'a>(&self, features: &[f32], work: &'a mut Decoding) -> Result<&'a [f32], GenerateError> {
        if features.len() != work.features.len() || work.tokens.is_empty() {
            let (what, expected) = ("gradient of decoded features", work.features.len());
            return Err(GenerateError::Length { what, expected, got: features.len() });
        }
        self.last.backward(features, &mut work.tokens, false);
        work.gradient.clear();
        work.gradient.resize(work.latent.len(), 0.0);
        let layout =
            Layout { lengths: &work.lengths, memory: Some((&work.latent, self.sizes.latent_tokens)) };
        self.decoder.backward_to_memory(&mut work.tokens, layout, &mut work.gradient, &mut work.tape);
        if let Some(path) = &self.path {
            path.backward(features, &work.lengths, &mut work.gradient);
        }
        work.tokens.clear();
        Ok(&work.gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::testing::numbers;
    use crate::weights::hashed;

    fn vae(tokens: usize) -> Vae {
        let cosines = if tokens > 1 { 6 } else { 0 };
        let sizes = Sizes { latent_tokens: tokens, cosines, ..Sizes::tiny() };
        Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap()
    }

    #[test]
    fn the_gradient_of_decoding_is_a_difference_for_one_token_and_for_more() {
        for tokens in [1, 3] {
            let vae = vae(tokens);
            let latents = numbers(1, 2 * vae.latent_width());
            let frames = [7, 5];
            let way = numbers(2, 12 * WIDTH);
            let run = |latents: &[f32]| {
                let mut work = Decoding::default();
                vae.decode(latents, &frames, &mut work).unwrap();
                let value: f64 = work.features().iter().zip(&way).map(|(a, b)| f64::from(a * b)).sum();
                (value, vae.gradient(&way, &mut work).unwrap().to_vec())
            };
            let (_, gradient) = run(&latents);
            let size = gradient.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            for at in [0, 5, vae.latent_width() + 3, 2 * vae.latent_width() - 1] {
                let (mut more, mut less) = (latents.clone(), latents.clone());
                more[at] += 5e-3;
                less[at] -= 5e-3;
                let slope = ((run(&more).0 - run(&less).0) / f64::from(more[at] - less[at])) as f32;
                assert!(
                    (slope - gradient[at]).abs() < 5e-3 * size,
                    "{tokens} {at}: {slope} {}",
                    gradient[at]
                );
            }
        }
    }

    #[test]
    fn a_clip_does_not_depend_on_the_clips_beside_it() {
        let vae = vae(2);
        let latents = numbers(1, 2 * vae.latent_width());
        let (mut both, mut one) = (Decoding::default(), Decoding::default());
        vae.decode(&latents, &[7, 20], &mut both).unwrap();
        vae.decode(&latents[vae.latent_width()..], &[20], &mut one).unwrap();
        assert_eq!(both.features()[7 * WIDTH..], *one.features());
    }

    #[test]
    fn lengths_that_cannot_be_are_refused() {
        let vae = vae(1);
        assert!(vae.encode(&[]).is_err() && vae.encode(&[0.0; WIDTH + 1]).is_err());
        assert!(vae.encode(&vec![0.0; WIDTH * 63]).is_err());
        assert_eq!(vae.encode(&vec![0.1; WIDTH * 62]).unwrap().mean.len(), vae.latent_width());
        let work = &mut Decoding::default();
        assert!(vae.decode(&[0.0; 16], &[0], work).is_err());
        assert!(vae.decode(&[0.0; 16], &[5, 5], work).is_err());
        assert!(vae.decode(&[0.0; 32], &[5], work).is_err());
        assert!(vae.gradient(&[], work).is_err());
    }
}
