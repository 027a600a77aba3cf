//! The calibration pose that many motion files begin with.

use crate::Clip;

/// How many frames at the beginning are a rest pose (T-pose) that is not part of the motion: 0 for most clips.
///
/// Such a lead-in is nearly still, then the body jumps to where the motion begins: the jump is at least five times
/// the largest step that the rest of the clip holds in one frame and at least four degrees a joint in the mean.
/// Align and training leave it out; converting and retargeting keep it.
pub fn rest_pose_frames(clip: &Clip) -> usize {
    /// Longest lead-in that is looked for, seconds.
    const LONGEST: f64 = 2.0;
    const OUTLIER: f32 = 5.0;
    /// Fewer steps than this say nothing of what is ordinary.
    const LEAST_AFTER: usize = 8;
    const LEAST_JUMP: f32 = 4.0 * std::f32::consts::PI / 180.0;

    let steps: Vec<f32> = (1..clip.frames()).map(|frame| step(clip, frame)).collect();
    let longest = ((LONGEST * clip.frame_rate()) as usize).clamp(1, 1000).min(steps.len() / 2);
    let Some((jump, &size)) = steps[..longest].iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else {
        return 0;
    };
    let before = steps[..jump].iter().copied().fold(0.0, f32::max);
    let mut after = steps[jump + 1..].to_vec();
    if after.len() < LEAST_AFTER {
        return 0;
    }
    // A glitch later in the clip shall not hide the lead-in: the 99th percentile stands for the largest step.
    let rank = (after.len() - 1) * 99 / 100;
    let (_, &mut largest, _) = after.select_nth_unstable_by(rank, f32::total_cmp);
    let lead_in = size > OUTLIER * largest.max(before) && size > LEAST_JUMP;
    if lead_in { jump + 1 } else { 0 }
}

/// Mean turn of the joints from the frame before, radians.
fn step(clip: &Clip, frame: usize) -> f32 {
    let pairs = clip.rotations(frame).iter().zip(clip.rotations(frame - 1));
    pairs.map(|(to, from)| to.angle_between(*from)).sum::<f32>() / clip.skeleton().len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton};
    use glam::{Quat, Vec3};
    use std::sync::Arc;

    fn swinging(lead_in: usize) -> Clip {
        let skeleton =
            Skeleton::new(vec![Joint::new("a", None, Vec3::ZERO), Joint::new("b", Some(0), Vec3::Y)]);
        let rotations = (0..90)
            .flat_map(|frame| {
                let angle = if frame < lead_in { 0.0 } else { 1.2 + 0.2 * (0.1 * frame as f32).sin() };
                [Quat::IDENTITY, Quat::from_rotation_z(angle)]
            })
            .collect();
        Clip::new(Arc::new(skeleton.unwrap()), 30.0, rotations, vec![]).unwrap()
    }

    #[test]
    fn a_lead_in_is_counted_and_an_ordinary_clip_has_none() {
        assert_eq!(rest_pose_frames(&swinging(0)), 0);
        assert_eq!(rest_pose_frames(&swinging(1)), 1);
        assert_eq!(rest_pose_frames(&swinging(10)), 10);
    }

    #[test]
    fn short_clips_have_none() {
        let clip = swinging(1);
        for frames in 1..4 {
            assert_eq!(rest_pose_frames(&crate::time::trim(&clip, 0..frames).unwrap()), 0);
        }
    }
}
