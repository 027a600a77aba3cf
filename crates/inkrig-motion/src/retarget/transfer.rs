//! Frame after frame from the source to the target.

use super::calibrate::Calibration;
use super::figure::Figure;
use super::plan::{Aim, Plan};
use super::twist::Share;
use crate::kinematics::Pose;
use crate::orientation::between;
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
    (source, from): (&Clip, &Figure),
    (target, onto): (&Skeleton, &Figure),
    plan: &Plan,
    twists: &mut [Share],
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
        let turned = |joint: usize| pose.rotations[joint] * calibration.source.rotations[joint].conjugate();
        let mut turns: Vec<Option<Quat>> = vec![None; target.len()];
        // The same of target joints.
        let mut along_with: Vec<Option<Quat>> = vec![None; target.len()];
        for ((link, reference), bone) in plan.links.iter().zip(&calibration.target).zip(&calibration.bones) {
            let (low, high) = (turned(link.lead.low), turned(link.lead.high));
            let mut along = if link.lead.part > 0.0 { low.slerp(high, link.lead.part) } else { low };
            let points = match &link.aim {
                // Where several bones of the source stand for one, their joint alone does not say where it points.
                Aim::Bone { from, to, .. } => {
                    bone.zip(Some(to.place(&pose.positions) - from.place(&pose.positions)))
                }
                Aim::Girdle { source: hip, .. } => bone.map(|bone| {
                    let carrier = above(target, link.target, &along_with);
                    let moved = calibration.scale
                        * strayed(source, &calibration.source, &pose, (link.lead.low, *hip));
                    (bone, carrier * (bone + moved))
                }),
                _ => None,
            };
            if let Some((bone, points)) = points {
                along = between((along * bone).as_dvec3(), points.as_dvec3()).as_quat() * along;
            }
            along_with[link.target] = Some(along);
            turns[link.target] = Some((along * *reference).normalize());
        }
        for twist in twists.iter_mut() {
            turns[twist.joint] = twist.turn(&turns, plan, calibration);
        }
        let mut world: Vec<Quat> = Vec::with_capacity(target.len());
        for (index, (joint, own)) in target.joints().iter().zip(turns).enumerate() {
            let parent = joint.parent.map_or(Quat::IDENTITY, |parent| world[parent]);
            world.push(own.unwrap_or_else(|| parent * local(target, &calibration.rest, index)));
        }
        // The middle of the legs is what is scaled: hips joints stand elsewhere in other skeletons.
        let middle = from.middle(&pose.positions) - Vec3::Y * calibration.source_ground;
        let goal = middle * calibration.scale + Vec3::Y * calibration.target_ground;
        let places = places(target, &world, onto.hips, Vec3::ZERO);
        moved.hips.push(goal - onto.middle(&places));
        moved.turns.push(world);
    }
    moved
}

/// A joint's rotation against what stands above it.
pub(super) fn local(skeleton: &Skeleton, pose: &Pose, joint: usize) -> Quat {
    let above = skeleton.joints()[joint].parent.map_or(Quat::IDENTITY, |parent| pose.rotations[parent]);
    above.conjugate() * pose.rotations[joint]
}

/// How far a hip or shoulder is from where it would be if its girdle did not turn against the trunk: metres, in the axes
/// of the reference pose.
fn strayed(source: &Clip, stood: &Pose, now: &Pose, (girdle, hip): (usize, usize)) -> Vec3 {
    let carrier = source.skeleton().joints()[girdle].parent;
    let seen = |pose: &Pose| {
        let (place, turn) = carrier.map_or((Vec3::ZERO, Quat::IDENTITY), |joint| {
            (pose.positions[joint], pose.rotations[joint] * stood.rotations[joint].conjugate())
        });
        turn.conjugate() * (pose.positions[hip] - place)
    };
    seen(now) - seen(stood)
}

/// What the nearest joint above is turned by that is led.
fn above(target: &Skeleton, joint: usize, turned: &[Option<Quat>]) -> Quat {
    let parent = |joint: &usize| target.joints().get(*joint).and_then(|joint| joint.parent);
    let first = target.joints()[joint].parent;
    std::iter::successors(first, parent).find_map(|joint| turned[joint]).unwrap_or(Quat::IDENTITY)
}

/// Places of all joints when the hips are at one.
fn places(target: &Skeleton, turns: &[Quat], hips: usize, at: Vec3) -> Vec<Vec3> {
    let mut places: Vec<Vec3> = Vec::with_capacity(target.len());
    for joint in target.joints() {
        let above = joint.parent.map_or(Vec3::ZERO, |parent| places[parent]);
        let turn = joint.parent.map_or(Quat::IDENTITY, |parent| turns[parent]);
        places.push(above + turn * joint.offset);
    }
    // The hips carry the character; all below them goes along.
    let shift = at - places[hips];
    let mut moved = vec![false; target.len()];
    for (index, joint) in target.joints().iter().enumerate() {
        moved[index] = index == hips || joint.parent.is_some_and(|parent| moved[parent]);
        if moved[index] {
            places[index] += shift;
        }
    }
    places
}

impl Moved {
    /// Places of all joints at a frame.
    pub(super) fn places(&self, frame: usize, target: &Skeleton) -> Vec<Vec3> {
        places(target, &self.turns[frame], self.hips_joint, self.hips[frame])
    }

    /// The clip of the skeleton as it is in its file: the hips' place and those of loose joints become translations in
    /// what stands above them.
    pub(super) fn into_clip(
        self,
        target: &Arc<Skeleton>,
        hung: &Skeleton,
        loose: &[usize],
        rate: f64,
    ) -> Result<Clip, MotionError> {
        let joints = target.joints();
        let mut rotations = Vec::with_capacity(self.turns.len() * joints.len());
        let moving: Vec<usize> = std::iter::once(self.hips_joint).chain(loose.iter().copied()).collect();
        let mut values: Vec<Vec<Vec3>> = vec![Vec::with_capacity(self.turns.len()); moving.len()];
        for (frame, turns) in self.turns.iter().enumerate() {
            for (joint, turn) in joints.iter().zip(turns) {
                let parent = joint.parent.map_or(Quat::IDENTITY, |parent| turns[parent]);
                rotations.push(parent.conjugate() * *turn);
            }
            let places = self.places(frame, hung);
            for (&joint, values) in moving.iter().zip(&mut values) {
                let above = joints[joint].parent;
                let place = above.map_or(Vec3::ZERO, |above| places[above]);
                let turn = above.map_or(Quat::IDENTITY, |above| turns[above]);
                values.push(turn.conjugate() * (places[joint] - place));
            }
        }
        let tracks = moving.into_iter().zip(values).map(|(joint, values)| TranslationTrack { joint, values });
        Clip::new(Arc::clone(target), rate, rotations, tracks.collect())
    }
}
