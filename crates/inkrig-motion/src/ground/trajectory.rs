//! Travel without sway: the way of a character over the ground, smoothed.

use super::continuation::Continuation;
use super::low_pass::{REACH, low_pass, low_pass_numbers};
use super::placement::Placement;
use super::{size_of, turned};
use crate::{Clip, rotation::twist_angle};
use glam::{DVec2, Vec3};

/// Above this many seconds smoothing means nothing any more.
const MOST_SECONDS: f64 = 60.0;
/// A ground this near to height 0 is taken to be there, in sizes of the character.
const SNAP: f64 = 0.05;

/// How travel is told from sway.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelOptions {
    /// Movements over the ground that are quicker than about four times this many seconds are sway and stay with the
    /// body; slower ones are travel. 0 takes every movement of the travelling joint as travel. 0 to 60, 0.5 by
    /// default: a person's sway from step to step is gone, a turn round a corner is not.
    pub smoothing_seconds: f64,
    /// The clip is a loop: after its last frame comes its first, further on.
    pub cyclic: bool,
}

impl Default for TravelOptions {
    fn default() -> Self {
        Self { smoothing_seconds: 0.5, cyclic: false }
    }
}

/// The way of a character over the ground, one value a frame. Built once by [`Trajectory::of`].
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The joint that travels: see [`Clip::travel_joint`].
    pub joint: usize,
    /// Where that joint is over the ground (x and z), metres.
    pub places: Vec<DVec2>,
    /// The same without sway, metres.
    pub path: Vec<DVec2>,
    /// Where the character is headed, without sway, radians: 0 as in the rest pose, a turn to the left is positive,
    /// and it runs on beyond a full turn.
    pub headings: Vec<f64>,
    /// Height of the ground, metres: that of the lowest joint, except for the lowest twentieth of the frames. 0 when
    /// that is nearer to 0 than a twentieth of the character's size.
    pub ground: f64,
}

impl Trajectory {
    /// Reads the way of a clip.
    pub fn of(clip: &Clip, options: &TravelOptions) -> Self {
        let joint = clip.travel_joint();
        let places: Vec<Placement> =
            (0..clip.frames()).map(|frame| Placement::world(clip, joint, frame)).collect();
        let over_ground: Vec<DVec2> =
            places.iter().map(|place| DVec2::new(place.position.x, place.position.z)).collect();
        let headings = headings(&places);
        let seconds = options.smoothing_seconds.clamp(0.0, MOST_SECONDS);
        let half = (seconds * clip.frame_rate()).round() as usize;
        let (path, smooth) = if options.cyclic && clip.frames() > 2 {
            smooth_loop(&over_ground, &headings, half)
        } else {
            (low_pass(&over_ground, half), low_pass_numbers(&headings, half))
        };
        Self { joint, places: over_ground, path, headings: smooth, ground: ground(clip) }
    }

    /// Length of [`Self::path`], metres.
    pub fn length(&self) -> f64 {
        self.path.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }
}

/// Headings since the rest pose where the character begins upright, else since the first frame.
fn headings(places: &[Placement]) -> Vec<f64> {
    let Some(first) = places.first() else { return Vec::new() };
    let upright = (first.rotation * glam::DVec3::Y).y > 0.5;
    let twist = |rotation: glam::DQuat| f64::from(twist_angle(rotation.as_quat(), Vec3::Y));
    let mut heading = if upright { twist(first.rotation) } else { 0.0 };
    let begin = heading;
    let from_first = first.rotation.inverse();
    (places.iter())
        .map(|place| {
            heading += super::wrapped(begin + twist(place.rotation * from_first) - heading);
            heading
        })
        .collect()
}

/// [`low_pass`] of a loop: each round goes on where and as the one before ended.
fn smooth_loop(places: &[DVec2], headings: &[f64], half: usize) -> (Vec<DVec2>, Vec<f64>) {
    let frames = places.len();
    let reach = (REACH * half).min(16 * frames);
    let Continuation { turn, next } = Continuation::of(places, headings);
    let on = |point: DVec2| next + turned(point - places[0], turn);
    let back = |point: DVec2| places[0] + turned(point - next, -turn);
    let mut all = places.to_vec();
    let mut turns = headings.to_vec();
    for index in 0..reach {
        all.push(on(all[index]));
        turns.push(turns[index] + turn);
    }
    all.reverse();
    turns.reverse();
    let total = all.len();
    for index in 0..reach {
        // The frame a round later stands `frames` places before the end.
        all.push(back(all[total + index - frames]));
        turns.push(turns[total + index - frames] - turn);
    }
    all.reverse();
    turns.reverse();
    let cut = reach..reach + frames;
    (low_pass(&all, half)[cut.clone()].to_vec(), low_pass_numbers(&turns, half)[cut].to_vec())
}

/// Height of the ground.
fn ground(clip: &Clip) -> f64 {
    let positions = crate::kinematics::positions(clip);
    let lowest = |frame: usize| positions.frame(frame).iter().map(|place| place.y).fold(f32::MAX, f32::min);
    let mut lows: Vec<f32> = (0..clip.frames()).map(lowest).collect();
    let rank = (lows.len() - 1) / 20;
    let low = f64::from(*lows.select_nth_unstable_by(rank, f32::total_cmp).1);
    if low.abs() < SNAP * size_of(clip.skeleton()) { 0.0 } else { low }
}
