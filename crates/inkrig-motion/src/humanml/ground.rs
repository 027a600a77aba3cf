//! Where a motion begins: on the floor, at the origin, facing +z.

use super::Joints;
use super::bones::{double, single};
use super::facing::{Across, Pose, forward};
use crate::orientation::between;
use glam::DVec3;

/// The same motion with its lowest point of all on the floor (y = 0), the pelvis of its first frame above the origin,
/// and its first frame facing +z. Empty for no frames.
pub fn ground(frames: &[Joints]) -> Vec<Joints> {
    let poses: Vec<Pose> = frames.iter().map(double).collect();
    let Some(first) = poses.first() else { return Vec::new() };
    let floor = poses.iter().flatten().map(|place| place.y).fold(f64::INFINITY, f64::min);
    let origin = DVec3::new(first[0].x, floor, first[0].z);
    let turn = between(forward(first, Across::Plain), DVec3::Z);
    poses.iter().map(|pose| single(&pose.map(|place| turn * (place - origin)))).collect()
}
