//! From gradients of what came out to that of all weights.

use super::depthwise::{Convolution, convolve, weight_gradient};
use super::forward::{PLACES, Work, four, grid};
use super::plan::{Kind, Shape, Value};
use super::weights::{BlockWeights, LayerWeights, Network};
use crate::numeric::elementwise::{add, gelu_again};
use crate::numeric::fit;

impl Network {
    /// Adds to the row of all weights' gradients, by the gradients of some tables of the picture that [`Network::forward`] saw last.
    /// A gradient or a row of another length than it needs is taken as far as it goes.
    pub fn backward(&self, work: &mut Work, of: &[(Value, &[f32])], row: &mut [f32]) {
        let plan = &self.plan;
        if row.len() != plan.numbers() || work.values.len() != plan.shapes.len() {
            return;
        }
        work.gradients.resize_with(plan.shapes.len(), Vec::new);
        for (gradient, shape) in work.gradients.iter_mut().zip(&plan.shapes) {
            fit(gradient, shape.numbers()).fill(0.0);
        }
        for (value, gradient) in of {
            let own = &mut work.gradients[*value];
            let count = own.len().min(gradient.len());
            add(&mut own[..count], &gradient[..count]);
        }
        for at in (0..plan.layers.len()).rev() {
            self.layer_backward(at, work, row);
        }
    }

    fn layer_backward(&self, at: usize, work: &mut Work, row: &mut [f32]) {
        let (plan, layer) = (&self.plan, &self.plan.layers[at]);
        let (before, after) = work.gradients.split_at_mut(at + 1);
        let (grad, kept) = (after[0].as_mut_slice(), &work.kept[at]);
        let (x, own) = (work.values[layer.from].as_slice(), &mut row[layer.weights.clone()]);
        let inner = plan.shapes[layer.from];
        let [s1, s2, s3] = &mut work.scratch;
        let outer = &mut work.outer;
        match (layer.kind, &self.layers[at]) {
            (Kind::Patch { skip, .. }, LayerWeights::Dense(dense)) => {
                if let Some(skip) = skip {
                    add(&mut before[skip], grad);
                }
                dense.weight_gradient(&kept.rows, grad, own, outer);
                if layer.from > 0 {
                    let grid = grid(plan, at);
                    let rows = fit(s1, grid.depth() * grid.outer.places());
                    dense.backward(grad, rows, false);
                    grid.scatter(rows, &mut before[layer.from]);
                }
            }
            (Kind::Linear, LayerWeights::Dense(dense)) => {
                dense.weight_gradient(x, grad, own, outer);
                dense.backward(grad, &mut before[layer.from], true);
            }
            (Kind::Norm, LayerWeights::Norm(norm)) => {
                norm.weight_gradient(grad, &kept.normalised, own);
                norm.backward(grad, &kept.normalised);
                add(&mut before[layer.from], grad);
            }
            (Kind::Join { skip }, LayerWeights::Dense(dense)) => {
                add(&mut before[skip], grad);
                let low = fit(s1, inner.places() * dense.outputs());
                gather(grad, Shape { channels: dense.outputs(), ..inner }, low);
                dense.weight_gradient(x, low, own, outer);
                dense.backward(low, &mut before[layer.from], true);
            }
            (Kind::Block { kernel, hidden }, LayerWeights::Block(block)) => {
                let BlockWeights { depthwise, norm, first, second, .. } = &**block;
                let width = inner.channels;
                let (to_depthwise, own) = own.split_at_mut(kernel * kernel * width);
                let (to_bias, own) = own.split_at_mut(width);
                let (to_norm, own) = own.split_at_mut(2 * width);
                let (to_first, to_second) = own.split_at_mut(hidden * (width + 1));
                let rows = fit(s2, inner.numbers());
                let (deep, width) = (PLACES * hidden, PLACES * inner.channels);
                let (wide, after) = fit(s1, 2 * deep).split_at_mut(deep);
                let tables = grad.chunks(width).zip(kept.before.chunks(deep));
                for ((grad, before), (kept, rows)) in
                    tables.zip(kept.rows.chunks(width).zip(rows.chunks_mut(width)))
                {
                    let (wide, after) = (&mut wide[..before.len()], &mut after[..before.len()]);
                    second.backward(grad, wide, false);
                    gelu_again(before, after, wide);
                    second.weight_gradient(after, grad, to_second, outer);
                    first.weight_gradient(kept, wide, to_first, outer);
                    first.backward(wide, rows, false);
                }
                norm.weight_gradient(rows, &kept.normalised, to_norm);
                norm.backward(rows, &kept.normalised);
                let room = &mut work.room;
                weight_gradient(x, inner, rows, kernel, room, (to_depthwise, to_bias));
                let back = fit(s3, inner.numbers());
                let job = Convolution {
                    x: rows,
                    shape: inner,
                    weight: depthwise,
                    kernel,
                    bias: None,
                    turned: true,
                };
                convolve(&job, room, back);
                let into = &mut before[layer.from];
                add(into, back);
                add(into, grad);
            }
            _ => {
                let share = 1.0 / inner.places() as f32;
                for row in before[layer.from].chunks_exact_mut(inner.channels) {
                    row.iter_mut().zip(&*grad).for_each(|(sum, part)| *sum += share * part);
                }
            }
        }
    }
}

/// Every place of a small table becomes the sum of four.
fn gather(grad: &[f32], shape: Shape, low: &mut [f32]) {
    for (place, row) in low.chunks_exact_mut(shape.channels).enumerate() {
        row.fill(0.0);
        for from in four(place, shape) {
            add(row, &grad[from * shape.channels..][..shape.channels]);
        }
    }
}
