//! Parts of an earlier result that stay as they are.

use super::moment::{features_beside, interpolate};
use super::resolve::Context;
use crate::patches::{PatchScratch, patch_distances};
use crate::reconstruct::Anchor;
use crate::{AlignError, Layout};
use inkrig_motion::{Clip, time};
use inkrig_transport::{Mat, MatRef};
use std::ops::Range;

/// What the earlier result is called.
const NAME: &str = "the earlier result";

/// A part of an earlier result at its time.
#[derive(Debug, Clone)]
pub(super) struct Fixed {
    /// Frames of the result at the source's own rate.
    pub(super) out: Range<usize>,
    /// The earlier result at the source's own rate.
    pub(super) earlier: Clip,
    /// Its frames at the matching rate in the source's subspace, as many as the control has or fewer.
    coordinates: Mat<f32>,
    /// First and last place of the part, frames at the matching rate.
    places: (f64, f64),
}

impl Fixed {
    pub(super) fn new(
        earlier: &Clip,
        frames: Range<usize>,
        context: &Context<'_>,
    ) -> Result<Self, AlignError> {
        let refuse = |what: String| Err(AlignError::Key { what });
        let (own_rate, step) = (context.timing.source.clip().frame_rate(), context.step());
        let rate = earlier.frame_rate();
        if frames.is_empty() || frames.end > earlier.frames() {
            return refuse(format!(
                "frames {} to {} shall stay as they are, but {NAME} has {} ({:.2} s): keep a part of those",
                frames.start,
                frames.end,
                earlier.frames(),
                earlier.frames() as f64 / rate
            ));
        }
        let result = (context.rows.frames() as f64 * step).round() as usize;
        let ratio = own_rate / rate;
        let first = (frames.start as f64 * ratio - 1e-4).ceil().max(0.0) as usize;
        let out = first..((frames.end - 1) as f64 * ratio + 1e-4).floor() as usize + 1;
        if out.end > result || out.is_empty() {
            return refuse(format!(
                "the part from {:.2} s to {:.2} s shall stay as it is, but the result has {:.2} s: keep an earlier part, \
                 or make the result longer",
                frames.start as f64 / rate,
                frames.end as f64 / rate,
                result as f64 / own_rate
            ));
        }
        let own = time::resample(earlier, own_rate)?;
        let last = own.frames() as f64 - 1.0;
        let samples = (0..context.rows.frames()).map(|row| row as f64 * step);
        let samples: Vec<f64> = samples.take_while(|&place| place <= last + 1e-6).collect();
        let matched = time::sample_at(&own, &samples, context.timing.matched.clip().frame_rate())?;
        let features = features_beside(NAME, &matched, context.seen())?;
        let (coordinates, _) = context.subspace.project(features.view(), context.options.threads)?;
        let places = (out.start as f64 / step, (out.end - 1) as f64 / step);
        Ok(Self { out, earlier: own, coordinates, places })
    }

    pub(super) fn anchor(&self) -> Anchor<'_> {
        Anchor::Clip { at: self.out.clone(), clip: &self.earlier }
    }

    /// Its time, for people.
    pub(super) fn span(&self, context: &Context<'_>) -> String {
        let rate = context.timing.source.clip().frame_rate();
        format!("{:.2} s to {:.2} s", self.out.start as f64 / rate, self.out.end as f64 / rate)
    }

    /// The frames of a level that are known, with their coordinates.
    pub(super) fn known(&self, full: &Layout, level: &Layout) -> Vec<(usize, Vec<f32>)> {
        // Half a frame of the level more than the part itself, so that a short one is not lost between two frames.
        let step = place(full, level, 1);
        let near = 0.5 * (step - 1.0).max(0.0) + 1e-6;
        (0..level.frames())
            .filter_map(|frame| {
                let place = place(full, level, frame);
                let within = place >= self.places.0 - near && place <= self.places.1 + near;
                within.then(|| (frame, self.at(place)))
            })
            .collect()
    }

    fn at(&self, place: f64) -> Vec<f32> {
        let mut row = vec![0.0; self.coordinates.cols()];
        interpolate(self.coordinates.view(), place, &mut row);
        row
    }

    /// The rows of a level that lie in the part, each with the open column that is most like it. A part that is shorter
    /// than a patch has the row about its middle.
    pub(super) fn settled(
        &self,
        full: &Layout,
        level: &Layout,
        (source, columns): (MatRef<'_, f32>, &Layout),
        closed: &[usize],
    ) -> Result<Vec<(usize, usize)>, AlignError> {
        let known = self.known(full, level);
        let patch = level.patch();
        let Some(&(begin, _)) = known.first() else { return Ok(Vec::new()) };
        let (first, table) = if known.len() >= patch {
            let width = self.coordinates.cols();
            (begin, Mat::from_fn(known.len(), width, |row, column| known[row].1[column]))
        } else {
            let middle = begin + known.len() / 2;
            let first = level.patch_around(middle).unwrap_or(0);
            let mut table = Mat::zeros(patch, self.coordinates.cols());
            for row in 0..patch {
                let frame = first + row;
                // Around a loop's seam the part goes on where it was.
                let frame =
                    if frame > middle + patch { frame as f64 - level.frames() as f64 } else { frame as f64 };
                let place = frame * place(full, level, 1);
                interpolate(self.coordinates.view(), place, table.row_mut(row));
            }
            (first, table)
        };
        let layout = Layout::open(table.rows(), patch);
        let (mut distances, mut scratch) = (Mat::default(), PatchScratch::new());
        let own = (table.view(), &layout);
        patch_distances(own, (source, columns), 1.0, &mut scratch, &mut distances, 1)?;
        Ok((0..distances.rows())
            .filter_map(|row| {
                let distances = distances.row(row);
                let open = (0..distances.len()).filter(|column| closed.binary_search(column).is_err());
                let nearest = open.min_by(|&a, &b| distances[a].total_cmp(&distances[b]))?;
                Some((first + row, nearest))
            })
            .collect())
    }

    /// Whether the part itself shows what is forbidden: the time of the first patch that is nearest to a closed column.
    pub(super) fn forbidden(
        &self,
        full: &Layout,
        (source, columns): (MatRef<'_, f32>, &Layout),
        closed: &[usize],
    ) -> Result<bool, AlignError> {
        let free = self.settled(full, full, (source, columns), &[])?;
        Ok(free.iter().any(|(_, column)| closed.binary_search(column).is_ok()))
    }
}

/// Where a frame of a level is in frames of the full length.
fn place(full: &Layout, level: &Layout, frame: usize) -> f64 {
    let (full_frames, frames) = (full.frames() as f64, level.frames() as f64);
    if full.is_cyclic() {
        frame as f64 * full_frames / frames
    } else {
        frame as f64 * (full_frames - 1.0) / (frames - 1.0).max(1.0)
    }
}
