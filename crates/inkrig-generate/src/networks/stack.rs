//! Blocks with skips: outputs of the first half go into the second half, the last one first.

use super::Sizes;
use super::block::{Block, BlockTape, BlockWork, Layout, WeightGradients};
use super::dropout::Dropout;
use super::linear::Linear;
use super::names::block_names;
use crate::GenerateError;
use crate::numeric::elementwise::add;
use crate::numeric::fit;
use crate::numeric::normal::{LayerNorm, Normalised};
use crate::weights::Tensors;

/// One table for each block of a stack: what comes out of it, or what is added to that.
pub(crate) type Residuals = Vec<Vec<f32>>;

/// Half of the blocks, one in the middle, as many again with a skip each; or only the first few.
#[derive(Debug, Clone)]
pub(crate) struct Stack {
    width: usize,
    blocks: Vec<Block>,
    joins: Vec<Linear>,
    norm: Option<LayerNorm>,
}

/// What the gradient needs of a forward pass, and buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct StackTape {
    blocks: Vec<BlockTape>,
    norm: Normalised,
    skips: Vec<Vec<f32>>,
    joined: Vec<f32>,
    work: BlockWork,
    /// Whether a forward pass keeps what the gradients of weights need: what went into the joins, too.
    kept: bool,
    dropout: Option<Dropout>,
    joins: Vec<Vec<f32>>,
}

impl StackTape {
    /// For a forward pass that the gradients of weights are asked of.
    pub(crate) fn for_learning() -> Self {
        Self { kept: true, ..Self::default() }
    }

    /// What the next forward pass drops.
    pub(crate) fn set_dropout(&mut self, dropout: Option<Dropout>) {
        self.dropout = dropout.filter(|dropout| dropout.share > 0.0);
    }
}

/// Gradients between the blocks of a stack and another network.
#[derive(Default)]
pub(crate) struct SideGradients<'a> {
    /// Of what came out of each block, besides what the next block says.
    pub(crate) outputs: Option<&'a Residuals>,
    /// Takes those of what was added to each, for as many blocks as it has tables.
    pub(crate) residuals: Option<&'a mut Residuals>,
}

/// What stands behind the last block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    Norm,
    Nothing,
}

impl Stack {
    /// With skips; `memory` when its blocks look at one.
    pub(crate) fn new(
        weights: &Tensors,
        name: &str,
        sizes: &Sizes,
        blocks: usize,
        memory: bool,
        ending: Ending,
    ) -> Result<Self, GenerateError> {
        let width = sizes.width;
        let block = |block: String| Block::new(weights, &format!("{name}.{block}"), sizes, memory);
        let join = |at: usize| Linear::new(weights, &format!("{name}.linear_blocks.{at}"), width, 2 * width);
        Ok(Self {
            width,
            blocks: block_names(blocks).map(block).collect::<Result<_, _>>()?,
            joins: (0..blocks / 2).map(join).collect::<Result<_, _>>()?,
            norm: norm(weights, name, width, ending)?,
        })
    }

    /// Without skips: blocks by the names given.
    pub(crate) fn plain(
        weights: &Tensors,
        name: &str,
        sizes: &Sizes,
        blocks: impl Iterator<Item = String>,
        ending: Ending,
    ) -> Result<Self, GenerateError> {
        let block = |block: String| Block::new(weights, &format!("{name}.{block}"), sizes, false);
        let blocks = blocks.map(block).collect::<Result<_, _>>()?;
        let norm = norm(weights, name, sizes.width, ending)?;
        Ok(Self { width: sizes.width, blocks, joins: Vec::new(), norm })
    }

    /// In place. `residuals` are added to what comes out of the first blocks, one each; what then is there goes
    /// into `outputs`.
    pub(crate) fn forward(
        &self,
        x: &mut [f32],
        layout: Layout<'_>,
        residuals: Option<&Residuals>,
        mut outputs: Option<&mut Residuals>,
        tape: &mut StackTape,
    ) {
        let skips = self.joins.len();
        tape.blocks.resize_with(self.blocks.len(), BlockTape::default);
        for (at, block) in tape.blocks.iter_mut().enumerate() {
            block.keep_inputs(tape.kept, tape.dropout.map(|dropout| dropout.of_block(at)));
        }
        tape.skips.resize_with(skips, Vec::new);
        tape.joins.resize_with(skips, Vec::new);
        for (at, block) in self.blocks.iter().enumerate() {
            if let Some(join) = at.checked_sub(skips + 1).and_then(|join| self.joins.get(join)) {
                let skip = &tape.skips[2 * skips - at];
                fit(&mut tape.joined, 2 * x.len());
                let rows = x.chunks_exact(self.width).zip(skip.chunks_exact(self.width));
                for (joined, (x, skip)) in tape.joined.chunks_exact_mut(2 * self.width).zip(rows) {
                    joined[..self.width].copy_from_slice(x);
                    joined[self.width..].copy_from_slice(skip);
                }
                join.forward(&tape.joined, x);
                if let (true, Some(kept)) = (tape.kept, tape.joins.get_mut(at - skips - 1)) {
                    kept.clear();
                    kept.extend_from_slice(&tape.joined);
                }
            }
            block.forward(x, layout, &mut tape.blocks[at], &mut tape.work);
            if let Some(residual) = residuals.and_then(|residuals| residuals.get(at)) {
                add(x, residual);
            }
            if let Some(skip) = tape.skips.get_mut(at) {
                skip.clear();
                skip.extend_from_slice(x);
            }
            if let Some(outputs) = &mut outputs {
                outputs.push(x.to_vec());
            }
        }
        if let Some(norm) = &self.norm {
            norm.forward(x, &mut tape.norm);
        }
    }

    /// From the gradient of what came out of a forward pass without residuals to that of the memory, added to
    /// `grad_memory`. `grad` is used up.
    pub(crate) fn backward_to_memory(
        &self,
        grad: &mut [f32],
        layout: Layout<'_>,
        grad_memory: &mut [f32],
        tape: &mut StackTape,
    ) {
        self.back(grad, layout, grad_memory, tape, true, None, SideGradients::default());
    }

    /// From the gradient of what came out of a forward pass with a tape [`StackTape::for_learning`] to that of what went in, in
    /// place; what weights get of it is added to theirs, and the memory's to `grad_memory`.
    pub(crate) fn backward(
        &self,
        grad: &mut [f32],
        layout: Layout<'_>,
        grad_memory: &mut [f32],
        tape: &mut StackTape,
        weights: &mut WeightGradients<'_>,
    ) {
        self.back(grad, layout, grad_memory, tape, false, Some(weights), SideGradients::default());
    }

    /// The same for a stack without memory that has another network beside it. Without `weights` the tape need not be one for
    /// learning.
    pub(crate) fn backward_beside(
        &self,
        grad: &mut [f32],
        layout: Layout<'_>,
        tape: &mut StackTape,
        weights: Option<&mut WeightGradients<'_>>,
        side: SideGradients<'_>,
    ) {
        self.back(grad, layout, &mut [], tape, false, weights, side);
    }

    #[allow(clippy::too_many_arguments, reason = "buffers of one pass")]
    fn back(
        &self,
        grad: &mut [f32],
        layout: Layout<'_>,
        grad_memory: &mut [f32],
        tape: &mut StackTape,
        memory_only: bool,
        mut weights: Option<&mut WeightGradients<'_>>,
        mut side: SideGradients<'_>,
    ) {
        let skips = self.joins.len();
        if let Some(norm) = &self.norm {
            if let Some(to) = weights.as_deref_mut() {
                norm.weight_gradient(grad, &tape.norm, to.row);
            }
            norm.backward(grad, &tape.norm);
        }
        for (at, block) in self.blocks.iter().enumerate().rev() {
            // What later blocks took over the skip; the forward pass' own numbers are needed no more.
            if let Some(skip) = tape.skips.get(at) {
                add(grad, skip);
            }
            if let Some(more) = side.outputs.and_then(|outputs| outputs.get(at)) {
                add(grad, more);
            }
            if let Some(residual) = side.residuals.as_mut().and_then(|residuals| residuals.get_mut(at)) {
                residual.clear();
                residual.extend_from_slice(grad);
            }
            let only = memory_only && at == 0;
            let own = &tape.blocks[at];
            block.backward(grad, layout, grad_memory, only, own, &mut tape.work, weights.as_deref_mut());
            if let Some(join) = at.checked_sub(skips + 1).and_then(|join| self.joins.get(join)) {
                if let Some(to) = weights.as_deref_mut() {
                    join.weight_gradient(&tape.joins[at - skips - 1], grad, to.row, to.work);
                }
                join.backward(grad, fit(&mut tape.joined, 2 * grad.len()), false);
                let skip = &mut tape.skips[2 * skips - at];
                let rows = grad.chunks_exact_mut(self.width).zip(skip.chunks_exact_mut(self.width));
                for (joined, (grad, skip)) in tape.joined.chunks_exact(2 * self.width).zip(rows) {
                    grad.copy_from_slice(&joined[..self.width]);
                    skip.copy_from_slice(&joined[self.width..]);
                }
            }
        }
    }
}

fn norm(
    weights: &Tensors,
    name: &str,
    width: usize,
    ending: Ending,
) -> Result<Option<LayerNorm>, GenerateError> {
    match ending {
        Ending::Norm => LayerNorm::new(weights, &format!("{name}.norm"), width).map(Some),
        Ending::Nothing => Ok(None),
    }
}
