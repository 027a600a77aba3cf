//! Blocks and stacks as in [`crate::networks`], for training. Fields have the names of the published state dictionary.

use super::attention::Attention;
use super::dropout::drop_out;
use super::named::{parameter, turned};
use crate::GenerateError;
use crate::networks::Sizes;
use crate::weights::Tensors;
use burn::module::{Module, Param};
use burn::nn::{LayerNorm, LayerNormConfig, Linear};
use burn::tensor::activation::gelu;
use burn::tensor::{Device, Tensor};

/// What modules are made of.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) weights: &'a Tensors,
    pub(crate) sizes: &'a Sizes,
    pub(crate) dropout: f64,
    pub(crate) device: &'a Device,
}

impl<'a> Source<'a> {
    /// Checks sizes and the share of numbers that are dropped.
    pub(crate) fn new(
        sizes: &'a Sizes,
        weights: &'a Tensors,
        dropout: f64,
        device: &'a Device,
    ) -> Result<Self, GenerateError> {
        sizes.check()?;
        if !(0.0..1.0).contains(&dropout) {
            let (setting, value) = ("dropout", dropout.to_string());
            return Err(GenerateError::Setting { setting, value, needed: "from 0 to below 1" });
        }
        Ok(Self { weights, sizes, dropout, device })
    }

    pub(crate) fn linear(&self, name: &str, outputs: usize, inputs: usize) -> Result<Linear, GenerateError> {
        let bias = parameter(self.weights, &format!("{name}.bias"), [outputs], self.device)?;
        Ok(Linear { bias: Some(bias), ..self.projection(name, outputs, inputs)? })
    }

    /// A linear layer without bias.
    pub(crate) fn projection(
        &self,
        name: &str,
        outputs: usize,
        inputs: usize,
    ) -> Result<Linear, GenerateError> {
        let weight = turned(self.weights, &format!("{name}.weight"), outputs, inputs, self.device)?;
        Ok(Linear { weight, bias: None })
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

    /// Blocks with skips, and perhaps a norm behind them.
    pub(crate) fn stack(
        &self,
        name: &str,
        blocks: usize,
        memory: bool,
        norm: bool,
    ) -> Result<Stack, GenerateError> {
        let half = blocks / 2;
        let width = self.sizes.width;
        let join = |at: usize| self.linear(&format!("{name}.linear_blocks.{at}"), width, 2 * width);
        Ok(Stack {
            layers: Vec::new(),
            input_blocks: self.blocks(&format!("{name}.input_blocks"), half, memory)?,
            middle_block: Some(Block::new(*self, &format!("{name}.middle_block"), memory)?),
            output_blocks: self.blocks(&format!("{name}.output_blocks"), half, memory)?,
            linear_blocks: (0..half).map(join).collect::<Result<_, _>>()?,
            norm: if norm { Some(self.norm(&format!("{name}.norm"))?) } else { None },
        })
    }

    /// The first blocks of a stack, without middle and skips.
    pub(crate) fn first_blocks(&self, name: &str, blocks: usize) -> Result<Stack, GenerateError> {
        let input_blocks = self.blocks(&format!("{name}.input_blocks"), blocks, false)?;
        Ok(Stack { input_blocks, ..Stack::empty() })
    }

    /// Blocks one after the other, and a norm.
    pub(crate) fn plain_stack(&self, name: &str, blocks: usize) -> Result<Stack, GenerateError> {
        let layers = self.blocks(&format!("{name}.layers"), blocks, false)?;
        Ok(Stack { layers, norm: Some(self.norm(&format!("{name}.norm"))?), ..Stack::empty() })
    }

    fn blocks(&self, name: &str, count: usize, memory: bool) -> Result<Vec<Block>, GenerateError> {
        (0..count).map(|at| Block::new(*self, &format!("{name}.{at}"), memory)).collect()
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

    /// The whole table, rows x width.
    pub(crate) fn table(&self) -> Tensor<2> {
        let table = self.pe.val();
        let [rows, _, width] = table.dims();
        table.reshape([rows, width])
    }
}

/// Blocks, with skips or without.
#[derive(Module, Debug)]
pub(crate) struct Stack {
    layers: Vec<Block>,
    input_blocks: Vec<Block>,
    middle_block: Option<Block>,
    output_blocks: Vec<Block>,
    linear_blocks: Vec<Linear>,
    norm: Option<LayerNorm>,
}

/// What the blocks of one network say to those of another.
#[derive(Default)]
pub(crate) struct Side<'a> {
    /// Added to what comes out of the first blocks, one each.
    pub(crate) residuals: Option<&'a [Tensor<3>]>,
    /// Takes what comes out of each block, residuals included.
    pub(crate) outputs: Option<&'a mut Vec<Tensor<3>>>,
}

impl Stack {
    fn empty() -> Self {
        Self {
            layers: Vec::new(),
            input_blocks: Vec::new(),
            middle_block: None,
            output_blocks: Vec::new(),
            linear_blocks: Vec::new(),
            norm: None,
        }
    }

    /// Clips x tokens x width; `bias` is added to the scores of attention among the tokens.
    pub(crate) fn forward(
        &self,
        x: Tensor<3>,
        bias: Option<&Tensor<4>>,
        memory: Option<&Tensor<3>>,
    ) -> Tensor<3> {
        self.forward_beside(x, bias, memory, Side::default())
    }

    /// The same, with another network beside it.
    pub(crate) fn forward_beside(
        &self,
        x: Tensor<3>,
        bias: Option<&Tensor<4>>,
        memory: Option<&Tensor<3>>,
        mut side: Side<'_>,
    ) -> Tensor<3> {
        let mut residuals = side.residuals.unwrap_or_default().iter();
        let mut run = |block: &Block, x: Tensor<3>| {
            let mut x = block.forward(x, bias, memory);
            if let Some(residual) = residuals.next() {
                x = x + residual.clone();
            }
            if let Some(outputs) = side.outputs.as_deref_mut() {
                outputs.push(x.clone());
            }
            x
        };
        let mut skips = Vec::with_capacity(self.input_blocks.len());
        let mut x = x;
        for block in &self.layers {
            x = run(block, x);
        }
        for block in &self.input_blocks {
            x = run(block, x);
            skips.push(x.clone());
        }
        if let Some(block) = &self.middle_block {
            x = run(block, x);
        }
        for ((block, join), skip) in
            self.output_blocks.iter().zip(&self.linear_blocks).zip(skips.into_iter().rev())
        {
            x = join.forward(Tensor::cat(vec![x, skip], 2));
            x = run(block, x);
        }
        match &self.norm {
            Some(norm) => norm.forward(x),
            None => x,
        }
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
    dropout: f64,
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
            dropout: source.dropout,
        })
    }

    fn forward(&self, x: Tensor<3>, bias: Option<&Tensor<4>>, memory: Option<&Tensor<3>>) -> Tensor<3> {
        let dropped = |x: Tensor<3>| drop_out(x, self.dropout);
        let part = self.self_attn.forward(x.clone(), None, bias, self.dropout);
        let mut x = self.norm1.forward(x + dropped(part));
        let mut last = &self.norm2;
        if let (Some(attention), Some(norm), Some(memory)) = (&self.multihead_attn, &self.norm3, memory) {
            let part = attention.forward(x.clone(), Some(memory), None, self.dropout);
            x = self.norm2.forward(x + dropped(part));
            last = norm;
        }
        let wide = dropped(gelu(self.linear1.forward(x.clone())));
        let part = self.linear2.forward(wide);
        last.forward(x + dropped(part))
    }
}
