//! Loops over the rows of one block. Rows are `stride` apart; all vectors along a row have `stride` values.

use super::Kernel;
use crate::Real;
use crate::padded::LANES;

/// Gradient to Gibbs kernel, and the first half of the first sweep:
/// `x = linear + column + scale * product`, `K = exp(-(x - min x) / epsilon)`, `u = p / (K 1)`, `sums += u K`.
/// Subtracting the row's minimum changes `u` only.
pub(crate) struct Gibbs<'a, T> {
    /// In: the product `Dy T Dx`. Out: `K`, zero in the padding.
    pub(crate) rows: &'a mut [T],
    /// Linear part of the gradient, [`Real::HUGE`] in the padding.
    pub(crate) linear: &'a [T],
    pub(crate) column: &'a [T],
    pub(crate) scale: T,
    pub(crate) inverse_epsilon: T,
    pub(crate) p: T,
    pub(crate) stride: usize,
    pub(crate) cols: usize,
    /// Out: column sums of `diag(u) K`.
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for Gibbs<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let column = &self.column[..self.stride];
        let sums = &mut self.sums[..self.stride];
        sums.fill(T::ZERO);
        for (x, linear) in self.rows.chunks_exact_mut(self.stride).zip(self.linear.chunks_exact(self.stride))
        {
            let least = add_terms::<T, FMA>(x, linear, column, self.scale);
            let total = exp_row::<T, FMA>(x, least, self.inverse_epsilon);
            x[self.cols..].fill(T::ZERO);
            let u = self.p / total;
            for (s, &k) in sums.iter_mut().zip(x.iter()) {
                *s = u.fma::<FMA>(k, *s);
            }
        }
    }
}

/// One sweep: `u = p / (K v)`, `sums = K^T u`. Reads `K` once.
pub(crate) struct Sweep<'a, T> {
    pub(crate) rows: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) p: T,
    pub(crate) stride: usize,
    /// Out: `K^T u` of these rows.
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for Sweep<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let v = &self.v[..self.stride];
        let sums = &mut self.sums[..self.stride];
        sums.fill(T::ZERO);
        for k in self.rows.chunks_exact(self.stride) {
            let u = self.p / dot::<T, FMA>(k, v);
            for (s, &k) in sums.iter_mut().zip(k) {
                *s = u.fma::<FMA>(k, *s);
            }
        }
    }
}

/// The plan: `u = p / (K v)`, `T = diag(u) K diag(v)`, and its column sums.
pub(crate) struct PlanRows<'a, T> {
    pub(crate) rows: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) p: T,
    pub(crate) stride: usize,
    /// Out: `T`.
    pub(crate) plan: &'a mut [T],
    /// Out: column sums of `T`.
    pub(crate) sums: &'a mut [T],
    /// Whether to compare with the plan that stands in `plan`.
    pub(crate) watch: bool,
}

impl<T: Real> Kernel for PlanRows<'_, T> {
    /// L1 distance to the plan before, when watched.
    type Output = f64;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let v = &self.v[..self.stride];
        let sums = &mut self.sums[..self.stride];
        sums.fill(T::ZERO);
        let mut change = 0.0;
        for (k, t) in self.rows.chunks_exact(self.stride).zip(self.plan.chunks_exact_mut(self.stride)) {
            let u = self.p / dot::<T, FMA>(k, v);
            if self.watch {
                let row: T =
                    k.iter().zip(v).zip(t.iter()).map(|((&k, &v), &t)| (u * k * v - t).magnitude()).sum();
                change += row.to_f64();
            }
            for (((t, s), &k), &v) in t.iter_mut().zip(sums.iter_mut()).zip(k).zip(v) {
                let x = u * k * v;
                *t = if x < T::FLUSH { T::ZERO } else { x };
                *s += *t;
            }
        }
        change
    }
}

/// One step of mirror descent in the logarithm: `L = decay * L - step * (linear + column + scale * product)`,
/// normalised so that `T = exp(L)` has rows of sum `p`.
pub(crate) struct Mirror<'a, T> {
    /// In: the product `Dy T Dx`. Destroyed.
    pub(crate) rows: &'a mut [T],
    pub(crate) linear: &'a [T],
    pub(crate) column: &'a [T],
    pub(crate) scale: T,
    pub(crate) decay: T,
    pub(crate) step: T,
    pub(crate) p: T,
    pub(crate) stride: usize,
    pub(crate) cols: usize,
    /// In and out: log T.
    pub(crate) log_plan: &'a mut [T],
    /// Out: T.
    pub(crate) plan: &'a mut [T],
    /// Out: column sums of T.
    pub(crate) sums: &'a mut [T],
}

impl<T: Real> Kernel for Mirror<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let column = &self.column[..self.stride];
        let sums = &mut self.sums[..self.stride];
        sums.fill(T::ZERO);
        let linear = self.linear.chunks_exact(self.stride);
        let plans = self.log_plan.chunks_exact_mut(self.stride).zip(self.plan.chunks_exact_mut(self.stride));
        for ((x, linear), (log, t)) in self.rows.chunks_exact_mut(self.stride).zip(linear).zip(plans) {
            add_terms::<T, FMA>(x, linear, column, self.scale);
            let mut least = T::HUGE;
            for (x, &log) in x.iter_mut().zip(log.iter()) {
                *x = self.step * *x - self.decay * log;
                least = least.lesser(*x);
            }
            t.copy_from_slice(x);
            let total = exp_row::<T, FMA>(t, least, T::ONE);
            t[self.cols..].fill(T::ZERO);
            let (u, shift) = (self.p / total, least + (self.p / total).ln());
            for (log, &x) in log[..self.cols].iter_mut().zip(x.iter()) {
                *log = shift - x;
            }
            for (t, s) in t.iter_mut().zip(sums.iter_mut()) {
                let x = u * *t;
                *t = if x < T::FLUSH { T::ZERO } else { x };
                *s += *t;
            }
        }
    }
}

/// `out = softmax(-cost / temperature)` per row. Rows without padding are fine.
pub(crate) struct Softmax<'a, T> {
    pub(crate) cost: &'a [T],
    pub(crate) out: &'a mut [T],
    pub(crate) cols: usize,
    pub(crate) inverse_temperature: T,
}

impl<T: Real> Kernel for Softmax<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (cost, out) in self.cost.chunks_exact(self.cols).zip(self.out.chunks_exact_mut(self.cols)) {
            out.copy_from_slice(cost);
            let least = least(out);
            let scale = T::ONE / exp_row::<T, FMA>(out, least, self.inverse_temperature);
            for x in out {
                let y = *x * scale;
                *x = if y < T::FLUSH { T::ZERO } else { y };
            }
        }
    }
}

/// `out_j = sum_l d_jl^2 c_l` for the rows of a distance matrix.
pub(crate) struct SquareProduct<'a, T> {
    pub(crate) rows: &'a [T],
    pub(crate) mass: &'a [T],
    pub(crate) stride: usize,
    pub(crate) out: &'a mut [T],
}

impl<T: Real> Kernel for SquareProduct<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mass = &self.mass[..self.stride];
        for (d, out) in self.rows.chunks_exact(self.stride).zip(self.out) {
            *out = lanes_sum::<T>(
                d,
                mass,
                #[inline(always)]
                |sum, d, c| (d * c).fma::<FMA>(d, sum),
            );
        }
    }
}

/// `x = linear + column + scale * x`; returns the least.
#[inline(always)]
fn add_terms<T: Real, const FMA: bool>(x: &mut [T], linear: &[T], column: &[T], scale: T) -> T {
    let mut lanes = [T::HUGE; LANES];
    let terms = linear.chunks_exact(LANES).zip(column.chunks_exact(LANES));
    for (x, (linear, column)) in x.chunks_exact_mut(LANES).zip(terms) {
        for l in 0..LANES {
            let y = scale.fma::<FMA>(x[l], linear[l] + column[l]);
            x[l] = y;
            lanes[l] = lanes[l].lesser(y);
        }
    }
    lanes.into_iter().fold(T::HUGE, T::lesser)
}

/// `x = exp((least - x) * scale)`, clamped below; returns the sum.
#[inline(always)]
pub(super) fn exp_row<T: Real, const FMA: bool>(x: &mut [T], least: T, scale: T) -> T {
    let mut lanes = [T::ZERO; LANES];
    let mut chunks = x.chunks_exact_mut(LANES);
    for chunk in &mut chunks {
        for l in 0..LANES {
            let e = ((least - chunk[l]) * scale).greater(T::EXPONENT_FLOOR).exp_poly::<FMA>();
            chunk[l] = e;
            lanes[l] += e;
        }
    }
    let mut total = T::ZERO;
    for x in chunks.into_remainder() {
        *x = ((least - *x) * scale).greater(T::EXPONENT_FLOOR).exp_poly::<FMA>();
        total += *x;
    }
    total + fold(lanes)
}

/// The least of a row of any length.
#[inline(always)]
fn least<T: Real>(x: &[T]) -> T {
    let mut lanes = [T::HUGE; LANES];
    let chunks = x.chunks_exact(LANES);
    let tail = chunks.remainder().iter().copied().fold(T::HUGE, T::lesser);
    for chunk in chunks {
        for l in 0..LANES {
            lanes[l] = lanes[l].lesser(chunk[l]);
        }
    }
    lanes.into_iter().fold(tail, T::lesser)
}

#[inline(always)]
pub(super) fn dot<T: Real, const FMA: bool>(a: &[T], b: &[T]) -> T {
    lanes_sum::<T>(
        a,
        b,
        #[inline(always)]
        |sum, a, b| a.fma::<FMA>(b, sum),
    )
}

/// Sums over two padded rows in four lane groups, which hide the latency of the addition.
#[inline(always)]
pub(super) fn lanes_sum<T: Real>(a: &[T], b: &[T], step: impl Fn(T, T, T) -> T) -> T {
    let mut sums = [[T::ZERO; LANES]; 4];
    let (quads_a, quads_b) = (a.chunks_exact(4 * LANES), b.chunks_exact(4 * LANES));
    let rest = quads_a.remainder().chunks_exact(LANES).zip(quads_b.remainder().chunks_exact(LANES));
    for (a, b) in quads_a.zip(quads_b) {
        for (q, sum) in sums.iter_mut().enumerate() {
            for l in 0..LANES {
                sum[l] = step(sum[l], a[q * LANES + l], b[q * LANES + l]);
            }
        }
    }
    for (a, b) in rest {
        for l in 0..LANES {
            sums[0][l] = step(sums[0][l], a[l], b[l]);
        }
    }
    let mut lanes = [T::ZERO; LANES];
    for l in 0..LANES {
        lanes[l] = (sums[0][l] + sums[1][l]) + (sums[2][l] + sums[3][l]);
    }
    fold(lanes)
}

#[inline(always)]
pub(super) fn fold<T: Real>(mut lanes: [T; LANES]) -> T {
    let mut half = LANES / 2;
    while half > 0 {
        for l in 0..half {
            lanes[l] += lanes[l + half];
        }
        half /= 2;
    }
    lanes[0]
}
