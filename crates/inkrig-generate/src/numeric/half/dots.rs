//! Products by the instruction that multiplies pairs of bfloat16 and adds both to a sum (AVX512-BF16: EPYCs and Ryzens since 2022, Xeons
//! since 2023): twice as fast as single precision. Where there are tiles, too, numbers are at least rounded here.
//!
//! Unsafe, because intrinsics of a processor's feature are, and so are reads and writes without a check of bounds. What is touched lies within
//! what the assertions at the head of each say; the test compares each shape with the plain product.
#![allow(unsafe_code)]

use super::{BLOCK, Place, SIDE, Strides};
use std::arch::x86_64::{
    __m512, __m512bh, __m512i, _mm512_add_ps, _mm512_cvtne2ps_pbh, _mm512_dpbf16_ps, _mm512_loadu_epi16,
    _mm512_loadu_epi32, _mm512_mask_storeu_ps, _mm512_maskz_loadu_ps, _mm512_permutexvar_epi16,
    _mm512_set1_epi32, _mm512_setzero_ps, _mm512_storeu_epi32,
};
use std::mem::transmute;

/// Rows of a block that are computed at once: with two registers a row, half of all 32 are sums.
const ROWS: usize = 8;

pub(super) fn available() -> bool {
    std::is_x86_feature_detected!("avx512bf16")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512f")
}

/// 32 rows of `deep` halves, as pairs, times a block of 32 columns, to their place in a table.
pub(super) fn block(
    pairs: &[u32],
    strides: Strides,
    tiles: &[u32],
    deep: usize,
    out: &mut [f32],
    place: &Place<'_>,
) {
    let Place { columns, column, width, bias, .. } = *place;
    let rows = (out.len() / columns).min(BLOCK);
    assert!(
        available()
            && tiles.len() == SIDE * deep
            && deep.is_multiple_of(2 * SIDE)
            && pairs.len() > (BLOCK - 1) * strides.row + (deep / 2).saturating_sub(1) * strides.pair
            && width <= BLOCK
            && column + width <= columns
            && bias.is_none_or(|bias| bias.len() == width)
    );
    // SAFETY: the processor has the features; the assertion says that the factors hold all that is read, and
    // the table all that is written: `rows` lines of `columns`, in each `width` numbers from `column` on.
    unsafe { sums(pairs, strides, tiles, deep, (out, rows), place) }
}

/// # Safety
/// As [`block`] asserts.
#[target_feature(enable = "avx512f,avx512bw,avx512bf16")]
unsafe fn sums(
    pairs: &[u32],
    strides: Strides,
    tiles: &[u32],
    deep: usize,
    (out, rows): (&mut [f32], usize),
    &Place { columns, column, width, bias, add }: &Place<'_>,
) {
    let masks = [mask(width), mask(width.saturating_sub(SIDE))];
    let shift = match bias {
        // SAFETY: masks let no more than `width` numbers be read.
        Some(bias) => unsafe {
            [some(bias.as_ptr(), masks[0]), some(bias.as_ptr().wrapping_add(SIDE), masks[1])]
        },
        None => [_mm512_setzero_ps(); 2],
    };
    for first in (0..rows).step_by(ROWS) {
        let mut sums = [[_mm512_setzero_ps(); 2]; ROWS];
        for pair in 0..deep / 2 {
            // Two tiles of 16 pairs x 16 columns for every 32 of the depth.
            let line = (pair / SIDE * 2 * SIDE + pair % SIDE) * SIDE;
            // SAFETY: `line` and the next tile's lie within the tiles, as there are `SIDE * deep` of them.
            let (left, right): (__m512bh, __m512bh) = unsafe {
                let at = tiles.as_ptr().add(line);
                (
                    transmute::<__m512i, __m512bh>(_mm512_loadu_epi32(at.cast())),
                    transmute::<__m512i, __m512bh>(_mm512_loadu_epi32(at.add(SIDE * SIDE).cast())),
                )
            };
            for (row, sums) in sums.iter_mut().enumerate() {
                // SAFETY: the farthest is that of the last row and the last pair, which the assertion is about.
                let both = unsafe {
                    let at = pairs.as_ptr().add((first + row) * strides.row + pair * strides.pair);
                    transmute::<__m512i, __m512bh>(_mm512_set1_epi32(at.read().cast_signed()))
                };
                sums[0] = _mm512_dpbf16_ps(sums[0], both, left);
                sums[1] = _mm512_dpbf16_ps(sums[1], both, right);
            }
        }
        for (row, sums) in sums.iter().enumerate().take(rows - first) {
            for ((side, sum), mask) in sums.iter().enumerate().zip(masks) {
                // SAFETY: a line of the table that has `width` numbers from `column` on; masks let no more be touched.
                unsafe {
                    let to = out.as_mut_ptr().add((first + row) * columns + column).wrapping_add(side * SIDE);
                    let before = if add { some(to, mask) } else { shift[side] };
                    _mm512_mask_storeu_ps(to, mask, _mm512_add_ps(*sum, before));
                }
            }
        }
    }
}

/// Rounds rows of `depth` numbers to pairs, `line` of them a row, zeros behind what there is.
pub(super) fn round_rows(x: &[f32], depth: usize, line: usize, to: &mut [u32]) {
    assert!(
        available()
            && depth > 0
            && line.is_multiple_of(SIDE)
            && 2 * line >= depth
            && to.len() >= x.len() / depth * line
    );
    // SAFETY: the processor has the features; each row is read up to `depth` and written as whole registers, `line` pairs.
    unsafe { rounded_rows(x, depth, line, to) }
}

/// # Safety
/// As [`round_rows`] asserts.
#[target_feature(enable = "avx512f,avx512bw,avx512bf16")]
unsafe fn rounded_rows(x: &[f32], depth: usize, line: usize, to: &mut [u32]) {
    for (row, to) in x.chunks_exact(depth).zip(to.chunks_exact_mut(line)) {
        for first in (0..line).step_by(SIDE) {
            let begin = (2 * first).min(depth);
            let count = depth - begin;
            // SAFETY: masks let no more than `count` numbers be read behind `begin`; 16 pairs from `first` on are within the line.
            unsafe {
                let from = row.as_ptr().add(begin);
                let (lower, upper) = (
                    some(from, mask(count)),
                    some(from.wrapping_add(SIDE), mask(count.saturating_sub(SIDE))),
                );
                let halves = _mm512_cvtne2ps_pbh(upper, lower);
                _mm512_storeu_epi32(
                    to.as_mut_ptr().add(first).cast(),
                    transmute::<__m512bh, __m512i>(halves),
                );
            }
        }
    }
}

/// Rounds two rows to `sides` times 16 pairs, one number of each row, zeros behind their ends. `place` says where the pairs of a side go.
pub(super) fn round_pairs(rows: [&[f32]; 2], sides: usize, to: &mut [u32], place: impl Fn(usize) -> usize) {
    assert!(available());
    // SAFETY: the processor has the features.
    unsafe { rounded_pairs(rows, sides, to, place) }
}

/// Of the first 16 halves and the last 16, one after the other.
const ZIPPED: [u16; 32] = {
    let mut places = [0; 32];
    let mut at = 0;
    while at < 32 {
        places[at] = (at / 2 + at % 2 * 16) as u16;
        at += 1;
    }
    places
};

/// # Safety
/// As [`round_pairs`] asserts.
#[target_feature(enable = "avx512f,avx512bw,avx512bf16")]
unsafe fn rounded_pairs(rows: [&[f32]; 2], sides: usize, to: &mut [u32], place: impl Fn(usize) -> usize) {
    // SAFETY: the constant is one register.
    let zip = unsafe { _mm512_loadu_epi16(ZIPPED.as_ptr().cast()) };
    for side in 0..sides {
        let to = &mut to[place(side)..][..SIDE];
        // SAFETY: masks let no more than what is left of each row be read; 16 pairs are written.
        unsafe {
            let [upper, lower] = rows.map(|row| {
                let first = (side * SIDE).min(row.len());
                some(row.as_ptr().add(first), mask(row.len() - first))
            });
            let halves = transmute::<__m512bh, __m512i>(_mm512_cvtne2ps_pbh(lower, upper));
            _mm512_storeu_epi32(to.as_mut_ptr().cast(), _mm512_permutexvar_epi16(zip, halves));
        }
    }
}

/// The lowest so many of 16.
fn mask(count: usize) -> u16 {
    if count >= SIDE { u16::MAX } else { (1 << count) - 1 }
}

/// Those of 16 numbers that a mask says, zeros elsewhere.
///
/// # Safety
/// What the mask says can be read.
#[target_feature(enable = "avx512f,avx512bw,avx512bf16")]
unsafe fn some(from: *const f32, mask: u16) -> __m512 {
    // SAFETY: as above.
    unsafe { _mm512_maskz_loadu_ps(mask, from) }
}
