//! Frame after frame from the source to the target.

use super::calibrate::Calibration;
use super::plan::Plan;
use crate::kinematics::Pose;
use crate::rig::Humanoid;
use crate::{Clip, MotionError, Skeleton, TranslationTrack};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// A motion of the target in the making: world rotations of all joints and the place of the hips, frame by frame.
#[derive(Debug, Clone)]
pub(super) struct Moved {
    /// Frames x joints.
    pub(super) turns: Vec<Vec<Quat>>,
    pub(super) hips: Vec<Vec3>,
    /// The joint that the places are of.
    pub(super) hips_joint: usize,
}

pub(super) fn transfer(
    (source, from): (&Clip, &Humanoid),
    (target, onto): (&Skeleton, &Humanoid),
    plan: &Plan,
    calibration: &Calibration,
) -> Moved {
    let mut pose = Pose::new(source.skeleton());
    let mut moved = Moved {
        turns: Vec::with_capacity(source.frames()),
        hips: Vec::with_capacity(source.frames()),
        hips_joint: onto.hips,
    };
    for frame in 0..source.frames() {
        pose.set(source, frame);
        // How a source joint is turned against the reference pose, world axes.
        let turned = |joint: usize| pose.rotations[joint] * calibration.source[joint].conjugate();
        let mut turns: Vec<Option<Quat>> = vec![None; target.len()];
        for (link, reference) in plan.links.iter().zip(&calibration.target) {
            let (low, high) = (turned(link.lead.low), turned(link.lead.high));
            let along = if link.lead.part > 0.0 { low.slerp(high, link.lead.part) } else { low };
            turns[link.target] = Some((along * *reference).normalize());
        }
        let mut world: Vec<Quat> = Vec::with_capacity(target.len());
        for (joint, own) in target.joints().iter().zip(turns) {
            let parent = joint.parent.map_or(Quat::IDENTITY, |parent| world[parent]);
            world.push(own.unwrap_or(parent));
        }
        // The middle of the legs is what is scaled: hips joints stand elsewhere in other skeletons.
        let legs = 0.5 * (pose.positions[from.legs[0].upper] + pose.positions[from.legs[1].upper]);
        let above = Vec3::new(legs.x, legs.y - calibration.source_ground, legs.z) * calibration.scale;
        let hips =
            above + Vec3::Y * calibration.target_ground + world[onto.hips] * calibration.hips_over_legs;
        moved.turns.push(world);
        moved.hips.push(hips);
    }
    moved
}

impl Moved {
    /// Places of all joints at a frame.
    pub(super) fn places(&self, frame: usize, target: &Skeleton) -> Vec<Vec3> {
        let turns = &self.turns[frame];
        let mut places: Vec<Vec3> = Vec::with_capacity(target.len());
        for joint in target.joints() {
            let above = joint.parent.map_or(Vec3::ZERO, |parent| places[parent]);
            let turn = joint.parent.map_or(Quat::IDENTITY, |parent| turns[parent]);
            places.push(above + turn * joint.offset);
        }
        // The hips carry the character; all below them goes along.
        let shift = self.hips[frame] - places[self.hips_joint];
        let mut moved = vec![false; target.len()];
        for (index, joint) in target.joints().iter().enumerate() {
            moved[index] = index == self.hips_joint || joint.parent.is_some_and(|parent| moved[parent]);
            if moved[index] {
                places[index] += shift;
            }
        }
        places
    }

    /// The clip: the hips' place becomes their translation in what stands above them.
    pub(super) fn into_clip(
        self,
        target: &Arc<Skeleton>,
        hips: usize,
        rate: f64,
    ) -> Result<Clip, MotionError> {
        let joints = target.joints();
        let mut rotations = Vec::with_capacity(self.turns.len() * joints.len());
        let mut values = Vec::with_capacity(self.turns.len());
        for (turns, place) in self.turns.iter().zip(&self.hips) {
            for (joint, turn) in joints.iter().zip(turns) {
                let parent = joint.parent.map_or(Quat::IDENTITY, |parent| turns[parent]);
                rotations.push(parent.conjugate() * *turn);
            }
            // What stands above the hips is at rest.
            let chain = std::iter::successors(joints[hips].parent, |&joint| joints[joint].parent);
            let above: Vec3 = chain.map(|joint| joints[joint].offset).sum();
            values.push(*place - above);
        }
        Clip::new(Arc::clone(target), rate, rotations, vec![TranslationTrack { joint: hips, values }])
    }
}
