//! What denoiser, ControlNet and adapter have in common.

use super::Sizes;
use super::block::Layout;
use super::denoiser::{Corrections, Noisy};
use super::embedding::TimeEmbedding;
use super::linear::Linear;
use super::stack::{Ending, Residuals, Stack, StackTape};
use super::tokens::{check_length, positions};
use crate::GenerateError;
use crate::numeric::elementwise::{add, relu};
use crate::weights::Tensors;

/// Embeddings of time and text, positions, blocks.
#[derive(Debug, Clone)]
pub(crate) struct Branch {
    pub(super) sizes: Sizes,
    pub(super) time: TimeEmbedding,
    pub(super) text: Linear,
    pub(super) positions: Vec<f32>,
    /// Where the gradient of the positional table begins.
    pub(super) place: usize,
    pub(super) stack: Stack,
}

impl Branch {
    pub(super) fn new(
        weights: &Tensors,
        name: &str,
        sizes: &Sizes,
        blocks: usize,
        ending: Ending,
    ) -> Result<Self, GenerateError> {
        sizes.check()?;
        let encoder = format!("{name}.encoder");
        let stack = if blocks == sizes.denoiser_blocks {
            Stack::new(weights, &encoder, sizes, blocks, false, ending)?
        } else {
            let blocks = (0..blocks).map(|block| format!("input_blocks.{block}"));
            Stack::plain(weights, &encoder, sizes, blocks, ending)?
        };
        Ok(Self {
            time: TimeEmbedding::new(weights, &format!("{name}.time_embedding"), sizes)?,
            text: Linear::new(weights, &format!("{name}.emb_proj.1"), sizes.width, sizes.text_width)?,
            positions: positions(weights, &format!("{name}.query_pos.pe"), sizes)?,
            place: weights.place(&format!("{name}.query_pos.pe")),
            stack,
            sizes: sizes.clone(),
        })
    }

    fn samples(&self, noisy: &Noisy<'_>) -> Result<usize, GenerateError> {
        let samples = noisy.timesteps.len();
        let latent = self.sizes.latent_tokens * self.sizes.width;
        for (what, numbers, width) in
            [("latents", noisy.latents.len(), latent), ("texts", noisy.texts.len(), self.sizes.text_width)]
        {
            if check_length(what, numbers, width, samples)? != samples {
                return Err(GenerateError::Length { what, expected: samples * width, got: numbers });
            }
        }
        if let Some(guidance) = noisy.guidance
            && self.sizes.guidance_width > 0
            && guidance.len() != self.sizes.guidance_width
        {
            let (what, expected) = ("guidance embedding", self.sizes.guidance_width);
            return Err(GenerateError::Length { what, expected, got: guidance.len() });
        }
        Ok(samples)
    }

    /// Runs the blocks; what comes out of the last is returned, what comes out of each goes into `outputs`.
    pub(super) fn run(
        &self,
        noisy: &Noisy<'_>,
        corrections: Option<&Corrections>,
        outputs: Option<&mut Residuals>,
        tape: &mut StackTape,
    ) -> Result<Vec<f32>, GenerateError> {
        let samples = self.samples(noisy)?;
        let Sizes { width, latent_tokens, text_width, .. } = self.sizes;
        let mut texts = noisy.texts.to_vec();
        relu(&mut texts);
        let texts = self.text.apply(&texts);
        debug_assert_eq!(text_width * samples, noisy.texts.len());
        let tokens = latent_tokens + 2;
        let mut x = Vec::with_capacity(samples * tokens * width);
        let mut time: Option<(usize, Vec<f32>)> = None;
        let each = noisy.latents.chunks_exact(latent_tokens * width).zip(texts.chunks_exact(width));
        for (&timestep, (latent, text)) in noisy.timesteps.iter().zip(each) {
            let known = time.take().filter(|(of, _)| *of == timestep);
            let (_, token) =
                time.insert(known.unwrap_or_else(|| (timestep, self.time.token(timestep, noisy.guidance))));
            let first = x.len();
            x.extend_from_slice(latent);
            x.extend_from_slice(token);
            x.extend_from_slice(text);
            add(&mut x[first..], &self.positions[..tokens * width]);
        }
        if let Some(corrections) = corrections {
            let what = "corrections of a block";
            for block in &corrections.blocks {
                if block.len() != x.len() {
                    return Err(GenerateError::Length { what, expected: x.len(), got: block.len() });
                }
            }
        }
        let lengths = vec![tokens; samples];
        let layout = Layout { lengths: &lengths, memory: None };
        self.stack.forward(&mut x, layout, corrections.map(|all| &all.blocks), outputs, tape);
        Ok(x)
    }
}
