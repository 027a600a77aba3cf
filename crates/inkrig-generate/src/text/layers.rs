//! What both text encoders are made of.

use crate::GenerateError;
use crate::checkpoint::{CheckpointError, TensorSource};
use crate::networks::Linear;
use crate::numeric::elementwise::{dot, softmax};

/// Files of weights in which tensors are looked up, so that none is held twice.
pub(super) struct Files<'a, 'b>(pub(super) &'a mut [&'b mut dyn TensorSource]);

impl Files<'_, '_> {
    /// The numbers of a tensor of this shape.
    pub(super) fn take(&mut self, name: &str, shape: &[usize]) -> Result<Vec<f32>, CheckpointError> {
        for file in self.0.iter_mut() {
            let Some(at) = file.listed().iter().position(|listed| listed.name == name) else { continue };
            if let Some(listed) = file.listed().get(at)
                && listed.shape != shape
            {
                let (expected, got) = (shape.to_vec(), listed.shape.clone());
                return Err(GenerateError::TensorShape { name: name.into(), expected, got }.into());
            }
            return Ok(file.read(at)?.into_data());
        }
        Err(GenerateError::MissingTensor { name: name.into() }.into())
    }

    pub(super) fn linear(
        &mut self,
        name: &str,
        outputs: usize,
        inputs: usize,
        bias: bool,
    ) -> Result<Linear, CheckpointError> {
        let weight = self.take(&format!("{name}.weight"), &[outputs, inputs])?;
        let bias = if bias { self.take(&format!("{name}.bias"), &[outputs])? } else { vec![0.0; outputs] };
        Ok(Linear::of(&weight, &bias, inputs))
    }
}

/// Attention of several heads, which lie side by side; `score` may change the score of (head, query, key).
pub(super) fn attention(
    [queries, keys, values]: [&[f32]; 3],
    width: usize,
    heads: usize,
    score: impl Fn(usize, usize, usize, f32) -> f32,
) -> Vec<f32> {
    let tokens = queries.len() / width;
    let size = width / heads;
    let mut out = vec![0.0; queries.len()];
    let mut scores = vec![0.0; tokens];
    for head in 0..heads {
        let part = |token: usize| token * width + head * size..token * width + (head + 1) * size;
        for query in 0..tokens {
            let own = &queries[part(query)];
            for (key, value) in scores.iter_mut().enumerate() {
                *value = score(head, query, key, dot(own, &keys[part(key)]));
            }
            softmax(&mut scores, tokens, 1.0);
            let out = &mut out[part(query)];
            for (key, share) in scores.iter().enumerate() {
                for (out, value) in out.iter_mut().zip(&values[part(key)]) {
                    *out += share * value;
                }
            }
        }
    }
    out
}

/// The rows of a table that tokens stand for.
pub(super) fn look_up(table: &[f32], width: usize, tokens: &[u32]) -> Result<Vec<f32>, GenerateError> {
    let mut rows = Vec::with_capacity(tokens.len() * width);
    for &token in tokens {
        let start = (token as usize).saturating_mul(width);
        let unknown = || GenerateError::Setting {
            setting: "a token of the tokenizer",
            value: token.to_string(),
            needed: "one that the text encoder knows: both files have to belong together",
        };
        rows.extend_from_slice(table.get(start..start.saturating_add(width)).ok_or_else(unknown)?);
    }
    Ok(rows)
}

/// To length 1.
pub(super) fn normalise(vector: &mut [f32]) {
    let length = vector.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt().max(1e-12);
    for x in vector {
        *x = (f64::from(*x) / length) as f32;
    }
}
