//! Pieces put where they go.

use super::base::append;
use crate::error::StoryboardError;
use inkrig_motion::glam::{DVec2, Vec3};
use inkrig_motion::ground::{GroundMove, Trajectory, TravelOptions, move_over_ground, shift};
use inkrig_motion::rig::Quadruped;
use inkrig_motion::{Clip, kinematics};
use std::f64::consts::TAU;

/// Directions are smoothed by a Gaussian of so many seconds.
const SMOOTH: f64 = 0.2;
/// Below this speed, in sizes a second, a way has no direction.
const SLOW: f64 = 0.1;

/// Poses on the spot, and where they go.
pub(super) struct Piece {
    /// Without travel.
    pub(super) clip: Clip,
    /// The clip's own way over the ground, a place a frame, metres.
    pub(super) path: Vec<DVec2>,
    /// Where the body's front is beside its heading, radians.
    pub(super) front: f64,
    /// The drawn way from the origin, a place a frame, metres.
    pub(super) way: Option<Vec<Vec3>>,
}

/// Where a body's front is beside its heading: where it goes, else where its trunk points, else its head.
pub(super) fn front(clip: &Clip) -> f64 {
    let trajectory = Trajectory::of(clip, &TravelOptions::default());
    let size = f64::from(clip.skeleton().extent()).max(1e-3);
    let headings = &trajectory.headings;
    let ahead: DVec2 = trajectory
        .path
        .windows(2)
        .zip(headings)
        .map(|(pair, heading)| {
            DVec2::from_angle(heading - angle(pair[1] - pair[0])) * pair[0].distance(pair[1])
        })
        .sum();
    if ahead.length() > 0.5 * size {
        return -ahead.to_angle();
    }
    let joints = clip.skeleton().joints();
    let pose = kinematics::positions(clip);
    let Some(first) = (clip.frames() > 0).then(|| pose.frame(0)) else { return 0.0 };
    let flat = |joint: usize| {
        first.get(joint).map_or(DVec2::ZERO, |at| DVec2::new(f64::from(at.x), f64::from(at.z)))
    };
    let trunk = Quadruped::find(clip.skeleton()).ok().and_then(|body| {
        let root = |leg: &inkrig_motion::rig::QuadrupedLeg| leg.joints.first().map(|joint| flat(*joint));
        let fore = body.fore.iter().filter_map(root).sum::<DVec2>();
        Some(fore - body.hind.iter().filter_map(root).sum::<DVec2>()).filter(|trunk| trunk.length() > 1e-6)
    });
    let head = || {
        let head = joints.iter().position(|joint| joint.name.to_lowercase().contains("head"))?;
        Some(flat(head) - flat(trajectory.joint)).filter(|ahead| ahead.length() > 0.05 * size)
    };
    let ahead = trunk.or_else(head).unwrap_or(DVec2::new(0.0, 1.0));
    angle(ahead) - headings.first().copied().unwrap_or(0.0)
}

/// All pieces one behind the other, each on its way from where the one before has come to; and where each begins. `None` of none.
pub(super) fn placed(pieces: &[&Piece]) -> Result<Option<(Clip, Vec<usize>)>, StoryboardError> {
    let Some((first, rest)) = pieces.split_first() else { return Ok(None) };
    let mut base = first.clip.clone();
    let mut starts = vec![0];
    for piece in rest {
        starts.push(base.frames());
        base = append(&base, &piece.clip)?;
    }
    let own = Trajectory::of(&base, &TravelOptions::default());
    let rate = base.frame_rate();
    let size = f64::from(base.skeleton().extent()).max(1e-3);
    let slow = SLOW * size / rate;
    let (mut at, mut height) = (own.path.first().copied().unwrap_or_default(), 0.0_f32);
    let (mut places, mut heights, mut turns): (Vec<DVec2>, Vec<f32>, Vec<Option<f64>>) = Default::default();
    let mut turn = 0.0;
    for (piece, start) in pieces.iter().zip(&starts) {
        let heading = |frame: usize| own.headings.get(start + frame).copied().unwrap_or(0.0);
        if let Some(way) = &piece.way {
            let flat: Vec<DVec2> =
                way.iter().map(|place| DVec2::new(f64::from(place.x), f64::from(place.z))).collect();
            let around = (rate * SMOOTH).round().max(1.0) as usize;
            for frame in 0..piece.clip.frames() {
                let (before, after) = (frame.saturating_sub(around), (frame + around).min(flat.len() - 1));
                let ahead = flat[after] - flat[before];
                let goes = ahead.length() > slow * (after - before).max(1) as f64;
                turns.push(goes.then(|| angle(ahead) - heading(frame) - piece.front));
                places.push(at + flat[frame]);
                heights.push(height + way[frame].y);
            }
            at += flat.last().copied().unwrap_or_default();
            height += way.last().map_or(0.0, |place| place.y);
        } else {
            // Its own way, turned as the body is.
            let mut here = at;
            let begun = Trajectory::of(&piece.clip, &TravelOptions::default()).headings.first().copied();
            let seam = heading(0) - begun.unwrap_or(0.0);
            turn = turns.iter().rev().flatten().next().copied().unwrap_or(turn);
            for frame in 0..piece.clip.frames() {
                let before = piece.path[frame.saturating_sub(1)];
                here += turned(piece.path[frame] - before, turn + seam);
                turns.push(Some(turn));
                places.push(here);
                heights.push(height);
            }
            at = here;
        }
    }
    let turns = smoothed(&filled(&turns), SMOOTH * rate);
    let moves: Vec<GroundMove> = own
        .path
        .iter()
        .zip(&places)
        .zip(turns)
        .map(|((from, to), turn)| GroundMove { turn, from: *from, to: *to })
        .collect();
    let moved = move_over_ground(&base, own.joint, &moves)?;
    let up: Vec<Vec3> = heights.iter().map(|height| Vec3::Y * *height).collect();
    Ok(Some((shift(&moved, own.joint, &up)?, starts)))
}

/// Nearest known values where nothing is known, whole turns taken out between neighbours.
fn filled(turns: &[Option<f64>]) -> Vec<f64> {
    let mut last = turns.iter().flatten().next().copied().unwrap_or(0.0);
    turns
        .iter()
        .map(|turn| {
            if let Some(turn) = turn {
                last += (turn - last) - TAU * ((turn - last) / TAU).round();
            }
            last
        })
        .collect()
}

fn smoothed(values: &[f64], frames: f64) -> Vec<f64> {
    let reach = (3.0 * frames).ceil() as usize;
    (0..values.len())
        .map(|at| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (other, value) in
                values.iter().enumerate().take(at + reach + 1).skip(at.saturating_sub(reach))
            {
                let away = at.abs_diff(other) as f64 / frames.max(1e-6);
                let weight = (-0.5 * away * away).exp();
                (sum, weights) = (sum + weight * value, weights + weight);
            }
            sum / weights
        })
        .collect()
}

fn angle(ahead: DVec2) -> f64 {
    ahead.x.atan2(ahead.y)
}

fn turned(vector: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = angle.sin_cos();
    DVec2::new(vector.x * cos + vector.y * sin, vector.y * cos - vector.x * sin)
}
