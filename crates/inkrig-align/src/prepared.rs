//! What one side of a run knows before it meets the other: its frames at every level and the distances within them.
//!
//! It depends on that side alone, so a source is prepared once for any number of controls.

use crate::patches::{PatchScratch, normalised_self_distances};
use crate::pyramid::{level_lengths, resample_frames};
use crate::{AlignError, Layout, Norm, Options};
use inkrig_transport::{LowRank, Mat, MatRef, Nystrom, with_threads};
use std::sync::Arc;

/// A table of frames and where its patches stand.
#[derive(Debug, Clone, Copy)]
pub struct Frames<'a> {
    /// One row a frame, as many as [`Layout::rows`] says.
    pub table: MatRef<'a, f32>,
    /// The clips, or the loop, that the frames are.
    pub layout: &'a Layout,
}

/// One side at one level.
#[derive(Debug, Clone)]
pub struct LevelTable {
    /// Where its patches stand.
    pub layout: Layout,
    /// Its frames: as many rows as [`Layout::rows`] says.
    pub frames: Mat<f32>,
    /// Distances within its patches times [`scale`](Self::scale); square, symmetric, zero diagonal.
    pub distances: Mat<f32>,
    /// 1 over the distance that counts as one: see [`Norm`].
    pub scale: f32,
    /// The same distances by factors, where the solver shall take those.
    pub factors: Option<Arc<LowRank<f32>>>,
}

/// The levels of one side.
#[derive(Debug, Clone)]
pub struct Prepared {
    layout: Layout,
    pub(crate) levels: Vec<LevelTable>,
}

impl Prepared {
    /// The source's side.
    ///
    /// # Errors
    /// [`AlignError::StillClip`] when all its patches are alike.
    pub fn source(frames: Frames<'_>, options: &Options) -> Result<Self, AlignError> {
        Self::at(frames, &own_levels(frames, options), options.source_norm, options)?
            .ok_or(AlignError::StillClip)
    }

    /// The control's side.
    ///
    /// # Errors
    /// [`AlignError::StillControl`] when all its patches are alike.
    pub fn control(frames: Frames<'_>, options: &Options) -> Result<Self, AlignError> {
        Self::at(frames, &own_levels(frames, options), options.control_norm, options)?
            .ok_or(AlignError::StillControl)
    }

    /// Where its patches stand in full.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// All levels, coarsest first; the last is the table as it was given.
    pub fn levels(&self) -> &[LevelTable] {
        &self.levels
    }

    /// Brought to the given layouts, coarsest first; `None` when all patches are alike.
    pub(crate) fn at(
        frames: Frames<'_>,
        layouts: &[Layout],
        norm: Norm,
        options: &Options,
    ) -> Result<Option<Self>, AlignError> {
        let levels: Option<Vec<_>> = with_threads(options.threads, || {
            let mut scratch = PatchScratch::new();
            let levels =
                layouts.iter().map(|layout| LevelTable::new(frames, layout, norm, options, &mut scratch));
            levels.collect::<Result<_, AlignError>>()
        })?;
        Ok(levels.map(|levels| Self { layout: frames.layout.clone(), levels }))
    }
}

impl LevelTable {
    /// `None` when all patches are alike.
    fn new(
        frames: Frames<'_>,
        layout: &Layout,
        norm: Norm,
        options: &Options,
        scratch: &mut PatchScratch<f32>,
    ) -> Result<Option<Self>, AlignError> {
        let (mut table, mut distances) = (Mat::default(), Mat::default());
        resample_frames(frames.table, frames.layout, layout, &mut table);
        let scale =
            normalised_self_distances(table.view(), layout, norm, scratch, &mut distances, options.threads)?;
        let Some(scale) = scale else { return Ok(None) };
        let factors = factors(&distances, norm, options)?;
        Ok(Some(Self { layout: layout.clone(), frames: table, distances, scale, factors }))
    }
}

fn own_levels(frames: Frames<'_>, options: &Options) -> Vec<Layout> {
    level_layouts(frames.layout, options.levels, options.ratio, options.patch())
}

/// Distances by factors, where there are so many that they are worth it. What is learned is learned on all of them.
fn factors(
    distances: &Mat<f32>,
    norm: Norm,
    options: &Options,
) -> Result<Option<Arc<LowRank<f32>>>, AlignError> {
    if norm == Norm::Learned || !options.solver.takes_factors(distances.rows()) {
        return Ok(None);
    }
    let job = Nystrom { threads: options.threads, ..Nystrom::default() };
    let row = |i: usize, out: &mut [f32]| out.copy_from_slice(distances.row(i));
    Ok(Some(Arc::new(job.fit(distances.rows(), row)?)))
}

/// The layouts of all levels, coarsest first. The longest clip keeps at least five patches' length, or its own.
pub(crate) fn level_layouts(layout: &Layout, levels: usize, ratio: f64, patch: usize) -> Vec<Layout> {
    let (full, floor) = (layout.frames(), 5 * patch);
    let longest = layout.parts().iter().map(std::ops::Range::len).max().unwrap_or(full).max(1);
    let floor = (floor as f64 * full as f64 / longest as f64).ceil() as usize;
    let lengths = level_lengths(full, levels, ratio, floor);
    lengths.into_iter().map(|length| layout.resampled(length)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_end_with_the_table_itself() {
        let table = Mat::from_fn(200, 2, |row, column| (row as f32 * 0.1 + column as f32).sin());
        let layout = Layout::open(200, 11);
        let frames = Frames { table: table.view(), layout: &layout };
        let prepared = Prepared::source(frames, &Options::default()).unwrap();
        assert_eq!(prepared.levels().len(), 6);
        let last = &prepared.levels()[5];
        assert_eq!((&last.layout, &last.frames), (&layout, &table));
        assert!(prepared.levels().iter().all(|level| level.distances.rows() == level.layout.patches()));
        let still = Mat::from_fn(200, 2, |_, _| 1.0);
        let frames = Frames { table: still.view(), layout: &layout };
        assert!(matches!(Prepared::source(frames, &Options::default()), Err(AlignError::StillClip)));
        assert!(matches!(Prepared::control(frames, &Options::default()), Err(AlignError::StillControl)));
    }
}
