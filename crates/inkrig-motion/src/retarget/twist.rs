//! Twist shared along a limb: skin over forearm and upper arm turns little by little.

use super::calibrate::Calibration;
use super::figure::Figure;
use super::plan::Plan;
use crate::Skeleton;
use crate::rig::{Humanoid, Part, Side, twist_joints};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// A joint that takes a share of a limb's twist.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Share {
    pub(super) joint: usize,
    /// The bone that it lies along: its two joints, and what it twists against.
    bone: usize,
    against: usize,
    /// How much of the twist of `against` about the bone it takes.
    part: f32,
    /// Along the bone while nothing is turned.
    axis: Vec3,
    /// The twist of the frame before: a turn of more than a half goes on rather than back.
    last: f32,
}

/// Bones whose twist is shared: their part, the one at their end, the one before them.
const BONES: [(Part, Part, Part); 4] = [
    (Part::UpperArm, Part::LowerArm, Part::Clavicle),
    (Part::LowerArm, Part::Hand, Part::UpperArm),
    (Part::UpperLeg, Part::LowerLeg, Part::Hips),
    (Part::LowerLeg, Part::Foot, Part::UpperLeg),
];

/// Twist joints of a person: those named so, and those between the two joints of a bone.
pub(super) fn shares(target: &Skeleton, figure: &Figure, plan: &Plan, rest: &[Vec3]) -> Vec<Share> {
    let Some(body) = figure.humanoid() else { return Vec::new() };
    let named = twist_joints(target);
    let led = |joint: usize| plan.links.iter().any(|link| link.target == joint);
    let mut found = Vec::new();
    for (part, end, before) in BONES {
        for side in Side::BOTH {
            let ends = (body.joint(part, side), body.joint(end, side));
            let (Some(begin), Some(end)) = ends else { continue };
            if !led(begin) || !led(end) {
                continue;
            }
            let bone = rest[end] - rest[begin];
            let Some(axis) = bone.try_normalize() else { continue };
            // Forearm and shin twist with what is at their end, upper arm and thigh against what is before them.
            let outer = matches!(part, Part::LowerArm | Part::LowerLeg);
            let against = if outer { Some(end) } else { above(body, target, begin, before, side, &led) };
            let Some(against) = against else { continue };
            for joint in lying(target, (begin, end), &named, (part, side)) {
                if led(joint) || found.iter().any(|share: &Share| share.joint == joint) {
                    continue;
                }
                let along = ((rest[joint] - rest[begin]).dot(axis) / bone.length()).clamp(0.0, 1.0);
                // One that stands at the bone's beginning says nothing of its place.
                let along = if along < 0.05 { 0.5 } else { along };
                let part = if outer { along } else { along - 1.0 };
                found.push(Share { joint, bone: begin, against, part, axis, last: 0.0 });
            }
        }
    }
    // Parents before children: a share is laid on what stands above.
    found.sort_by_key(|share| share.joint);
    found
}

/// What an upper limb twists against: the joint before it that is led.
fn above(
    body: &Humanoid,
    target: &Skeleton,
    begin: usize,
    before: Part,
    side: Side,
    led: &dyn Fn(usize) -> bool,
) -> Option<usize> {
    let parent = |joint: &usize| target.joints().get(*joint).and_then(|joint| joint.parent);
    let named = body.joint(before, side).filter(|&joint| led(joint));
    named.or_else(|| std::iter::successors(parent(&begin), parent).find(|&joint| led(joint)))
}

/// Joints along a bone: between its two, or named as its twist joints and hanging on it.
fn lying(
    target: &Skeleton,
    (begin, end): (usize, usize),
    named: &[(usize, Part, Side)],
    of: (Part, Side),
) -> Vec<usize> {
    let parent = |joint: &usize| target.joints().get(*joint).and_then(|joint| joint.parent);
    let upwards = |joint: usize| std::iter::successors(parent(&joint), parent);
    let mut lying: Vec<usize> = upwards(end).take_while(|&joint| joint != begin).collect();
    let hangs = |joint: usize| upwards(joint).any(|above| above == begin);
    let twists = named.iter().filter(|twist| (twist.1, twist.2) == of && hangs(twist.0));
    lying.extend(twists.map(|twist| twist.0));
    lying
}

impl Share {
    /// The joint's world rotation at a frame, when all led joints have theirs.
    pub(super) fn turn(
        &mut self,
        turns: &[Option<Quat>],
        plan: &Plan,
        calibration: &Calibration,
    ) -> Option<Quat> {
        let stood = |joint: usize| {
            let place = plan.links.iter().position(|link| link.target == joint)?;
            calibration.target.get(place).copied()
        };
        let (bone, against) = (turns[self.bone]?, turns[self.against]?);
        let (bone_stood, against_stood) = (stood(self.bone)?, stood(self.against)?);
        // What the other is turned by, seen from the bone, against how both stood.
        let turned = bone * bone_stood.conjugate();
        let other = turned.conjugate() * against * against_stood.conjugate();
        let rest = calibration.rest.rotations[self.bone];
        let axis = bone_stood * rest.conjugate() * self.axis;
        let half = other.xyz().dot(axis).atan2(other.w);
        let mut twist = 2.0 * half;
        twist -= TAU * ((twist - self.last) / TAU).round();
        // Beyond three quarters of a turn it was a wrong way around.
        if twist.abs() > 1.5 * PI {
            twist -= TAU * twist.signum();
        }
        self.last = twist;
        let about = Quat::from_axis_angle(
            (bone * rest.conjugate() * self.axis).normalize_or(Vec3::X),
            self.part * twist,
        );
        Some((about * bone * rest.conjugate() * calibration.rest.rotations[self.joint]).normalize())
    }
}
