//! Loops: made of a clip that nearly repeats, measured, resampled.
//!
//! In a loop of n frames the frame after the last is the first, further on; no frame stands there twice. A loop may
//! travel and turn.

mod laps;

pub use laps::laps;

use crate::channels::PoseChannels;
use crate::ground::continued;
use crate::{Clip, MotionError, VelocityFrame, kinematics, root::RootMotion, time};
use glam::{Quat, Vec3};

/// How a loop is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopOptions {
    /// What differs between the two ends is spread over so many seconds to either side of the seam, at most half of
    /// the loop. 0 leaves the seam as it is. Default: 0.4.
    pub window_seconds: f64,
}

impl Default for LoopOptions {
    fn default() -> Self {
        Self { window_seconds: 0.4 }
    }
}

/// A loop, and what it was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct MadeLoop {
    /// The loop.
    pub clip: Clip,
    /// The frame of the given clip where it begins.
    pub start: usize,
    /// Frames of the given clip that became one round.
    pub period: usize,
    /// Mean distance of the joints between the two ends before they were brought together, metres.
    pub apart: f64,
    /// See [`seam_ratio`], of the result.
    pub seam_ratio: f64,
}

/// A round may be made this much shorter or longer.
const STRETCH: f64 = 1.25;
/// Pairs of frames that are compared, times joints: more are thinned out first.
const MOST_COMPARISONS: usize = 20_000_000;
/// Joints that are compared.
const MOST_JOINTS: usize = 64;

/// Makes a loop of exactly `frames` frames at the clip's own rate from a clip that nearly repeats.
///
/// Of all rounds that are at most a quarter shorter or longer than `frames`, the one is taken whose ends are most
/// alike in pose and movement, rather of the right length; it is brought to the right length, and what still differs
/// is spread over a window around the seam. Travel and turning go on over the seam as they are elsewhere. Any clip
/// that is long enough gives a loop; [`MadeLoop::apart`] tells whether it was one.
///
/// # Errors
/// [`MotionError::LoopLength`] when fewer than 4 frames are asked for, or the clip is too short for the loop.
pub fn make_loop(clip: &Clip, frames: usize, options: &LoopOptions) -> Result<MadeLoop, MotionError> {
    let needed = ((frames as f64 / STRETCH).ceil() as usize).max(4) + 1;
    if frames < 4 || clip.frames() < needed {
        return Err(MotionError::LoopLength { frames, needed, got: clip.frames() });
    }
    let poses = Poses::of(clip);
    let (start, period) = poses.best_round(frames);
    let (layout, rows) = PoseChannels::of(&clip.clone().into(), VelocityFrame::Heading);
    let width = layout.width();
    let stretch = period as f64 / frames as f64;
    let window = (options.window_seconds * clip.frame_rate()).min(0.5 * frames as f64);
    let (first, last) = (rows.row(start), rows.row(start + period));
    let mut out = Vec::with_capacity(frames * width);
    for frame in 0..frames {
        let place = start as f64 + frame as f64 * stretch;
        let low = place.floor() as usize;
        let part = (place - low as f64) as f32;
        let high = (low + 1).min(clip.frames() - 1);
        // Half of what differs is made up for on either side.
        let share = 0.5 * (fading(frame as f64, window) - fading((frames - frame) as f64, window)) as f32;
        for channel in 0..width {
            let (a, b) = (rows.row(low)[channel], rows.row(high)[channel]);
            let value = a + part * (b - a) + share * (last[channel] - first[channel]);
            // Steps over the ground and turning are per frame.
            let rate = [0, 2, 3].contains(&channel);
            out.push(if rate { value * stretch as f32 } else { value });
        }
    }
    let looped = layout.to_clip(&out, clip.frame_rate())?;
    let seam_ratio = seam_ratio(&looped)?;
    let apart = poses.distance(start, start + period);
    Ok(MadeLoop { clip: looped, start, period, apart, seam_ratio })
}

/// How a loop goes over its seam: the mean step of the joints from the last frame to the first, relative to the
/// travelling joint and as the first comes after the last, over the median of the clip's own steps. About 1 for a
/// loop without a seam; 0 for fewer than three frames or a body that does not move.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn seam_ratio(clip: &Clip) -> Result<f64, MotionError> {
    if clip.frames() < 3 {
        return Ok(0.0);
    }
    let positions = kinematics::positions(&continued(clip)?).relative_to(clip.travel_joint());
    let step = |frame: usize| {
        let pairs = positions.frame(frame).iter().zip(positions.frame(frame + 1));
        pairs.map(|(from, to)| f64::from(to.distance(*from))).sum::<f64>()
    };
    let mut steps: Vec<f64> = (0..clip.frames() - 1).map(step).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    Ok(if median > 0.0 { step(clip.frames() - 1) / median } else { 0.0 })
}

/// A loop at another frame rate: as [`time::resample`], but the frames between the last and the first are there too,
/// so that n frames become n times the ratio of the rates, rounded.
///
/// # Errors
/// When `frame_rate` is outside [`Clip::FRAME_RATES`].
pub fn resample_loop(clip: &Clip, frame_rate: f64) -> Result<Clip, MotionError> {
    if !Clip::FRAME_RATES.contains(&frame_rate) {
        return Err(MotionError::FrameRate(frame_rate));
    }
    if clip.frames() < 3 || frame_rate == clip.frame_rate() {
        return time::resample(clip, frame_rate);
    }
    let frames = (clip.frames() as f64 * frame_rate / clip.frame_rate()).round().max(1.0);
    // The round stays whole: its frames are evenly apart however the rates divide.
    let step = clip.frames() as f64 / frames;
    let places: Vec<f64> = (0..frames as usize).map(|frame| frame as f64 * step).collect();
    sample_loop(clip, &places, frame_rate)
}

/// The poses of a loop at given places, in frames: as [`time::sample_at`], but from the last frame on to the first, which
/// has the place `clip.frames()` too.
///
/// # Errors
/// As for [`time::sample_at`].
pub fn sample_loop(clip: &Clip, places: &[f64], frame_rate: f64) -> Result<Clip, MotionError> {
    time::sample_at(&continued(clip)?, places, frame_rate)
}

/// 1 at 0, 0 from `window` on, smooth.
fn fading(distance: f64, window: f64) -> f64 {
    if distance >= window {
        return 0.0;
    }
    let part = distance / window;
    1.0 - part * part * (3.0 - 2.0 * part)
}

/// Poses as the body sees them: joints from where it stands and is headed, metres.
struct Poses {
    joints: usize,
    values: Vec<Vec3>,
}

impl Poses {
    fn of(clip: &Clip) -> Self {
        let positions = kinematics::positions(clip);
        let root = RootMotion::of(&clip.clone().into());
        let step = clip.skeleton().len().div_ceil(MOST_JOINTS);
        let mut values = Vec::new();
        for frame in 0..clip.frames() {
            let places = positions.frame(frame);
            let on_ground = places[root.joint].with_y(0.0);
            let facing = Quat::from_rotation_y(-root.headings[frame]);
            values.extend(places.iter().step_by(step).map(|place| facing * (*place - on_ground)));
        }
        Self { joints: clip.skeleton().len().div_ceil(step), values }
    }

    fn frames(&self) -> usize {
        self.values.len() / self.joints
    }

    /// Mean distance of the joints between two frames.
    fn distance(&self, a: usize, b: usize) -> f64 {
        let pose = |frame: usize| &self.values[frame * self.joints..(frame + 1) * self.joints];
        let sum: f32 = pose(a).iter().zip(pose(b)).map(|(a, b)| a.distance(*b)).sum();
        f64::from(sum) / self.joints as f64
    }

    /// First frame and length of the round whose ends are most alike.
    fn best_round(&self, frames: usize) -> (usize, usize) {
        let last = self.frames() - 1;
        let shortest = ((frames as f64 / STRETCH).ceil() as usize).max(4);
        let longest = ((frames as f64 * STRETCH).floor() as usize).min(last);
        let pairs =
            (longest - shortest + 1).saturating_mul(last - shortest + 1).saturating_mul(3 * self.joints);
        let stride = (pairs as f64 / MOST_COMPARISONS as f64).sqrt().ceil().max(1.0) as usize;
        // Alike a few frames before and after as well: the same pose on the way back is another moment.
        let near = (frames / 20).max(1);
        let cost = |start: usize, period: usize| {
            let end = start + period;
            let back = near.min(start);
            let on = near.min(last - end);
            let stretch = (period as f64 / frames as f64).ln().abs();
            let apart = self.distance(start, end)
                + self.distance(start - back, end - back)
                + self.distance(start + on, end + on);
            apart * (1.0 + stretch)
        };
        let mut best = (f64::INFINITY, 0, shortest);
        let mut look = |starts: std::ops::RangeInclusive<usize>,
                        periods: std::ops::RangeInclusive<usize>,
                        stride: usize| {
            for period in periods.step_by(stride) {
                for start in starts.clone().step_by(stride).take_while(|start| start + period <= last) {
                    let cost = cost(start, period);
                    if cost < best.0 {
                        best = (cost, start, period);
                    }
                }
            }
            best
        };
        let (_, start, period) = look(0..=last - shortest, shortest..=longest, stride);
        let around = |middle: usize, low: usize, high: usize| {
            middle.saturating_sub(stride).max(low)..=(middle + stride).min(high)
        };
        let (_, start, period) = look(around(start, 0, last), around(period, shortest, longest), 1);
        (start, period)
    }
}
