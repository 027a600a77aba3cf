//! Products in half the precision, for training: factors are rounded to bfloat16, sums stay f32. On processors with AMX tiles that is ten
//! times as fast as single precision, on those that multiply pairs of bfloat16 twice; on others there is no such product, and callers
//! stay with [`super::product`].
// Without such a processor nothing of this is reached.
#![cfg_attr(not(all(target_arch = "x86_64", target_os = "linux")), allow(dead_code, unused_variables))]

#[cfg(target_arch = "x86_64")]
mod dots;
mod round;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod tiles;

use super::fit;
use pulp::Arch;
use round::{pair_of, round_pairs, round_rows};
use std::array;
use std::sync::OnceLock;

/// Rows, and columns of 32 bits, of a tile.
const SIDE: usize = 16;
/// Numbers of the shared axis that a tile takes.
const DEPTH: usize = 2 * SIDE;
/// Rows and columns that are computed at once: two tiles each.
const BLOCK: usize = 2 * SIDE;

/// What this processor has for such products.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    /// AMX, and a system that lets this program use it.
    Tiles,
    /// Products of pairs.
    Dots,
    None,
}

/// Asked once.
fn unit() -> Unit {
    static UNIT: OnceLock<Unit> = OnceLock::new();
    *UNIT.get_or_init(|| {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        if tiles::request() {
            return Unit::Tiles;
        }
        #[cfg(target_arch = "x86_64")]
        if dots::available() {
            return Unit::Dots;
        }
        Unit::None
    })
}

/// Whether this processor has such products.
pub(crate) fn available() -> bool {
    unit() != Unit::None
}

/// A matrix of `depth` x `columns`, laid out in tiles.
#[derive(Debug, Clone, Default)]
pub(crate) struct HalfPacked {
    depth: usize,
    columns: usize,
    /// Blocks of 32 columns; in each, for every 32 of the depth, two tiles of 16 pairs of rows x 16 columns.
    tiles: Vec<u32>,
}

impl HalfPacked {
    /// Takes over `depth` rows of `columns` numbers.
    pub(crate) fn fill(&mut self, rows: &[f32], depth: usize, columns: usize) {
        self.shape(depth, columns);
        for pair in 0..depth.div_ceil(DEPTH) * SIDE {
            let two = [2 * pair, 2 * pair + 1].map(|row| row_of(rows, row, columns));
            let place = |side| line(depth, pair, side);
            round_pairs(two, columns.div_ceil(BLOCK) * 2, &mut self.tiles, place);
        }
    }

    /// Takes over `columns` rows of `depth` numbers.
    pub(crate) fn fill_transposed(&mut self, rows: &[f32], depth: usize, columns: usize) {
        self.shape(depth, columns);
        self.tiles.fill(0);
        for (column, row) in rows.chunks(depth).take(columns).enumerate() {
            for (at, two) in row.chunks(2).enumerate() {
                let place = line(depth, at, column / SIDE) + column % SIDE;
                let (upper, lower) = (two[0], two.get(1).copied().unwrap_or(0.0));
                self.tiles[place] = pair_of(upper, lower);
            }
        }
    }

    fn shape(&mut self, depth: usize, columns: usize) {
        (self.depth, self.columns) = (depth, columns);
        self.tiles.resize(columns.div_ceil(BLOCK) * BLOCK * depth.div_ceil(DEPTH) * SIDE, 0);
    }
}

/// Where 16 columns of a pair of rows begin among the tiles.
#[inline(always)]
fn line(depth: usize, pair: usize, side: usize) -> usize {
    let tile = (side / 2 * depth.div_ceil(DEPTH) + pair / SIDE) * 2 + side % 2;
    (tile * SIDE + pair % SIDE) * SIDE
}

/// The left factor as pairs, padded to whole tiles, and a place for a block of the result.
#[derive(Debug, Clone)]
pub(crate) struct HalfWork {
    pairs: Vec<u32>,
    block: [f32; BLOCK * BLOCK],
}

impl Default for HalfWork {
    fn default() -> Self {
        Self { pairs: Vec::new(), block: [0.0; BLOCK * BLOCK] }
    }
}

/// How far apart the left factor's pairs lie: one row from the next, and one pair of the shared axis.
#[derive(Debug, Clone, Copy)]
struct Strides {
    row: usize,
    pair: usize,
}

impl HalfWork {
    /// Takes over rows of `depth` numbers.
    fn fill(&mut self, x: &[f32], depth: usize) -> Strides {
        let strides = self.row_by_row(x.len() / depth, depth);
        let used = x.len() / depth * strides.row;
        round_rows(x, depth, strides.row, &mut self.pairs[..used]);
        self.pairs[used..].fill(0);
        strides
    }

    /// Takes over the transpose of rows of `columns` numbers: `columns` rows.
    fn fill_transposed(&mut self, x: &[f32], columns: usize) -> Strides {
        if unit() == Unit::Tiles { self.turn(x, columns) } else { self.pair_up(x, columns) }
    }

    /// Row by row, as tiles need them. In squares, so that both tables are read and written by cache lines.
    fn turn(&mut self, x: &[f32], columns: usize) -> Strides {
        let height = x.len() / columns;
        let strides = self.row_by_row(columns, height);
        self.pairs.fill(0);
        for top in (0..height).step_by(SIDE) {
            let bottom = (top + SIDE).min(height);
            for left in (0..columns).step_by(SIDE) {
                for column in left..(left + SIDE).min(columns) {
                    let line = &mut self.pairs[column * strides.row + top / 2..];
                    for (pair, row) in line.iter_mut().zip((top..bottom).step_by(2)) {
                        let lower = if row + 1 < bottom { x[(row + 1) * columns + column] } else { 0.0 };
                        *pair = pair_of(x[row * columns + column], lower);
                    }
                }
            }
        }
        strides
    }

    /// As they come: a pair lies beside those of the other rows, so that nothing is turned.
    fn pair_up(&mut self, x: &[f32], columns: usize) -> Strides {
        let (height, wide) = (x.len() / columns, columns.div_ceil(BLOCK) * BLOCK);
        fit(&mut self.pairs, height.div_ceil(DEPTH) * SIDE * wide);
        for (pair, pairs) in self.pairs.chunks_exact_mut(wide).enumerate() {
            let two = [2 * pair, 2 * pair + 1].map(|row| row_of(x, row, columns));
            round_pairs(two, wide / SIDE, pairs, |side| side * SIDE);
        }
        Strides { row: 1, pair: wide }
    }

    fn row_by_row(&mut self, count: usize, depth: usize) -> Strides {
        let row = depth.div_ceil(DEPTH) * SIDE;
        fit(&mut self.pairs, count.div_ceil(BLOCK) * BLOCK * row);
        Strides { row, pair: 1 }
    }
}

/// `out = x packed + bias`, or added to what is there. `x` has as many numbers a row as the matrix is deep.
///
/// Only where [`available`] says so; elsewhere it does nothing.
pub(crate) fn multiply_half(
    x: &[f32],
    packed: &HalfPacked,
    bias: Option<&[f32]>,
    out: &mut [f32],
    add: bool,
    work: &mut HalfWork,
) {
    debug_assert_eq!(out.len() / packed.columns.max(1), x.len() / packed.depth.max(1));
    debug_assert!(!add || bias.is_none());
    let strides = work.fill(x, packed.depth.max(1));
    product(packed, bias, out, add, work, strides);
}

/// `out += grad^T x`, as [`super::product::add_weight_gradient`]; `packed` is a buffer.
pub(crate) fn add_half_weight_gradient(
    grad: &[f32],
    outputs: usize,
    x: &[f32],
    inputs: usize,
    out: &mut [f32],
    (work, packed): (&mut HalfWork, &mut HalfPacked),
) {
    // So that both factors stay in the second cache.
    const ROWS: usize = 1024;
    for (grad, x) in grad.chunks(ROWS * outputs).zip(x.chunks(ROWS * inputs)) {
        let strides = work.fill_transposed(grad, outputs);
        packed.fill(x, x.len() / inputs, inputs);
        product(packed, None, out, true, work, strides);
    }
}

/// Where a block of 32 columns goes in a table.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    /// Numbers of the table's rows, the block's first one, and how many it has there.
    columns: usize,
    column: usize,
    width: usize,
    /// What is added to each row of the block.
    bias: Option<&'a [f32]>,
    /// Whether it is added to what is there; without a bias then.
    add: bool,
}

fn product(
    packed: &HalfPacked,
    bias: Option<&[f32]>,
    out: &mut [f32],
    add: bool,
    work: &mut HalfWork,
    strides: Strides,
) {
    if packed.depth == 0 || packed.columns == 0 {
        return;
    }
    let HalfWork { pairs, block } = work;
    match unit() {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        Unit::Tiles => tiles::configured(|| {
            blocks(packed, bias, out, add, |row, tiles, deep, out, place| {
                tiles::block(&pairs[row * strides.row..][..SIDE * deep], tiles, deep, block);
                write(block, out, place);
            });
        }),
        #[cfg(target_arch = "x86_64")]
        Unit::Dots => blocks(packed, bias, out, add, |row, tiles, deep, out, place| {
            dots::block(&pairs[row * strides.row..], strides, tiles, deep, out, place);
        }),
        _ => {}
    }
}

/// Each block of 32 columns, for every 32 rows: the first row, the tiles, how deep they are, the rows of the table, the place there.
fn blocks(
    packed: &HalfPacked,
    bias: Option<&[f32]>,
    out: &mut [f32],
    add: bool,
    mut block: impl FnMut(usize, &[u32], usize, &mut [f32], &Place<'_>),
) {
    let (deep, columns) = (packed.depth.div_ceil(DEPTH) * DEPTH, packed.columns);
    for (rows, out) in out.chunks_mut(BLOCK * columns).enumerate() {
        for (left, tiles) in packed.tiles.chunks_exact(SIDE * deep).enumerate() {
            let column = left * BLOCK;
            let width = BLOCK.min(columns - column);
            let bias = bias.map(|bias| &bias[column..column + width]);
            block(rows * BLOCK, tiles, deep, out, &Place { columns, column, width, bias, add });
        }
    }
}

/// Brings a block to its place.
fn write(
    block: &[f32; BLOCK * BLOCK],
    out: &mut [f32],
    &Place { columns, column, width, bias, add }: &Place<'_>,
) {
    let mut shift = [0.0; BLOCK];
    bias.iter().for_each(|bias| shift[..width].copy_from_slice(bias));
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (line, sums) in out.chunks_mut(columns).zip(block.as_chunks::<BLOCK>().0) {
                let line = &mut line[column..column + width];
                match line.as_mut_array::<BLOCK>() {
                    Some(line) if add => line.iter_mut().zip(sums).for_each(|(out, sum)| *out += sum),
                    Some(line) => *line = array::from_fn(|at| sums[at] + shift[at]),
                    None if add => line.iter_mut().zip(sums).for_each(|(out, sum)| *out += sum),
                    None => line
                        .iter_mut()
                        .zip(sums)
                        .zip(shift)
                        .for_each(|((out, sum), shift)| *out = sum + shift),
                }
            }
        },
    );
}

/// A row of a table, empty behind its end.
fn row_of(table: &[f32], row: usize, columns: usize) -> &[f32] {
    table.get(row * columns..(row + 1) * columns).unwrap_or_default()
}

#[cfg(test)]
mod tests;
