//! How far two motions of one skeleton are apart.

use crate::{Clip, MotionError, kinematics::Pose};

/// The largest differences between two motions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Of the place of any joint or end site in the world, metres.
    pub metres: f64,
    /// Of any rotation local to its parent, radians; end sites are not looked at.
    pub radians: f64,
}

/// Compares two motions frame by frame.
///
/// # Errors
/// When they do not have as many frames and joints.
pub fn deviation(a: &Clip, b: &Clip) -> Result<Deviation, MotionError> {
    for (what, expected, got) in [
        ("joints of the other motion", a.skeleton().len(), b.skeleton().len()),
        ("frames of the other motion", a.frames(), b.frames()),
    ] {
        if expected != got {
            return Err(MotionError::Length { what, expected, got });
        }
    }
    let mut worst = Deviation::default();
    let (mut pose_a, mut pose_b) = (Pose::new(a.skeleton()), Pose::new(b.skeleton()));
    for frame in 0..a.frames() {
        pose_a.set(a, frame);
        pose_b.set(b, frame);
        for (a, b) in pose_a.positions.iter().zip(&pose_b.positions) {
            worst.metres = worst.metres.max(f64::from(a.distance(*b)));
        }
        for ((a, b), joint) in a.rotations(frame).iter().zip(b.rotations(frame)).zip(a.skeleton().joints()) {
            if !joint.end_site {
                let (a, b) = (a.as_dquat(), b.as_dquat());
                let apart = (a - b).length().min((a + b).length());
                worst.radians = worst.radians.max(4.0 * (0.5 * apart).min(1.0).asin());
            }
        }
    }
    Ok(worst)
}
