//! ControlNet, adapter and the encoders of conditions on batches, forwards and back to their weights.

use super::block::{Layout, WeightGradients};
use super::branch_gradient::{BranchTape, InputGradients, Samples, WaveTable};
use super::conditions::ConditionEncoder;
use super::denoiser::{Adapter, ControlNet};
use super::linear::Linear;
use super::names::POSE;
use super::stack::{Residuals, SideGradients, StackTape};
use super::tokens::check_length;
use crate::GenerateError;
use crate::numeric::elementwise::{add, relu};

/// What ControlNet or adapter need of a batch for the way back.
#[derive(Debug)]
pub(crate) struct ControlTape {
    pub(crate) branch: BranchTape,
    /// What came out of each block.
    blocks: Residuals,
    /// What went into the layers of the condition.
    conditions: Vec<Vec<f32>>,
    latents: Vec<f32>,
    inputs: InputGradients,
}

impl Default for ControlTape {
    fn default() -> Self {
        let (blocks, conditions, latents, inputs) = Default::default();
        Self { branch: BranchTape::for_learning(), blocks, conditions, latents, inputs }
    }
}

impl ControlTape {
    /// Back through the zero-initialised layers behind the blocks, then through the blocks. Gives the gradients of the corrections that
    /// came in.
    fn back(
        &mut self,
        (branch, outputs): (&super::branch::Branch, &[Linear]),
        grads: &Residuals,
        samples: &Samples<'_>,
        corrected: bool,
        to: &mut WeightGradients<'_>,
    ) -> Residuals {
        let mut of_blocks = Residuals::new();
        for ((output, grad), block) in outputs.iter().zip(grads).zip(&self.blocks) {
            output.weight_gradient(block, grad, to.row, to.work);
            let mut back = vec![0.0; block.len()];
            output.backward(grad, &mut back, false);
            of_blocks.push(back);
        }
        let mut residuals = vec![Vec::new(); if corrected { outputs.len() } else { 0 }];
        let mut last = vec![0.0; grads.first().map_or(0, Vec::len)];
        let side = SideGradients { outputs: Some(&of_blocks), residuals: Some(&mut residuals) };
        branch.backward_batch(&mut last, samples, &mut self.branch, side, Some(to), &mut self.inputs);
        residuals
    }
}

fn through(outputs: &[Linear], blocks: &Residuals) -> Residuals {
    outputs.iter().zip(blocks).map(|(output, block)| output.apply(block)).collect()
}

impl ControlNet {
    /// Corrections, one table a block; `trajectories` are embeddings, samples x width.
    pub(crate) fn forward_batch(
        &self,
        samples: &Samples<'_>,
        waves: &WaveTable,
        trajectories: &[f32],
        tape: &mut ControlTape,
    ) -> Residuals {
        let width = self.branch.sizes.width;
        let mut condition = trajectories.to_vec();
        tape.conditions.clear();
        for layer in &self.condition {
            let next = layer.apply(&condition);
            tape.conditions.push(std::mem::replace(&mut condition, next));
        }
        tape.latents.clear();
        tape.latents.extend_from_slice(samples.latents);
        let rows = tape.latents.chunks_exact_mut(self.branch.sizes.latent_tokens * width);
        for (latent, condition) in rows.zip(condition.chunks_exact(width)) {
            latent.chunks_exact_mut(width).for_each(|token| add(token, condition));
        }
        let own = Samples { latents: &tape.latents, ..*samples };
        tape.blocks.clear();
        self.branch.forward_batch(&own, waves, None, Some(&mut tape.blocks), &mut tape.branch);
        through(&self.outputs, &tape.blocks)
    }

    /// From the gradients of the corrections to those of the weights, added to theirs, and of the embeddings.
    pub(crate) fn backward_batch(
        &self,
        grads: &Residuals,
        samples: &Samples<'_>,
        tape: &mut ControlTape,
        to: &mut WeightGradients<'_>,
    ) -> Vec<f32> {
        tape.back((&self.branch, &self.outputs), grads, samples, false, to);
        let width = self.branch.sizes.width;
        let mut grad = Vec::new();
        for latent in tape.inputs.latents.chunks_exact(self.branch.sizes.latent_tokens * width) {
            let first = grad.len();
            grad.resize(first + width, 0.0);
            latent.chunks_exact(width).for_each(|token| add(&mut grad[first..], token));
        }
        for (layer, input) in self.condition.iter().zip(&tape.conditions).rev() {
            layer.weight_gradient(input, &grad, to.row, to.work);
            let mut back = vec![0.0; input.len()];
            layer.backward(&grad, &mut back, false);
            grad = back;
        }
        grad
    }
}

impl Adapter {
    /// Texts plus what key poses say, samples x text width; `keyposes` are embeddings, samples x width.
    pub(crate) fn ground_batch(&self, texts: &[f32], keyposes: &[f32], tape: &mut ControlTape) -> Vec<f32> {
        let mut poses = keyposes.to_vec();
        relu(&mut poses);
        let mut grounded = self.pose.apply(&poses);
        add(&mut grounded, texts);
        tape.conditions = vec![poses];
        grounded
    }

    /// Corrections of samples whose texts are grounded ones.
    pub(crate) fn forward_batch(
        &self,
        samples: &Samples<'_>,
        waves: &WaveTable,
        trajectory: &Residuals,
        tape: &mut ControlTape,
    ) -> Residuals {
        tape.blocks.clear();
        self.branch.forward_batch(samples, waves, Some(trajectory), Some(&mut tape.blocks), &mut tape.branch);
        through(&self.outputs, &tape.blocks)
    }

    /// From the gradients of the corrections to those of the weights, added to theirs, of the corrections that came in, and of the
    /// embeddings of key poses.
    pub(crate) fn backward_batch(
        &self,
        grads: &Residuals,
        samples: &Samples<'_>,
        tape: &mut ControlTape,
        to: &mut WeightGradients<'_>,
    ) -> (Residuals, Vec<f32>) {
        let residuals = tape.back((&self.branch, &self.outputs), grads, samples, true, to);
        let poses = tape.conditions.first().map_or(&[][..], Vec::as_slice);
        self.pose.weight_gradient(poses, &tape.inputs.texts, to.row, to.work);
        let mut grad = vec![0.0; poses.len()];
        self.pose.backward(&tape.inputs.texts, &mut grad, false);
        grad.iter_mut().zip(poses).filter(|(_, pose)| **pose <= 0.0).for_each(|(grad, _)| *grad = 0.0);
        (residuals, grad)
    }
}

/// A condition of one sample: pairs of frame and 66 normalised numbers.
pub type ConditionRows = Vec<(usize, Vec<f32>)>;

/// What an encoder of conditions needs of a batch for the way back.
#[derive(Debug)]
pub(crate) struct EncoderTape {
    stack: StackTape,
    lengths: Vec<usize>,
    rows: Vec<f32>,
    x: Vec<f32>,
}

impl Default for EncoderTape {
    fn default() -> Self {
        Self { stack: StackTape::for_learning(), lengths: Vec::new(), rows: Vec::new(), x: Vec::new() }
    }
}

impl ConditionEncoder {
    /// One vector of each sample's condition, samples x width.
    ///
    /// # Errors
    /// As for [`Self::encode`].
    pub(crate) fn encode_batch(
        &self,
        samples: &[&ConditionRows],
        tape: &mut EncoderTape,
    ) -> Result<Vec<f32>, GenerateError> {
        let width = self.width;
        let most = self.positions.len() / width - 1;
        tape.rows.clear();
        for (frame, row) in samples.iter().copied().flatten() {
            check_length("joints of a frame", row.len(), POSE, 1)?;
            check_length("frames before a condition", frame + 1, 1, most)?;
            tape.rows.extend_from_slice(row);
        }
        let embedded = self.embed.apply(&tape.rows);
        let mut rest = embedded.chunks_exact(width);
        tape.x.clear();
        tape.lengths.clear();
        for sample in samples {
            let first = tape.x.len();
            tape.x.extend_from_slice(&self.token);
            add(&mut tape.x[first..], &self.positions[..width]);
            for ((frame, _), row) in sample.iter().zip(rest.by_ref().take(sample.len())) {
                let first = tape.x.len();
                tape.x.extend_from_slice(row);
                add(&mut tape.x[first..], &self.positions[(frame + 1) * width..][..width]);
            }
            tape.lengths.push(1 + sample.len());
        }
        let layout = Layout { lengths: &tape.lengths, memory: None };
        self.stack.forward(&mut tape.x, layout, None, None, &mut tape.stack);
        let mut out = Vec::with_capacity(samples.len() * width);
        let mut first = 0;
        for tokens in &tape.lengths {
            out.extend_from_slice(&tape.x[first..first + width]);
            first += tokens * width;
        }
        Ok(out)
    }

    /// From the gradient of what [`Self::encode_batch`] gave to those of the weights, added to theirs.
    pub(crate) fn backward_batch(
        &self,
        grads: &[f32],
        samples: &[&ConditionRows],
        tape: &mut EncoderTape,
        to: &mut WeightGradients<'_>,
    ) {
        let width = self.width;
        tape.x.fill(0.0);
        let mut first = 0;
        for (tokens, grad) in tape.lengths.iter().zip(grads.chunks_exact(width)) {
            tape.x[first..first + width].copy_from_slice(grad);
            first += tokens * width;
        }
        let layout = Layout { lengths: &tape.lengths, memory: None };
        let side = SideGradients::default();
        self.stack.backward_beside(&mut tape.x, layout, &mut tape.stack, Some(to), side);
        let mut of_rows = Vec::with_capacity(tape.rows.len() / POSE * width);
        let mut rest = tape.x.chunks_exact(width);
        for sample in samples {
            let token = rest.next().unwrap_or_default();
            add(&mut to.row[self.places.0..][..token.len()], token);
            add(&mut to.row[self.places.1..][..token.len()], token);
            for ((frame, _), grad) in sample.iter().zip(rest.by_ref().take(sample.len())) {
                add(&mut to.row[self.places.1 + (frame + 1) * width..][..width], grad);
                of_rows.extend_from_slice(grad);
            }
        }
        self.embed.weight_gradient(&tape.rows, &of_rows, to.row, to.work);
    }
}
