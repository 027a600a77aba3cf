//! The curves that few keys are measured by: one key a frame.

use super::fit::{Numbers, Piece, SAMPLES};
use crate::Clip;
use glam::Quat;

/// What a joint does, [`SAMPLES`] a frame.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) joint: usize,
    /// A rotation; else a translation.
    pub(super) turns: bool,
    /// Nothing of it changes.
    pub(super) still: bool,
    /// Rotations of unit length, signs running on.
    pub(super) samples: Vec<Numbers>,
}

/// Rotations of all joints, and translations where a clip has them; parents first, a translation before its rotation.
pub(super) fn references(clip: &Clip) -> Vec<Reference> {
    let frames = 0..clip.frames();
    let turns = (0..clip.skeleton().len()).map(|joint| {
        let mut before = Quat::IDENTITY;
        let values = frames.clone().map(|frame| {
            let now = clip.rotations(frame)[joint];
            before = if before.dot(now) < 0.0 { -now } else { now };
            before.as_dquat().normalize().to_array()
        });
        Reference::of(joint, true, &values.collect::<Vec<_>>())
    });
    let moves = clip.translations().iter().map(|track| {
        let value = |v: &glam::Vec3| [f64::from(v.x), f64::from(v.y), f64::from(v.z), 0.0];
        Reference::of(track.joint, false, &track.values.iter().map(value).collect::<Vec<_>>())
    });
    let mut all: Vec<Reference> = moves.chain(turns).collect();
    // What a joint hangs on comes before it.
    all.sort_by_key(|reference| reference.joint);
    all
}

impl Reference {
    fn of(joint: usize, turns: bool, values: &[Numbers]) -> Self {
        let first = values.first().copied().unwrap_or_default();
        let still = values.iter().all(|value| distance(value, &first) < STILL);
        let mut samples = Vec::with_capacity(values.len() * SAMPLES);
        for (frame, pair) in values.windows(2).enumerate() {
            let &[from, to] = pair else { continue };
            let slopes = [slope(values, frame), slope(values, frame + 1)];
            let curve = Piece { length: 1, from, to, slopes };
            samples
                .extend(curve.samples().take(SAMPLES).map(|value| if turns { unit(value) } else { value }));
        }
        samples.extend(values.last());
        Self { joint, turns, still, samples }
    }
}

/// What rounding does: a channel that changes by less never changes.
const STILL: f64 = 1e-6;

/// The mean of the steps before and after (Catmull-Rom), no more than three times the smaller, so that nothing swings
/// beyond its neighbours where a motion stops or jumps (the condition of Fritsch and Carlson 1980, by length).
pub(super) fn slope(values: &[Numbers], frame: usize) -> Numbers {
    let step = |from: usize| -> Option<Numbers> {
        let (a, b) = (values.get(from)?, values.get(from + 1)?);
        Some(std::array::from_fn(|i| b[i] - a[i]))
    };
    match (frame.checked_sub(1).and_then(step), step(frame)) {
        (Some(before), Some(after)) => {
            let mean: Numbers = std::array::from_fn(|i| 0.5 * (before[i] + after[i]));
            let most = 3.0 * length(&before).min(length(&after));
            let factor = (most / length(&mean).max(1e-300)).min(1.0);
            mean.map(|value| value * factor)
        }
        (one, other) => one.or(other).unwrap_or_default(),
    }
}

pub(super) fn unit(value: Numbers) -> Numbers {
    let length = length(&value);
    if length > 1e-12 { value.map(|number| number / length) } else { [0.0, 0.0, 0.0, 1.0] }
}

pub(super) fn distance(a: &Numbers, b: &Numbers) -> f64 {
    length(&std::array::from_fn(|i| a[i] - b[i]))
}

pub(super) fn length(value: &Numbers) -> f64 {
    value.iter().map(|number| number * number).sum::<f64>().sqrt()
}
