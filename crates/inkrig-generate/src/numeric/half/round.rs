//! Numbers as pairs of bfloat16, by the processor's own instruction where it has one.

use super::SIDE;
#[cfg(target_arch = "x86_64")]
use super::dots;

/// Rows of `depth` numbers as pairs, `line` of them a row, zeros behind what there is.
pub(super) fn round_rows(x: &[f32], depth: usize, line: usize, to: &mut [u32]) {
    #[cfg(target_arch = "x86_64")]
    if dots::available() {
        return dots::round_rows(x, depth, line, to);
    }
    plain_rows(x, depth, line, to);
}

fn plain_rows(x: &[f32], depth: usize, line: usize, to: &mut [u32]) {
    for (row, pairs) in x.chunks_exact(depth).zip(to.chunks_exact_mut(line)) {
        for (at, pair) in pairs.iter_mut().enumerate() {
            let [first, second] = [2 * at, 2 * at + 1].map(|at| row.get(at).copied().unwrap_or(0.0));
            *pair = pair_of(first, second);
        }
    }
}

/// Two rows as `sides` times 16 pairs, one number of each, zeros behind their ends; `place` says where those of a side go.
pub(super) fn round_pairs(rows: [&[f32]; 2], sides: usize, to: &mut [u32], place: impl Fn(usize) -> usize) {
    #[cfg(target_arch = "x86_64")]
    if dots::available() {
        return dots::round_pairs(rows, sides, to, place);
    }
    plain_pairs(rows, sides, to, place);
}

fn plain_pairs(rows: [&[f32]; 2], sides: usize, to: &mut [u32], place: impl Fn(usize) -> usize) {
    for side in 0..sides {
        for (at, pair) in to[place(side)..][..SIDE].iter_mut().enumerate() {
            let [upper, lower] = rows.map(|row| row.get(side * SIDE + at).copied().unwrap_or(0.0));
            *pair = pair_of(upper, lower);
        }
    }
}

#[inline(always)]
pub(super) fn pair_of(first: f32, second: f32) -> u32 {
    bits(first) >> 16 | bits(second) & 0xffff_0000
}

/// The nearest number of bfloat16, the even one of two, as the upper half of these bits.
#[inline(always)]
fn bits(value: f32) -> u32 {
    let bits = value.to_bits();
    bits.wrapping_add(0x7fff + (bits >> 16 & 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::testing::numbers;

    #[test]
    fn both_ways_of_rounding_are_one() {
        for (rows, depth) in [(1, 1), (3, 31), (2, 32), (5, 33), (4, 131)] {
            let x = numbers(depth as u64, rows * depth);
            let line = depth.div_ceil(2 * SIDE) * SIDE;
            let (mut own, mut plain) = (vec![7; rows * line], vec![9; rows * line]);
            round_rows(&x, depth, line, &mut own);
            plain_rows(&x, depth, line, &mut plain);
            assert_eq!(own, plain);
            assert_eq!(plain[0], pair_of(x[0], if depth > 1 { x[1] } else { 0.0 }));
            // Two rows, of which the lower one may be missing.
            let upper = &x[..depth];
            for lower in [&x[(rows - 1) * depth..], &[]] {
                let sides = depth.div_ceil(SIDE) + 1;
                let place = |side| (sides - 1 - side) * SIDE;
                let (mut own, mut plain) = (vec![7; sides * SIDE], vec![9; sides * SIDE]);
                round_pairs([upper, lower], sides, &mut own, place);
                plain_pairs([upper, lower], sides, &mut plain, place);
                assert_eq!(own, plain);
                assert_eq!(plain[place(0)], pair_of(upper[0], lower.first().copied().unwrap_or(0.0)));
                assert_eq!(plain[..SIDE], [0; SIDE], "behind the rows' ends");
            }
        }
    }
}
