//! The autoencoder on batches, forwards and back to its weights.

use super::block::{Layout, WeightGradients};
use super::stack::StackTape;
use super::tokens::check_length;
use super::vae::{Encoded, Vae};
use crate::GenerateError;
use crate::numeric::elementwise::add;
use crate::numeric::fit;
use crate::numeric::product::OuterWork;
use inkrig_motion::humanml::WIDTH;

/// What the gradient needs of a batch, and buffers.
#[derive(Debug)]
pub(crate) struct VaeTape {
    encoder: StackTape,
    decoder: StackTape,
    /// Tokens of the encoder's sequences.
    lengths: Vec<usize>,
    tokens: Vec<f32>,
    rows: Vec<f32>,
    decoded: Vec<f32>,
    features: Vec<f32>,
    outer: OuterWork,
}

impl Default for VaeTape {
    fn default() -> Self {
        Self {
            encoder: StackTape::for_learning(),
            decoder: StackTape::for_learning(),
            lengths: Vec::new(),
            tokens: Vec::new(),
            rows: Vec::new(),
            decoded: Vec::new(),
            features: Vec::new(),
            outer: OuterWork::default(),
        }
    }
}

impl VaeTape {
    /// What was decoded last.
    pub(crate) fn features(&self) -> &[f32] {
        &self.features
    }
}

impl Vae {
    /// Encodes clips of `lengths` frames, one after the other in `features`; the latents, too, lie one after the other.
    pub(crate) fn encode_batch(
        &self,
        features: &[f32],
        lengths: &[usize],
        tape: &mut VaeTape,
    ) -> Result<Encoded, GenerateError> {
        for &frames in lengths {
            check_length("frames of a clip", frames, 1, self.sizes.most_frames())?;
        }
        let frames: usize = lengths.iter().sum();
        let (what, expected) = ("features of all clips", frames * WIDTH);
        if features.len() != expected {
            return Err(GenerateError::Length { what, expected, got: features.len() });
        }
        let (own, width) = (self.tokens.len(), self.sizes.width);
        self.embed.forward(features, fit(&mut tape.rows, frames * width));
        tape.tokens.clear();
        tape.lengths.clear();
        let mut rest = &tape.rows[..];
        for &frames in lengths {
            let (rows, others) = rest.split_at(frames * width);
            rest = others;
            let first = tape.tokens.len();
            tape.tokens.extend_from_slice(&self.tokens);
            tape.tokens.extend_from_slice(rows);
            add(&mut tape.tokens[first..], &self.encoder_positions);
            tape.lengths.push(own / width + frames);
        }
        let layout = Layout { lengths: &tape.lengths, memory: None };
        self.encoder.forward(&mut tape.tokens, layout, None, None, &mut tape.encoder);
        let half = self.latent_width();
        let mut encoded = Encoded { mean: Vec::new(), log_variance: Vec::new() };
        let mut first = 0;
        for tokens in &tape.lengths {
            encoded.mean.extend_from_slice(&tape.tokens[first..first + half]);
            encoded.log_variance.extend_from_slice(&tape.tokens[first + half..first + 2 * half]);
            first += tokens * width;
        }
        if let Some(path) = &self.path {
            path.encode(features, lengths, &mut encoded);
        }
        Ok(encoded)
    }

    /// Decodes latents, one after the other, to as many frames as `lengths` says; the result is the tape's.
    pub(crate) fn decode_batch(
        &self,
        latents: &[f32],
        lengths: &[usize],
        tape: &mut VaeTape,
    ) -> Result<(), GenerateError> {
        let width = self.latent_width();
        let clips = check_length("latent of a clip", latents.len(), width, lengths.len())?;
        check_length("lengths of clips", lengths.len(), 1, clips)?;
        let per_frame = self.sizes.width;
        tape.decoded.clear();
        for &frames in lengths {
            tape.decoded.extend_from_slice(&self.decoder_positions[..frames * per_frame]);
        }
        let layout = Layout { lengths, memory: Some((latents, self.sizes.latent_tokens)) };
        self.decoder.forward(&mut tape.decoded, layout, None, None, &mut tape.decoder);
        let numbers = tape.decoded.len() / per_frame * WIDTH;
        self.last.forward(&tape.decoded, fit(&mut tape.features, numbers));
        if let Some(path) = &self.path {
            path.decode(latents, lengths, &mut tape.features);
        }
        Ok(())
    }

    /// From the gradient of the features that [`Self::decode_batch`] made: to the latents, added to `grad_latents`, and to the
    /// decoder's weights, added to `row`.
    pub(crate) fn decoder_gradient(
        &self,
        grad_features: &[f32],
        latents: &[f32],
        lengths: &[usize],
        grad_latents: &mut [f32],
        tape: &mut VaeTape,
        row: &mut [f32],
    ) {
        self.last.weight_gradient(&tape.decoded, grad_features, row, &mut tape.outer);
        self.last.backward(grad_features, &mut tape.decoded, false);
        let layout = Layout { lengths, memory: Some((latents, self.sizes.latent_tokens)) };
        let mut to = WeightGradients { row, work: &mut tape.outer };
        self.decoder.backward(&mut tape.decoded, layout, grad_latents, &mut tape.decoder, &mut to);
        if let Some(path) = &self.path {
            path.backward(grad_features, lengths, grad_latents);
        }
        let mut rest = &tape.decoded[..];
        for &frames in lengths {
            let (own, others) = rest.split_at(frames * self.sizes.width);
            rest = others;
            add(&mut row[self.places.decoder_positions..][..own.len()], own);
        }
    }

    /// From the gradients of means and logarithms of variances that [`Self::encode_batch`] gave to the encoder's weights, added
    /// to `row`.
    pub(crate) fn encoder_gradient(
        &self,
        features: &[f32],
        lengths: &[usize],
        (grad_mean, grad_log_variance): (&[f32], &[f32]),
        tape: &mut VaeTape,
        row: &mut [f32],
    ) {
        let (half, width) = (self.latent_width(), self.sizes.width);
        tape.tokens.fill(0.0);
        let mut first = 0;
        let halves = grad_mean.chunks_exact(half).zip(grad_log_variance.chunks_exact(half));
        for (tokens, (mean, log_variance)) in tape.lengths.iter().zip(halves) {
            tape.tokens[first..first + half].copy_from_slice(mean);
            tape.tokens[first + half..first + 2 * half].copy_from_slice(log_variance);
            first += tokens * width;
        }
        let layout = Layout { lengths: &tape.lengths, memory: None };
        let mut to = WeightGradients { row, work: &mut tape.outer };
        self.encoder.backward(&mut tape.tokens, layout, &mut [], &mut tape.encoder, &mut to);
        tape.rows.clear();
        let mut rest = &tape.tokens[..];
        for &frames in lengths {
            let (own, others) = rest.split_at(2 * half + frames * width);
            rest = others;
            add(&mut row[self.places.encoder_positions..][..own.len()], own);
            let (tokens, frames) = own.split_at(2 * half);
            add(&mut row[self.places.tokens..][..tokens.len()], tokens);
            tape.rows.extend_from_slice(frames);
        }
        self.embed.weight_gradient(features, &tape.rows, row, &mut tape.outer);
    }
}
