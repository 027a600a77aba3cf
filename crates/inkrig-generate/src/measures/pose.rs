//! How far a pose is from the one that was asked for.

use inkrig_motion::humanml::{Camera, JOINTS, Joints};

/// MPJPE: mean distance of the joints from where they should be, both relative to the pelvis, metres.
pub fn pose_error(pose: &Joints, asked: &Joints) -> f64 {
    let distance = |joint: usize| {
        let own = (pose[joint] - pose[0]).as_dvec3();
        own.distance((asked[joint] - asked[0]).as_dvec3())
    };
    (0..JOINTS).map(distance).sum::<f64>() / JOINTS as f64
}

/// The same as a camera sees them, metres on the picture.
pub fn pose_error_2d(pose: &Joints, asked: &Joints, camera: &Camera) -> f64 {
    let flat = |joints: &Joints| joints.map(|joint| camera.project(joint).extend(0.0));
    pose_error(&flat(pose), &flat(asked))
}
