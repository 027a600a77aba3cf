//! A clip's moments and how far they are from each other, without a table of all pairs.

use crate::alignment::{table, without_lead_ins};
use crate::patches::{PatchScratch, patch_distances};
use crate::reconstruct::frames_per_sample;
use crate::{AlignError, Layout, Options, pca};
use inkrig_motion::{FeatureLayout, Takes};
use inkrig_transport::{Mat, MatRef};

/// Moments of a clip whose distances to all others stand for those of all.
const SAMPLE: usize = 256;

/// The patches of a clip in the space in which they are matched. Distances are made for one moment at a time: memory is
/// linear in the clip's length.
#[derive(Debug, Clone)]
pub struct Moments {
    /// matched frames x rank.
    frames: Mat<f32>,
    layout: Layout,
    /// Divides distances by their mean.
    scale: f32,
    /// For every matched frame.
    places: Vec<Moment>,
    threads: usize,
}

/// A pose of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Frame of the source as it was given, at its own rate, takes counted through: what a [`Key`](crate::Key) takes.
    pub frame: usize,
    /// Its take, counted from 0.
    pub take: usize,
    /// Seconds since the beginning of that take.
    pub seconds: f64,
}

impl Moments {
    /// The moments of a source, compared as `options` say: matching rate, patch length, features. Rest-pose lead-ins are
    /// left out.
    ///
    /// # Errors
    /// When an option is out of range, or the clip is too short or does not move.
    pub fn of(source: &Takes, options: &Options) -> Result<Self, AlignError> {
        options.validate()?;
        let (own, lead_ins) = without_lead_ins(source)?;
        let matched = own.decimate(options.matching_rate)?;
        let lengths: Vec<usize> = matched.ranges().map(|range| range.len()).collect();
        let layout = Layout::clips(&lengths, options.patch());
        if layout.patches() < 2 {
            return Err(AlignError::ClipTooShort {
                frames: lengths.into_iter().max().unwrap_or(0),
                rate: options.matching_rate,
                patch: options.patch(),
                needed: options.patch() + 1,
            });
        }
        let features = FeatureLayout::of(&matched, &options.features).features(&matched);
        let frames = pca::reduce(table(&features)?, pca::FEATURE_ENERGY, options.threads)?.frames;
        let places = places(source, &lead_ins, &matched);
        let mut moments = Self { frames, layout, scale: 1.0, places, threads: options.threads };
        let mean = moments.mean_distance()?;
        if !(mean.is_finite() && mean > 1e-6 * moments.size()) {
            return Err(AlignError::StillClip);
        }
        moments.scale = (1.0 / mean) as f32;
        Ok(moments)
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.layout.patches()
    }

    /// Every frame at the matching rate, in order.
    pub fn frames(&self) -> &[Moment] {
        &self.places
    }

    /// The patch that a frame at the matching rate is in the middle of, or nearest to the middle.
    pub fn patch_around(&self, frame: usize) -> usize {
        self.layout.nearest_patch(frame).unwrap_or(0)
    }

    /// The pose in the middle of a patch; that of the last one when there is no such patch.
    pub fn middle(&self, patch: usize) -> Moment {
        let frame = self.first_frame(patch) + self.layout.patch() / 2;
        self.places.get(frame).or(self.places.last()).copied().unwrap_or(Moment {
            frame: 0,
            take: 0,
            seconds: 0.0,
        })
    }

    /// Distances from one patch to all, in mean distances of the clip's moments.
    ///
    /// # Errors
    /// Never for a patch below [`Self::count`]; others count as the last.
    pub fn distances_from(&self, patch: usize) -> Result<Vec<f32>, AlignError> {
        let (mut out, mut scratch) = (Mat::default(), PatchScratch::new());
        self.write_distances(patch, &mut scratch, &mut out)?;
        Ok(out.into_vec())
    }

    /// 1 over the mean distance of the clip's moments.
    pub(crate) fn scale(&self) -> f64 {
        f64::from(self.scale)
    }

    /// At most `most` patches, evenly spread over the clip.
    pub(super) fn spread(&self, most: usize) -> Vec<usize> {
        let (count, all) = (most.clamp(1, self.count()), self.count());
        (0..count).map(|index| (2 * index + 1) * all / (2 * count)).collect()
    }

    /// Distances from several patches (rows) to all, as for [`Self::distances_from`].
    pub(super) fn distances_of(&self, patches: &[usize]) -> Result<Mat<f32>, AlignError> {
        let (mut row, mut scratch) = (Mat::default(), PatchScratch::new());
        let mut all = Mat::zeros(patches.len(), self.count());
        for (index, &patch) in patches.iter().enumerate() {
            self.write_distances(patch, &mut scratch, &mut row)?;
            all.row_mut(index).copy_from_slice(row.row(0));
        }
        Ok(all)
    }

    fn write_distances(
        &self,
        patch: usize,
        scratch: &mut PatchScratch<f32>,
        out: &mut Mat<f32>,
    ) -> Result<(), AlignError> {
        let (patch, length, width) = (patch.min(self.count() - 1), self.layout.patch(), self.frames.cols());
        let first = self.first_frame(patch);
        let rows = &self.frames.as_slice()[first * width..(first + length) * width];
        let one = Layout::open(length, length);
        let all = (self.frames.view(), &self.layout);
        let own = (MatRef::new(rows, length, width)?, &one);
        patch_distances(own, all, self.scale, scratch, out, self.threads)?;
        // Rounding leaves a little between a patch and itself.
        out.row_mut(0)[patch] = 0.0;
        Ok(())
    }

    /// The first frame of a patch.
    fn first_frame(&self, patch: usize) -> usize {
        let run = self.layout.runs().find(|run| patch < run.patch + run.count);
        run.map_or(0, |run| run.frame + patch - run.patch)
    }

    fn mean_distance(&self) -> Result<f64, AlignError> {
        let sampled = self.distances_of(&self.spread(SAMPLE))?;
        let total: f64 = sampled.as_slice().iter().map(|&distance| f64::from(distance)).sum();
        Ok(total / sampled.as_slice().len() as f64)
    }

    /// Length of the longest patch from the centre, not normalised.
    fn size(&self) -> f64 {
        let squares = |frame| self.frames.row(frame).iter().map(|&v| f64::from(v).powi(2)).sum::<f64>();
        let largest = (0..self.frames.rows()).map(squares).fold(0.0, f64::max);
        (largest * self.layout.patch() as f64).sqrt()
    }
}

/// Where every matched frame comes from.
pub(crate) fn places(source: &Takes, lead_ins: &[usize], matched: &Takes) -> Vec<Moment> {
    let rate = source.clip().frame_rate();
    let step = frames_per_sample(rate, matched.clip().frame_rate());
    let takes = source.ranges().zip(lead_ins).zip(matched.ranges()).enumerate();
    takes
        .flat_map(|(take, ((given, &lead_in), range))| {
            (0..range.len()).map(move |index| {
                let place = (lead_in + (index as f64 * step).round() as usize).min(given.len() - 1);
                Moment { frame: given.start + place, take, seconds: place as f64 / rate }
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Norm;
    use crate::patches::normalised_self_distances;
    use crate::testing::swinging;

    #[test]
    fn distances_are_those_of_the_whole_table() {
        let moments = Moments::of(&swinging(4.0, 30.0).into(), &Options::default()).unwrap();
        let mut whole = Mat::default();
        let frames = moments.frames.view();
        let scratch = &mut PatchScratch::new();
        normalised_self_distances(frames, &moments.layout, Norm::Mean, scratch, &mut whole, 1).unwrap();
        assert_eq!((moments.count(), whole.rows()), (111, 111));
        for patch in [0, 40, 110] {
            for (a, b) in moments.distances_from(patch).unwrap().iter().zip(whole.row(patch)) {
                assert!((a - b).abs() < 2e-3, "{a} {b}");
            }
        }
    }

    #[test]
    fn moments_know_where_they_come_from() {
        let takes = Takes::join(&[swinging(2.0, 60.0), swinging(3.0, 60.0)]).unwrap();
        let moments = Moments::of(&takes, &Options::default()).unwrap();
        assert_eq!(moments.frames().len(), 61 + 91);
        // The middle of the second take's first patch: five steps of two frames into it.
        assert_eq!(moments.middle(51), Moment { frame: 121 + 10, take: 1, seconds: 10.0 / 60.0 });
        assert_eq!(moments.patch_around(61), 51);
        let spread = moments.spread(4);
        assert_eq!((spread.len(), spread[0], spread[3]), (4, 16, 115));
    }

    #[test]
    fn a_clip_that_stands_still_is_told() {
        let still = inkrig_motion::time::sample_at(&swinging(2.0, 30.0), &[9.0; 60], 30.0).unwrap();
        assert!(matches!(Moments::of(&still.into(), &Options::default()), Err(AlignError::StillClip)));
        let short = inkrig_motion::time::trim(&swinging(2.0, 30.0), 0..11).unwrap();
        assert!(matches!(
            Moments::of(&short.into(), &Options::default()),
            Err(AlignError::ClipTooShort { .. })
        ));
    }
}
