//! Muon (Jordan 2024): a matrix is moved by its momentum with all singular values made equal, which small transformers learn from in
//! fewer steps than from AdamW. Scaled as by Liu et al. 2025 (0.2 times the root of the longer side), so that AdamW's rates hold.

use super::adamw::{AdamW, Moments};
use inkrig_generate::learning::orthogonalise;
use inkrig_generate::weights::Tensors;
use rayon::prelude::*;

/// How slowly the momentum forgets.
const MOMENTUM: f32 = 0.95;

/// A matrix in the row of all weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Matrix {
    first: usize,
    rows: usize,
    columns: usize,
}

/// The matrices inside blocks: projections of attention (queries, keys and values apart), feed-forward layers and joins of skips. Layers
/// at the ends, tables, tokens, norms and biases are AdamW's.
pub(super) fn matrices(weights: &Tensors) -> Vec<Matrix> {
    let inside = |name: &str| name.split('.').any(|part| part.ends_with("block") || part.ends_with("blocks"));
    matrices_of(weights.iter().map(|(name, tensor)| (name, tensor.shape())), inside)
}

/// The matrices with these names, of tensors that lie one behind the other.
pub(crate) fn matrices_of<'a>(
    tensors: impl Iterator<Item = (&'a str, &'a [usize])>,
    inside: impl Fn(&str) -> bool,
) -> Vec<Matrix> {
    let mut first = 0;
    let mut found = Vec::new();
    for (name, shape) in tensors {
        if let ([rows, columns], true) = (shape, inside(name)) {
            found.push(Matrix { first, rows: *rows, columns: *columns });
        }
        first += shape.iter().product::<usize>();
    }
    found
}

/// One step for all weights: Muon for the matrices, AdamW for what is between them.
pub(crate) fn step(
    matrices: &[Matrix],
    adam: AdamW,
    weights: &mut [f32],
    gradient: &[f32],
    moments: &mut Moments,
    rate: f64,
) {
    let before: Vec<f32> = matrices.iter().flat_map(|own| weights[own.range()].to_vec()).collect();
    let means: Vec<f32> = matrices.iter().flat_map(|own| moments.mean[own.range()].to_vec()).collect();
    adam.step(weights, gradient, moments, rate);
    let mut at = 0;
    let mut work = Vec::with_capacity(matrices.len());
    for &own in matrices {
        let range = at..at + own.rows * own.columns;
        at = range.end;
        let momentum: Vec<f32> = means[range.clone()]
            .iter()
            .zip(&gradient[own.range()])
            .map(|(mean, gradient)| MOMENTUM * mean + (1.0 - MOMENTUM) * gradient)
            .collect();
        work.push((own, range, momentum));
    }
    let moves: Vec<Vec<f32>> = work
        .par_iter()
        .map(|(own, _, momentum)| {
            let ahead: Vec<f32> = momentum
                .iter()
                .zip(&gradient[own.range()])
                .map(|(mean, gradient)| MOMENTUM * mean + (1.0 - MOMENTUM) * gradient)
                .collect();
            equalised(ahead, own.rows, own.columns)
        })
        .collect();
    for ((own, range, momentum), way) in work.into_iter().zip(moves) {
        let by = (rate * 0.2) as f32;
        let keep = 1.0 - (rate * adam.weight_decay) as f32;
        for ((weight, before), way) in weights[own.range()].iter_mut().zip(&before[range]).zip(way) {
            *weight = before * keep - by * way;
        }
        moments.mean[own.range()].copy_from_slice(&momentum);
        moments.square[own.range()].fill(0.0);
    }
}

impl Matrix {
    fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.rows * self.columns
    }
}

/// A packed projection to queries, keys and values is three matrices, one below the other.
fn equalised(mut numbers: Vec<f32>, rows: usize, columns: usize) -> Vec<f32> {
    let parts = if rows == 3 * columns { 3 } else { 1 };
    let each = rows / parts;
    let scale = (each.max(columns) as f32).sqrt();
    for part in numbers.chunks_exact_mut(each * columns) {
        let mut own = part.to_vec();
        orthogonalise(&mut own, each, columns);
        part.iter_mut().zip(own).for_each(|(x, own)| *x = scale * own);
    }
    numbers
}
