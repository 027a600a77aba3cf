//! Convolutions of every channel with a kernel of its own; the border is surrounded by zeros.

use super::plan::Shape;
use pulp::Arch;

/// Channels that are worked on at once.
const LANES: usize = 32;

/// `out = x * weight + bias`; weights are kernel x kernel x channels. `turned` takes the kernel turned by half a circle, which leads
/// from the gradient of what came out to that of what went in.
pub(super) fn convolve(
    x: &[f32],
    shape: Shape,
    weight: &[f32],
    kernel: usize,
    bias: Option<&[f32]>,
    turned: bool,
    out: &mut [f32],
) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            let Shape { height, width, channels } = shape;
            let (taps, half) = (kernel * kernel, kernel / 2);
            for first in (0..channels).step_by(LANES) {
                let lanes = LANES.min(channels - first);
                for y in 0..height {
                    for column in 0..width {
                        let mut sums = [0.0_f32; LANES];
                        if let Some(bias) = bias {
                            sums[..lanes].copy_from_slice(&bias[first..first + lanes]);
                        }
                        let rows = half.saturating_sub(y)..kernel.min(height + half - y);
                        let columns = half.saturating_sub(column)..kernel.min(width + half - column);
                        for down in rows {
                            let line = (y + down - half) * width + column;
                            for right in columns.clone() {
                                let tap = down * kernel + right;
                                let tap = if turned { taps - 1 - tap } else { tap };
                                let from = (line + right - half) * channels + first;
                                let weight = &weight[tap * channels + first..][..lanes];
                                add_products(&mut sums, &x[from..][..lanes], weight);
                            }
                        }
                        out[(y * width + column) * channels + first..][..lanes]
                            .copy_from_slice(&sums[..lanes]);
                    }
                }
            }
        },
    );
}

/// Adds to the gradient of the weights, by `x` and the gradient of what came out.
pub(super) fn weight_gradient(
    x: &[f32],
    shape: Shape,
    grad: &[f32],
    kernel: usize,
    weight: &mut [f32],
    bias: &mut [f32],
) {
    Arch::new().dispatch(
        #[inline(always)]
        || {
            let Shape { height, width, channels } = shape;
            let half = kernel / 2;
            for tap in 0..kernel * kernel {
                let (down, right) = (tap / kernel, tap % kernel);
                let rows = half.saturating_sub(down)..height.min((height + half).saturating_sub(down));
                let columns = half.saturating_sub(right)..width.min((width + half).saturating_sub(right));
                for first in (0..channels).step_by(LANES) {
                    let lanes = LANES.min(channels - first);
                    let mut sums = [0.0_f32; LANES];
                    for y in rows.clone() {
                        for column in columns.clone() {
                            let from = ((y + down - half) * width + column + right - half) * channels + first;
                            let to = (y * width + column) * channels + first;
                            add_products(&mut sums, &x[from..][..lanes], &grad[to..][..lanes]);
                        }
                    }
                    for (weight, sum) in weight[tap * channels + first..][..lanes].iter_mut().zip(sums) {
                        *weight += sum;
                    }
                }
            }
            for row in grad.chunks_exact(channels) {
                bias.iter_mut().zip(row).for_each(|(sum, part)| *sum += part);
            }
        },
    );
}

#[inline(always)]
fn add_products(sums: &mut [f32; LANES], a: &[f32], b: &[f32]) {
    if let (Some(a), Some(b)) = (a.first_chunk::<LANES>(), b.first_chunk::<LANES>()) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    } else {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
}
