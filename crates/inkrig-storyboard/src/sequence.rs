//! Clips one after the other: every clip begins where the one before has come to, and a transition leads over that leaves
//! alone what was asked for (section 6 of the paper).

use crate::error::StoryboardError;
use crate::generate::Generated;
use inkrig_generate::blending::{BlendOptions, blend, placed_after};
use inkrig_generate::sampling::Sampler;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::Joints;
use std::ops::Range;

/// Frames of a transition, half of each clip where these are free.
const TRANSITION: usize = 20;
/// A transition of fewer frames would be a jerk: where clips are not free, frames are put between them.
const LEAST: usize = 12;
/// Frames on each side of a transition that the model sees.
const AROUND: usize = 10;

/// Clips as one motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    /// All frames.
    pub motion: Vec<Joints>,
    /// The frame at which each clip begins.
    pub starts: Vec<usize>,
    /// From a clip's own space to that of the motion: a turn about the vertical, then a shift.
    pub placements: Vec<(Quat, Vec3)>,
    /// Between each clip and the next.
    pub transitions: Vec<Transition>,
}

/// How one clip becomes the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Transition {
    /// Frames of the motion that are neither clip's.
    pub frames: Range<usize>,
    /// How many of them were put between the clips.
    pub inserted: usize,
    /// Decodings with their gradient that the model's guidance took.
    pub evaluations: usize,
}

/// What makes transitions natural.
#[derive(Debug, Clone, Copy)]
pub struct Blender<'a> {
    /// The model; one that can go back to noise.
    pub sampler: &'a Sampler<'a>,
    /// A text's vector for every transition.
    pub texts: &'a [Vec<f32>],
    /// How.
    pub options: &'a BlendOptions,
}

/// Joins clips. Without a blender, transitions are smooth curves.
///
/// # Errors
/// When the model cannot make a transition.
pub fn sequence(clips: &[Generated], blender: Option<Blender<'_>>) -> Result<Joined, StoryboardError> {
    let motions: Vec<&[Joints]> = clips.iter().map(|clip| clip.motion.as_slice()).collect();
    sequence_of(clips, &motions, blender)
}

/// The same with other motions than the clips': each lies where its clip would.
pub(crate) fn sequence_of(
    clips: &[Generated],
    motions: &[&[Joints]],
    blender: Option<Blender<'_>>,
) -> Result<Joined, StoryboardError> {
    let mut joined =
        Joined { motion: Vec::new(), starts: Vec::new(), placements: Vec::new(), transitions: Vec::new() };
    for (number, (clip, motion)) in clips.iter().zip(motions).enumerate() {
        let Some(before) = number.checked_sub(1).and_then(|before| clips.get(before)) else {
            joined.motion = motion.to_vec();
            joined.starts.push(0);
            joined.placements.push((Quat::IDENTITY, Vec3::ZERO));
            continue;
        };
        let (tail, head) = (free(before).1.min(TRANSITION / 2), free(clip).0.min(TRANSITION / 2));
        let (tail, head) = (tail.min(before.motion.len() / 3), head.min(clip.motion.len() / 3));
        let inserted = LEAST.saturating_sub(tail + head);
        joined.append(&clip.motion, motion, tail, inserted, head);
        if let Some(Blender { sampler, texts, options }) = blender
            && let (Some(transition), Some(text)) =
                (joined.transitions.last().cloned(), texts.get(number - 1))
        {
            let failed = |cause| StoryboardError::Generate { frame: number + 1, cause: Box::new(cause) };
            let frames = transition.frames;
            let first =
                joined.motion.get(frames.start.saturating_sub(AROUND)..frames.start + frames.len() / 2);
            let end = (frames.end + AROUND).min(joined.motion.len());
            let second = joined.motion.get(frames.start + frames.len() / 2..end);
            if let (Some(first), Some(second)) = (first, second) {
                let options = BlendOptions { transition: frames.len(), ..options.clone() };
                let blended = blend(sampler, text, first, second, &options).map_err(failed)?;
                let from = frames.start.saturating_sub(AROUND);
                joined.put(&frames, &blended.motion, from);
                if let Some(transition) = joined.transitions.last_mut() {
                    transition.evaluations = blended.guided.iter().map(|step| step.evaluations).sum();
                }
            }
        }
    }
    Ok(joined)
}

/// Frames before the first that is asked for, and behind the last.
fn free(clip: &Generated) -> (usize, usize) {
    let asks = [clip.plan.asks(), clip.plan.on_path()].concat();
    let frames = || asks.iter().map(|ask| ask.frame);
    let length = clip.motion.len();
    let head = frames().min().unwrap_or(length);
    let tail = frames().max().map_or(length, |last| length.saturating_sub(last + 1));
    (head, tail)
}

impl Joined {
    /// `like` says where the next motion lies.
    fn append(&mut self, like: &[Joints], next: &[Joints], tail: usize, inserted: usize, head: usize) {
        let (Some(end), Some(begin)) = (self.motion.last().copied(), like.first().copied()) else { return };
        let like = &like[..like.len().min(5)];
        let both = placed_after(&self.motion, &[like, next].concat());
        let (like, placed) = both.split_at(like.len());
        let Some(first) = like.first() else { return };
        // The way goes on at the mean of both speeds until the next clip begins.
        let last = self.motion.len() - 1;
        let flat = |by: Vec3| Vec3::new(by.x, 0.0, by.z);
        let over = |frames: &[Joints]| match (frames.first(), frames.last()) {
            (Some(a), Some(b)) if frames.len() > 1 => flat(b[0] - a[0]) / (frames.len() - 1) as f32,
            _ => Vec3::ZERO,
        };
        let leaving = over(&self.motion[last.saturating_sub(4)..]);
        let arriving = over(like);
        let by = 0.5 * (leaving + arriving) * (inserted + 1) as f32;
        // What was placed says how it was turned: two joints apart over the ground.
        let turn = turned(&begin, first);
        let shift = first[0] + by - turn * begin[0];
        self.placements.push((turn, Vec3::new(shift.x, 0.0, shift.z)));
        self.motion.extend(std::iter::repeat_n(end, inserted));
        let start = self.motion.len();
        self.starts.push(start);
        self.motion.extend(placed.iter().map(|pose| pose.map(|place| place + by)));
        let frames = start - inserted - tail..start + head;
        self.bridge(&frames);
        self.transitions.push(Transition { frames, inserted, evaluations: 0 });
    }

    /// Cubics over some frames, with the speeds around them.
    fn bridge(&mut self, frames: &Range<usize>) {
        let pose = |at: usize| self.motion.get(at).copied();
        let (Some(from), Some(to)) = (frames.start.checked_sub(1).and_then(pose), pose(frames.end)) else {
            return;
        };
        let before = frames.start.checked_sub(2).and_then(pose).unwrap_or(from);
        let after = pose(frames.end + 1).unwrap_or(to);
        let length = (frames.len() + 1) as f32;
        for (number, at) in frames.clone().enumerate() {
            let t = (number + 1) as f32 / length;
            let Some(pose) = self.motion.get_mut(at) else { return };
            *pose = std::array::from_fn(|joint| {
                let speeds = [(from[joint] - before[joint]) * length, (after[joint] - to[joint]) * length];
                hermite([from[joint], to[joint]], speeds, t)
            });
        }
    }

    /// Takes frames from another motion that begins at frame `from`, moved so that it meets what is around them.
    fn put(&mut self, frames: &Range<usize>, other: &[Joints], from: usize) {
        let own = |at: usize| Some((self.motion.get(at)?, other.get(at.checked_sub(from)?)?));
        let (Some((a, b)), Some((c, d))) = (frames.start.checked_sub(1).and_then(own), own(frames.end))
        else {
            return;
        };
        let ends: [Joints; 2] = [
            std::array::from_fn(|joint| a[joint] - b[joint]),
            std::array::from_fn(|joint| c[joint] - d[joint]),
        ];
        let length = (frames.len() + 1) as f32;
        for (number, at) in frames.clone().enumerate() {
            let t = (number + 1) as f32 / length;
            let (Some(pose), Some(new)) = (self.motion.get_mut(at), other.get(at - from)) else { return };
            *pose = std::array::from_fn(|joint| new[joint] + ends[0][joint].lerp(ends[1][joint], t));
        }
    }
}

/// The turn about the vertical from one pose to the same pose placed elsewhere.
fn turned(pose: &Joints, placed: &Joints) -> Quat {
    let (mut sin, mut cos) = (0.0, 0.0);
    for (a, b) in pose.iter().zip(placed) {
        let (a, b) = (*a - pose[0], *b - placed[0]);
        cos += a.x * b.x + a.z * b.z;
        sin += a.z * b.x - a.x * b.z;
    }
    Quat::from_rotation_y(sin.atan2(cos))
}

fn hermite([from, to]: [Vec3; 2], [leaving, arriving]: [Vec3; 2], t: f32) -> Vec3 {
    let (t2, t3) = (t * t, t * t * t);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + leaving * (t3 - 2.0 * t2 + t)
        + to * (3.0 * t2 - 2.0 * t3)
        + arriving * (t3 - t2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use inkrig_motion::glam::Vec2;
    use inkrig_motion::humanml::{Camera, JOINTS};

    /// A figure that goes along +z, with a sideways line of joints.
    fn clip(frames: usize, speed: f32, asked: &[usize]) -> Generated {
        let pose: Joints = std::array::from_fn(|joint| {
            let side = if [1, 16].contains(&joint) {
                0.2
            } else if [2, 17].contains(&joint) {
                -0.2
            } else {
                0.0
            };
            Vec3::new(side, 0.1 * joint as f32, 0.0)
        });
        let motion = (0..frames).map(|at| pose.map(|p| p + Vec3::Z * speed * at as f32)).collect();
        let ways = asked.iter().map(|at| (20, *at, vec![Vec2::ZERO])).collect();
        let camera = Camera::default();
        let plan = Plan { ways, ..Plan::of_word(String::new(), frames, camera) };
        Generated { contacts: Vec::new(), motion, plan, error: 0.0, worst: 0.0, candidate: 0, evaluations: 0 }
    }

    #[test]
    fn transitions_leave_alone_what_was_asked_for() {
        let clips = [clip(40, 0.05, &[0, 39]), clip(40, 0.05, &[0, 35]), clip(40, 0.05, &[30])];
        let joined = sequence(&clips, None).unwrap();
        assert_eq!(joined.transitions[0], Transition { frames: 40..52, inserted: 12, evaluations: 0 });
        assert_eq!(joined.starts, [0, 52, 92]);
        assert_eq!(joined.transitions[1], Transition { frames: 88..102, inserted: 0, evaluations: 0 });
        assert_eq!(joined.motion.len(), 132);
        // All go straight on at one speed, and so does the whole.
        for (at, pair) in joined.motion.windows(2).enumerate() {
            let step = pair[1][JOINTS - 1] - pair[0][JOINTS - 1];
            assert!(step.distance(Vec3::Z * 0.05) < 1e-4, "{at}: {step}");
        }
    }

    #[test]
    fn placements_bring_clips_to_where_they_are() {
        let mut turning = clip(40, 0.05, &[0, 39]);
        let turn = Quat::from_rotation_y(1.0);
        turning.motion.iter_mut().for_each(|pose| *pose = pose.map(|place| turn * place));
        let joined = sequence(&[turning, clip(40, 0.02, &[0, 39])], None).unwrap();
        let (turn, shift) = joined.placements[1];
        let placed = clip(40, 0.02, &[]).motion[20].map(|place| turn * place + shift);
        let own = joined.motion[joined.starts[1] + 20];
        assert!(placed.iter().zip(&own).all(|(a, b)| a.distance(*b) < 1e-4), "{placed:?} {own:?}");
    }
}
