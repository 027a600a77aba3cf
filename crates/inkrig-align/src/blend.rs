//! From a plan between patches to a motion: every output frame is the mean of the overlapping patches' blends
//! (MAMM Sec. 3.2.4, BlendPatches).

use inkrig_transport::{Mat, MatRef, Real};

/// Spreads a patch plan into frame weights.
///
/// `plan` is N x M with rows that sum to 1/N; `out` becomes (N + patch - 1) x (M + patch - 1) with rows that sum to
/// 1: output frame t takes `out[t][s]` of source frame s. One product of `out` with the source's frames is then the
/// blended motion; it equals blending every patch and averaging the up to `patch` overlapping frames.
pub fn frame_weights<T: Real>(plan: MatRef<'_, T>, patch: usize, out: &mut Mat<T>) {
    let (rows, columns) = (plan.rows(), plan.cols());
    out.resize(rows + patch - 1, columns + patch - 1);
    for t in 0..out.rows() {
        let first = (t + 1).saturating_sub(patch);
        let last = t.min(rows - 1);
        let weights = out.row_mut(t);
        weights.fill(T::ZERO);
        for i in first..=last {
            let offset = t - i;
            for (weight, &mass) in weights[offset..offset + columns].iter_mut().zip(plan.row(i)) {
                *weight += mass;
            }
        }
        let scale = T::from_f64(rows as f64 / (last + 1 - first) as f64);
        for weight in weights {
            *weight *= scale;
        }
    }
}
