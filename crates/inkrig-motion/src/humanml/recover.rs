//! From 263 numbers a frame back to positions.

use super::bones::{assemble, double, single};
use super::facing::Pose;
use super::features::{Blocks, WIDTH};
use super::{JOINTS, Joints, Offsets};
use crate::{Features, MotionError};
use glam::{DMat3, DQuat, DVec3, Vec3};

/// Where the root is and how it is turned, one of each a row.
#[derive(Debug, Clone, PartialEq)]
pub struct RootPath {
    /// World axes, metres.
    pub places: Vec<Vec3>,
    /// From the world's axes to the facing frame.
    pub turns: Vec<glam::Quat>,
}

/// The path of the root: rates of turning and travel added up. It begins above the origin, facing +z.
///
/// # Errors
/// When the table is not [`WIDTH`] wide.
pub fn root_path(features: &Features) -> Result<RootPath, MotionError> {
    let path = path(features)?;
    let (places, turns) = path.into_iter().map(|(place, turn)| (place.as_vec3(), turn.as_quat())).unzip();
    Ok(RootPath { places, turns })
}

/// Positions by the joints' places: what the form is mostly read by.
///
/// # Errors
/// When the table is not [`WIDTH`] wide.
pub fn recover_positions(features: &Features) -> Result<Vec<Joints>, MotionError> {
    let frames = path(features)?.into_iter().enumerate().map(|(frame, (root, turn))| {
        let row = &features.row(frame)[Blocks::PLACES];
        let mut pose: Pose = [root; JOINTS];
        for (place, local) in pose[1..].iter_mut().zip(row.chunks_exact(3)) {
            let local = DVec3::new(local[0].into(), local[1].into(), local[2].into());
            *place = turn.conjugate() * local + DVec3::new(root.x, 0.0, root.z);
        }
        single(&pose)
    });
    Ok(frames.collect())
}

/// Positions by the joints' rotations, on a body: bone lengths are exact.
///
/// # Errors
/// When the table is not [`WIDTH`] wide.
pub fn recover_bones(features: &Features, body: &Offsets) -> Result<Vec<Joints>, MotionError> {
    let body = double(body);
    let frames = path(features)?.into_iter().enumerate().map(|(frame, (root, turn))| {
        let row = &features.row(frame)[Blocks::ROTATIONS];
        let mut local = [turn; JOINTS];
        for (rotation, six) in local[1..].iter_mut().zip(row.chunks_exact(6)) {
            *rotation = gram_schmidt(six);
        }
        single(&assemble(&local, &body, root))
    });
    Ok(frames.collect())
}

fn path(features: &Features) -> Result<Vec<(DVec3, DQuat)>, MotionError> {
    if features.width() != WIDTH {
        let what = "the numbers of a frame";
        return Err(MotionError::Length { what, expected: WIDTH, got: features.width() });
    }
    let (mut angle, mut place) = (0.0_f64, DVec3::ZERO);
    let mut path = Vec::with_capacity(features.frames());
    for frame in 0..features.frames() {
        let row = features.row(frame);
        if frame > 0 {
            let before = features.row(frame - 1);
            angle += f64::from(before[Blocks::YAW]);
            let turn = about_y(angle);
            place += turn.conjugate() * DVec3::new(before[1].into(), 0.0, before[2].into());
        }
        place.y = row[Blocks::HEIGHT].into();
        path.push((place, about_y(angle)));
    }
    Ok(path)
}

/// The quaternion (cos a, 0, sin a, 0): the feature is half the angle already.
fn about_y(half_angle: f64) -> DQuat {
    let (sin, cos) = half_angle.sin_cos();
    DQuat::from_xyzw(0.0, sin, 0.0, cos)
}

/// The first column is kept in direction, the second made perpendicular to it: as the form's authors do it.
fn gram_schmidt(six: &[f32]) -> DQuat {
    let column = |at: usize| DVec3::new(six[at].into(), six[at + 1].into(), six[at + 2].into());
    let x = column(0).normalize_or(DVec3::X);
    let z = x.cross(column(3)).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
    DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize()
}
