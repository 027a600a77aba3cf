//! A clip of anybody as the numbers of one body.

use super::check::{Rejected, check};
use super::poses::key_pose_frames;
use inkrig_motion::humanml::{self, Joints, Offsets};
use inkrig_motion::rig::Humanoid;
use inkrig_motion::{Clip, Features, lead_in, time};

/// What the networks see of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// Frames x 263, see [`humanml::features`].
    pub features: Features,
    /// The same of the mirror image.
    pub mirrored: Features,
    /// Rows whose poses stand out: candidates for a key pose.
    pub key_poses: Vec<usize>,
}

/// Finds the body of a clip, leaves out a rest pose at its beginning, and gives it the proportions of `target`.
///
/// # Errors
/// Why it is not fit to learn from.
pub fn prepare(clip: &Clip, target: &Offsets, least_frames: usize) -> Result<Prepared, Rejected> {
    prepare_joints(&joints(clip)?, target, least_frames)
}

/// The same from joints at 20 frames a second, metres, y up.
pub(super) fn prepare_joints(
    joints: &[Joints],
    target: &Offsets,
    least_frames: usize,
) -> Result<Prepared, Rejected> {
    check(joints, least_frames)?;
    let broken = |error: inkrig_motion::MotionError| Rejected::Broken(error.to_string());
    let uniform = humanml::ground(&humanml::uniform(joints, target));
    let features = humanml::features(&uniform).map_err(broken)?;
    let mirrored = humanml::features(&humanml::ground(&humanml::mirror(&uniform))).map_err(broken)?;
    let key_poses = key_pose_frames(&features);
    Ok(Prepared { features, mirrored, key_poses })
}

/// The bones of the body in a clip's first frame.
pub(super) fn body(clip: &Clip) -> Result<Offsets, Rejected> {
    let joints = joints(clip)?;
    joints.first().map(humanml::bone_lengths).ok_or(Rejected::Short { frames: 0, least: 1 })
}

fn joints(clip: &Clip) -> Result<Vec<Joints>, Rejected> {
    let broken = |error: inkrig_motion::MotionError| Rejected::Broken(error.to_string());
    let body = Humanoid::find(clip.skeleton()).map_err(|missing| Rejected::NoBody(missing.to_string()))?;
    let rest = lead_in::rest_pose_frames(clip);
    let clip =
        if rest == 0 { clip.clone() } else { time::trim(clip, rest..clip.frames()).map_err(broken)? };
    Ok(humanml::from_clip(&clip, &body))
}
