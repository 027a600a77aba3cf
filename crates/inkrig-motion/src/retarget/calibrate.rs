//! How the target stands in the source's reference pose.

use super::plan::{Aim, Plan};
use super::reference::{Reference, hip_height, sole};
use super::{RetargetError, RetargetOptions};
use crate::Skeleton;
use crate::kinematics::Pose;
use crate::orientation::{best_rotation, between};
use crate::rig::Humanoid;
use glam::{DQuat, DVec3, Quat, Vec3};

/// What carrying over needs to know beside the frames.
#[derive(Debug, Clone)]
pub(super) struct Calibration {
    /// For every link, the target's world rotation in the reference pose.
    pub(super) target: Vec<Quat>,
    /// World rotations of all source joints in the reference pose.
    pub(super) source: Vec<Quat>,
    pub(super) scale: f32,
    /// Height of the ground under the source and under the target at rest, metres.
    pub(super) source_ground: f32,
    pub(super) target_ground: f32,
    /// Place of the target's hips over the middle of its hip joints, in the hips' axes.
    pub(super) hips_over_legs: Vec3,
    /// Length of a leg of the source, metres.
    pub(super) leg: f32,
}

pub(super) fn calibrate(
    reference: &Reference,
    (target, onto): (&Skeleton, &Humanoid),
    plan: &Plan,
    options: &RetargetOptions,
) -> Result<Calibration, RetargetError> {
    let rest = options.stance.clone().unwrap_or_else(|| Pose::new(target));
    if rest.positions.len() != target.len() || rest.rotations.len() != target.len() {
        return Err(RetargetError::Stance { expected: target.len(), got: rest.positions.len() });
    }
    let own_hips = hip_height(&rest, onto);
    let scale = match options.scale {
        Some(scale) if scale.is_finite() && scale > 0.0 => scale,
        _ if reference.hips <= 1e-4 => return Err(RetargetError::NoLegs("motion")),
        _ if own_hips <= 1e-4 => return Err(RetargetError::NoLegs("character")),
        _ => own_hips / reference.hips,
    };
    let from = |joint: usize| reference.pose.positions[joint].as_dvec3();
    let to = |joint: usize| rest.positions[joint].as_dvec3();
    let turn = facing(&reference.pose, &reference.body) * facing(&rest, onto).conjugate();
    let mut turned: Vec<Option<DQuat>> = vec![None; target.len()];
    let mut rotations = Vec::with_capacity(plan.links.len());
    for link in &plan.links {
        let place = to(link.target);
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
            Aim::Bone { target, from: begin, to: end } => {
                let own = turn * (to(*target) - place).normalize_or_zero();
                between(own, (from(*end) - from(*begin)).normalize_or_zero()) * turn
            }
            Aim::Sole { target, from: begin, to: end } => {
                let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z).normalize_or_zero();
                between(flat(turn * (to(*target) - place)), flat(from(*end) - from(*begin))) * turn
            }
            Aim::Upright | Aim::Along => above(target, link.target, &turned).unwrap_or(turn),
        };
        turned[link.target] = Some(rotation);
        rotations.push(rotation.as_quat() * rest.rotations[link.target]);
    }
    let legs = 0.5 * (rest.positions[onto.legs[0].upper] + rest.positions[onto.legs[1].upper]);
    let source_leg = reference.body.legs[0];
    let at = |joint: usize| reference.pose.positions[joint];
    let shin = source_leg.foot.map_or(0.0, |foot| at(foot).distance(at(source_leg.lower)));
    Ok(Calibration {
        target: rotations,
        source: reference.pose.rotations.clone(),
        scale,
        source_ground: reference.ground,
        target_ground: sole(&rest, onto),
        hips_over_legs: rest.rotations[onto.hips].conjugate() * (rest.positions[onto.hips] - legs),
        leg: at(source_leg.lower).distance(at(source_leg.upper)) + shin,
    })
}

/// The rotation from z and y to where a body faces and its up.
fn facing(pose: &Pose, body: &Humanoid) -> DQuat {
    let at = |joint: usize| pose.positions[joint].as_dvec3();
    let mut left = at(body.legs[0].upper) - at(body.legs[1].upper);
    if let [Some(own), Some(other)] = body.arms {
        left += at(own.upper) - at(other.upper);
    }
    let forward = DVec3::new(left.x, 0.0, left.z).cross(DVec3::Y).normalize_or(DVec3::Z);
    DQuat::from_rotation_y(forward.x.atan2(forward.z))
}

/// What the nearest joint above that is led is turned by.
fn above(skeleton: &Skeleton, joint: usize, turned: &[Option<DQuat>]) -> Option<DQuat> {
    let parent = |joint: &usize| skeleton.joints().get(*joint).and_then(|joint| joint.parent);
    let first = skeleton.joints()[joint].parent;
    std::iter::successors(first, parent).find_map(|joint| turned[joint])
}
