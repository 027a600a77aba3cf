//! From a plan between patches to a motion: every output frame is the mean of the overlapping patches' blends
//! (MAMM Sec. 3.2.4, BlendPatches).

use crate::Layout;
use inkrig_transport::{Mat, MatRef, Real, for_rows};

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
    pub(crate) fn weight(self, offset: usize, patch: usize) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::Hann => (std::f64::consts::PI * (offset + 1) as f64 / (patch + 1) as f64).sin().powi(2),
        }
    }
}

/// Spreads a patch plan into frame weights.
///
/// `plan` has a row of mass 1/N for each of the N patches of the first layout and a column for each patch of the
/// second; `out` becomes frames of the first x frames of the second, with rows that sum to 1: output frame t takes
/// `out[t][s]` of source frame s. One product of `out` with the source's frames is then the blended motion; for
/// [`Window::Box`] it equals blending every patch and averaging the up to `patch` overlapping frames.
pub fn frame_weights<T: Real>(
    plan: MatRef<'_, T>,
    (rows, columns): (&Layout, &Layout),
    window: Window,
    out: &mut Mat<T>,
    threads: usize,
) {
    let (patch, width) = (rows.patch(), columns.frames());
    out.resize(rows.frames(), width);
    for_rows(threads, out.as_mut_slice(), width, &|first, block| {
        for (i, weights) in block.chunks_exact_mut(width).enumerate() {
            let patches = rows.covering(first + i);
            let total: f64 = patches.iter().map(|&(_, offset)| window.weight(offset, patch)).sum();
            for (i, offset) in patches {
                let share = T::from_f64(window.weight(offset, patch) * plan.rows() as f64 / total);
                for run in columns.runs() {
                    let from = run.frame + offset;
                    let masses = &plan.row(i)[run.patch..run.patch + run.count];
                    for (weight, &mass) in weights[from..from + run.count].iter_mut().zip(masses) {
                        *weight += share * mass;
                    }
                }
            }
        }
    });
}
