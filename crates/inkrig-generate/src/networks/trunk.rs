//! Feed-forward blocks on whole vectors: a linear layer, blocks that add to what came in, and a norm.

use super::block::WeightGradients;
use super::dropout::Dropout;
use super::linear::Linear;
use crate::GenerateError;
use crate::numeric::elementwise::{add, gelu, gelu_gradient};
use crate::numeric::normal::{LayerNorm, Normalised};
use crate::weights::Tensors;

/// Blocks of a trunk.
pub(super) const BLOCKS: usize = 3;
/// How much wider a block is inside.
pub(super) const WIDENING: usize = 2;

/// The layers.
#[derive(Debug, Clone)]
pub(super) struct Trunk {
    input: Linear,
    blocks: Vec<Feed>,
    norm: LayerNorm,
}

#[derive(Debug, Clone)]
struct Feed {
    norm: LayerNorm,
    widen: Linear,
    narrow: Linear,
}

/// What the way back needs of a forward pass.
#[derive(Debug, Clone, Default)]
pub(super) struct TrunkTape {
    pub(super) dropout: Option<Dropout>,
    input: Vec<f32>,
    blocks: Vec<FeedTape>,
    norm: Normalised,
}

#[derive(Debug, Clone, Default)]
struct FeedTape {
    norm: Normalised,
    normed: Vec<f32>,
    wide: Vec<f32>,
}

impl Trunk {
    /// Takes `NAME.input`, `NAME.blocks.*` and `NAME.norm`.
    pub(super) fn new(
        weights: &Tensors,
        name: &str,
        inputs: usize,
        width: usize,
    ) -> Result<Self, GenerateError> {
        let feed = |block: usize| {
            let name = format!("{name}.blocks.{block}");
            Ok(Feed {
                norm: LayerNorm::new(weights, &format!("{name}.norm"), width)?,
                widen: Linear::new(weights, &format!("{name}.widen"), WIDENING * width, width)?,
                narrow: Linear::new(weights, &format!("{name}.narrow"), width, WIDENING * width)?,
            })
        };
        Ok(Self {
            input: Linear::new(weights, &format!("{name}.input"), width, inputs)?,
            blocks: (0..BLOCKS).map(feed).collect::<Result<_, GenerateError>>()?,
            norm: LayerNorm::new(weights, &format!("{name}.norm"), width)?,
        })
    }

    /// Rows of inputs to rows of the trunk's width.
    pub(super) fn forward(&self, input: Vec<f32>, tape: &mut TrunkTape) -> Vec<f32> {
        let mut x = self.input.apply(&input);
        tape.input = input;
        tape.blocks.resize_with(self.blocks.len(), FeedTape::default);
        for (at, (feed, kept)) in self.blocks.iter().zip(&mut tape.blocks).enumerate() {
            kept.normed.clear();
            kept.normed.extend_from_slice(&x);
            feed.norm.forward(&mut kept.normed, &mut kept.norm);
            kept.wide = feed.widen.apply(&kept.normed);
            let mut active = vec![0.0; kept.wide.len()];
            gelu(&kept.wide, &mut active);
            let mut part = feed.narrow.apply(&active);
            if let Some(dropout) = tape.dropout {
                dropout.of_block(at).apply(&mut part, 0);
            }
            add(&mut x, &part);
        }
        self.norm.forward(&mut x, &mut tape.norm);
        x
    }

    /// From the gradient of what came out, which is used up, to those of weights and of what went in.
    pub(super) fn backward(
        &self,
        mut grad: Vec<f32>,
        tape: &TrunkTape,
        to: &mut WeightGradients<'_>,
    ) -> Vec<f32> {
        self.norm.weight_gradient(&grad, &tape.norm, to.row);
        self.norm.backward(&mut grad, &tape.norm);
        for (at, (feed, kept)) in self.blocks.iter().zip(&tape.blocks).enumerate().rev() {
            let mut buffer = Vec::new();
            let part = match tape.dropout {
                Some(dropout) => dropout.of_block(at).back(&grad, 0, &mut buffer),
                None => &grad,
            };
            let mut active = vec![0.0; kept.wide.len()];
            gelu(&kept.wide, &mut active);
            feed.narrow.weight_gradient(&active, part, to.row, to.work);
            let mut wide = active;
            feed.narrow.backward(part, &mut wide, false);
            gelu_gradient(&kept.wide, &mut wide);
            feed.widen.weight_gradient(&kept.normed, &wide, to.row, to.work);
            let mut back = vec![0.0; grad.len()];
            feed.widen.backward(&wide, &mut back, false);
            feed.norm.weight_gradient(&back, &kept.norm, to.row);
            feed.norm.backward(&mut back, &kept.norm);
            add(&mut grad, &back);
        }
        self.input.weight_gradient(&tape.input, &grad, to.row, to.work);
        let mut back = vec![0.0; tape.input.len()];
        self.input.backward(&grad, &mut back, false);
        back
    }
}
