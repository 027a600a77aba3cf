//! How a loop goes on after its last frame.

use super::placement::{GroundMove, move_over_ground};
use super::{Trajectory, TravelOptions, turned};
use crate::{Clip, MotionError, time};
use glam::DVec2;

/// Where the first pose comes to be when it follows the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Continuation {
    /// The turn of a whole round to the left, radians.
    pub(super) turn: f64,
    /// Its place on the ground, metres.
    pub(super) next: DVec2,
}

impl Continuation {
    /// Goes on as the loop does at its ends: turning at the mean rate of the steps before and after the seam, and with
    /// their mean step as the body sees it. At least two frames.
    pub(super) fn of(places: &[DVec2], headings: &[f64]) -> Self {
        let last = places.len() - 1;
        let rate = 0.5 * (headings[last] - headings[last - 1] + headings[1] - headings[0]);
        let turn = headings[last] + rate - headings[0];
        let (before, after) = (places[last] - places[last - 1], places[1] - places[0]);
        let step = 0.5 * (turned(before, rate) + turned(after, turn - rate));
        Self { turn, next: places[last] + step }
    }
}

/// A loop with one frame more: its first pose as it comes after the last. At least two frames.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn continued(clip: &Clip) -> Result<Clip, MotionError> {
    let raw = TravelOptions { smoothing_seconds: 0.0, cyclic: false };
    let Trajectory { joint, places, headings, .. } = Trajectory::of(clip, &raw);
    let Continuation { turn, next } = Continuation::of(&places, &headings);
    let frames: Vec<f64> = (0..clip.frames()).chain([0]).map(|frame| frame as f64).collect();
    let longer = time::sample_at(clip, &frames, clip.frame_rate())?;
    let mut moves = vec![GroundMove { turn: 0.0, from: DVec2::ZERO, to: DVec2::ZERO }; clip.frames()];
    moves.push(GroundMove { turn, from: places[0], to: next });
    move_over_ground(&longer, joint, &moves)
}

/// A loop several times over, each round where the one before it ends. `closed` says that the last frame is the first one
/// again, where the next round begins; it is left out between rounds. At least two frames.
pub(crate) fn rounds(clip: &Clip, times: usize, closed: bool) -> Result<Clip, MotionError> {
    let raw = TravelOptions { smoothing_seconds: 0.0, cyclic: false };
    let Trajectory { joint, places, headings, .. } = Trajectory::of(clip, &raw);
    let frames = clip.frames() - usize::from(closed);
    let round = if closed {
        Continuation { turn: headings[frames] - headings[0], next: places[frames] }
    } else {
        Continuation::of(&places, &headings)
    };
    let mut moves = Vec::with_capacity(frames * times);
    let mut to = places[0];
    for number in 0..times {
        let turn = number as f64 * round.turn;
        moves.resize(moves.len() + frames, GroundMove { turn, from: places[0], to });
        to = round.next + turned(to - places[0], round.turn);
    }
    let order: Vec<f64> = (0..frames * times).map(|frame| (frame % frames) as f64).collect();
    move_over_ground(&time::sample_at(clip, &order, clip.frame_rate())?, joint, &moves)
}
