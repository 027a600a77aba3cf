//! Convolutions of every channel with a kernel of its own; the border is surrounded by zeros.
//!
//! As many channels as a register holds are worked on at a time, in tables of their own with the border around them: so no place is a
//! special one, and the sums of [`COLUMNS`] places stay in registers.

use super::plan::Shape;
use crate::numeric::fit;
use pulp::{Arch, Simd, WithSimd};
use std::array;

/// Places of a row that are computed at once.
const COLUMNS: usize = 10;
/// Taps of a row whose gradients are summed at once.
const TAPS: usize = 7;

/// Tables of a few channels. Made once, used again and again.
#[derive(Debug, Clone, Default)]
pub(super) struct Room {
    x: Vec<f32>,
    grad: Vec<f32>,
    weight: Vec<f32>,
}

/// What is convolved with what.
pub(super) struct Convolution<'a> {
    /// Places x channels.
    pub x: &'a [f32],
    pub shape: Shape,
    /// Kernel x kernel x channels.
    pub weight: &'a [f32],
    pub kernel: usize,
    /// Of each channel; zeros where there is none.
    pub bias: Option<&'a [f32]>,
    /// Takes the kernel turned by half a circle, which leads from the gradient of what came out to that of what went in.
    pub turned: bool,
}

/// `out = x * weight + bias`.
pub(super) fn convolve(job: &Convolution<'_>, room: &mut Room, out: &mut [f32]) {
    Arch::new().dispatch(Forward { job, room, out });
}

/// Adds to the gradient of the weights, by `x` and the gradient of what came out.
pub(super) fn weight_gradient(
    x: &[f32],
    shape: Shape,
    grad: &[f32],
    kernel: usize,
    room: &mut Room,
    (weight, bias): (&mut [f32], &mut [f32]),
) {
    Arch::new().dispatch(Backward { x, shape, grad, kernel, room, weight, bias });
}

struct Forward<'a> {
    job: &'a Convolution<'a>,
    room: &'a mut Room,
    out: &'a mut [f32],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Convolution { x, shape, weight, kernel, bias, turned } = *self.job;
        let Shape { height, width, channels } = shape;
        let taps = kernel * kernel;
        let line = width.div_ceil(COLUMNS) * COLUMNS + kernel - 1;
        for first in (0..channels).step_by(S::F32_LANES) {
            let lanes = S::F32_LANES.min(channels - first);
            surrounded::<S>(x, shape, first, (kernel / 2, line, height + kernel - 1), &mut self.room.x);
            self.room.weight.clear();
            self.room.weight.resize(taps * S::F32_LANES, 0.0);
            for (tap, own) in self.room.weight.chunks_exact_mut(S::F32_LANES).enumerate() {
                let tap = if turned { taps - 1 - tap } else { tap };
                own[..lanes].copy_from_slice(&weight[tap * channels + first..][..lanes]);
            }
            let mut shift = [0.0_f32; 64];
            if let Some(bias) = bias {
                shift[..lanes].copy_from_slice(&bias[first..first + lanes]);
            }
            let (shift, _) = S::as_simd_f32s(&shift[..S::F32_LANES]);
            let ((x, _), (weight, _)) = (S::as_simd_f32s(&self.room.x), S::as_simd_f32s(&self.room.weight));
            for y in 0..height {
                for column in (0..width).step_by(COLUMNS) {
                    let mut sums = [shift[0]; COLUMNS];
                    for down in 0..kernel {
                        let from = &x[(y + down) * line + column..][..COLUMNS + kernel - 1];
                        let weight = &weight[down * kernel..][..kernel];
                        for (right, &weight) in weight.iter().enumerate() {
                            let from = &from[right..right + COLUMNS];
                            sums = array::from_fn(|at| simd.mul_add_e_f32s(from[at], weight, sums[at]));
                        }
                    }
                    let places = COLUMNS.min(width - column);
                    for (at, sum) in sums.iter().enumerate().take(places) {
                        let to = &mut self.out[(y * width + column + at) * channels + first..][..lanes];
                        store::<S>(*sum, to);
                    }
                }
            }
        }
    }
}

struct Backward<'a> {
    x: &'a [f32],
    shape: Shape,
    grad: &'a [f32],
    kernel: usize,
    room: &'a mut Room,
    weight: &'a mut [f32],
    bias: &'a mut [f32],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (shape, kernel) = (self.shape, self.kernel);
        let Shape { height, width, channels } = shape;
        let line = width + kernel - 1;
        for first in (0..channels).step_by(S::F32_LANES) {
            let lanes = S::F32_LANES.min(channels - first);
            surrounded::<S>(self.x, shape, first, (kernel / 2, line, height + kernel - 1), &mut self.room.x);
            surrounded::<S>(self.grad, shape, first, (0, width, height), &mut self.room.grad);
            let ((x, _), (grad, _)) = (S::as_simd_f32s(&self.room.x), S::as_simd_f32s(&self.room.grad));
            for down in 0..kernel {
                for right in (0..kernel).step_by(TAPS) {
                    let x = &x[down * line + right..];
                    let place = (down * kernel + right) * channels + first;
                    let weight = &mut self.weight[place..];
                    let job = Taps { x, grad, width, line, channels, lanes };
                    match TAPS.min(kernel - right) {
                        1 => job.add::<S, 1>(simd, weight),
                        2 => job.add::<S, 2>(simd, weight),
                        3 => job.add::<S, 3>(simd, weight),
                        4 => job.add::<S, 4>(simd, weight),
                        5 => job.add::<S, 5>(simd, weight),
                        6 => job.add::<S, 6>(simd, weight),
                        _ => job.add::<S, TAPS>(simd, weight),
                    }
                }
            }
            let sum = grad.iter().fold(simd.splat_f32s(0.0), |sum, part| simd.add_f32s(sum, *part));
            add::<S>(simd, sum, &mut self.bias[first..first + lanes]);
        }
    }
}

struct Taps<'a, V> {
    /// From the first tap of a row on.
    x: &'a [V],
    grad: &'a [V],
    width: usize,
    line: usize,
    channels: usize,
    lanes: usize,
}

impl<V: Copy> Taps<'_, V> {
    #[inline(always)]
    fn add<S: Simd<f32s = V>, const COUNT: usize>(&self, simd: S, weight: &mut [f32]) {
        let mut sums = [simd.splat_f32s(0.0); COUNT];
        for (y, grad) in self.grad.chunks_exact(self.width).enumerate() {
            let x = &self.x[y * self.line..][..self.width + COUNT - 1];
            for (x, &grad) in x.windows(COUNT).zip(grad) {
                sums = array::from_fn(|at| simd.mul_add_e_f32s(x[at], grad, sums[at]));
            }
        }
        for (at, sum) in sums.iter().enumerate() {
            add::<S>(simd, *sum, &mut weight[at * self.channels..][..self.lanes]);
        }
    }
}

/// A register's channels of a table, from `first` on, as a table of `line` x `lines` places, of which `border` lie before the first one
/// in both directions; zeros around it.
#[inline(always)]
fn surrounded<S: Simd>(
    table: &[f32],
    Shape { height, width, channels }: Shape,
    first: usize,
    (border, line, lines): (usize, usize, usize),
    out: &mut Vec<f32>,
) {
    let lanes = S::F32_LANES.min(channels - first);
    let (before, wide) = (border * S::F32_LANES, width * S::F32_LANES);
    let lines = fit(out, line * lines * S::F32_LANES).chunks_exact_mut(line * S::F32_LANES);
    for (y, to) in lines.enumerate() {
        let Some(y) = y.checked_sub(border).filter(|y| *y < height) else {
            to.fill(0.0);
            continue;
        };
        let (left, to) = to.split_at_mut(before);
        let (to, right) = to.split_at_mut(wide);
        left.fill(0.0);
        right.fill(0.0);
        let from = table[y * width * channels..][..width * channels].chunks_exact(channels);
        for (to, from) in to.chunks_exact_mut(S::F32_LANES).zip(from) {
            if lanes == S::F32_LANES {
                to.copy_from_slice(&from[first..first + S::F32_LANES]);
            } else {
                to[..lanes].copy_from_slice(&from[first..]);
                to[lanes..].fill(0.0);
            }
        }
    }
}

#[inline(always)]
fn store<S: Simd>(numbers: S::f32s, to: &mut [f32]) {
    if to.len() == S::F32_LANES {
        let (to, _) = S::as_mut_simd_f32s(to);
        to[0] = numbers;
    } else {
        let mut all = [0.0_f32; 64];
        let (own, _) = S::as_mut_simd_f32s(&mut all[..S::F32_LANES]);
        own[0] = numbers;
        to.copy_from_slice(&all[..to.len()]);
    }
}

#[inline(always)]
fn add<S: Simd>(simd: S, numbers: S::f32s, to: &mut [f32]) {
    let mut all = [0.0_f32; 64];
    let (own, _) = S::as_mut_simd_f32s(&mut all[..S::F32_LANES]);
    own[0] = simd.add_f32s(own[0], numbers);
    to.iter_mut().zip(all).for_each(|(to, part)| *to += part);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::Noise;

    /// Sums as they are written in books, without borders or registers.
    fn plain(x: &[f32], shape: Shape, weight: &[f32], kernel: usize) -> Vec<f32> {
        let Shape { height, width, channels } = shape;
        let half = kernel / 2;
        let one = |at: usize| {
            let (place, channel) = (at / channels, at % channels);
            let (y, column) = (place / width, place % width);
            let mut sum = 0.0;
            for tap in 0..kernel * kernel {
                let (from_y, from_x) = (y + tap / kernel, column + tap % kernel);
                if (half..height + half).contains(&from_y) && (half..width + half).contains(&from_x) {
                    let from = (from_y - half) * width + from_x - half;
                    sum += f64::from(x[from * channels + channel] * weight[tap * channels + channel]);
                }
            }
            sum as f32
        };
        (0..shape.numbers()).map(one).collect()
    }

    #[test]
    fn convolutions_of_all_shapes_are_plain_sums_and_their_gradients_fit() {
        let mut room = Room::default();
        for (height, width, channels, kernel) in
            [(10, 10, 33, 7), (1, 1, 1, 3), (4, 13, 5, 5), (7, 20, 64, 3), (6, 3, 16, 9)]
        {
            let shape = Shape { height, width, channels };
            let mut noise = Noise::new(kernel as u64);
            let (x, grad) = (noise.normals(shape.numbers()), noise.normals(shape.numbers()));
            let weight = noise.normals(kernel * kernel * channels);
            let bias: Vec<f32> = noise.normals(channels);
            // What an earlier call left must not count.
            for left in [&mut room.x, &mut room.grad, &mut room.weight] {
                left.fill(f32::NAN);
            }
            let job = Convolution { x: &x, shape, weight: &weight, kernel, bias: None, turned: false };
            let mut out = vec![9.0; shape.numbers()];
            convolve(&job, &mut room, &mut out);
            let wanted = plain(&x, shape, &weight, kernel);
            let far =
                |a: &[f32], b: &[f32]| a.iter().zip(b).fold(0.0_f32, |far, (a, b)| far.max((a - b).abs()));
            assert!(far(&out, &wanted) < 1e-4, "{shape:?} {kernel}");
            let mut shifted = out.clone();
            convolve(&Convolution { bias: Some(&bias), ..job }, &mut room, &mut shifted);
            let wanted: Vec<f32> =
                out.iter().zip(bias.iter().cycle()).map(|(out, bias)| out + bias).collect();
            assert!(far(&shifted, &wanted) < 1e-4);
            // The gradient of <grad, x * w>: in x it is the turned convolution, in w the sums below.
            let mut back = vec![0.0; shape.numbers()];
            let turned = Convolution { x: &grad, turned: true, ..job };
            convolve(&turned, &mut room, &mut back);
            let dot = |a: &[f32], b: &[f32]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum() };
            let value = dot(&grad, &out);
            assert!((dot(&back, &x) - value).abs() < 1e-3 * value.abs().max(10.0));
            let (mut to_weight, mut to_bias) = (vec![0.0; weight.len()], vec![0.0; channels]);
            weight_gradient(&x, shape, &grad, kernel, &mut room, (&mut to_weight, &mut to_bias));
            assert!((dot(&to_weight, &weight) - value).abs() < 1e-3 * value.abs().max(10.0));
            let sums: Vec<f32> =
                (0..channels).map(|at| grad.iter().skip(at).step_by(channels).sum()).collect();
            assert!(far(&to_bias, &sums) < 1e-3);
            // One tap's weight alone.
            let tap = (kernel * kernel / 2 + 1) * channels;
            if tap < weight.len() {
                let mut one = vec![0.0; weight.len()];
                one[tap] = 1.0;
                assert!(
                    (dot(&grad, &plain(&x, shape, &one, kernel)) - f64::from(to_weight[tap])).abs() < 1e-3
                );
            }
        }
    }
}
