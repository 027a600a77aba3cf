//! The frames about a key's pose, at the matching rate and at every level.

use crate::{AlignError, Layout, Options, pca::Subspace};
use inkrig_motion::{Clip, FeatureLayout, MotionError, Takes, time};
use inkrig_transport::{Mat, MatRef};

/// A pose with what is around it, as matching sees it.
#[derive(Debug, Clone)]
pub(super) enum Moment {
    /// Matched frame of the source.
    Own(usize),
    /// Of another clip.
    Other(Passage),
}

/// Frames of another clip about a moment, at the matching rate.
#[derive(Debug, Clone)]
pub(super) struct Passage {
    /// Frame features, n x d.
    pub(super) features: Mat<f32>,
    /// The same in the source's subspace, n x r.
    coordinates: Mat<f32>,
    /// How far each frame lies off that subspace.
    off: Vec<f32>,
    /// The row that the moment itself is.
    pub(super) centre: usize,
}

/// A patch that distances are taken to.
#[derive(Debug)]
pub(super) struct KeyPatch {
    /// Frames of a patch, patch x r.
    pub(super) frames: Mat<f32>,
    /// Sum of the squares of what the frames' coordinates leave out.
    pub(super) off_squared: f32,
}

/// What another clip is compared with.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) matched: &'a Takes,
    pub(super) layout: &'a FeatureLayout,
    pub(super) subspace: &'a Subspace,
    pub(super) options: &'a Options,
}

impl Passage {
    /// The frames about a frame of a clip: as many to each side as the coarsest level's patches need.
    pub(super) fn new(name: &str, clip: &Clip, frame: usize, seen: Seen<'_>) -> Result<Self, AlignError> {
        if frame >= clip.frames() {
            let what = format!(
                "there is no frame {frame} in {name}: it has {}, counted from 0; give another",
                clip.frames()
            );
            return Err(AlignError::Key { what });
        }
        let rate = seen.matched.clip().frame_rate();
        let step = clip.frame_rate() / rate;
        let reach = (seen.options.patch() as f64 * seen.options.ratio).ceil() as usize + 1;
        let before = ((frame as f64 / step).floor() as usize).min(reach);
        let after = (((clip.frames() - 1 - frame) as f64 / step).floor() as usize).min(reach);
        let places: Vec<f64> =
            (0..=before + after).map(|row| frame as f64 + (row as f64 - before as f64) * step).collect();
        let sampled = time::sample_at(clip, &places, rate)?;
        let features = features_beside(name, &sampled, seen)?;
        let (coordinates, off) = seen.subspace.project(features.view(), seen.options.threads)?;
        Ok(Self { features, coordinates, off, centre: before })
    }

    /// The patch about the moment where frames are `step` matched frames apart.
    fn patch(&self, patch: usize, step: f64) -> KeyPatch {
        let last = self.coordinates.rows() - 1;
        let mut frames = Mat::zeros(patch, self.coordinates.cols());
        let mut off_squared = 0.0;
        for row in 0..patch {
            let place = self.centre as f64 + (row as f64 - (patch / 2) as f64) * step;
            let place = place.clamp(0.0, last as f64);
            interpolate(self.coordinates.view(), place, frames.row_mut(row));
            off_squared += self.off[place.round() as usize].powi(2);
        }
        KeyPatch { frames, off_squared }
    }
}

impl Moment {
    /// The patch about it at a level.
    pub(super) fn patch(&self, full: &Layout, level: &Layout, table: MatRef<'_, f32>) -> KeyPatch {
        match self {
            Self::Own(frame) => KeyPatch::around(table, level, full.frame_in(level, *frame)),
            Self::Other(passage) => {
                let step = full.frames() as f64 / level.frames().max(1) as f64;
                passage.patch(level.patch(), step)
            }
        }
    }
}

impl KeyPatch {
    /// A patch of a table.
    pub(super) fn of(table: MatRef<'_, f32>, layout: &Layout, patch: usize) -> Self {
        let start = layout
            .runs()
            .find(|run| (run.patch..run.patch + run.count).contains(&patch))
            .map_or(0, |run| run.frame + patch - run.patch);
        let frames = Mat::from_fn(layout.patch(), table.cols(), |row, column| table.row(start + row)[column]);
        Self { frames, off_squared: 0.0 }
    }

    /// The patch about a frame. Where its clip is shorter than a patch, its first and last frames stay.
    fn around(table: MatRef<'_, f32>, layout: &Layout, frame: usize) -> Self {
        if let Some(patch) = layout.patch_around(frame) {
            return Self::of(table, layout, patch);
        }
        let last = table.rows().saturating_sub(1);
        let part = layout.part_of(frame).unwrap_or(0..last + 1);
        let frames = Mat::from_fn(layout.patch(), table.cols(), |row, column| {
            let place = (frame + row).saturating_sub(layout.patch() / 2);
            table.row(place.clamp(part.start, part.end.max(part.start + 1) - 1).min(last))[column]
        });
        Self { frames, off_squared: 0.0 }
    }

    /// A patch that stays at one row of values.
    pub(super) fn still(row: &[f32], patch: usize) -> Self {
        Self { frames: Mat::from_fn(patch, row.len(), |_, column| row[column]), off_squared: 0.0 }
    }

    /// This patch moved straight away from another, from `distance` to `wanted` (both not normalised).
    pub(super) fn away_from(mut self, other: &Self, distance: f32, wanted: f32) -> Self {
        // What lies off the subspace cannot be moved.
        let within = |distance: f32| (distance * distance - other.off_squared).max(0.0).sqrt();
        let factor = (within(wanted) / within(distance).max(1e-3 * wanted)).max(1.0);
        let values = self.frames.as_mut_slice().iter_mut().zip(other.frames.as_slice());
        values.for_each(|(value, &origin)| *value = origin + factor * (*value - origin));
        self
    }

    /// L2 distances of all patches of a table to this one, times `scale`; that of an equal one is exactly 0.
    pub(super) fn distances(&self, table: MatRef<'_, f32>, layout: &Layout, scale: f32) -> Vec<f32> {
        let starts = layout.runs().flat_map(|run| run.frame..run.frame + run.count);
        let distance = |start: usize| {
            let squares = (0..layout.patch()).map(|row| {
                let pairs = table.row(start + row).iter().zip(self.frames.row(row));
                pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
            });
            (self.off_squared + squares.sum::<f32>()).sqrt() * scale
        };
        starts.map(distance).collect()
    }
}

/// Frame features of a motion as they are beside the source's: headings count from the source's first frame.
pub(super) fn features_beside(name: &str, clip: &Clip, seen: Seen<'_>) -> Result<Mat<f32>, AlignError> {
    let first = time::trim(seen.matched.clip(), 0..1)?;
    let joined = Takes::join(&[first, clip.clone()]).map_err(|error| other_skeleton(name, error))?;
    let features = seen.layout.features(&joined);
    Ok(Mat::from_fn(features.frames() - 1, features.width(), |row, column| features.row(row + 1)[column]))
}

/// Says which clip of a key has another skeleton.
pub(super) fn other_skeleton(name: &str, error: MotionError) -> AlignError {
    match error {
        MotionError::OtherSkeleton { what, .. } => AlignError::Key {
            what: format!(
                "{name} has another skeleton ({what}): give a clip of the same character as the one that is arranged"
            ),
        },
        other => other.into(),
    }
}

/// The row of a table at a place between its rows.
pub(super) fn interpolate(table: MatRef<'_, f32>, place: f64, out: &mut [f32]) {
    let last = table.rows() - 1;
    let low = (place.max(0.0).floor() as usize).min(last);
    let part = (place - low as f64).clamp(0.0, 1.0) as f32;
    let (a, b) = (table.row(low), table.row((low + 1).min(last)));
    for ((value, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *value = a + part * (b - a);
    }
}
