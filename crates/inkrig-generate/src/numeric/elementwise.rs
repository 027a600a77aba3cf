//! Functions of single numbers over whole buffers, written so that the compiler makes vector code of them.

use pulp::Arch;

/// Floats of the widest register: sums run in that many lanes, on every processor.
const LANES: usize = 16;
/// How high the normal distribution is in its middle.
const ROOT: f32 = 0.398_942_3;

/// `x Phi(x)` with the exact normal distribution, not the tanh that resembles it. Returned in `out`; `x` stays, as its
/// gradient needs it.
pub(crate) fn gelu(x: &[f32], out: &mut [f32]) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (out, &x) in out.iter_mut().zip(x) {
                *out = x * normal_below(x);
            }
        },
    );
}

/// The gradient at `x` of what follows, by that of what follows, in place.
pub(crate) fn gelu_gradient(x: &[f32], grad: &mut [f32]) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (grad, &x) in grad.iter_mut().zip(x) {
                *grad *= normal_below(x) + x * ROOT * exp(-0.5 * x * x);
            }
        },
    );
}

/// [`gelu`] and [`gelu_gradient`] at once.
pub(crate) fn gelu_again(x: &[f32], out: &mut [f32], grad: &mut [f32]) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for ((out, grad), &x) in out.iter_mut().zip(grad).zip(x) {
                let below = normal_below(x);
                *out = x * below;
                *grad *= below + x * ROOT * exp(-0.5 * x * x);
            }
        },
    );
}

/// `x / (1 + e^-x)`, in place.
pub(crate) fn silu(x: &mut [f32]) {
    for x in x {
        *x /= 1.0 + (-*x).exp();
    }
}

/// The larger of 0 and `x`, in place.
pub(crate) fn relu(x: &mut [f32]) {
    for x in x {
        *x = x.max(0.0);
    }
}

/// Adds one buffer to another.
pub(crate) fn add(out: &mut [f32], x: &[f32]) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (out, x) in out.iter_mut().zip(x) {
                *out += x;
            }
        },
    );
}

/// Adds every row of a table to a row.
pub(crate) fn add_rows(out: &mut [f32], table: &[f32]) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for row in table.chunks_exact(out.len().max(1)) {
                for (out, x) in out.iter_mut().zip(row) {
                    *out += x;
                }
            }
        },
    );
}

/// Every row becomes positive numbers that add up to 1: exponentials of `scale` times it.
pub(crate) fn softmax(rows: &mut [f32], width: usize, scale: f32) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for row in rows.chunks_exact_mut(width) {
                let most = row.iter().fold(f32::NEG_INFINITY, |most, &x| most.max(x));
                for x in row.iter_mut() {
                    *x = exp(scale * (*x - most));
                }
                let share = 1.0 / sum(row);
                for x in row.iter_mut() {
                    *x *= share;
                }
            }
        },
    );
}

/// From probabilities and the gradient of each to the gradient of the scores before [`softmax`], in place.
pub(crate) fn softmax_gradient(probabilities: &[f32], grad: &mut [f32], width: usize, scale: f32) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (p, grad) in probabilities.chunks_exact(width).zip(grad.chunks_exact_mut(width)) {
                let mean = dot(p, grad);
                for (grad, p) in grad.iter_mut().zip(p) {
                    *grad = scale * p * (*grad - mean);
                }
            }
        },
    );
}

/// The sum, in sixteen lanes.
#[inline(always)]
pub(crate) fn sum(x: &[f32]) -> f32 {
    let (chunks, rest) = x.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane += x;
        }
    }
    together(lanes) + rest.iter().sum::<f32>()
}

/// The sum of products, in sixteen lanes.
#[inline(always)]
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    together(lanes) + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f32>()
}

#[inline(always)]
fn together(mut lanes: [f32; LANES]) -> f32 {
    let mut half = LANES / 2;
    while half > 0 {
        for lane in 0..half {
            lanes[lane] += lanes[lane + half];
        }
        half /= 2;
    }
    lanes[0]
}

/// The part of a normal distribution below `x`.
#[inline(always)]
fn normal_below(x: f32) -> f32 {
    0.5 + 0.5 * erf(x * std::f32::consts::FRAC_1_SQRT_2)
}

/// The error function by a quotient of polynomials, as XLA and Eigen have it; within 5e-7.
#[inline(always)]
fn erf(x: f32) -> f32 {
    let x = x.clamp(-4.0, 4.0);
    let square = x * x;
    let mut above = -2.726_142_3e-10_f32;
    for next in [2.770_681_4e-8, -2.101_024e-6, -5.692_506_3e-5, -7.349_906e-4, -2.954_6e-3, -1.609_603_3e-2]
    {
        above = above * square + next;
    }
    let mut below = -1.456_607_2e-5_f32;
    for next in [-2.133_740_5e-4, -1.682_827e-3, -7.373_329_3e-3, -1.426_473_9e-2] {
        below = below * square + next;
    }
    x * above / below
}

/// The exponential function, within 1e-7 of its size, for numbers below 88.
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    /// Adding it leaves the nearest whole number in the lowest bits.
    const ROUND: f32 = 12_582_912.0;
    let x = x.max(-87.0);
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let power = rounded.to_bits() << 23;
    let whole = rounded - ROUND;
    let rest = (x - whole * 0.693_359_4) - whole * -2.121_944_4e-4;
    let mut sum = 1.987_569_1e-4_f32;
    for next in [1.398_199_9e-3, 8.333_452e-3, 4.166_579_6e-2, 0.166_666_66, 0.5] {
        sum = sum * rest + next;
    }
    let fraction = sum * rest * rest + rest + 1.0;
    f32::from_bits(fraction.to_bits().wrapping_add(power))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error function by its series, in double precision.
    fn exact(x: f64) -> f64 {
        let (mut term, mut total) = (x, x);
        for n in 1..200 {
            term *= -x * x / f64::from(n);
            total += term / f64::from(2 * n + 1);
        }
        total * std::f64::consts::FRAC_2_SQRT_PI
    }

    #[test]
    fn error_function_and_exponential_are_exact_to_single_precision() {
        for step in -400..=400 {
            let x = step as f32 / 100.0;
            assert!((f64::from(erf(x)) - exact(f64::from(x))).abs() < 5e-7, "{x}");
            let e = f64::from(exp(x * 20.0)) / f64::from(x * 20.0).exp();
            assert!((e - 1.0).abs() < 2e-7, "{x}: {e}");
        }
        assert!(exp(-1e9) < 1e-37);
    }

    #[test]
    fn gradients_are_differences() {
        for x in [-3.0_f32, -0.7, 0.0, 0.4, 2.5] {
            let value = |x: f32| f64::from(x) * (0.5 + 0.5 * exact(f64::from(x) * 0.5_f64.sqrt()));
            let mut grad = [2.0];
            gelu_gradient(&[x], &mut grad);
            let slope = (value(x + 1e-3) - value(x - 1e-3)) / (f64::from(x + 1e-3) - f64::from(x - 1e-3));
            assert!((f64::from(grad[0]) - 2.0 * slope).abs() < 1e-5);
        }
    }

    #[test]
    fn probabilities_add_up_to_one() {
        let mut rows: Vec<f32> = (0..66).map(|x| (x * 7 % 13) as f32 * 9.0).collect();
        softmax(&mut rows, 33, 0.5);
        assert!(rows.chunks(33).all(|row| (sum(row) - 1.0).abs() < 1e-6));
        assert!((dot(&rows[..33], &[2.0; 33]) - 2.0).abs() < 1e-5);
    }
}
