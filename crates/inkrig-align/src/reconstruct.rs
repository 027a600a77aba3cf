//! From frame weights to a clip at the clip's own frame rate.

use crate::{AlignError, FrameWeights, Options};
use inkrig_motion::channels::{Journey, PoseChannels};
use inkrig_motion::{Clip, Features, Takes, time::whole_ratio};

/// What comes after the last row of weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Nothing.
    Open,
    /// The first row.
    Loop,
}

/// Weights below this are rounding, not motion.
pub(crate) const LEAST_WEIGHT: f32 = 1e-5;

/// Blends the source's poses by weights that were found at a matching rate.
///
/// `weights` are m x n: output frame i takes weight (i, j) of frame j of `matched`, which are the
/// source's takes at the matching rate. `exact` names output frames that shall be source frames, both at the source's
/// own rate; around them, over half a patch, the blend goes over into the source's own movement. The result has the source's own frame rate and the time of m matched frames. An
/// output frame between two matched ones blends both rows, each moved to its own moment in the source, so no detail
/// of a faster clip is lost by matching at a slower rate.
///
/// # Errors
/// When the result is not a motion (cannot happen for rows that sum to 1).
pub fn blend_clip(
    source: &Takes,
    matched: &Takes,
    weights: &FrameWeights,
    (ends, exact): (Ends, &[(usize, usize)]),
    options: &Options,
) -> Result<Clip, AlignError> {
    let rows: Vec<SparseRow> = (0..weights.rows()).map(|row| weights.row(row).collect()).collect();
    PoseBlend::new(source, matched, options).clip(&rows, (ends, exact))
}

/// A source that is ready to be blended, any number of times.
#[derive(Debug, Clone)]
pub(crate) struct PoseBlend {
    layout: PoseChannels,
    poses: Features,
    rate: f64,
    /// Frames per row of weights.
    step: f64,
    /// Frames over which the blend goes over into an exact one.
    reach: f64,
    shares: Shares,
}

impl PoseBlend {
    pub(crate) fn new(source: &Takes, matched: &Takes, options: &Options) -> Self {
        let (layout, poses) = PoseChannels::of(source, options.travel);
        let rate = source.clip().frame_rate();
        let step = frames_per_sample(rate, matched.clip().frame_rate());
        let reach = 0.5 * options.patch() as f64 * step;
        Self { layout, poses, rate, step, reach, shares: Shares::new(source, matched) }
    }

    /// As [`blend_clip`].
    pub(crate) fn clip(
        &mut self,
        rows: &[SparseRow],
        (ends, exact): (Ends, &[(usize, usize)]),
    ) -> Result<Clip, AlignError> {
        let frames = (rows.len() as f64 * self.step).round().max(1.0) as usize;
        let width = self.layout.width();
        let mut out = vec![0.0_f32; frames * width];
        // After its last row a loop goes on to its first; anything else stays where it is.
        let last = (rows.len() - 1) as f64;
        let last = if ends == Ends::Loop { last + 1.0 - 1e-9 } else { last };
        for (frame, values) in out.chunks_exact_mut(width).enumerate() {
            let place = (frame as f64 / self.step).min(last);
            let row = place.floor() as usize;
            self.mix((&rows[row], &rows[(row + 1) % rows.len()]), place - row as f64);
            for &(at, key) in exact {
                self.shares.fade_to(key, frame as isize - at as isize, self.reach);
            }
            self.take(values);
        }
        Ok(self.layout.to_clip(&out, self.rate)?)
    }

    /// The frames that `rows` allow, of a motion that goes on: `first` is the number of the first row, `given` counts the
    /// frames handed out before. Up to the last row's own moment, or, at the motion's `end`, up to its end.
    pub(crate) fn piece(
        &mut self,
        rows: &[SparseRow],
        first: usize,
        given: usize,
        end: bool,
        journey: &mut Journey,
    ) -> Result<Option<Clip>, AlignError> {
        let last = (first + rows.len() - 1) as f64;
        let frames = if end {
            ((last + 1.0) * self.step).round() as usize
        } else {
            (last * self.step + 1e-9).floor() as usize + 1
        };
        if frames <= given {
            return Ok(None);
        }
        let width = self.layout.width();
        let mut out = vec![0.0_f32; (frames - given) * width];
        for (frame, values) in (given..frames).zip(out.chunks_exact_mut(width)) {
            let place = (frame as f64 / self.step).clamp(first as f64, last) - first as f64;
            let row = place.floor() as usize;
            self.mix((&rows[row], &rows[(row + 1).min(rows.len() - 1)]), place - row as f64);
            self.take(values);
        }
        Ok(Some(self.layout.to_clip_from(&out, self.rate, journey)?))
    }

    /// The shares of a frame that lies between two rows of weights, `part` of the way.
    fn mix(&mut self, (a, b): (&SparseRow, &SparseRow), part: f64) {
        self.shares.add(a, 1.0 - part, self.step, part);
        if part > 0.0 {
            self.shares.add(b, part, self.step, part - 1.0);
        }
    }

    /// The pose of the shares.
    fn take(&mut self, values: &mut [f32]) {
        let poses = &self.poses;
        self.shares.take(|index, weight| {
            for (value, &channel) in values.iter_mut().zip(poses.row(index)) {
                *value += weight * channel;
            }
        });
    }
}

/// Columns and weights of a row, without those that are nothing but rounding.
pub(crate) type SparseRow = Vec<(usize, f32)>;

/// Frames of a clip per matched frame; exact where frames were picked, so that no interpolation creeps in.
pub fn frames_per_sample(rate: f64, matching_rate: f64) -> f64 {
    whole_ratio(rate, matching_rate).map_or(rate / matching_rate, |whole| whole as f64)
}

/// The columns of a row whose weight is more than rounding.
pub(crate) fn kept(row: &[f32]) -> SparseRow {
    row.iter().copied().enumerate().filter(|(_, weight)| *weight > LEAST_WEIGHT).collect()
}

/// The shares that the source's frames have in one output frame.
#[derive(Debug, Clone)]
struct Shares {
    /// First matched frame, first own frame and last own frame of every take.
    takes: Vec<(usize, usize, usize)>,
    share: Vec<f32>,
    used: Vec<usize>,
}

impl Shares {
    fn new(source: &Takes, matched: &Takes) -> Self {
        let takes = matched
            .ranges()
            .zip(source.ranges())
            .map(|(matched, own)| (matched.start, own.start, own.end - 1));
        Self { takes: takes.collect(), share: vec![0.0; source.clip().frames()], used: Vec::new() }
    }

    /// Adds weights of matched frames, each moved by `shift` matched frames and shared between its two neighbours at
    /// the source's own rate. What would lie outside of a take falls on its first or last frame.
    fn add(&mut self, weights: &[(usize, f32)], factor: f64, step: f64, shift: f64) {
        for &(column, weight) in weights {
            let after = self.takes.partition_point(|take| take.0 <= column);
            let (begin, first, last) = self.takes[after - 1];
            let place = (((column - begin) as f64 + shift) * step).clamp(0.0, (last - first) as f64);
            let low = place.floor() as usize;
            let part = (place - low as f64) as f32;
            let weight = factor as f32 * weight;
            self.put(first + low, weight * (1.0 - part));
            self.put((first + low + 1).min(last), weight * part);
        }
    }

    fn put(&mut self, frame: usize, weight: f32) {
        if weight > 0.0 {
            if self.share[frame] == 0.0 {
                self.used.push(frame);
            }
            self.share[frame] += weight;
        }
    }

    /// Fades to the source's own movement around a frame: all of it where `offset` (in frames) is 0, none from `reach` on.
    fn fade_to(&mut self, key: usize, offset: isize, reach: f64) {
        let place = offset as f64 / reach.max(1.0);
        if place.abs() >= 1.0 {
            return;
        }
        let new = (0.5 * std::f64::consts::PI * place).cos().powi(2) as f32;
        let total: f32 = self.used.iter().map(|&frame| self.share[frame]).sum();
        let kept = (1.0 - new) / total;
        for &frame in &self.used {
            self.share[frame] *= kept;
        }
        if kept == 0.0 {
            self.used.clear();
        }
        let take = self.takes.partition_point(|take| take.1 <= key) - 1;
        let (_, first, last) = self.takes[take];
        self.put(key.saturating_add_signed(offset).clamp(first, last), new);
    }

    /// Hands out the shares, made to sum to 1, and forgets them.
    fn take(&mut self, mut give: impl FnMut(usize, f32)) {
        let total: f32 = self.used.iter().map(|&frame| self.share[frame]).sum();
        for frame in self.used.drain(..) {
            give(frame, std::mem::take(&mut self.share[frame]) / total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;
    use inkrig_transport::Mat;

    /// Every matched frame takes just itself.
    fn through(clip: &Clip) -> Clip {
        let source = Takes::from(clip.clone());
        let matched = source.decimate(30.0).unwrap();
        let frames = matched.clip().frames();
        let identity = Mat::from_fn(frames, frames, |row, column| f32::from(u8::from(row == column)));
        let identity = FrameWeights::from_mat(identity.view()).unwrap();
        blend_clip(&source, &matched, &identity, (Ends::Open, &[]), &Options::default()).unwrap()
    }

    #[test]
    fn the_identity_gives_the_clip_back_at_its_own_rate() {
        for rate in [30.0, 60.0, 59.99988, 120.0] {
            let clip = swinging(4.0, rate);
            let back = through(&clip);
            assert_eq!(back.frame_rate(), rate);
            for frame in 0..back.frames().min(clip.frames()) {
                for (a, b) in clip.rotations(frame).iter().zip(back.rotations(frame)) {
                    assert!(a.dot(*b).abs() > 1.0 - 1e-6, "rate {rate}, frame {frame}");
                }
            }
        }
    }

    #[test]
    fn a_slower_clip_comes_back_at_its_own_rate_too() {
        let clip = swinging(4.0, 24.0);
        let back = through(&clip);
        assert_eq!(back.frames(), 97);
        for frame in 0..97 {
            let turned = clip.rotations(frame)[1].angle_between(back.rotations(frame)[1]);
            assert!(turned < 0.01, "frame {frame}: {turned} radians off");
        }
    }
}
