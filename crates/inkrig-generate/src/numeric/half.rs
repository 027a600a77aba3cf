//! Products in half the precision, for training: factors are rounded to bfloat16, sums stay f32. On processors with AMX tiles (Xeons since
//! 2023) that is ten times as fast as single precision; on others there is no such product, and callers stay with [`super::product`].
//!
//! Unsafe, because the tile instructions exist as assembly only. Every address that a tile is read from or written to lies in a buffer that
//! was made for whole tiles right before; the test compares each shape with the plain product.
#![allow(unsafe_code)]

/// Rows, and columns of 32 bits, of a tile.
const SIDE: usize = 16;
/// Numbers of the shared axis that a tile takes.
const DEPTH: usize = 2 * SIDE;
/// Rows and columns that are computed at once: two tiles each.
const BLOCK: usize = 2 * SIDE;

/// Numbers of bfloat16.
type Half = u16;

/// Whether this processor has the tiles, and the system lets this program use them. Asked once.
pub(crate) fn available() -> bool {
    static AVAILABLE: std::sync::OnceLock<bool> = std::sync::OnceLock::new();
    *AVAILABLE.get_or_init(tiles::request)
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
        let none = vec![0.0; columns];
        for (at, two) in rows.chunks(2 * columns).take(depth.div_ceil(2)).enumerate() {
            let (upper, lower) = two.split_at(columns.min(two.len()));
            let lower = if lower.is_empty() { &none[..] } else { lower };
            let sixteen = upper.chunks(SIDE).zip(lower.chunks(SIDE)).enumerate();
            for (side, (upper, lower)) in sixteen {
                let line = self.line(at, side);
                for ((pair, &upper), &lower) in self.tiles[line..].iter_mut().zip(upper).zip(lower) {
                    *pair = pair_of(upper, lower);
                }
            }
        }
    }

    /// Takes over `columns` rows of `depth` numbers.
    pub(crate) fn fill_transposed(&mut self, rows: &[f32], depth: usize, columns: usize) {
        self.shape(depth, columns);
        for (column, row) in rows.chunks(depth).take(columns).enumerate() {
            for (at, two) in row.chunks(2).enumerate() {
                let place = self.line(at, column / SIDE) + column % SIDE;
                let (upper, lower) = (two[0], two.get(1).copied().unwrap_or(0.0));
                self.tiles[place] = pair_of(upper, lower);
            }
        }
    }

    /// Where 16 columns of a pair of rows begin.
    fn line(&self, pair: usize, side: usize) -> usize {
        let tile = (side / 2 * self.depth.div_ceil(DEPTH) + pair / SIDE) * 2 + side % 2;
        (tile * SIDE + pair % SIDE) * SIDE
    }

    fn shape(&mut self, depth: usize, columns: usize) {
        (self.depth, self.columns) = (depth, columns);
        self.tiles.clear();
        self.tiles.resize(columns.div_ceil(BLOCK) * BLOCK * depth.div_ceil(DEPTH) * SIDE, 0);
    }
}

/// Rows of the left factor, padded to whole tiles, and a place for a block of the result.
#[derive(Debug, Clone)]
pub(crate) struct HalfWork {
    rows: Vec<Half>,
    block: [f32; BLOCK * BLOCK],
}

impl Default for HalfWork {
    fn default() -> Self {
        Self { rows: Vec::new(), block: [0.0; BLOCK * BLOCK] }
    }
}

impl HalfWork {
    /// Takes over rows of `depth` numbers.
    fn fill(&mut self, x: &[f32], depth: usize) {
        let deep = self.shape(x.len() / depth, depth);
        for (row, halves) in x.chunks_exact(depth).zip(self.rows.chunks_exact_mut(deep)) {
            halves.iter_mut().zip(row).for_each(|(half_of, &value)| *half_of = half(value));
        }
    }

    /// Takes over the transpose of rows of `columns` numbers: `columns` rows. In squares, so that both are read and written by cache
    /// lines.
    fn fill_transposed(&mut self, x: &[f32], columns: usize) {
        let height = x.len() / columns;
        let deep = self.shape(columns, height);
        for top in (0..height).step_by(SIDE) {
            let bottom = (top + SIDE).min(height);
            for left in (0..columns).step_by(SIDE) {
                for column in left..(left + SIDE).min(columns) {
                    let line = &mut self.rows[column * deep + top..column * deep + bottom];
                    for (half_of, row) in line.iter_mut().zip(top..bottom) {
                        *half_of = half(x[row * columns + column]);
                    }
                }
            }
        }
    }

    fn shape(&mut self, count: usize, depth: usize) -> usize {
        let deep = depth.div_ceil(DEPTH) * DEPTH;
        self.rows.clear();
        self.rows.resize(count.div_ceil(BLOCK) * BLOCK * deep, 0);
        deep
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
    work.fill(x, packed.depth.max(1));
    product(packed, bias, out, add, work);
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
        work.fill_transposed(grad, outputs);
        packed.fill(x, x.len() / inputs, inputs);
        product(packed, None, out, true, work);
    }
}

fn product(packed: &HalfPacked, bias: Option<&[f32]>, out: &mut [f32], add: bool, work: &mut HalfWork) {
    let (deep, columns) = (packed.depth.div_ceil(DEPTH) * DEPTH, packed.columns);
    if !available() || deep == 0 || columns == 0 {
        return;
    }
    tiles::configured(|| {
        for (rows, out) in work.rows.chunks_exact(BLOCK * deep).zip(out.chunks_mut(BLOCK * columns)) {
            for (left, tiles) in packed.tiles.chunks_exact(SIDE * deep).enumerate() {
                tiles::block(rows, tiles, deep, &mut work.block);
                let column = left * BLOCK;
                let width = BLOCK.min(columns - column);
                let lines = out.chunks_mut(columns);
                for (line, sums) in lines.zip(work.block.chunks_exact(BLOCK)) {
                    let line = &mut line[column..column + width];
                    if let Some(bias) = bias {
                        let bias = &bias[column..column + width];
                        line.iter_mut().zip(sums).zip(bias).for_each(|((out, sum), bias)| *out = sum + bias);
                    } else if add {
                        line.iter_mut().zip(sums).for_each(|(out, sum)| *out += sum);
                    } else {
                        line.copy_from_slice(&sums[..width]);
                    }
                }
            }
        }
    });
}

fn pair_of(first: f32, second: f32) -> u32 {
    u32::from(half(first)) | u32::from(half(second)) << 16
}

/// The nearest number of bfloat16, the even one of two.
fn half(value: f32) -> Half {
    let bits = value.to_bits();
    (bits.wrapping_add(0x7fff + (bits >> 16 & 1)) >> 16) as Half
}

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod tiles {
    use super::{BLOCK, DEPTH, Half, SIDE};
    use std::arch::asm;
    use std::arch::x86_64::{__cpuid, __cpuid_count};

    /// The system's call that lets a process use a part of the processor's state, and that of the tiles.
    const ARCH_PRCTL: usize = 158;
    const REQUEST: usize = 0x1023;
    const TILE_DATA: usize = 18;

    /// All eight tiles of 16 rows of 64 bytes.
    #[repr(C, align(64))]
    struct Configuration([u8; 64]);

    static CONFIGURATION: Configuration = {
        let mut bytes = [0_u8; 64];
        bytes[0] = 1;
        let mut tile = 0;
        while tile < 8 {
            bytes[16 + 2 * tile] = 64;
            bytes[48 + tile] = SIDE as u8;
            tile += 1;
        }
        Configuration(bytes)
    };

    pub(super) fn request() -> bool {
        // Leaf 7 has both features; before it is asked for, leaf 0 says whether there is one.
        if __cpuid(0).eax < 7 || __cpuid(1).ecx >> 27 & 1 == 0 {
            return false;
        }
        let features = __cpuid_count(7, 0).edx;
        if features >> 22 & 1 == 0 || features >> 24 & 1 == 0 {
            return false;
        }
        let answer: isize;
        // SAFETY: the call changes nothing but what this process may use; registers that it overwrites are named.
        unsafe {
            asm!(
                "syscall",
                inlateout("rax") ARCH_PRCTL => answer,
                in("rdi") REQUEST,
                in("rsi") TILE_DATA,
                lateout("rcx") _,
                lateout("r11") _,
                options(nostack),
            );
        }
        answer == 0
    }

    /// Runs something with the tiles set up, and lets go of them after it.
    pub(super) fn configured(run: impl FnOnce()) {
        // SAFETY: only called where `request` gave leave; the 64 bytes are a valid configuration.
        unsafe {
            asm!("ldtilecfg [{}]", in(reg) CONFIGURATION.0.as_ptr(), options(nostack, readonly));
        }
        run();
        // SAFETY: as above.
        unsafe {
            asm!("tilerelease", options(nostack, nomem));
        }
    }

    /// 32 rows of `deep` halves times a block of 32 columns, into `out`, row-major.
    pub(super) fn block(rows: &[Half], tiles: &[u32], deep: usize, out: &mut [f32; BLOCK * BLOCK]) {
        assert!(
            deep > 0
                && deep.is_multiple_of(DEPTH)
                && rows.len() == BLOCK * deep
                && tiles.len() == SIDE * deep
        );
        // SAFETY: the assertion says that both factors are whole blocks; each turn of the loop reads one tile column of 64
        // bytes from each of 32 rows, and 2 KiB of tiles. `out` takes four tiles. `configured` is around every call.
        unsafe {
            asm!(
                "tilezero tmm0",
                "tilezero tmm1",
                "tilezero tmm2",
                "tilezero tmm3",
                "2:",
                "tileloadd tmm4, [{upper} + {stride}]",
                "tileloadd tmm6, [{tiles} + {line}]",
                "tileloadd tmm7, [{tiles} + {line} + 1024]",
                "tileloadd tmm5, [{lower} + {stride}]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                "add {upper}, 64",
                "add {lower}, 64",
                "add {tiles}, 2048",
                "dec {turns}",
                "jnz 2b",
                "tilestored [{out} + {wide}], tmm0",
                "tilestored [{out} + {wide} + 64], tmm1",
                "tilestored [{below} + {wide}], tmm2",
                "tilestored [{below} + {wide} + 64], tmm3",
                upper = inout(reg) rows.as_ptr() => _,
                lower = inout(reg) rows.as_ptr().add(SIDE * deep) => _,
                tiles = inout(reg) tiles.as_ptr() => _,
                turns = inout(reg) deep / DEPTH => _,
                stride = in(reg) 2 * deep,
                line = in(reg) 64_usize,
                out = in(reg) out.as_mut_ptr(),
                below = in(reg) out.as_mut_ptr().add(SIDE * BLOCK),
                wide = in(reg) 4 * BLOCK,
                out("tmm0") _, out("tmm1") _, out("tmm2") _, out("tmm3") _,
                out("tmm4") _, out("tmm5") _, out("tmm6") _, out("tmm7") _,
                options(nostack),
            );
        }
    }
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
mod tiles {
    use super::{BLOCK, Half};

    pub(super) fn request() -> bool {
        false
    }

    pub(super) fn configured(_run: impl FnOnce()) {}

    pub(super) fn block(_rows: &[Half], _tiles: &[u32], _deep: usize, _out: &mut [f32; BLOCK * BLOCK]) {}
}

#[cfg(test)]
mod tests {
    use super::super::testing::numbers;
    use super::*;

    fn rounded(numbers: &[f32]) -> Vec<f64> {
        numbers.iter().map(|&x| f64::from(f32::from_bits(u32::from(half(x)) << 16))).collect()
    }

    #[test]
    fn halves_are_the_nearest() {
        let back = |x: f32| f32::from_bits(u32::from(half(x)) << 16);
        assert_eq!(back(1.0), 1.0);
        assert_eq!(back(1.0 + 1.0 / 256.0), 1.0, "the even one of two");
        assert_eq!(back(1.0 + 3.0 / 256.0), 1.0 + 4.0 / 256.0);
        assert_eq!(back(-2.7173), -2.718_75);
    }

    #[test]
    fn products_of_all_shapes_are_those_of_rounded_factors() {
        if !available() {
            println!("skipped: this processor has no AMX tiles");
            return;
        }
        for (rows, columns, depth) in [(1, 1, 1), (3, 32, 7), (33, 33, 64), (41, 263, 40), (70, 5, 131)] {
            let (x, weight, bias) =
                (numbers(1, rows * depth), numbers(2, columns * depth), numbers(3, columns));
            let (exact_x, exact_weight) = (rounded(&x), rounded(&weight));
            let mut packed = HalfPacked::default();
            packed.fill_transposed(&weight, depth, columns);
            let mut turned = HalfPacked::default();
            let by_depth: Vec<f32> =
                (0..depth).flat_map(|at| weight.iter().skip(at).step_by(depth).copied()).collect();
            turned.fill(&by_depth, depth, columns);
            assert_eq!(packed.tiles, turned.tiles);
            let (mut work, mut out) = (HalfWork::default(), vec![7.0; rows * columns]);
            multiply_half(&x, &packed, Some(&bias), &mut out, false, &mut work);
            let mut twice = out.clone();
            multiply_half(&x, &packed, None, &mut twice, true, &mut work);
            for (at, (got, more)) in out.iter().zip(&twice).enumerate() {
                let (row, column) = (at / columns, at % columns);
                let sum: f64 =
                    (0..depth).map(|k| exact_x[row * depth + k] * exact_weight[column * depth + k]).sum();
                let wanted = sum + f64::from(bias[column]);
                assert!((f64::from(*got) - wanted).abs() < 1e-4, "{rows} {columns} {depth}: {got} {wanted}");
                assert!((f64::from(*more) - wanted - sum).abs() < 2e-4);
            }
            // The gradient of the weight: columns x depth.
            let mut gradient = vec![0.0; columns * depth];
            add_half_weight_gradient(&out, columns, &x, depth, &mut gradient, (&mut work, &mut turned));
            let exact_out = rounded(&out);
            for (at, got) in gradient.iter().enumerate() {
                let (column, k) = (at / depth, at % depth);
                let wanted: f64 =
                    (0..rows).map(|row| exact_out[row * columns + column] * exact_x[row * depth + k]).sum();
                assert!((f64::from(*got) - wanted).abs() < 2e-3, "{rows} {columns} {depth}: {got} {wanted}");
            }
        }
    }
}
