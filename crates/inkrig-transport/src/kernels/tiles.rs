//! The matrix product of the inner loop. The `gemm` crate is as fast on one large product, but packs its operands and
//! allocates at every call, which a product cut into blocks of rows pays per block; here operands are padded once, and a
//! forced instruction level holds for the product too.
// Tiles of processor vectors read and write through pointers.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

use super::Kernel;
#[cfg(target_arch = "x86_64")]
use super::vector::Vector;
use crate::padded::LANES;
use crate::{Isa, Real};

/// `out = a b` for padded `b` and `out`. Each entry is one chain of multiply-adds over k in order, so it depends neither
/// on the tiling nor on the cut into blocks.
pub(crate) struct Product<'a, T> {
    /// m rows of k values, `a_stride` apart.
    pub(crate) a: &'a [T],
    pub(crate) a_stride: usize,
    /// k rows, `stride` apart.
    pub(crate) b: &'a [T],
    pub(crate) k: usize,
    /// m rows, `stride` apart; `stride` is a multiple of the lanes.
    pub(crate) out: &'a mut [T],
    pub(crate) stride: usize,
}

impl<T: Real> Product<'_, T> {
    pub(crate) fn multiply(self, isa: Isa) {
        let rows = self.out.len() / self.stride;
        assert!(self.stride.is_multiple_of(LANES) && self.b.len() >= self.k * self.stride, "b does not fit");
        assert!(rows == 0 || self.a.len() >= (rows - 1) * self.a_stride + self.k, "a does not fit");
        match isa {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an `Isa` is never above what the processor has, see `isa_entry`; the asserts above bound every tile.
            Isa::Avx512 => unsafe { avx512(self, rows) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx2 => unsafe { avx2(self, rows) },
            _ => super::dispatch(isa, self),
        }
    }
}

/// The plain form: four rows of `b` at a time onto a row of `out`, in the same order as the tiles.
impl<T: Real> Kernel for Product<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (i, out) in self.out.chunks_exact_mut(self.stride).enumerate() {
            out.fill(T::ZERO);
            let a = &self.a[i * self.a_stride..][..self.k];
            let mut b = self.b.chunks_exact(self.stride);
            let quads = a.chunks_exact(4);
            let rest = quads.remainder();
            for a in quads {
                if let (Some(b0), Some(b1), Some(b2), Some(b3)) = (b.next(), b.next(), b.next(), b.next()) {
                    for ((((out, &b0), &b1), &b2), &b3) in out.iter_mut().zip(b0).zip(b1).zip(b2).zip(b3) {
                        let sum = a[1].fma::<FMA>(b1, a[0].fma::<FMA>(b0, *out));
                        *out = a[3].fma::<FMA>(b3, a[2].fma::<FMA>(b2, sum));
                    }
                }
            }
            for (&a, b) in rest.iter().zip(b) {
                out.iter_mut().zip(b).for_each(|(out, &b)| *out = a.fma::<FMA>(b, *out));
            }
        }
    }
}

/// 24 accumulators, three of `b` and a broadcast: of AVX-512's 32 registers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma")]
unsafe fn avx512<T: Real>(product: Product<'_, T>, rows: usize) {
    // SAFETY: the caller's.
    unsafe { tiles::<T, T::Avx512, 8>(product, rows) }
}

/// 12 accumulators, three of `b` and a broadcast: AVX2's 16 registers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn avx2<T: Real>(product: Product<'_, T>, rows: usize) {
    // SAFETY: the caller's.
    unsafe { tiles::<T, T::Avx2, 4>(product, rows) }
}

/// Rows of `b` worked on at once: with the width of a tile they stay in the first-level cache.
#[cfg(target_arch = "x86_64")]
const DEPTH: usize = 192;
/// Rows of `b` to fetch ahead.
#[cfg(target_arch = "x86_64")]
const AHEAD: usize = 12;

/// # Safety
/// `a`, `b` and `out` hold what the sizes say (`Product::multiply` asserts it), and the processor has V's instructions.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn tiles<T: Real, V: Vector<T>, const TALL: usize>(product: Product<'_, T>, rows: usize) {
    let Product { a, a_stride, b, k, out, stride } = product;
    let mut from = 0;
    while from == 0 || from < k {
        let depth = DEPTH.min(k - from);
        let mut at = 0;
        while at < stride {
            let wide = match (stride - at) / V::LEN {
                // Two and two rather than three and one.
                2 | 4 => 2,
                1 => 1,
                _ => 3,
            };
            let mut row = 0;
            while row < rows {
                let tall = if row + TALL <= rows { TALL } else { 1 };
                // SAFETY: row + tall <= rows, at + wide * LEN <= stride and from + depth <= k keep within the slices.
                unsafe {
                    let a = a.as_ptr().add(row * a_stride + from);
                    let b = b.as_ptr().add(from * stride + at);
                    let out = out.as_mut_ptr().add(row * stride + at);
                    let s = [a_stride, stride, depth];
                    match (tall == TALL, wide) {
                        (true, 3) => tile::<T, V, TALL, 3>(a, b, out, s, from == 0),
                        (true, 2) => tile::<T, V, TALL, 2>(a, b, out, s, from == 0),
                        (true, _) => tile::<T, V, TALL, 1>(a, b, out, s, from == 0),
                        (false, 3) => tile::<T, V, 1, 3>(a, b, out, s, from == 0),
                        (false, 2) => tile::<T, V, 1, 2>(a, b, out, s, from == 0),
                        (false, _) => tile::<T, V, 1, 1>(a, b, out, s, from == 0),
                    }
                }
                row += tall;
            }
            at += wide * V::LEN;
        }
        from += DEPTH;
    }
}

/// One tile of `out`, R rows by C vectors: set to, or increased by, the product of `depth` columns of `a` and rows of `b`.
///
/// # Safety
/// As `tiles`; the pointers stand at the tile's first values.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn tile<T: Real, V: Vector<T>, const R: usize, const C: usize>(
    a: *const T,
    b: *const T,
    out: *mut T,
    [a_stride, stride, depth]: [usize; 3],
    first: bool,
) {
    // SAFETY: the caller's.
    unsafe {
        let mut sums = [[V::splat(T::ZERO); C]; R];
        if !first {
            for (r, sums) in sums.iter_mut().enumerate() {
                for (c, sum) in sums.iter_mut().enumerate() {
                    *sum = V::load(out.add(r * stride + c * V::LEN));
                }
            }
        }
        for k in 0..depth {
            let mut wide = [V::splat(T::ZERO); C];
            for (c, wide) in wide.iter_mut().enumerate() {
                let at = b.wrapping_add(k * stride + c * V::LEN);
                // The processor does not foresee steps of a whole row. A prefetch past the end does nothing.
                _mm_prefetch::<_MM_HINT_T0>(at.wrapping_add(AHEAD * stride).cast());
                *wide = V::load(at);
            }
            for (r, sums) in sums.iter_mut().enumerate() {
                let x = V::splat(*a.add(r * a_stride + k));
                for (c, sum) in sums.iter_mut().enumerate() {
                    *sum = x.fma(wide[c], *sum);
                }
            }
        }
        for (r, sums) in sums.iter().enumerate() {
            for (c, sum) in sums.iter().enumerate() {
                sum.store(out.add(r * stride + c * V::LEN));
            }
        }
    }
}
