//! The 263 numbers of a frame.

use super::bones::{double, local_rotations};
use super::facing::{Pose, root_rotations};
use super::{JOINTS, Joints, body::check};
use crate::{Features, MotionError};
use glam::{DMat3, DQuat, DVec3};
use std::ops::Range;

/// Numbers a frame.
pub const WIDTH: usize = 263;

/// Squared way of a foot from frame to frame below which it counts as standing, square metres.
const STANDING: f64 = 0.002;

/// What stands where in a row.
#[derive(Debug, Clone, Copy)]
pub struct Blocks;

impl Blocks {
    /// Rate of turning: half the yaw angle to the next frame, radians.
    pub const YAW: usize = 0;
    /// Way of the root to the next frame along x and z in the facing frame, metres.
    pub const TRAVEL: Range<usize> = 1..3;
    /// Height of the root, metres.
    pub const HEIGHT: usize = 3;
    /// Places of joints 1 to 21 in the facing frame above the root's place on the floor, metres.
    pub const PLACES: Range<usize> = 4..67;
    /// Local rotations of joints 1 to 21: first and second column of the matrix.
    pub const ROTATIONS: Range<usize> = 67..193;
    /// Ways of all joints to the next frame in the facing frame, metres.
    pub const VELOCITIES: Range<usize> = 193..259;
    /// Left ankle, left foot, right ankle, right foot: 1 where it stands.
    pub const CONTACTS: Range<usize> = 259..263;
    /// All of them, in order: each has one standard deviation.
    pub const ALL: [Range<usize>; 7] =
        [0..1, Self::TRAVEL, 3..4, Self::PLACES, Self::ROTATIONS, Self::VELOCITIES, Self::CONTACTS];
}

/// The features of a motion that [`ground`](super::ground) has placed: one row less than frames.
///
/// # Errors
/// When there are fewer than two frames, or a position is not finite.
pub fn features(frames: &[Joints]) -> Result<Features, MotionError> {
    check(frames)?;
    let poses: Vec<Pose> = frames.iter().map(double).collect();
    let turns = root_rotations(&poses, true);
    let mut values = Vec::with_capacity(poses.len().saturating_sub(1) * WIDTH);
    for frame in 0..poses.len().saturating_sub(1) {
        let (now, next) = (&poses[frame], &poses[frame + 1]);
        push_frame((now, turns[frame]), (next, turns[frame + 1]), &mut values);
    }
    Features::new(values, WIDTH)
}

fn push_frame((now, turn): (&Pose, DQuat), (next, next_turn): (&Pose, DQuat), out: &mut Vec<f32>) {
    let mut push = |values: &[f64]| out.extend(values.iter().map(|&value| value as f32));
    // Rounding may leave a little more than 1 at a half turn.
    let yaw = (next_turn * turn.conjugate()).y.clamp(-1.0, 1.0).asin();
    let travel = next_turn * (next[0] - now[0]);
    push(&[yaw, travel.x, travel.z, now[0].y]);
    for place in &now[1..] {
        let local = turn * DVec3::new(place.x - now[0].x, place.y, place.z - now[0].z);
        push(&local.to_array());
    }
    for rotation in &local_rotations(now, turn)[1..] {
        let matrix = DMat3::from_quat(*rotation);
        push(&matrix.x_axis.to_array());
        push(&matrix.y_axis.to_array());
    }
    for joint in 0..JOINTS {
        push(&(turn * (next[joint] - now[joint])).to_array());
    }
    for joint in [7, 10, 8, 11] {
        push(&[f64::from(u8::from(next[joint].distance_squared(now[joint]) < STANDING))]);
    }
}
