//! Blocks and stacks as in [`crate::networks`], for training. Fields have the names of the published state dictionary.

use super::named::{parameter, turned};
use crate::GenerateError;
use crate::networks::Sizes;
use crate::weights::Tensors;
use burn::module::{Module, Param};
use burn::nn::{Dropout, DropoutConfig, LayerNorm, LayerNormConfig, Linear};
use burn::tensor::activation::{gelu, softmax};
use burn::tensor::{Device, Tensor};

/// What modules are made of.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) weights: &'a Tensors,
    pub(crate) sizes: &'a Sizes,
    pub(crate) dropout: f64,
    pub(crate) device: &'a Device,
}

impl Source<'_> {
    pub(crate) fn linear(&self, name: &str, outputs: usize, inputs: usize) -> Result<Linear, GenerateError> {
        let weight = turned(self.weights, &format!("{name}.weight"), outputs, inputs, self.device)?;
        let bias = parameter(self.weights, &format!("{name}.bias"), [outputs], self.device)?;
        Ok(Linear { weight, bias: Some(bias) })
    }

    pub(crate) fn norm(&self, name: &str) -> Result<LayerNorm, GenerateError> {
        let width = self.sizes.width;
        let mut norm = LayerNormConfig::new(width).init(self.device);
        norm.gamma = parameter(self.weights, &format!("{name}.weight"), [width], self.device)?;
        norm.beta = Some(parameter(self.weights, &format!("{name}.bias"), [width], self.device)?);
        Ok(norm)
    }

    pub(crate) fn positions(&self, name: &str) -> Result<Positions, GenerateError> {
        let shape = [self.sizes.positions, 1, self.sizes.width];
        Ok(Positions { pe: parameter(self.weights, &format!("{name}.pe"), shape, self.device)? })
    }

    pub(crate) fn stack(&self, name: &str, blocks: usize, memory: bool) -> Result<Stack, GenerateError> {
        let half = blocks / 2;
        let block = |block: String| Block::new(*self, &format!("{name}.{block}"), memory);
        let width = self.sizes.width;
        let join = |at: usize| self.linear(&format!("{name}.linear_blocks.{at}"), width, 2 * width);
        Ok(Stack {
            input_blocks: (0..half)
                .map(|at| block(format!("input_blocks.{at}")))
                .collect::<Result<_, _>>()?,
            middle_block: block("middle_block".into())?,
            output_blocks: (0..half)
                .map(|at| block(format!("output_blocks.{at}")))
                .collect::<Result<_, _>>()?,
            linear_blocks: (0..half).map(join).collect::<Result<_, _>>()?,
            norm: self.norm(&format!("{name}.norm"))?,
        })
    }
}

/// A learned positional table.
#[derive(Module, Debug)]
pub(crate) struct Positions {
    pe: Param<Tensor<3>>,
}

impl Positions {
    /// Its first rows, 1 x rows x width.
    pub(crate) fn rows(&self, rows: usize) -> Tensor<3> {
        self.pe.val().narrow(0, 0, rows).swap_dims(0, 1)
    }
}

/// Blocks with skips, and a norm behind them.
#[derive(Module, Debug)]
pub(crate) struct Stack {
    input_blocks: Vec<Block>,
    middle_block: Block,
    output_blocks: Vec<Block>,
    linear_blocks: Vec<Linear>,
    norm: LayerNorm,
}

impl Stack {
    /// Clips x tokens x width; `bias` is added to the scores of attention among the tokens.
    pub(crate) fn forward(
        &self,
        x: Tensor<3>,
        bias: Option<&Tensor<4>>,
        memory: Option<&Tensor<3>>,
    ) -> Tensor<3> {
        let mut skips = Vec::with_capacity(self.input_blocks.len());
        let mut x = x;
        for block in &self.input_blocks {
            x = block.forward(x, bias, memory);
            skips.push(x.clone());
        }
        x = self.middle_block.forward(x, bias, memory);
        for ((block, join), skip) in
            self.output_blocks.iter().zip(&self.linear_blocks).zip(skips.into_iter().rev())
        {
            x = join.forward(Tensor::cat(vec![x, skip], 2));
            x = block.forward(x, bias, memory);
        }
        self.norm.forward(x)
    }
}

/// One block.
#[derive(Module, Debug)]
pub(crate) struct Block {
    self_attn: Attention,
    multihead_attn: Option<Attention>,
    linear1: Linear,
    linear2: Linear,
    norm1: LayerNorm,
    norm2: LayerNorm,
    norm3: Option<LayerNorm>,
    dropout: Dropout,
}

impl Block {
    fn new(source: Source<'_>, name: &str, memory: bool) -> Result<Self, GenerateError> {
        let (width, wide) = (source.sizes.width, source.sizes.feed_forward);
        let attention = |part: &str| Attention::new(source, &format!("{name}.{part}"));
        let norm = |at: usize| source.norm(&format!("{name}.norm{at}"));
        Ok(Self {
            self_attn: attention("self_attn")?,
            multihead_attn: if memory { Some(attention("multihead_attn")?) } else { None },
            linear1: source.linear(&format!("{name}.linear1"), wide, width)?,
            linear2: source.linear(&format!("{name}.linear2"), width, wide)?,
            norm1: norm(1)?,
            norm2: norm(2)?,
            norm3: if memory { Some(norm(3)?) } else { None },
            dropout: DropoutConfig::new(source.dropout).init(),
        })
    }

    fn forward(&self, x: Tensor<3>, bias: Option<&Tensor<4>>, memory: Option<&Tensor<3>>) -> Tensor<3> {
        let part = self.self_attn.forward(x.clone(), None, bias, &self.dropout);
        let mut x = self.norm1.forward(x + self.dropout.forward(part));
        let mut last = &self.norm2;
        if let (Some(attention), Some(norm), Some(memory)) = (&self.multihead_attn, &self.norm3, memory) {
            let part = attention.forward(x.clone(), Some(memory), None, &self.dropout);
            x = self.norm2.forward(x + self.dropout.forward(part));
            last = norm;
        }
        let wide = self.dropout.forward(gelu(self.linear1.forward(x.clone())));
        let part = self.linear2.forward(wide);
        last.forward(x + self.dropout.forward(part))
    }
}

/// Attention with its projections.
#[derive(Module, Debug)]
pub(crate) struct Attention {
    in_proj: Linear,
    out_proj: Linear,
    heads: usize,
}

impl Attention {
    fn new(source: Source<'_>, name: &str) -> Result<Self, GenerateError> {
        let (width, device) = (source.sizes.width, source.device);
        let weight = turned(source.weights, &format!("{name}.in_proj_weight"), 3 * width, width, device)?;
        let bias = parameter(source.weights, &format!("{name}.in_proj_bias"), [3 * width], device)?;
        let in_proj = Linear { weight, bias: Some(bias) };
        let out_proj = source.linear(&format!("{name}.out_proj"), width, width)?;
        Ok(Self { in_proj, out_proj, heads: source.sizes.heads })
    }

    fn forward(
        &self,
        x: Tensor<3>,
        memory: Option<&Tensor<3>>,
        bias: Option<&Tensor<4>>,
        dropout: &Dropout,
    ) -> Tensor<3> {
        let [clips, tokens, width] = x.dims();
        let head = width / self.heads;
        let heads = |x: Tensor<3>| {
            let tokens = x.dims()[1];
            x.reshape([clips, tokens, self.heads, head]).swap_dims(1, 2)
        };
        let (queries, keys, values) = match memory {
            None => {
                let all = self.in_proj.forward(x);
                (
                    all.clone().narrow(2, 0, width),
                    all.clone().narrow(2, width, width),
                    all.narrow(2, 2 * width, width),
                )
            }
            Some(memory) => {
                let (of_queries, of_memory) = (self.part(0, width), self.part(width, 2 * width));
                let both = of_memory.forward(memory.clone());
                (of_queries.forward(x), both.clone().narrow(2, 0, width), both.narrow(2, width, width))
            }
        };
        let scale = 1.0 / (head as f64).sqrt();
        let mut scores = heads(queries).matmul(heads(keys).swap_dims(2, 3)) * scale;
        if let Some(bias) = bias {
            scores = scores + bias.clone();
        }
        let mixed = dropout.forward(softmax(scores, 3)).matmul(heads(values));
        self.out_proj.forward(mixed.swap_dims(1, 2).reshape([clips, tokens, width]))
    }

    /// Some outputs of the packed projection, as a layer.
    fn part(&self, first: usize, count: usize) -> Part {
        let weight = self.in_proj.weight.val().narrow(1, first, count);
        Part { weight, bias: self.in_proj.bias.as_ref().map(|bias| bias.val().narrow(0, first, count)) }
    }
}

struct Part {
    weight: Tensor<2>,
    bias: Option<Tensor<1>>,
}

impl Part {
    fn forward(&self, x: Tensor<3>) -> Tensor<3> {
        burn::tensor::module::linear(x, self.weight.clone(), self.bias.clone())
    }
}
