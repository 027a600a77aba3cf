//! The points that a drawn figure and a moving one have in common.

use super::Joints;

/// A drawn figure has neck, spine and collars, but no joints between; those that lie between others are put on the
/// line, so that drawn and moving figures agree: shoulders half way from collar to elbow, the upper spine by thirds
/// from the lowest spine joint to the neck.
pub fn augment(joints: &Joints) -> Joints {
    let mut out = *joints;
    out[16] = 0.5 * (joints[13] + joints[18]);
    out[17] = 0.5 * (joints[14] + joints[19]);
    let spine = joints[12] - joints[3];
    out[6] = joints[3] + spine / 3.0;
    out[9] = joints[3] + spine * (2.0 / 3.0);
    out
}
