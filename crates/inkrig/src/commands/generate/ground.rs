//! Feet on the floor, unless `--ground off` says otherwise.

use super::Wanted;
use super::record::{clip_poses, trajectory_error};
use crate::printable::fixed;
use inkrig_generate::measures::skating;
use inkrig_generate::sampling::Semantics;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{
    Blocks, FRAME_RATE, Footing, JOINTS, Joints, Kept, WIDTH, keep_footing, to_clip,
};
use inkrig_motion::{Clip, MotionError};
use serde::Serialize;
use std::fmt::Write;

/// Points between others that a key pose has elsewhere than a body: see [`augment`](inkrig_motion::humanml::augment).
const BETWEEN: [usize; 4] = [6, 9, 16, 17];
/// The sole of a foot: ankle and toe, left and right.
const SOLES: [[usize; 2]; 2] = [[7, 10], [8, 11]];

/// A foot that is farther above the floor than this, metres, is not on it.
const ABOVE: f32 = 0.05;

/// What was changed, in the report; the names are stable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct GroundRecord {
    /// How far the whole body was raised or lowered, and moved over the ground: in the mean and at most, millimetres.
    height_mm: [f64; 2],
    travel_mm: [f64; 2],
    /// The largest distance of a joint from where it was in the body as a whole, millimetres.
    limbs_mm: f64,
    /// The middle of the lower foot's heights above the floor while nothing is in the air, before and after, millimetres.
    lower_foot_mm: [f64; 2],
    /// Frames in which the lower foot is more than 5 cm above the floor, of how many, and the farthest that it is, millimetres.
    above_frames: usize,
    frames: usize,
    above_mm: f64,
    /// Shares of moments in which a foot slides, before and after (GMD's measure). Feet above the floor do not count, so that
    /// those of a motion that floated seem to slide less before.
    skating: [f64; 2],
    /// Frames in which a foot stands, and in which the body is in the air.
    standing_frames: usize,
    airborne_frames: usize,
    /// Mean distance from the trajectory before this, metres; after it is the trajectory's own.
    trajectory_error_before_metres: Option<f64>,
}

/// The same motion with its feet on the floor. What was asked for stays as near as it was.
pub(super) fn ground(
    clip: &Clip,
    rows: &[f32],
    wanted: &Wanted,
    semantics: Semantics,
) -> Result<(Clip, GroundRecord), MotionError> {
    let before = clip_poses(clip);
    let contacts: Vec<[f32; 4]> =
        rows.chunks_exact(WIDTH).filter_map(|row| row[Blocks::CONTACTS].try_into().ok()).collect();
    let footing = keep_footing(&before, &contacts, FRAME_RATE, &kept(wanted, semantics, &before))?;
    let record = GroundRecord::of(&before, &footing, wanted);
    Ok((to_clip(&footing.frames, clip.skeleton(), FRAME_RATE)?, record))
}

/// What was asked for, as joints at places. A key pose that says nothing of where it is over the ground is kept where the motion has it.
fn kept(wanted: &Wanted, semantics: Semantics, motion: &[Joints]) -> Vec<Kept> {
    let asks = wanted.trajectory.iter().flatten();
    let mut kept: Vec<Kept> =
        asks.map(|ask| Kept { frame: ask.frame, joint: ask.joint, place: ask.place }).collect();
    let Some(pose) = &wanted.keypose else { return kept };
    let own = motion.get(pose.frame).map_or(pose.joints[0], |joints| joints[0]);
    let aside = if semantics.keypose_is_relative() { (own - pose.joints[0]).with_y(0.0) } else { Vec3::ZERO };
    let joints = (0..JOINTS).filter(|joint| !BETWEEN.contains(joint));
    kept.extend(joints.map(|joint| Kept { frame: pose.frame, joint, place: pose.joints[joint] + aside }));
    kept
}

impl GroundRecord {
    fn of(before: &[Joints], footing: &Footing, wanted: &Wanted) -> Self {
        let spread = |of: &dyn Fn(&Vec3) -> f32| {
            let sizes = || footing.moved.iter().map(|moved| 1e3 * f64::from(of(moved)));
            [sizes().sum::<f64>() / footing.moved.len().max(1) as f64, sizes().fold(0.0, f64::max)]
        };
        let height =
            |joints: &Joints| SOLES.iter().flatten().map(|at| joints[*at].y).fold(f32::MAX, f32::min);
        let above = || footing.frames.iter().map(height);
        let lower = |motion: &[Joints]| {
            let low = motion.iter().zip(&footing.airborne).filter(|(_, airborne)| !**airborne);
            let mut heights: Vec<f32> = low.map(|(joints, _)| height(joints)).collect();
            heights.sort_unstable_by(f32::total_cmp);
            1e3 * f64::from(heights.get(heights.len() / 2).copied().unwrap_or(0.0))
        };
        Self {
            height_mm: spread(&|moved| moved.y.abs()),
            travel_mm: spread(&|moved| moved.with_y(0.0).length()),
            limbs_mm: 1e3 * f64::from(footing.largest_bend(before)),
            lower_foot_mm: [lower(before), lower(&footing.frames)],
            above_frames: above().filter(|height| *height > ABOVE).count(),
            frames: footing.frames.len(),
            above_mm: 1e3 * f64::from(above().fold(0.0, f32::max)),
            skating: [skating(before).ratio, skating(&footing.frames).ratio],
            standing_frames: footing.standing.iter().filter(|feet| feet.contains(&true)).count(),
            airborne_frames: footing.airborne.iter().filter(|airborne| **airborne).count(),
            trajectory_error_before_metres: wanted
                .trajectory
                .as_ref()
                .map(|asks| trajectory_error(before, asks)),
        }
    }

    pub(super) fn text(&self) -> String {
        let whole = |mm: f64| fixed(mm, 0);
        let on_floor = if self.above_frames == 0 {
            "feet on the floor".to_string()
        } else {
            format!(
                "feet on the floor in {} of {} frames, else the lower one up to {} cm above it",
                self.frames - self.above_frames,
                self.frames,
                fixed(self.above_mm / 10.0, 0)
            )
        };
        let mut text = format!(
            "{on_floor}: body raised or lowered by {} mm (at most {}), moved along by {} mm (at most {}), limbs by {} mm at most",
            whole(self.height_mm[0]),
            whole(self.height_mm[1]),
            whole(self.travel_mm[0]),
            whole(self.travel_mm[1]),
            whole(self.limbs_mm),
        );
        let after = fixed(1e2 * self.skating[1], 0);
        // Writing to a string cannot fail.
        let _ = write!(text, "; feet near the floor slide in {after} of 100 frames");
        text
    }
}
