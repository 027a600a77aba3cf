//! A linear layer.

use crate::GenerateError;
use crate::numeric::elementwise::add;
use crate::numeric::product::{Out, OuterWork, Packed, Rows, add_weight_gradient, multiply};
use crate::weights::{Slots, Tensors};
use std::sync::OnceLock;

/// `y = W x + b`, weights laid out for speed.
#[derive(Debug, Clone)]
pub(crate) struct Linear {
    packed: Packed,
    bias: Vec<f32>,
    /// Made when a gradient is first asked for.
    transposed: OnceLock<Packed>,
    slots: Slots,
}

impl Linear {
    pub(crate) fn new(
        weights: &Tensors,
        name: &str,
        outputs: usize,
        inputs: usize,
    ) -> Result<Self, GenerateError> {
        let weight = weights.expect(&format!("{name}.weight"), &[outputs, inputs])?;
        let bias = weights.expect(&format!("{name}.bias"), &[outputs])?;
        Ok(Self { slots: Slots::of(weights, name), ..Self::of(weight, bias, inputs) })
    }

    /// One of the three parts of an attention's packed projection: queries, keys, values.
    pub(crate) fn part(
        weights: &Tensors,
        name: &str,
        width: usize,
        part: usize,
    ) -> Result<Self, GenerateError> {
        let weight = weights.expect(&format!("{name}.in_proj_weight"), &[3 * width, width])?;
        let bias = weights.expect(&format!("{name}.in_proj_bias"), &[3 * width])?;
        let (weight, bias) = (weight.chunks_exact(width * width), bias.chunks_exact(width));
        let (weight, bias) = (weight.skip(part).flatten(), bias.skip(part).flatten());
        let weight: Vec<f32> = weight.take(width * width).copied().collect();
        let bias: Vec<f32> = bias.take(width).copied().collect();
        let slots = Slots {
            weight: weights.place(&format!("{name}.in_proj_weight")) + part * width * width,
            bias: weights.place(&format!("{name}.in_proj_bias")) + part * width,
        };
        Ok(Self { slots, ..Self::of(&weight, &bias, width) })
    }

    /// `outputs x inputs` numbers, row-major, and a bias for each output.
    pub(crate) fn of(weight: &[f32], bias: &[f32], inputs: usize) -> Self {
        let packed = Packed::from_weight(weight, bias.len(), inputs);
        Self { packed, bias: bias.to_vec(), transposed: OnceLock::new(), slots: Slots::default() }
    }

    /// Replaces `out`: as many rows as `x` has.
    pub(crate) fn forward(&self, x: &[f32], out: &mut [f32]) {
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        let rows = Rows { data: x, stride: inputs, count: x.len() / inputs };
        multiply(rows, &self.packed, Some(&self.bias), Out { data: out, stride: outputs, add: false });
    }

    /// The same, in a buffer of its own.
    pub(crate) fn apply(&self, x: &[f32]) -> Vec<f32> {
        let mut out = vec![0.0; x.len() / self.packed.depth() * self.packed.columns()];
        self.forward(x, &mut out);
        out
    }

    /// From the gradient of what came out to that of what went in.
    pub(crate) fn backward(&self, grad: &[f32], out: &mut [f32], add: bool) {
        let transposed = self.transposed.get_or_init(|| self.packed.transposed());
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        let rows = Rows { data: grad, stride: outputs, count: grad.len() / outputs };
        multiply(rows, transposed, None, Out { data: out, stride: inputs, add });
    }

    /// What weight and bias get of the gradient of what came out, added to the row of all gradients; `x` is what went in.
    pub(crate) fn weight_gradient(&self, x: &[f32], grad: &[f32], weights: &mut [f32], work: &mut OuterWork) {
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        let bias = &mut weights[self.slots.bias..][..outputs];
        grad.chunks_exact(outputs).for_each(|row| add(bias, row));
        let weight = &mut weights[self.slots.weight..][..inputs * outputs];
        add_weight_gradient(grad, outputs, x, inputs, weight, work);
    }
}
