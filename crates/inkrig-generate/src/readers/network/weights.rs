//! A plan with its weights, laid out to be run.

use super::plan::{Kind, Plan};
use crate::GenerateError;
use crate::networks::Linear;
use crate::numeric::normal::LayerNorm;
use crate::weights::{Tensor, Tensors};

/// A network that can be run, and taught.
#[derive(Debug, Clone)]
pub struct Network {
    pub(super) plan: Plan,
    pub(super) layers: Vec<LayerWeights>,
    /// Whether products are of half the precision where the processor is quick at them.
    half: bool,
}

#[derive(Debug, Clone)]
pub(super) enum LayerWeights {
    Dense(Linear),
    Block(Box<BlockWeights>),
    Norm(LayerNorm),
    Nothing,
}

#[derive(Debug, Clone)]
pub(super) struct BlockWeights {
    pub depthwise: Vec<f32>,
    pub bias: Vec<f32>,
    pub norm: LayerNorm,
    pub first: Linear,
    pub second: Linear,
}

impl Network {
    /// Lays out a row of all weights.
    ///
    /// # Errors
    /// When the row has another length than the plan.
    pub fn new(plan: Plan, row: &[f32]) -> Result<Self, GenerateError> {
        let layers = lay_out(&plan, row, false)?;
        Ok(Self { plan, layers, half: false })
    }

    /// The same for teaching: where the processor is faster at it, products are rounded to bfloat16.
    ///
    /// # Errors
    /// As for [`Network::new`].
    pub fn taught(plan: Plan, row: &[f32]) -> Result<Self, GenerateError> {
        let layers = lay_out(&plan, row, true)?;
        Ok(Self { plan, layers, half: true })
    }

    /// Takes other weights.
    ///
    /// # Errors
    /// When the row has another length than the plan.
    pub fn set(&mut self, row: &[f32]) -> Result<(), GenerateError> {
        self.layers = lay_out(&self.plan, row, self.half)?;
        Ok(())
    }

    /// What it consists of.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// A network of named tensors.
    ///
    /// # Errors
    /// When a tensor is missing or has another shape.
    pub fn from_tensors(plan: Plan, tensors: &Tensors) -> Result<Self, GenerateError> {
        let mut row = Vec::with_capacity(plan.numbers());
        for (name, shape) in plan.tensors() {
            row.extend_from_slice(tensors.expect(name, shape)?);
        }
        Self::new(plan, &row)
    }

    /// The row of all weights as named tensors.
    ///
    /// # Errors
    /// When the row has another length than the plan.
    pub fn to_tensors(plan: &Plan, row: &[f32]) -> Result<Tensors, GenerateError> {
        let mut rest = row;
        plan.tensors()
            .map(|(name, shape)| {
                let count = shape.iter().product();
                let (own, after) = rest.split_at_checked(count).ok_or_else(|| wrong(plan, row))?;
                rest = after;
                Ok((name.to_owned(), Tensor::new(shape.to_vec(), own.to_vec())?))
            })
            .collect()
    }
}

fn lay_out(plan: &Plan, row: &[f32], half: bool) -> Result<Vec<LayerWeights>, GenerateError> {
    if row.len() != plan.numbers() {
        return Err(wrong(plan, row));
    }
    let dense = |weight: &[f32], bias: &[f32]| Linear::beside(weight, bias, half);
    let layers = plan.layers.iter().enumerate().map(|(at, layer)| {
        let own = &row[layer.weights.clone()];
        let (from, out) = (plan.shapes[layer.from].channels, plan.shapes[at + 1].channels);
        match layer.kind {
            Kind::Mean => LayerWeights::Nothing,
            Kind::Norm => LayerWeights::Norm(LayerNorm::of(own)),
            Kind::Patch { .. } | Kind::Join { .. } | Kind::Linear => {
                let (weight, bias) = own.split_at(own.len() - out);
                LayerWeights::Dense(dense(weight, bias))
            }
            Kind::Block { kernel, hidden } => {
                let (depthwise, own) = own.split_at(kernel * kernel * from);
                let (bias, own) = own.split_at(from);
                let (norm, own) = own.split_at(2 * from);
                let (first, own) = own.split_at(hidden * from);
                let (first_bias, own) = own.split_at(hidden);
                let (second, second_bias) = own.split_at(hidden * from);
                LayerWeights::Block(Box::new(BlockWeights {
                    depthwise: depthwise.to_vec(),
                    bias: bias.to_vec(),
                    norm: LayerNorm::of(norm),
                    first: dense(first, first_bias),
                    second: dense(second, second_bias),
                }))
            }
        }
    });
    Ok(layers.collect())
}

fn wrong(plan: &Plan, row: &[f32]) -> GenerateError {
    GenerateError::Length { what: "row of weights", expected: plan.numbers(), got: row.len() }
}
