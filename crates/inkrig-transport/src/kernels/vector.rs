// Processor vectors for the product's tiles, which compilers do not keep in registers when written as plain loops.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256, __m256d, __m512, __m512d, _mm256_fmadd_pd, _mm256_fmadd_ps, _mm256_loadu_pd, _mm256_loadu_ps,
    _mm256_set1_pd, _mm256_set1_ps, _mm256_storeu_pd, _mm256_storeu_ps, _mm512_fmadd_pd, _mm512_fmadd_ps,
    _mm512_loadu_pd, _mm512_loadu_ps, _mm512_set1_pd, _mm512_set1_ps, _mm512_storeu_pd, _mm512_storeu_ps,
};

/// A vector of `LEN` values of `T`.
///
/// # Safety
/// Every function needs a processor with the instructions of the type, and is to be inlined into a function that enables
/// them; `load` and `store` reach `LEN` values.
pub trait Vector<T>: Copy {
    /// Values in it.
    const LEN: usize;
    /// Reads `LEN` values.
    unsafe fn load(from: *const T) -> Self;
    /// Writes `LEN` values.
    unsafe fn store(self, to: *mut T);
    /// `x` in every place.
    unsafe fn splat(x: T) -> Self;
    /// `self * a + b`.
    unsafe fn fma(self, a: Self, b: Self) -> Self;
}

macro_rules! vector {
    ($vector:ty, $real:ty, $len:literal, $load:ident, $store:ident, $splat:ident, $fma:ident) => {
        impl Vector<$real> for $vector {
            const LEN: usize = $len;
            #[inline(always)]
            unsafe fn load(from: *const $real) -> Self {
                // SAFETY: the caller's, see the trait.
                unsafe { $load(from) }
            }
            #[inline(always)]
            unsafe fn store(self, to: *mut $real) {
                // SAFETY: the caller's, see the trait.
                unsafe { $store(to, self) }
            }
            #[inline(always)]
            unsafe fn splat(x: $real) -> Self {
                // SAFETY: the caller's, see the trait.
                unsafe { $splat(x) }
            }
            #[inline(always)]
            unsafe fn fma(self, a: Self, b: Self) -> Self {
                // SAFETY: the caller's, see the trait.
                unsafe { $fma(self, a, b) }
            }
        }
    };
}

vector!(__m512, f32, 16, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_set1_ps, _mm512_fmadd_ps);
vector!(__m512d, f64, 8, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_set1_pd, _mm512_fmadd_pd);
vector!(__m256, f32, 8, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_set1_ps, _mm256_fmadd_ps);
vector!(__m256d, f64, 4, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_set1_pd, _mm256_fmadd_pd);
