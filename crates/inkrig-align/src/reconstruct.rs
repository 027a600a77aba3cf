//! From frame weights to a clip at the clip's own frame rate.

use crate::anchor::{Fade, Fades, join};
use crate::{AlignError, FrameWeights, Options};
use inkrig_motion::channels::{Journey, PoseChannels};
use inkrig_motion::time::{self, whole_ratio};
use inkrig_motion::{Clip, Features, MotionError, Takes};
use std::ops::Range;

/// What comes after the last row of weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Nothing.
    Open,
    /// The first row.
    Loop,
}

pub use crate::anchor::Anchor;

/// What the finished motion has to obey beside its weights.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// What comes after the last row.
    pub ends: Ends,
    /// What is settled exactly, in order of time.
    pub anchors: &'a [Anchor<'a>],
    /// Frames of the matched source that may not appear, in ascending order: between them and their neighbours nothing
    /// is interpolated.
    pub forbidden: &'a [usize],
}

impl Rules<'_> {
    /// Nothing but the weights.
    pub fn free(ends: Ends) -> Self {
        Self { ends, anchors: &[], forbidden: &[] }
    }
}

/// Weights below this are rounding, not motion.
pub(crate) const LEAST_WEIGHT: f32 = 1e-5;

/// Blends the source's poses by weights that were found at a matching rate.
///
/// `weights` are m x n: output frame i takes weight (i, j) of frame j of `matched`, which are the
/// source's takes at the matching rate. Around what is settled, over half a patch, the blend goes over into the settled
/// motion's own movement. The result has the source's own frame rate and the time of m matched frames. An output frame
/// between two matched ones blends both rows, each moved to its own moment in the source, so no detail of a faster clip
/// is lost by matching at a slower rate.
///
/// # Errors
/// When the result is not a motion (cannot happen for rows that sum to 1), or an anchor's skeleton is another.
pub fn blend_clip(
    source: &Takes,
    matched: &Takes,
    weights: &FrameWeights,
    rules: Rules<'_>,
    options: &Options,
) -> Result<Clip, AlignError> {
    let rows: Vec<SparseRow> = (0..weights.rows()).map(|row| weights.row(row).collect()).collect();
    PoseBlend::new(source, matched, options).clip(&rows, rules)
}

/// A source that is ready to be blended, any number of times.
#[derive(Debug, Clone)]
pub(crate) struct PoseBlend {
    layout: PoseChannels,
    poses: Features,
    /// The source's first frame, from which headings count.
    first: Option<Clip>,
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
        let first = time::trim(source.clip(), 0..1).ok();
        let rate = source.clip().frame_rate();
        let step = frames_per_sample(rate, matched.clip().frame_rate());
        let reach = 0.5 * options.patch() as f64 * step;
        Self { layout, poses, first, rate, step, reach, shares: Shares::new(source, matched) }
    }

    /// As [`blend_clip`].
    pub(crate) fn clip(&mut self, rows: &[SparseRow], rules: Rules<'_>) -> Result<Clip, AlignError> {
        let frames = (rows.len() as f64 * self.step).round().max(1.0) as usize;
        let width = self.layout.width();
        let mut out = vec![0.0_f32; frames * width];
        // After its last row a loop goes on to its first; anything else stays where it is.
        let last = (rows.len() - 1) as f64;
        let last = if rules.ends == Ends::Loop { last + 1.0 - 1e-9 } else { last };
        let settled = self.settled(rules.anchors)?;
        let fades = Fades::new(rules.anchors, frames, rules.ends, self.reach);
        self.shares.forbid(rules.forbidden, self.step);
        for (frame, values) in out.chunks_exact_mut(width).enumerate() {
            let place = (frame as f64 / self.step).min(last);
            let row = place.floor() as usize;
            self.mix((&rows[row], &rows[(row + 1) % rows.len()]), place - row as f64);
            let mut free = 1.0;
            for fade in fades.at(frame) {
                free -= fade.share;
                match (&rules.anchors[fade.anchor], &settled[fade.anchor]) {
                    (Anchor::Clip { clip, .. }, Some(poses)) => {
                        let count = clip.frames() as isize;
                        // An earlier loop goes around, too.
                        let around = rules.ends == Ends::Loop && count == frames as isize;
                        let own = if around {
                            fade.frame.rem_euclid(count)
                        } else {
                            fade.frame.clamp(0, count - 1)
                        };
                        add(values, poses.row(1 + own as usize), fade.share);
                    }
                    (anchor, _) => self.shares.fade(anchor, &fade),
                }
            }
            self.take(free.max(0.0), values);
        }
        self.shares.forbid(&[], self.step);
        Ok(join(&self.layout.to_clip(&out, self.rate)?, self.layout.travel_joint(), rules.anchors)?)
    }

    /// The poses of anchors that are clips, after the source's first frame, so that headings count from it.
    fn settled(&self, anchors: &[Anchor<'_>]) -> Result<Vec<Option<Features>>, AlignError> {
        let rows = |anchor: &Anchor<'_>| match anchor {
            Anchor::Frame { .. } => Ok(None),
            Anchor::Clip { clip, .. } => {
                let first = self.first.clone().ok_or(MotionError::NoFrames)?;
                let takes = Takes::join(&[first, (*clip).clone()])?;
                Ok(Some(self.layout.rows(&takes)))
            }
        };
        anchors.iter().map(rows).collect()
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
            self.take(1.0, values);
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

    /// Adds the pose of the shares, those of the weights made to sum to `free`.
    fn take(&mut self, free: f32, values: &mut [f32]) {
        let poses = &self.poses;
        self.shares.take(free, |index, weight| add(values, poses.row(index), weight));
    }
}

fn add(values: &mut [f32], row: &[f32], weight: f32) {
    values.iter_mut().zip(row).for_each(|(value, &channel)| *value += weight * channel);
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
    /// Matched and own frames of every take.
    takes: Vec<(Range<usize>, Range<usize>)>,
    /// For every own frame the nearest of its take that may appear; empty while all may.
    allowed: Vec<usize>,
    share: Vec<f32>,
    used: Vec<usize>,
    /// Shares of what is settled: of the whole, not of what the weights make up.
    settled: Vec<(usize, f32)>,
}

impl Shares {
    fn new(source: &Takes, matched: &Takes) -> Self {
        let takes = matched.ranges().zip(source.ranges()).collect();
        let share = vec![0.0; source.clip().frames()];
        Self { takes, allowed: Vec::new(), share, used: Vec::new(), settled: Vec::new() }
    }

    /// Says which matched frames may not appear, in ascending order.
    fn forbid(&mut self, forbidden: &[usize], step: f64) {
        self.allowed.clear();
        if forbidden.is_empty() {
            return;
        }
        self.allowed.extend(0..self.share.len());
        for (matched, own) in &self.takes {
            let may = |frame: usize| {
                let nearest = ((frame - own.start) as f64 / step).round() as usize + matched.start;
                forbidden.binary_search(&nearest.min(matched.end - 1)).is_err()
            };
            let open: Vec<usize> = own.clone().filter(|&frame| may(frame)).collect();
            for frame in own.clone() {
                let after = open.partition_point(|&open| open < frame);
                let around = open[after.saturating_sub(1)..(after + 1).min(open.len())].iter();
                let nearest = around.copied().min_by_key(|open| open.abs_diff(frame));
                self.allowed[frame] = nearest.unwrap_or(frame);
            }
        }
    }

    /// Adds weights of matched frames, each moved by `shift` matched frames and shared between its two neighbours at
    /// the source's own rate. What would lie outside of a take falls on its first or last frame.
    fn add(&mut self, weights: &[(usize, f32)], factor: f64, step: f64, shift: f64) {
        for &(column, weight) in weights {
            let after = self.takes.partition_point(|take| take.0.start <= column);
            let (matched, own) = &self.takes[after - 1];
            let (begin, first, last) = (matched.start, own.start, own.end - 1);
            let place = (((column - begin) as f64 + shift) * step).clamp(0.0, (last - first) as f64);
            let low = place.floor() as usize;
            let part = (place - low as f64) as f32;
            let weight = factor as f32 * weight;
            self.put(first + low, weight * (1.0 - part));
            self.put((first + low + 1).min(last), weight * part);
        }
    }

    /// The frame, or the nearest that may appear.
    fn may(&self, frame: usize) -> usize {
        self.allowed.get(frame).copied().unwrap_or(frame)
    }

    fn put(&mut self, frame: usize, weight: f32) {
        if weight > 0.0 {
            let frame = self.may(frame);
            if self.share[frame] == 0.0 {
                self.used.push(frame);
            }
            self.share[frame] += weight;
        }
    }

    /// Adds the source's own movement about a frame that is settled.
    fn fade(&mut self, anchor: &Anchor<'_>, fade: &Fade) {
        let Anchor::Frame { at, source } = anchor else { return };
        let take = self.takes.partition_point(|take| take.1.start <= *source) - 1;
        let own = &self.takes[take].1;
        let frame = source.saturating_add_signed(fade.frame - *at as isize).clamp(own.start, own.end - 1);
        self.settled.push((self.may(frame), fade.share));
    }

    /// Hands out the shares, those of the weights made to sum to `free`, and forgets them.
    fn take(&mut self, free: f32, mut give: impl FnMut(usize, f32)) {
        let total: f32 = self.used.iter().map(|&frame| self.share[frame]).sum();
        for frame in self.used.drain(..) {
            let share = std::mem::take(&mut self.share[frame]) / total * free;
            if share > 0.0 {
                give(frame, share);
            }
        }
        self.settled.drain(..).for_each(|(frame, share)| give(frame, share));
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
        blend_clip(&source, &matched, &identity, Rules::free(Ends::Open), &Options::default()).unwrap()
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
