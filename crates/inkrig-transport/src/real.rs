use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::{__m256, __m256d, __m512, __m512d};

    #[cfg(target_arch = "x86_64")]
    use crate::kernels::vector::Vector;

    pub trait Sealed: Sized {
        #[cfg(target_arch = "x86_64")]
        type Avx512: Vector<Self>;
        #[cfg(target_arch = "x86_64")]
        type Avx2: Vector<Self>;
    }

    impl Sealed for f32 {
        #[cfg(target_arch = "x86_64")]
        type Avx512 = __m512;
        #[cfg(target_arch = "x86_64")]
        type Avx2 = __m256;
    }

    impl Sealed for f64 {
        #[cfg(target_arch = "x86_64")]
        type Avx512 = __m512d;
        #[cfg(target_arch = "x86_64")]
        type Avx2 = __m256d;
    }
}

/// The two number types of the crate: `f32` for speed, `f64` for the reference. Sealed.
pub trait Real:
    sealed::Sealed
    + Copy
    + Default
    + Debug
    + Display
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Sum
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Exponents are not taken below this: what lies under it would be a denormal or nothing, and costs 100 times the
    /// time of a normal number.
    const EXPONENT_FLOOR: Self;
    /// Plan entries below this become 0.
    const FLUSH: Self;
    /// The least column mass of which a logarithm is taken.
    const TINY: Self;
    /// Greater than any cost; fills the padding so that it never becomes a row's minimum.
    const HUGE: Self;
    /// The largest logarithm by which a column scaling changes within one outer iteration.
    const LOG_CHANGE: Self;

    /// Nearest value of this type.
    fn from_f64(x: f64) -> Self;
    /// Exact value as `f64`.
    fn to_f64(self) -> f64;
    /// Whether neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `self * a + b`, fused when `FMA`, which asks for a processor that has it.
    #[doc(hidden)]
    fn fma<const FMA: bool>(self, a: Self, b: Self) -> Self;
    /// e^x for x in `EXPONENT_FLOOR ..= -EXPONENT_FLOOR`: straight-line code that compilers turn into vector code.
    #[doc(hidden)]
    fn exp_poly<const FMA: bool>(self) -> Self;
    /// Natural logarithm of a normal positive number, again straight-line.
    #[doc(hidden)]
    fn ln_poly<const FMA: bool>(self) -> Self;
    /// The lesser of the two; as one instruction, so without care for NaN.
    #[doc(hidden)]
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    /// The greater of the two.
    #[doc(hidden)]
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// Absolute value.
    #[doc(hidden)]
    fn magnitude(self) -> Self;
}

/// 1/k! for k = 13 down to 0: the Taylor series of e^r, exact to the last bit of an `f64` for |r| <= ln(2)/2.
const TAYLOR: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const EXPONENT_FLOOR: Self = -60.0;
    const FLUSH: Self = 1e-18;
    const TINY: Self = 1e-30;
    const HUGE: Self = 1e30;
    const LOG_CHANGE: Self = 40.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.ln()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn fma<const FMA: bool>(self, a: Self, b: Self) -> Self {
        if FMA { self.mul_add(a, b) } else { self * a + b }
    }
    #[inline(always)]
    fn exp_poly<const FMA: bool>(self) -> Self {
        // 1.5 * 2^23: adding it rounds to an integer, which then stands in the low bits. A conversion to i32 would
        // saturate and so keep the loop scalar.
        const ROUND: f32 = 12_582_912.0;
        const LN2_HIGH: f32 = 0.693_359_4;
        const LN2_LOW: f32 = -2.121_944_4e-4;
        let shifted = self.fma::<FMA>(std::f32::consts::LOG2_E, ROUND);
        let n = shifted - ROUND;
        let r = n.fma::<FMA>(-LN2_LOW, n.fma::<FMA>(-LN2_HIGH, self));
        let mut p = TAYLOR[6] as f32;
        for c in &TAYLOR[7..] {
            p = p.fma::<FMA>(r, *c as f32);
        }
        p * f32::from_bits((shifted.to_bits() << 23).wrapping_add(1.0f32.to_bits()))
    }
    #[inline(always)]
    fn ln_poly<const FMA: bool>(self) -> Self {
        // x = 2^n m with m in [sqrt(1/2), sqrt(2)); ln m = 2 artanh(s), s = (m - 1)/(m + 1), |s| < .172.
        let bits = self.to_bits();
        let n_bits = bits.wrapping_sub(std::f32::consts::FRAC_1_SQRT_2.to_bits());
        let n = ((n_bits as i32) >> 23) as f32;
        let m = f32::from_bits(bits.wrapping_sub(n_bits & 0xff80_0000));
        let s = (m - 1.0) / (m + 1.0);
        let z = s * s;
        let mut p = 2.0f32 / 9.0;
        for c in [2.0 / 7.0, 2.0 / 5.0, 2.0 / 3.0, 2.0] {
            p = p.fma::<FMA>(z, c);
        }
        n.fma::<FMA>(std::f32::consts::LN_2, p * s)
    }
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const EXPONENT_FLOOR: Self = -700.0;
    const FLUSH: Self = 1e-290;
    const TINY: Self = 1e-290;
    const HUGE: Self = 1e200;
    const LOG_CHANGE: Self = 250.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.ln()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn fma<const FMA: bool>(self, a: Self, b: Self) -> Self {
        if FMA { self.mul_add(a, b) } else { self * a + b }
    }
    #[inline(always)]
    fn exp_poly<const FMA: bool>(self) -> Self {
        // As for f32, with 1.5 * 2^52.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
        const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
        let shifted = self.fma::<FMA>(std::f64::consts::LOG2_E, ROUND);
        let n = shifted - ROUND;
        let r = n.fma::<FMA>(-LN2_LOW, n.fma::<FMA>(-LN2_HIGH, self));
        let mut p = TAYLOR[0];
        for c in &TAYLOR[1..] {
            p = p.fma::<FMA>(r, *c);
        }
        p * f64::from_bits((shifted.to_bits() << 52).wrapping_add(1.0f64.to_bits()))
    }
    #[inline(always)]
    fn ln_poly<const FMA: bool>(self) -> Self {
        // The reference takes its time.
        self.ln()
    }
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_and_ln_are_accurate_over_the_range_used() {
        let (mut exp32, mut exp64, mut ln32) = (0.0f64, 0.0f64, 0.0f64);
        for k in 0..200_000 {
            let x = -60.0 + k as f64 * 6e-4;
            let x32 = x as f32;
            let want = f64::from(x32).exp();
            exp32 = exp32.max((f64::from(x32.exp_poly::<false>()) / want - 1.0).abs());
            exp32 = exp32.max((f64::from(x32.exp_poly::<true>()) / want - 1.0).abs());
            let x64 = x * 11.0;
            exp64 = exp64.max((x64.exp_poly::<true>() / x64.exp() - 1.0).abs());
            let y = want as f32;
            ln32 = ln32.max((f64::from(y.ln_poly::<true>()) - f64::from(y).ln()).abs() / (1.0 + x.abs()));
        }
        assert!(exp32 < 2e-7 && exp64 < 1e-15 && ln32 < 2e-7, "{exp32:e} {exp64:e} {ln32:e}");
    }
}
