//! How the target stands in the source's reference pose.

use super::figure::Figure;
use super::plan::{Aim, Plan};
use super::reference::Reference;
use super::transfer::local;
use super::{RetargetError, RetargetOptions};
use crate::Skeleton;
use crate::kinematics::Pose;
use crate::orientation::{best_rotation, between};
use glam::{DQuat, DVec3, Quat, Vec3};

/// What carrying over needs to know beside the frames.
#[derive(Debug, Clone)]
pub(super) struct Calibration {
    /// For every link, the target's world rotation in the reference pose.
    pub(super) target: Vec<Quat>,
    /// For links that point a bone, where the source's points in the reference pose; for girdles their own bone then,
    /// metres.
    pub(super) bones: Vec<Option<Vec3>>,
    /// The source's reference pose.
    pub(super) source: Pose,
    /// The target's rest pose.
    pub(super) rest: Pose,
    pub(super) scale: f32,
    /// Height of the ground under the source and under the target at rest, metres.
    pub(super) source_ground: f32,
    pub(super) target_ground: f32,
}

pub(super) fn calibrate(
    (source, reference): (&Figure, &Reference),
    (target, onto, rest): (&Skeleton, &Figure, Pose),
    plan: &Plan,
    options: &RetargetOptions,
) -> Result<Calibration, RetargetError> {
    let from = |joint: usize| reference.pose.positions[joint].as_dvec3();
    let to = |joint: usize| rest.positions[joint].as_dvec3();
    let turn = source.facing(&reference.pose) * onto.facing(&rest).conjugate();
    let mut turned: Vec<Option<DQuat>> = vec![None; target.len()];
    let mut rotations = Vec::with_capacity(plan.links.len());
    let mut bones = Vec::with_capacity(plan.links.len());
    for link in &plan.links {
        let place = to(link.target);
        let mut points = None;
        let rotation = match &link.aim {
            // Both stand upright: shoulders of another slope are no reason to lean.
            Aim::Hub(_) | Aim::Upright if reference.at_rest => turn,
            Aim::Hub(neighbours) => {
                let pair = |&(own, other): &(usize, usize)| {
                    let source = from(other) - from(link.lead.high);
                    ((to(own) - place).normalize_or_zero(), source.normalize_or_zero())
                };
                best_rotation(&neighbours.iter().map(pair).collect::<Vec<_>>(), turn)
            }
            Aim::Bone { target, from, to: end } => {
                let own = turn * (to(*target) - place).normalize_or_zero();
                let bone = end.place(&reference.pose.positions) - from.place(&reference.pose.positions);
                points = bone.try_normalize();
                between(own, bone.as_dvec3().normalize_or_zero()) * turn
            }
            Aim::Sole { target, from: begin, to: end } => {
                let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z).normalize_or_zero();
                between(flat(turn * (to(*target) - place)), flat(from(*end) - from(*begin))) * turn
            }
            Aim::Girdle { target: hip, .. } => {
                let own = above(target, link.target, &turned).unwrap_or(turn);
                points = Some((own * (to(*hip) - place)).as_vec3());
                own
            }
            Aim::Upright | Aim::Along => above(target, link.target, &turned).unwrap_or(turn),
        };
        turned[link.target] = Some(rotation);
        rotations.push(rotation.as_quat() * rest.rotations[link.target]);
        bones.push(points);
    }
    let scale = match options.scale {
        Some(scale) if scale.is_finite() && scale > 0.0 => scale,
        Some(scale) => return Err(RetargetError::Scale(scale)),
        None => {
            // A person in the same pose; an animal's legs reach as far as they do at rest, however they bend.
            let as_source = || onto.height(&stood((target, &rest), plan, &rotations));
            let own = if onto.quadruped().is_some() { onto.height(&rest) } else { as_source() };
            if reference.height <= 1e-4 {
                return Err(RetargetError::NoLegs("motion"));
            }
            if own <= 1e-4 {
                return Err(RetargetError::NoLegs("character"));
            }
            own / reference.height
        }
    };
    Ok(Calibration {
        target: rotations,
        bones,
        source: reference.pose.clone(),
        scale,
        source_ground: reference.ground,
        target_ground: onto.sole(&rest),
        rest,
    })
}

/// The target in the source's reference pose, its first root at its own offset.
fn stood((target, rest): (&Skeleton, &Pose), plan: &Plan, rotations: &[Quat]) -> Pose {
    let mut pose = Pose::new(target);
    for (index, joint) in target.joints().iter().enumerate() {
        let above = joint.parent.map_or(Quat::IDENTITY, |parent| pose.rotations[parent]);
        let place = joint.parent.map_or(Vec3::ZERO, |parent| pose.positions[parent]);
        let link = plan.links.iter().position(|link| link.target == index);
        let own = link.and_then(|link| rotations.get(link).copied());
        pose.rotations[index] = own.unwrap_or_else(|| above * local(target, rest, index));
        pose.positions[index] = place + above * joint.offset;
    }
    pose
}

/// What the nearest joint above that is led is turned by.
fn above(skeleton: &Skeleton, joint: usize, turned: &[Option<DQuat>]) -> Option<DQuat> {
    let parent = |joint: &usize| skeleton.joints().get(*joint).and_then(|joint| joint.parent);
    let first = skeleton.joints()[joint].parent;
    std::iter::successors(first, parent).find_map(|joint| turned[joint])
}
