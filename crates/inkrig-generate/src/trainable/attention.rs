//! Attention with its projections, for training.

use super::dropout::drop_out;
use super::layers::Source;
use super::named::{parameter, turned};
use crate::GenerateError;
use burn::module::Module;
use burn::nn::Linear;
use burn::tensor::Tensor;
use burn::tensor::activation::softmax;

/// Attention among tokens, or to a memory.
#[derive(Module, Debug)]
pub(crate) struct Attention {
    in_proj: Linear,
    out_proj: Linear,
    heads: usize,
}

impl Attention {
    pub(crate) fn new(source: Source<'_>, name: &str) -> Result<Self, GenerateError> {
        let (width, device) = (source.sizes.width, source.device);
        let weight = turned(source.weights, &format!("{name}.in_proj_weight"), 3 * width, width, device)?;
        let bias = parameter(source.weights, &format!("{name}.in_proj_bias"), [3 * width], device)?;
        let in_proj = Linear { weight, bias: Some(bias) };
        let out_proj = source.linear(&format!("{name}.out_proj"), width, width)?;
        Ok(Self { in_proj, out_proj, heads: source.sizes.heads })
    }

    pub(crate) fn forward(
        &self,
        x: Tensor<3>,
        memory: Option<&Tensor<3>>,
        bias: Option<&Tensor<4>>,
        dropout: f64,
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
        let mixed = drop_out(softmax(scores, 3), dropout).matmul(heads(values));
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
