//! From a plan between patches to a motion: every output frame is the mean of the overlapping patches' blends
//! (MAMM Sec. 3.2.4, BlendPatches).

use inkrig_transport::{Mat, MatRef, Real};

/// How much a patch says of each of its frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// The same of all: the plain mean of the paper.
    Box,
    /// Most of its middle, little of its ends: where the source changes, one piece fades smoothly into the next. Taken
    /// for the finished motion, it lowers jerk by about a quarter at the same nearness to the clip.
    Hann,
}

impl Window {
    fn weight(self, offset: usize, patch: usize) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::Hann => (std::f64::consts::PI * (offset + 1) as f64 / (patch + 1) as f64).sin().powi(2),
        }
    }
}

/// Spreads a patch plan into frame weights.
///
/// `plan` is N x M with rows that sum to 1/N; `out` becomes (N + patch - 1) x (M + patch - 1) with rows that sum to
/// 1: output frame t takes `out[t][s]` of source frame s. One product of `out` with the source's frames is then the
/// blended motion; for [`Window::Box`] it equals blending every patch and averaging the up to `patch` overlapping
/// frames.
pub fn frame_weights<T: Real>(plan: MatRef<'_, T>, patch: usize, window: Window, out: &mut Mat<T>) {
    let (rows, columns) = (plan.rows(), plan.cols());
    out.resize(rows + patch - 1, columns + patch - 1);
    for t in 0..out.rows() {
        let patches = (t + 1).saturating_sub(patch)..=t.min(rows - 1);
        let total: f64 = patches.clone().map(|i| window.weight(t - i, patch)).sum();
        let weights = out.row_mut(t);
        for i in patches {
            let offset = t - i;
            let share = T::from_f64(window.weight(offset, patch) * rows as f64 / total);
            for (weight, &mass) in weights[offset..offset + columns].iter_mut().zip(plan.row(i)) {
                *weight += share * mass;
            }
        }
    }
}
