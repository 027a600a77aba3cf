//! Clips as pieces: repeated, played at a pace, and put one behind the other.

use crate::error::StoryboardError;
use inkrig_motion::glam::{DVec2, Quat, Vec3};
use inkrig_motion::ground::{GroundMove, Trajectory, TravelOptions, move_over_ground};
use inkrig_motion::{Clip, TranslationTrack, cycle, kinematics, rig, time};

/// What differs at a seam is gone after so many seconds.
const FADE: f64 = 0.4;
/// A joint is on the ground below so many sizes above it.
const LOW: f32 = 0.05;
/// Speeds that bodies go with, sizes a second.
const SPEEDS: [f64; 2] = [0.2, 4.0];
/// The speed of a body of which nothing is known, sizes a second.
const USUAL: f64 = 0.8;

/// At least so many frames of a clip, played again and again where it is shorter.
pub(super) fn at_least(clip: &Clip, frames: usize) -> Result<Clip, StoryboardError> {
    if clip.frames() >= frames {
        return Ok(clip.clone());
    }
    let times = frames.div_ceil(clip.frames().saturating_sub(1).max(1)) + 1;
    if let Some(repeated) = cycle::laps(clip, times)? {
        return Ok(repeated);
    }
    let mut whole = clip.clone();
    while whole.frames() < frames {
        whole = append(&whole, clip)?;
    }
    Ok(whole)
}

/// The second clip from where the first has come to, with its heading; what differs in their poses fades away over the second's
/// first moments. Both have one skeleton and frame rate.
pub(super) fn append(first: &Clip, second: &Clip) -> Result<Clip, StoryboardError> {
    let raw = TravelOptions { smoothing_seconds: 0.0, cyclic: false };
    let (a, b) = (Trajectory::of(first, &raw), Trajectory::of(second, &raw));
    let last = first.frames() - 1;
    let step = if last > 0 { a.places[last] - a.places[last - 1] } else { DVec2::ZERO };
    let moved =
        GroundMove { turn: a.headings[last] - b.headings[0], from: b.places[0], to: a.places[last] + step };
    let second = move_over_ground(second, b.joint, &vec![moved; second.frames()])?;
    let joints = first.skeleton().len();
    let fade = (FADE * first.frame_rate()).max(1.0);
    // From all of it to none, without a jump in speed at either end.
    let share = |frame: usize| {
        let t = (frame as f64 / fade).min(1.0);
        (1.0 - t * t * (3.0 - 2.0 * t)) as f32
    };
    let mut rotations: Vec<Quat> =
        (0..first.frames()).flat_map(|frame| first.rotations(frame).iter().copied()).collect();
    let off: Vec<Quat> =
        first.rotations(last).iter().zip(second.rotations(0)).map(|(a, b)| near(*a * b.inverse())).collect();
    for frame in 0..second.frames() {
        let own = second.rotations(frame).iter().zip(&off);
        rotations.extend(own.map(|(own, off)| (Quat::IDENTITY.slerp(*off, share(frame)) * *own).normalize()));
    }
    let mut tracks = Vec::new();
    for joint in 0..joints {
        if first.track(joint).is_none() && second.track(joint).is_none() {
            continue;
        }
        let rest = first.skeleton().joints().get(joint).map_or(Vec3::ZERO, |joint| joint.offset);
        let value = |clip: &Clip, frame: usize| {
            clip.track(joint).and_then(|values| values.get(frame).copied()).unwrap_or(rest)
        };
        let mut values: Vec<Vec3> = (0..first.frames()).map(|frame| value(first, frame)).collect();
        let mut off = value(first, last) - value(&second, 0);
        if joint == a.joint {
            // Where it goes over the ground it goes on; only its height differs.
            off = up_only(first, joint, last, off);
        }
        values.extend((0..second.frames()).map(|frame| value(&second, frame) + off * share(frame)));
        tracks.push(TranslationTrack { joint, values });
    }
    Ok(Clip::new(first.skeleton().clone(), first.frame_rate(), rotations, tracks)?)
}

/// The part of a shift in the parent's space that is up or down in the world.
fn up_only(clip: &Clip, joint: usize, frame: usize, off: Vec3) -> Vec3 {
    let mut turn = Quat::IDENTITY;
    let mut above = clip.skeleton().joints()[joint].parent;
    while let Some(parent) = above {
        turn = clip.rotations(frame)[parent] * turn;
        above = clip.skeleton().joints()[parent].parent;
    }
    turn.inverse() * (Vec3::Y * (turn * off).y)
}

/// The shorter of both ways round.
fn near(turn: Quat) -> Quat {
    if turn.w < 0.0 { -turn } else { turn }
}

/// Frames at these times, seconds; times beyond the end are the end.
pub(super) fn at_times(clip: &Clip, times: &[f64]) -> Result<Clip, StoryboardError> {
    let last = (clip.frames() - 1) as f64;
    let places: Vec<f64> = times.iter().map(|time| (time * clip.frame_rate()).clamp(0.0, last)).collect();
    Ok(time::sample_at(clip, &places, clip.frame_rate())?)
}

/// How fast a clip goes, metres a second: by its way, or where it stays, by how fast what touches the ground is drawn over it.
pub(super) fn speed(clip: &Clip) -> f64 {
    let size = f64::from(clip.skeleton().extent()).max(1e-3);
    let trajectory = Trajectory::of(clip, &TravelOptions::default());
    let own = trajectory.length() / clip.duration().max(1e-3);
    if own > 0.1 * size {
        return own;
    }
    let joints = clip.skeleton().joints();
    let handles = rig::controls(clip.skeleton());
    let places = kinematics::positions(clip);
    let is_end = |joint: usize| !handles[joint] && joints.iter().all(|other| other.parent != Some(joint));
    let ends: Vec<usize> = (0..joints.len()).filter(|joint| is_end(*joint)).collect();
    let low = trajectory.ground as f32 + LOW * size as f32;
    let mut speeds = Vec::new();
    for frame in 1..clip.frames() {
        let step = |joint: &usize| {
            let (a, b) = (places.frame(frame - 1)[*joint], places.frame(frame)[*joint]);
            (a.y < low && b.y < low).then(|| f64::from((b - a).with_y(0.0).length()))
        };
        // Of what is low, what rests is no foot that carries.
        if let Some(most) = ends.iter().filter_map(step).max_by(f64::total_cmp) {
            speeds.push(most * clip.frame_rate());
        }
    }
    speeds.sort_by(f64::total_cmp);
    let median = speeds.get(speeds.len() / 2).copied().unwrap_or(0.0);
    if median < 0.05 * size { USUAL * size } else { median.clamp(SPEEDS[0] * size, SPEEDS[1] * size) }
}
