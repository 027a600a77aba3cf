//! A loop of a second or two, played several times over.

use super::Poses;
use crate::ground::rounds;
use crate::{Clip, MotionError};

/// From its last pose to its first a loop goes no further than so many of its ordinary steps.
const OPEN: f64 = 2.5;
/// A last pose nearer to the first than this part of the steps before and after is the first again, as files of game
/// characters have it.
const CLOSED: f64 = 0.5;
/// Of the character's size: what stands as still as this is alike.
const STILL: f64 = 1e-4;

/// A clip that is a loop, `times` times over: travel and turning go on from round to round. A last frame that is the
/// first again is left out. `None` when the clip's ends do not meet, or it is shorter than four frames.
///
/// # Errors
/// When the result is longer than a clip can be.
pub fn laps(clip: &Clip, times: usize) -> Result<Option<Clip>, MotionError> {
    if clip.frames() < 4 {
        return Ok(None);
    }
    let poses = Poses::of(clip);
    let last = clip.frames() - 1;
    let mut steps: Vec<f64> = (0..last).map(|frame| poses.distance(frame, frame + 1)).collect();
    let around = 0.5 * (steps[0] + steps[last - 1]);
    let step = *steps.select_nth_unstable_by(last / 2, f64::total_cmp).1;
    let still = STILL * f64::from(clip.skeleton().extent());
    let apart = poses.distance(last, 0);
    if apart > (OPEN * step).max(still) {
        return Ok(None);
    }
    rounds(clip, times.max(1), apart <= (CLOSED * around).max(still)).map(Some)
}
