//! The calibration pose that many motion files begin with.

use crate::Clip;
use glam::Quat;

/// Longest lead-in that is looked for, seconds.
const LONGEST: f64 = 2.0;
/// A pose with a smaller mean turn of its joints is a rest pose, degrees. Capture files have 1 to 3.
const REST: f32 = 8.0;
/// The body moves less than this a frame while it is held, degrees a joint in the mean.
const HELD: f32 = 1.0;
/// A smaller step is no jump, degrees a joint in the mean.
const JUMP: f32 = 2.5;
/// A jump is so many times larger than the ordinary steps after it.
const OUTLIER: f32 = 3.5;
/// Steps after a jump that say what is ordinary.
const AFTER: usize = 10;

/// How many frames at the beginning are a rest pose (T-pose) that is not part of the motion: 0 for most clips.
///
/// Such a lead-in is held still near the rest pose, then the body jumps to where the motion begins, within a frame
/// or two (files that were thinned or filtered hold a frame half way). Aligning and training leave it out;
/// converting and retargeting keep it.
pub fn rest_pose_frames(clip: &Clip) -> usize {
    let longest = ((LONGEST * clip.frame_rate()) as usize).clamp(1, 1000);
    let steps: Vec<f32> =
        (1..clip.frames().min(longest + 3 + AFTER)).map(|frame| step(clip, frame)).collect();
    let jumps = |index: usize| {
        let after = &steps[(index + 1).min(steps.len())..(index + 1 + AFTER).min(steps.len())];
        after.len() == AFTER && steps[index] > JUMP && steps[index] > OUTLIER * median(after)
    };
    let Some(first) = (0..longest.min(steps.len())).find(|&index| steps[index] > HELD) else { return 0 };
    if mean_turn(clip, first) > REST || !jumps(first) {
        return 0;
    }
    let half_way = (first + 1..(first + 3).min(steps.len())).take_while(|&index| jumps(index)).count();
    first + 1 + half_way
}

/// Mean turn of the joints away from the rest pose, degrees.
fn mean_turn(clip: &Clip, frame: usize) -> f32 {
    mean_angle(clip, clip.rotations(frame).iter().map(|rotation| rotation.angle_between(Quat::IDENTITY)))
}

/// Mean turn of the joints from the frame before, degrees.
fn step(clip: &Clip, frame: usize) -> f32 {
    let pairs = clip.rotations(frame).iter().zip(clip.rotations(frame - 1));
    mean_angle(clip, pairs.map(|(to, from)| to.angle_between(*from)))
}

fn mean_angle(clip: &Clip, angles: impl Iterator<Item = f32>) -> f32 {
    let turning = clip.skeleton().joints().iter().filter(|joint| !joint.end_site).count();
    (angles.sum::<f32>() / turning.max(1) as f32).to_degrees()
}

fn median(values: &[f32]) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton};
    use glam::Vec3;
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
        assert_eq!(rest_pose_frames(&swinging(80)), 0, "longer than any lead-in");
    }

    #[test]
    fn short_clips_have_none() {
        let clip = swinging(1);
        for frames in 1..4 {
            assert_eq!(rest_pose_frames(&crate::time::trim(&clip, 0..frames).unwrap()), 0);
        }
    }
}
