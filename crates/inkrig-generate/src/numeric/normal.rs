//! Layer normalisation and its gradient.

use super::elementwise::{add, dot, sum};
use super::fit;
use crate::GenerateError;
use crate::weights::{Slots, Tensors};
use pulp::Arch;

/// What PyTorch adds to the variance.
const EPSILON: f32 = 1e-5;

/// Rows are brought to mean 0 and variance 1, then scaled and shifted.
#[derive(Debug, Clone)]
pub(crate) struct LayerNorm {
    scale: Vec<f32>,
    shift: Vec<f32>,
    slots: Slots,
}

/// What the gradient needs of a forward pass.
#[derive(Debug, Clone, Default)]
pub(crate) struct Normalised {
    /// Rows before scale and shift.
    rows: Vec<f32>,
    /// What each row was multiplied with.
    factors: Vec<f32>,
}

impl LayerNorm {
    pub(crate) fn new(weights: &Tensors, name: &str, width: usize) -> Result<Self, GenerateError> {
        let scale = weights.expect(&format!("{name}.weight"), &[width])?.to_vec();
        let shift = weights.expect(&format!("{name}.bias"), &[width])?.to_vec();
        Ok(Self { scale, shift, slots: Slots::of(weights, name) })
    }

    /// Of scales, and shifts behind them; so the gradient has them, too.
    pub(crate) fn of(weights: &[f32]) -> Self {
        let width = weights.len() / 2;
        let (scale, shift) = weights.split_at(width);
        Self { scale: scale.to_vec(), shift: shift.to_vec(), slots: Slots { weight: 0, bias: width } }
    }

    /// In place.
    pub(crate) fn forward(&self, x: &mut [f32], kept: &mut Normalised) {
        let width = self.scale.len();
        let rows = fit(&mut kept.rows, x.len());
        let factors = fit(&mut kept.factors, x.len() / width);
        Arch::new().dispatch(
            #[inline(always)]
            || {
                let tables = x.chunks_exact_mut(width).zip(rows.chunks_exact_mut(width));
                for ((x, row), factor) in tables.zip(factors) {
                    let mean = sum(x) / width as f32;
                    for (row, x) in row.iter_mut().zip(&*x) {
                        *row = x - mean;
                    }
                    *factor = 1.0 / (dot(row, row) / width as f32 + EPSILON).sqrt();
                    for (row, x) in row.iter_mut().zip(&mut *x) {
                        *row *= *factor;
                        *x = *row;
                    }
                    for ((x, scale), shift) in x.iter_mut().zip(&self.scale).zip(&self.shift) {
                        *x = *x * scale + shift;
                    }
                }
            },
        );
    }

    /// What scale and shift get of the gradient of the result, added to `weights`.
    pub(crate) fn weight_gradient(&self, grad: &[f32], kept: &Normalised, weights: &mut [f32]) {
        let width = self.scale.len();
        let mut sums = [vec![0.0_f32; width], vec![0.0_f32; width]];
        Arch::new().dispatch(
            #[inline(always)]
            || {
                let [scale, shift] = &mut sums;
                for (grad, row) in grad.chunks_exact(width).zip(kept.rows.chunks_exact(width)) {
                    let sums = scale.iter_mut().zip(shift.iter_mut());
                    for (((scale, shift), grad), row) in sums.zip(grad).zip(row) {
                        *scale += grad * row;
                        *shift += grad;
                    }
                }
            },
        );
        add(&mut weights[self.slots.weight..][..width], &sums[0]);
        add(&mut weights[self.slots.bias..][..width], &sums[1]);
    }

    /// From the gradient of the result to that of what went in, in place.
    pub(crate) fn backward(&self, grad: &mut [f32], kept: &Normalised) {
        let width = self.scale.len();
        Arch::new().dispatch(
            #[inline(always)]
            || {
                let tables = grad.chunks_exact_mut(width).zip(kept.rows.chunks_exact(width));
                for ((grad, row), factor) in tables.zip(&kept.factors) {
                    for (grad, scale) in grad.iter_mut().zip(&self.scale) {
                        *grad *= scale;
                    }
                    let mean = sum(grad) / width as f32;
                    let along = dot(grad, row) / width as f32;
                    for (grad, row) in grad.iter_mut().zip(row) {
                        *grad = factor * (*grad - mean - along * row);
                    }
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::numbers;
    use super::*;

    #[test]
    fn rows_are_normal_and_the_gradient_is_a_difference() {
        let norm =
            LayerNorm { scale: numbers(1, 20), shift: numbers(2, 20), slots: Slots { weight: 0, bias: 20 } };
        let (x, way) = (numbers(3, 40), numbers(4, 40));
        let run = |x: &[f32]| {
            let (mut out, mut kept) = (x.to_vec(), Normalised::default());
            norm.forward(&mut out, &mut kept);
            (out.iter().zip(&way).map(|(a, b)| f64::from(a * b)).sum::<f64>(), kept)
        };
        let (_, kept) = run(&x);
        assert!(
            sum(&kept.rows[..20]).abs() < 1e-5
                && (dot(&kept.rows[..20], &kept.rows[..20]) - 20.0).abs() < 1e-3
        );
        let mut grad = way.clone();
        norm.backward(&mut grad, &kept);
        let mut weights = vec![0.0; 40];
        norm.weight_gradient(&way, &kept, &mut weights);
        let shift: f32 = [0, 20].iter().map(|row| way[row + 3]).sum();
        assert!((weights[23] - shift).abs() < 1e-5);
        let scale: f32 = [0, 20].iter().map(|row| way[row + 3] * kept.rows[row + 3]).sum();
        assert!((weights[3] - scale).abs() < 1e-5);
        for at in [0, 7, 25] {
            let (mut more, mut less) = (x.clone(), x.clone());
            more[at] += 1e-2;
            less[at] -= 1e-2;
            let slope = (run(&more).0 - run(&less).0) / 2e-2;
            assert!((slope - f64::from(grad[at])).abs() < 2e-3, "{slope} {}", grad[at]);
        }
    }
}
