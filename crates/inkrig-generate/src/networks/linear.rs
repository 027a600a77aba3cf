//! A linear layer.

use crate::GenerateError;
use crate::numeric::elementwise::add_rows;
use crate::numeric::half::{HalfPacked, HalfWork, add_half_weight_gradient, available, multiply_half};
use crate::numeric::product::{Out, OuterWork, Packed, Rows, add_weight_gradient, multiply};
use crate::weights::{Slots, Tensors};
use std::cell::RefCell;
use std::sync::OnceLock;

/// `y = W x + b`, weights laid out for speed.
#[derive(Debug, Clone)]
pub(crate) struct Linear {
    packed: Packed,
    bias: Vec<f32>,
    /// Made when a gradient is first asked for.
    transposed: OnceLock<Packed>,
    slots: Slots,
    half: Option<Box<HalfLinear>>,
}

/// The same weights in half the precision, both ways round.
#[derive(Debug, Clone)]
struct HalfLinear {
    packed: HalfPacked,
    transposed: HalfPacked,
}

/// Products of fewer rows gain nothing from half the precision.
const LEAST_ROWS: usize = 32;

thread_local! {
    static HALF_WORK: RefCell<(HalfWork, HalfPacked)> = RefCell::default();
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
        let half = half(weights, weight, bias.len(), inputs);
        Ok(Self { slots: Slots::of(weights, name), half, ..Self::of(weight, bias, inputs) })
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
        let half = half(weights, &weight, width, width);
        Ok(Self { slots, half, ..Self::of(&weight, &bias, width) })
    }

    /// `outputs x inputs` numbers, row-major, and a bias for each output.
    pub(crate) fn of(weight: &[f32], bias: &[f32], inputs: usize) -> Self {
        let packed = Packed::from_weight(weight, bias.len(), inputs);
        Self { packed, bias: bias.to_vec(), transposed: OnceLock::new(), slots: Slots::default(), half: None }
    }

    /// The same, its gradients in the places of a name.
    pub(crate) fn at(self, weights: &Tensors, name: &str) -> Self {
        Self { slots: Slots::of(weights, name), ..self }
    }

    /// A layer whose gradients lie one behind the other, as its weights do: outputs x inputs, then the biases. With `half`, products are
    /// of half the precision where the processor is faster at them.
    pub(crate) fn beside(weight: &[f32], bias: &[f32], with_half: bool) -> Self {
        let inputs = weight.len() / bias.len().max(1);
        let half = (with_half && available()).then(|| Box::new(HalfLinear::of(weight, bias.len(), inputs)));
        let slots = Slots { weight: 0, bias: weight.len() };
        Self { slots, half, ..Self::of(weight, bias, inputs) }
    }

    /// How many numbers come out.
    pub(crate) fn outputs(&self) -> usize {
        self.packed.columns()
    }

    /// Replaces `out`: as many rows as `x` has.
    pub(crate) fn forward(&self, x: &[f32], out: &mut [f32]) {
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        if let Some(half) = self.half.as_ref().filter(|_| x.len() >= LEAST_ROWS * inputs) {
            return HALF_WORK.with_borrow_mut(|(work, _)| {
                multiply_half(x, &half.packed, Some(&self.bias), out, false, work);
            });
        }
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
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        if let Some(half) = self.half.as_ref().filter(|_| grad.len() >= LEAST_ROWS * outputs) {
            return HALF_WORK.with_borrow_mut(|(work, _)| {
                multiply_half(grad, &half.transposed, None, out, add, work);
            });
        }
        let transposed = self.transposed.get_or_init(|| self.packed.transposed());
        let rows = Rows { data: grad, stride: outputs, count: grad.len() / outputs };
        multiply(rows, transposed, None, Out { data: out, stride: inputs, add });
    }

    /// What weight and bias get of the gradient of what came out, added to the row of all gradients; `x` is what went in.
    pub(crate) fn weight_gradient(&self, x: &[f32], grad: &[f32], weights: &mut [f32], work: &mut OuterWork) {
        let outputs = self.packed.columns();
        let bias = &mut weights[self.slots.bias..][..outputs];
        add_rows(bias, grad);
        self.matrix_gradient(x, grad, weights, work);
    }

    /// The same for a layer without bias.
    pub(crate) fn matrix_gradient(&self, x: &[f32], grad: &[f32], weights: &mut [f32], work: &mut OuterWork) {
        let (inputs, outputs) = (self.packed.depth(), self.packed.columns());
        let weight = &mut weights[self.slots.weight..][..inputs * outputs];
        if self.half.is_some() {
            return HALF_WORK.with_borrow_mut(|(work, packed)| {
                add_half_weight_gradient(grad, outputs, x, inputs, weight, (work, packed));
            });
        }
        add_weight_gradient(grad, outputs, x, inputs, weight, work);
    }
}

/// Made where the weights ask for it and the processor is faster at it.
fn half(weights: &Tensors, weight: &[f32], outputs: usize, inputs: usize) -> Option<Box<HalfLinear>> {
    weights.in_half_precision().then(|| Box::new(HalfLinear::of(weight, outputs, inputs)))
}

impl HalfLinear {
    fn of(weight: &[f32], outputs: usize, inputs: usize) -> Self {
        let (mut packed, mut transposed) = (HalfPacked::default(), HalfPacked::default());
        packed.fill_transposed(weight, inputs, outputs);
        transposed.fill(weight, outputs, inputs);
        Self { packed, transposed }
    }
}
