//! A picture through a network.

use super::depthwise::{Convolution, Room, convolve};
use super::patches::Grid;
use super::plan::{Kind, Plan, Shape, Value};
use super::weights::{BlockWeights, LayerWeights, Network};
use crate::numeric::elementwise::{add, gelu};
use crate::numeric::fit;
use crate::numeric::normal::Normalised;
use crate::numeric::product::OuterWork;

/// Places of a block whose hidden channels are computed at once, so that they stay in the cache.
pub(super) const PLACES: usize = 160;

/// All tables of one picture's way, and room for their gradients. Made once, used again and again.
#[derive(Debug, Clone, Default)]
pub struct Work {
    pub(super) values: Vec<Vec<f32>>,
    pub(super) kept: Vec<Kept>,
    pub(super) gradients: Vec<Vec<f32>>,
    pub(super) scratch: [Vec<f32>; 3],
    pub(super) outer: OuterWork,
    pub(super) room: Room,
}

/// What a layer's gradient needs.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    /// Patches; or a block's normalised table.
    pub rows: Vec<f32>,
    pub normalised: Normalised,
    /// Before the block's GELU.
    pub before: Vec<f32>,
}

impl Work {
    /// A table of the last picture; empty where none was seen.
    pub fn value(&self, value: Value) -> &[f32] {
        self.values.get(value).map_or(&[], Vec::as_slice)
    }
}

impl Network {
    /// Runs a picture of the plan's shape; a shorter one is filled up with zeros. The tables are in `work` then.
    pub fn forward(&self, picture: &[f32], work: &mut Work) {
        let plan = &self.plan;
        work.values.resize_with(plan.shapes.len(), Vec::new);
        work.kept.resize_with(plan.layers.len(), Kept::default);
        let first = fit(&mut work.values[0], plan.shapes[0].numbers());
        first.fill(0.0);
        first.iter_mut().zip(picture).for_each(|(own, number)| *own = *number);
        for at in 0..plan.layers.len() {
            self.layer(at, work);
        }
    }

    fn layer(&self, at: usize, work: &mut Work) {
        let (plan, layer) = (&self.plan, &self.plan.layers[at]);
        let (before, after) = work.values.split_at_mut(at + 1);
        let (x, kept) = (before[layer.from].as_slice(), &mut work.kept[at]);
        let out = fit(&mut after[0], plan.shapes[at + 1].numbers());
        let inner = plan.shapes[layer.from];
        match (layer.kind, &self.layers[at]) {
            (Kind::Patch { skip, .. }, LayerWeights::Dense(dense)) => {
                let grid = grid(plan, at);
                let rows = fit(&mut kept.rows, grid.depth() * grid.outer.places());
                grid.gather(x, rows);
                dense.forward(rows, out);
                if let Some(skip) = skip {
                    add(out, &before[skip]);
                }
            }
            (Kind::Linear, LayerWeights::Dense(dense)) => dense.forward(x, out),
            (Kind::Norm, LayerWeights::Norm(norm)) => {
                out.copy_from_slice(x);
                norm.forward(out, &mut kept.normalised);
            }
            (Kind::Join { skip }, LayerWeights::Dense(dense)) => {
                let low = fit(&mut kept.rows, inner.places() * dense.outputs());
                dense.forward(x, low);
                out.copy_from_slice(&before[skip]);
                spread(low, Shape { channels: dense.outputs(), ..inner }, out);
            }
            (Kind::Block { kernel, hidden }, LayerWeights::Block(block)) => {
                let BlockWeights { depthwise, bias, norm, first, second } = &**block;
                let rows = fit(&mut kept.rows, inner.numbers());
                let job = Convolution {
                    x,
                    shape: inner,
                    weight: depthwise,
                    kernel,
                    bias: Some(bias),
                    turned: false,
                };
                convolve(&job, &mut work.room, rows);
                norm.forward(rows, &mut kept.normalised);
                let wide = fit(&mut kept.before, inner.places() * hidden);
                let after = fit(&mut work.scratch[0], PLACES * hidden);
                let (deep, width) = (PLACES * hidden, PLACES * inner.channels);
                let tables = rows.chunks(width).zip(wide.chunks_mut(deep)).zip(out.chunks_mut(width));
                for ((rows, wide), out) in tables {
                    first.forward(rows, wide);
                    let after = &mut after[..wide.len()];
                    gelu(wide, after);
                    second.forward(after, out);
                }
                add(out, x);
            }
            _ => {
                let share = 1.0 / inner.places() as f32;
                out.fill(0.0);
                for row in x.chunks_exact(inner.channels) {
                    out.iter_mut().zip(row).for_each(|(sum, number)| *sum += share * number);
                }
            }
        }
    }
}

/// How the patches of a layer lie.
pub(super) fn grid(plan: &Plan, at: usize) -> Grid {
    let layer = &plan.layers[at];
    let (inner, outer) = (plan.shapes[layer.from], plan.shapes[at + 1]);
    match layer.kind {
        Kind::Patch { kernel, stride, pad, .. } => Grid { kernel, stride, pad, inner, outer },
        _ => Grid { kernel: [1, 1], stride: [1, 1], pad: [0, 0], inner, outer },
    }
}

/// Adds every place of a small table to four of a table of twice its size.
fn spread(low: &[f32], shape: Shape, out: &mut [f32]) {
    for (place, row) in low.chunks_exact(shape.channels).enumerate() {
        for to in four(place, shape) {
            add(&mut out[to * shape.channels..][..shape.channels], row);
        }
    }
}

/// The four places of a table of twice the size.
pub(super) fn four(place: usize, shape: Shape) -> [usize; 4] {
    let (y, x) = (place / shape.width, place % shape.width);
    let corner = 4 * y * shape.width + 2 * x;
    [corner, corner + 1, corner + 2 * shape.width, corner + 2 * shape.width + 1]
}
