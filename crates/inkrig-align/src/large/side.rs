//! One side at one level, without a table of all its distances.

use crate::pyramid::resample_frames;
use crate::{AlignError, Frames, Layout, Norm};
use inkrig_transport::{LowRank, Mat, Nystrom, Windows};

/// Factors of each patch; beside them the solver needs its self-norm (see [`LowRank`]).
const RANK: usize = 32;
/// Patches whose distances to all others make the factors.
const LANDMARKS: usize = 192;
/// Patches whose distances to all others stand for all distances, where a share of them is asked for.
const SAMPLE: usize = 64;

/// Frames of one side at one level, and the distances within its patches by factors.
#[derive(Debug)]
pub(crate) struct Side {
    pub(crate) layout: Layout,
    /// As many rows as [`Layout::rows`] says.
    pub(crate) frames: Mat<f32>,
    /// The first frame of every patch.
    starts: Vec<usize>,
    /// Distances times `scale`.
    pub(crate) distances: LowRank<f32>,
    /// 1 over the distance that counts as one.
    pub(crate) scale: f32,
}

impl Side {
    /// Brings frames to a layout; `None` when all patches are alike.
    pub(crate) fn new(
        frames: Frames<'_>,
        layout: &Layout,
        norm: Norm,
        threads: usize,
    ) -> Result<Option<Self>, AlignError> {
        let mut table = Mat::default();
        resample_frames(frames.table, frames.layout, layout, &mut table);
        let starts = layout.first_frames();
        let windows = Windows::new(table.view(), &starts, layout.patch())?;
        let job = Nystrom { rank: RANK, landmarks: LANDMARKS, threads };
        let mut distances = job.fit(starts.len(), |patch, out: &mut [f32]| {
            windows.distances_from(windows.get(patch), 1.0, out);
        })?;
        let mean = distances.mean();
        let largest = (0..table.rows()).map(|row| table.row(row).iter().map(|x| x * x).sum::<f32>());
        // Rounding leaves distances of this size between equal patches.
        let noise = 1e-6 * (1.0 + f64::from(largest.fold(0.0, f32::max).sqrt()));
        if !(mean.is_finite() && mean > noise) {
            return Ok(None);
        }
        let size = match norm {
            Norm::Mean | Norm::Learned => mean,
            Norm::Max => quantile(&windows, 1.0).max(mean),
            Norm::Quantile => quantile(&windows, 0.9).max(mean),
        };
        distances.scale(1.0 / size)?;
        Ok(Some(Self {
            layout: layout.clone(),
            starts,
            distances,
            scale: (1.0 / size) as f32,
            frames: table,
        }))
    }

    /// Its patches.
    pub(crate) fn patches(&self) -> Result<Windows<'_, f32>, AlignError> {
        self.windows(&self.frames)
    }

    /// The patches of another table of this layout.
    pub(crate) fn windows<'a>(&'a self, table: &'a Mat<f32>) -> Result<Windows<'a, f32>, AlignError> {
        Ok(Windows::new(table.view(), &self.starts, self.layout.patch())?)
    }
}

/// The distance below which a share of the distances from some patches, spread evenly, lies.
fn quantile(windows: &Windows<'_, f32>, share: f64) -> f64 {
    let count = windows.count();
    let some = SAMPLE.min(count);
    let mut values = vec![0.0_f32; some * count];
    for (k, row) in values.chunks_exact_mut(count).enumerate() {
        windows.distances_from(windows.get((2 * k + 1) * count / (2 * some)), 1.0, row);
    }
    let rank = ((values.len() - 1) as f64 * share) as usize;
    f64::from(*values.select_nth_unstable_by(rank, f32::total_cmp).1)
}
