//! Products of a few rows with a large matrix that stays: rows are tokens, the matrix is a weight.
//!
//! A general product packs its operands at every call. Here the weight is packed once, in panels of 32 outputs, and
//! read from front to back: with three tokens the time is that of reading the weight from memory.

use pulp::{Arch, Simd, WithSimd};
use std::array;

/// Outputs in a panel. Twice the floats of the widest register, so that a tile is rows x 2 registers.
const PANEL: usize = 32;
/// Rows of a tile where there are 32 registers; 16 registers hold 6.
const MOST_ROWS: usize = 8;

/// A matrix of `depth` x `columns`, laid out for [`multiply`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Packed {
    depth: usize,
    columns: usize,
    panels: Vec<f32>,
}

impl Packed {
    /// From outputs x inputs, as PyTorch keeps a linear layer's weight: `x` times this is `x W^T`.
    pub(crate) fn from_weight(weight: &[f32], outputs: usize, inputs: usize) -> Self {
        let mut packed = Self::default();
        packed.fill_transposed(weight, inputs, outputs, inputs);
        packed
    }

    /// What the gradient is multiplied with: `x` times this is `x W`.
    pub(crate) fn transposed(&self) -> Self {
        let mut rows = vec![0.0; self.depth * self.columns];
        for (panel, numbers) in self.panels.chunks_exact((self.depth * PANEL).max(1)).enumerate() {
            let first = panel * PANEL;
            let width = PANEL.min(self.columns - first);
            for (row, numbers) in rows.chunks_exact_mut(self.columns).zip(numbers.chunks_exact(PANEL)) {
                row[first..first + width].copy_from_slice(&numbers[..width]);
            }
        }
        Self::from_weight(&rows, self.depth, self.columns)
    }

    /// Takes over `depth` rows of `columns` numbers, `stride` apart.
    pub(crate) fn fill(&mut self, rows: &[f32], depth: usize, columns: usize, stride: usize) {
        self.shape(depth, columns);
        for (panel, numbers) in self.panels.chunks_exact_mut((depth * PANEL).max(1)).enumerate() {
            let first = panel * PANEL;
            let width = PANEL.min(columns - first);
            for (row, numbers) in rows.chunks(stride).zip(numbers.chunks_exact_mut(PANEL)) {
                numbers[..width].copy_from_slice(&row[first..first + width]);
                numbers[width..].fill(0.0);
            }
        }
    }

    /// Takes over `columns` rows of `depth` numbers, `stride` apart.
    pub(crate) fn fill_transposed(&mut self, rows: &[f32], depth: usize, columns: usize, stride: usize) {
        self.shape(depth, columns);
        for (panel, numbers) in self.panels.chunks_exact_mut((depth * PANEL).max(1)).enumerate() {
            let first = panel * PANEL;
            let width = PANEL.min(columns - first);
            for column in 0..width {
                let row = &rows[(first + column) * stride..][..depth];
                for (numbers, value) in numbers.chunks_exact_mut(PANEL).zip(row) {
                    numbers[column] = *value;
                }
            }
            for numbers in numbers.chunks_exact_mut(PANEL) {
                numbers[width..].fill(0.0);
            }
        }
    }

    pub(crate) fn depth(&self) -> usize {
        self.depth
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    fn shape(&mut self, depth: usize, columns: usize) {
        (self.depth, self.columns) = (depth, columns);
        self.panels.resize(columns.div_ceil(PANEL) * PANEL * depth, 0.0);
    }
}

/// Rows of a larger table, `stride` apart.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) data: &'a [f32],
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

/// Rows that are to be written.
pub(crate) struct Out<'a> {
    pub(crate) data: &'a mut [f32],
    pub(crate) stride: usize,
    /// Whether the product is added to what is there, or replaces it.
    pub(crate) add: bool,
}

/// `out = x packed + bias`, one row a row of `x`.
pub(crate) fn multiply(x: Rows<'_>, packed: &Packed, bias: Option<&[f32]>, out: Out<'_>) {
    Arch::new().dispatch(Product { x, packed, bias, out });
}

/// Buffers of [`add_weight_gradient`].
#[derive(Debug, Clone, Default)]
pub(crate) struct OuterWork {
    packed: Packed,
    turned: Vec<f32>,
}

/// Rows that are turned and packed at a time, so that a panel stays in the nearest cache.
const OUTER_ROWS: usize = 256;

/// `out += grad^T x`: from what came out of a linear layer (rows of `outputs` numbers) and what went in (`inputs`), the
/// gradient of its weight, outputs x inputs.
pub(crate) fn add_weight_gradient(
    grad: &[f32],
    outputs: usize,
    x: &[f32],
    inputs: usize,
    out: &mut [f32],
    work: &mut OuterWork,
) {
    let chunks = grad.chunks(OUTER_ROWS * outputs).zip(x.chunks(OUTER_ROWS * inputs));
    for (grad, x) in chunks {
        let rows = grad.len() / outputs;
        work.turned.resize(grad.len(), 0.0);
        turn(grad, outputs, rows, &mut work.turned);
        work.packed.fill(x, rows, inputs, inputs);
        let turned = Rows { data: &work.turned, stride: rows, count: outputs };
        multiply(turned, &work.packed, None, Out { data: out, stride: inputs, add: true });
    }
}

/// In squares, so that both tables are read and written by cache lines.
fn turn(table: &[f32], width: usize, height: usize, out: &mut [f32]) {
    const SIDE: usize = 16;
    for top in (0..height).step_by(SIDE) {
        let bottom = (top + SIDE).min(height);
        for left in (0..width).step_by(SIDE) {
            for column in left..(left + SIDE).min(width) {
                let line = &mut out[column * height + top..column * height + bottom];
                for (value, row) in line.iter_mut().zip(top..bottom) {
                    *value = table[row * width + column];
                }
            }
        }
    }
}

struct Product<'a> {
    x: Rows<'a>,
    packed: &'a Packed,
    bias: Option<&'a [f32]>,
    out: Out<'a>,
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let most = if S::REGISTER_COUNT >= 32 { MOST_ROWS } else { 6 };
        let depth = self.packed.depth;
        for (panel, weights) in self.packed.panels.chunks_exact((depth * PANEL).max(1)).enumerate() {
            let mut row = 0;
            while row < self.x.count {
                let rows = (self.x.count - row).min(most);
                match rows {
                    1 => self.tile::<S, 1>(simd, row, panel, weights),
                    2 => self.tile::<S, 2>(simd, row, panel, weights),
                    3 => self.tile::<S, 3>(simd, row, panel, weights),
                    4 => self.tile::<S, 4>(simd, row, panel, weights),
                    5 => self.tile::<S, 5>(simd, row, panel, weights),
                    6 => self.tile::<S, 6>(simd, row, panel, weights),
                    7 => self.tile::<S, 7>(simd, row, panel, weights),
                    _ => self.tile::<S, MOST_ROWS>(simd, row, panel, weights),
                }
                row += rows;
            }
        }
    }
}

impl Product<'_> {
    /// `ROWS` rows times one panel.
    #[inline(always)]
    fn tile<S: Simd, const ROWS: usize>(&mut self, simd: S, row: usize, panel: usize, weights: &[f32]) {
        let depth = self.packed.depth;
        let x: [&[f32]; ROWS] = array::from_fn(|at| &self.x.data[(row + at) * self.x.stride..][..depth]);
        let mut sums = [[0.0_f32; PANEL]; ROWS];
        let width = 2 * S::F32_LANES;
        for first in (0..PANEL).step_by(width) {
            let mut tile = [[simd.splat_f32s(0.0); 2]; ROWS];
            for k in 0..depth {
                let (weights, _) = S::as_simd_f32s(&weights[k * PANEL + first..][..width]);
                let (left, right) = (weights[0], weights[1]);
                for at in 0..ROWS {
                    let value = simd.splat_f32s(x[at][k]);
                    tile[at][0] = simd.mul_add_e_f32s(value, left, tile[at][0]);
                    tile[at][1] = simd.mul_add_e_f32s(value, right, tile[at][1]);
                }
            }
            for at in 0..ROWS {
                let (sums, _) = S::as_mut_simd_f32s(&mut sums[at][first..first + width]);
                sums[0] = tile[at][0];
                sums[1] = tile[at][1];
            }
        }
        let first = panel * PANEL;
        let columns = PANEL.min(self.packed.columns - first);
        for (at, sums) in sums.iter_mut().enumerate() {
            if let Some(bias) = self.bias {
                for (sum, bias) in sums.iter_mut().zip(&bias[first..first + columns]) {
                    *sum += bias;
                }
            }
            let out = &mut self.out.data[(row + at) * self.out.stride + first..][..columns];
            if self.out.add {
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out += *sum;
                }
            } else {
                out.copy_from_slice(&sums[..columns]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{apart, numbers};
    use super::*;

    fn plain(x: &[f32], rows: usize, weight: &[f32], outputs: usize, inputs: usize) -> Vec<f32> {
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>() as f32;
        (0..rows * outputs)
            .map(|at| dot(&x[at / outputs * inputs..][..inputs], &weight[at % outputs * inputs..][..inputs]))
            .collect()
    }

    #[test]
    fn products_of_all_shapes_are_those_of_plain_sums() {
        for (rows, outputs, inputs) in [(1, 1, 1), (3, 32, 7), (6, 33, 64), (41, 263, 40), (17, 5, 128)] {
            let (x, weight) = (numbers(1, rows * inputs), numbers(2, outputs * inputs));
            let bias = numbers(3, outputs);
            let packed = Packed::from_weight(&weight, outputs, inputs);
            let mut out = vec![0.0; rows * outputs];
            let x_rows = Rows { data: &x, stride: inputs, count: rows };
            let into = Out { data: &mut out, stride: outputs, add: false };
            multiply(x_rows, &packed, Some(&bias), into);
            let mut expected = plain(&x, rows, &weight, outputs, inputs);
            expected.iter_mut().enumerate().for_each(|(at, value)| *value += bias[at % outputs]);
            assert!(apart(&out, &expected) < 2e-5, "{rows} {outputs} {inputs}");

            // What the layer's own weight gets of a gradient, added to what is there.
            let mut of_weight = vec![1.0; outputs * inputs];
            add_weight_gradient(&out, outputs, &x, inputs, &mut of_weight, &mut OuterWork::default());
            let (mut turned_out, mut turned_x) = (vec![0.0; out.len()], vec![0.0; x.len()]);
            turn(&out, outputs, rows, &mut turned_out);
            turn(&x, inputs, rows, &mut turned_x);
            let outer = plain(&turned_out, outputs, &turned_x, inputs, rows);
            let expected: Vec<f32> = outer.iter().map(|value| value + 1.0).collect();
            assert!(apart(&of_weight, &expected) < 2e-3, "{rows} {outputs} {inputs}");

            // The transposed one, added to what is there.
            let mut back = vec![1.0; rows * inputs];
            let grad = Rows { data: &out, stride: outputs, count: rows };
            multiply(grad, &packed.transposed(), None, Out { data: &mut back, stride: inputs, add: true });
            let turned: Vec<f32> =
                (0..inputs * outputs).map(|at| weight[at % outputs * inputs + at / outputs]).collect();
            let mut expected = plain(&out, rows, &turned, inputs, outputs);
            expected.iter_mut().for_each(|value| *value += 1.0);
            assert!(apart(&back, &expected) < 2e-3, "{rows} {outputs} {inputs}");
        }
    }

    #[test]
    fn a_row_does_not_depend_on_the_rows_beside_it() {
        let (x, weight) = (numbers(1, 11 * 96), numbers(2, 40 * 96));
        let packed = Packed::from_weight(&weight, 40, 96);
        let mut all = vec![0.0; 11 * 40];
        let rows = Rows { data: &x, stride: 96, count: 11 };
        multiply(rows, &packed, None, Out { data: &mut all, stride: 40, add: false });
        let mut one = vec![0.0; 40];
        let rows = Rows { data: &x[9 * 96..], stride: 96, count: 1 };
        multiply(rows, &packed, None, Out { data: &mut one, stride: 40, add: false });
        assert_eq!(all[9 * 40..10 * 40], one);
    }
}
