use super::Kernel;
use super::rows::fold;
use crate::Real;
use crate::padded::LANES;

/// Update of the column scaling from the column sums `s = K^T u`, in logarithms:
///
/// `log v = w (log target - log s) - (1 - w) held`, `w = (lambda + mu) / (lambda + mu + epsilon)`
///
/// where `held` is the part of the scaling that already stands in `K`. A common factor of `v` does not show in the plan,
/// so `v` is then divided by the mass it would give; what remains is the change of the columns' masses.
pub(crate) struct Scaling<'a, T> {
    pub(crate) sums: &'a [T],
    pub(crate) log_target: &'a [T],
    pub(crate) held: &'a [T],
    pub(crate) weight: T,
    /// In and out; 0 in the padding.
    pub(crate) v: &'a mut [T],
    /// Out: log v.
    pub(crate) log_v: &'a mut [T],
    pub(crate) cols: usize,
}

impl<T: Real> Kernel for Scaling<'_, T> {
    /// L1 change of the column masses, which sum to 1.
    type Output = T;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> T {
        let (sums, log_target, held) = (self.sums, self.log_target, self.held);
        let rest = T::ONE - self.weight;
        let mut mass = [T::ZERO; LANES];
        let inputs =
            sums.chunks_exact(LANES).zip(log_target.chunks_exact(LANES)).zip(held.chunks_exact(LANES));
        for (((sums, log_target), held), log_v) in inputs.zip(self.log_v.chunks_exact_mut(LANES)) {
            for l in 0..LANES {
                let log_sum = sums[l].greater(T::TINY).ln_poly::<FMA>();
                let x = self.weight * (log_target[l] - log_sum) - rest * held[l];
                log_v[l] = x.lesser(T::LOG_CHANGE).greater(-T::LOG_CHANGE);
                mass[l] += log_v[l].exp_poly::<FMA>() * sums[l];
            }
        }
        let shift = fold(mass).greater(T::TINY).ln();
        let mut change = [T::ZERO; LANES];
        let inputs = sums.chunks_exact(LANES).zip(self.v.chunks_exact_mut(LANES));
        for ((sums, v), log_v) in inputs.zip(self.log_v.chunks_exact_mut(LANES)) {
            for l in 0..LANES {
                log_v[l] = (log_v[l] - shift).greater(T::EXPONENT_FLOOR).lesser(-T::EXPONENT_FLOOR);
                let x = log_v[l].exp_poly::<FMA>();
                change[l] += (x - v[l]).magnitude() * sums[l];
                v[l] = x;
            }
        }
        self.v[self.cols..].fill(T::ZERO);
        fold(change)
    }
}
