//! What denoiser, ControlNet and adapter have in common, for training.

use super::layers::{Positions, Side, Source, Stack};
use crate::GenerateError;
use crate::networks::timestep_waves;
use crate::schedule::STEPS;
use burn::module::Module;
use burn::nn::Linear;
use burn::tensor::activation::{relu, silu};
use burn::tensor::{Device, Tensor, TensorData};

/// Samples that the three networks see.
#[derive(Debug, Clone)]
pub struct NoisyBatch {
    /// Samples x latent tokens x width.
    pub latents: Tensor<3>,
    /// The waves of each sample's timestep, samples x text width: see [`TimeWaves`].
    pub times: Tensor<2>,
    /// Samples x text width.
    pub texts: Tensor<2>,
    /// The waves of each sample's guidance weight ([`guidance_waves`](crate::networks::guidance_waves)), for networks that are distilled.
    pub guidance: Option<Tensor<2>>,
}

impl NoisyBatch {
    /// Some samples that follow one another.
    pub fn narrow(&self, first: usize, count: usize) -> Self {
        Self {
            latents: self.latents.clone().narrow(0, first, count),
            times: self.times.clone().narrow(0, first, count),
            texts: self.texts.clone().narrow(0, first, count),
            guidance: self.guidance.as_ref().map(|waves| waves.clone().narrow(0, first, count)),
        }
    }
}

/// The waves of all timesteps, worked out once.
#[derive(Debug, Clone)]
pub struct TimeWaves {
    width: usize,
    rows: Vec<f32>,
}

impl TimeWaves {
    /// For networks with text vectors of this width.
    pub fn new(width: usize) -> Self {
        Self { width, rows: (0..STEPS).flat_map(|step| timestep_waves(step, width)).collect() }
    }

    /// Those of some timesteps, timesteps x width; beyond the last they are the last's.
    pub fn of(&self, timesteps: &[usize], device: &Device) -> Tensor<2> {
        let row = |&step: &usize| &self.rows[step.min(STEPS - 1) * self.width..][..self.width];
        let numbers: Vec<f32> = timesteps.iter().flat_map(row).copied().collect();
        Tensor::from_data(TensorData::new(numbers, [timesteps.len(), self.width]), device)
    }
}

/// Embeddings of time and text, positions, blocks.
#[derive(Module, Debug)]
pub(crate) struct Branch {
    time_embedding: TimeEmbedding,
    emb_proj: Linear,
    query_pos: Positions,
    encoder: Stack,
}

impl Branch {
    pub(crate) fn new(
        source: Source<'_>,
        name: &str,
        blocks: usize,
        norm: bool,
    ) -> Result<Self, GenerateError> {
        let (width, text) = (source.sizes.width, source.sizes.text_width);
        let encoder = format!("{name}.encoder");
        Ok(Self {
            time_embedding: TimeEmbedding::new(source, &format!("{name}.time_embedding"))?,
            emb_proj: source.linear(&format!("{name}.emb_proj.1"), width, text)?,
            query_pos: source.positions(&format!("{name}.query_pos"))?,
            encoder: if blocks == source.sizes.denoiser_blocks {
                source.stack(&encoder, blocks, false, norm)?
            } else {
                source.first_blocks(&encoder, blocks)?
            },
        })
    }

    /// What comes out for the sequence latent, time, text: samples x (latent tokens + 2) x width.
    pub(crate) fn forward(&self, batch: &NoisyBatch, side: Side<'_>) -> Tensor<3> {
        let time = self.time_embedding.forward(batch.times.clone(), batch.guidance.clone());
        let text = self.emb_proj.forward(relu(batch.texts.clone()));
        let token = |x: Tensor<2>| x.unsqueeze_dim::<3>(1);
        let x = Tensor::cat(vec![batch.latents.clone(), token(time), token(text)], 1);
        let tokens = x.dims()[1];
        self.encoder.forward_beside(x + self.query_pos.rows(tokens), None, None, side)
    }
}

#[derive(Module, Debug)]
struct TimeEmbedding {
    cond_proj: Option<Linear>,
    linear_1: Linear,
    linear_2: Linear,
}

impl TimeEmbedding {
    fn new(source: Source<'_>, name: &str) -> Result<Self, GenerateError> {
        let (width, waves) = (source.sizes.width, source.sizes.text_width);
        let guidance = |inputs| source.projection(&format!("{name}.cond_proj"), waves, inputs);
        Ok(Self {
            cond_proj: Some(source.sizes.guidance_width).filter(|&width| width > 0).map(guidance).transpose()?,
            linear_1: source.linear(&format!("{name}.linear_1"), width, waves)?,
            linear_2: source.linear(&format!("{name}.linear_2"), width, width)?,
        })
    }

    fn forward(&self, mut waves: Tensor<2>, guidance: Option<Tensor<2>>) -> Tensor<2> {
        if let (Some(projection), Some(guidance)) = (&self.cond_proj, guidance) {
            waves = waves + projection.forward(guidance);
        }
        self.linear_2.forward(silu(self.linear_1.forward(waves)))
    }
}
