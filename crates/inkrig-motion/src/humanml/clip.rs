//! From 22 positions a frame to a clip that a rig can use: bone lengths exact, joints turned as people's are.
//!
//! Positions say where bones point, not how they are turned about themselves. Pelvis and chest are fitted to their
//! three neighbours, the spine shares the twist between them, upper arms and thighs are turned so that elbows and
//! knees bend as hinges; where a limb is straight, its twist is taken from the frames around.

use super::body::check;
use super::bones::double;
use super::facing::Pose;
use super::{JOINTS, Joints, NAMES, Offsets, PARENTS};
use crate::orientation::{best_rotation, between};
use crate::{Clip, Joint, MotionError, Skeleton, TranslationTrack};
use glam::{DQuat, DVec3, Vec3};
use std::sync::Arc;

/// Directions of the bones in the rest pose of the clips, a T-pose that faces +z.
const REST: Joints = [
    Vec3::ZERO,
    Vec3::new(0.7, -0.714, 0.0),
    Vec3::new(-0.7, -0.714, 0.0),
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::Y,
    Vec3::Z,
    Vec3::Z,
    Vec3::Y,
    Vec3::new(0.6, 0.8, 0.0),
    Vec3::new(-0.6, 0.8, 0.0),
    Vec3::Y,
    Vec3::X,
    Vec3::NEG_X,
    Vec3::X,
    Vec3::NEG_X,
    Vec3::X,
    Vec3::NEG_X,
];

/// Limbs that bend as hinges, each from the joint that is turned about its bone to the last, with the axis that the
/// second joint bends about in the rest pose.
const HINGES: [(&[usize], DVec3); 4] = [
    (&[1, 4, 7, 10], DVec3::X),
    (&[2, 5, 8, 11], DVec3::X),
    (&[16, 18, 20], DVec3::NEG_Y),
    (&[17, 19, 21], DVec3::Y),
];

/// Sines of the bends between which a hinge begins to count: 8 and 25 degrees.
const BENDS: (f64, f64) = (0.139, 0.423);

/// Frames over which twists are averaged, as a standard deviation, and how much an unturned limb counts there.
const TWIST_SIGMA: f64 = 2.0;
const UNTURNED: f64 = 0.02;

/// Joints that are fitted to three neighbours: pelvis and chest.
const HUBS: [(usize, [usize; 3]); 2] = [(0, [1, 2, 3]), (9, [12, 13, 14])];

/// The skeleton of a body in its T-pose, metres. Where hips and collars stand in pelvis and chest is taken from the
/// mean of `like`; for no frames it is that of an average person.
///
/// # Errors
/// When a bone length or a position is not finite.
pub fn skeleton(body: &Offsets, like: &[Joints]) -> Result<Skeleton, MotionError> {
    check(like)?;
    let mut directions = REST.map(|direction| direction.as_dvec3().normalize_or_zero());
    for (hub, children) in HUBS {
        // Fitted to directions that are better each time; three times is more than enough.
        for _ in 0..3 {
            let mut sums = [DVec3::ZERO; 3];
            let mut turn = DQuat::IDENTITY;
            for joints in like {
                let pose = double(joints);
                let seen = children.map(|child| (pose[child] - pose[hub]).normalize_or_zero());
                let pairs: [(DVec3, DVec3); 3] =
                    std::array::from_fn(|index| (directions[children[index]], seen[index]));
                turn = best_rotation(&pairs, turn);
                sums.iter_mut().zip(seen).for_each(|(sum, direction)| *sum += turn.conjugate() * direction);
            }
            for (child, sum) in children.into_iter().zip(sums) {
                directions[child] = sum.try_normalize().unwrap_or(directions[child]);
            }
        }
    }
    let joint = |index: usize| {
        let parent = (index > 0).then(|| PARENTS[index]);
        Joint::new(NAMES[index], parent, directions[index].as_vec3() * body[index].length())
    };
    Skeleton::new((0..JOINTS).map(joint).collect())
}

/// A clip of positions on a [`skeleton`]. Bones have its lengths; each points from where it begins to where the
/// position of its end is, so positions of another body are met as nearly as its lengths allow.
///
/// # Errors
/// When there is no frame, a number is not finite, the skeleton is not one of these, or the rate is none that a clip
/// may have.
pub fn to_clip(frames: &[Joints], skeleton: &Arc<Skeleton>, frame_rate: f64) -> Result<Clip, MotionError> {
    check(frames)?;
    if skeleton.len() != JOINTS {
        return Err(MotionError::Length { what: "the joints", expected: JOINTS, got: skeleton.len() });
    }
    let rest: Pose = std::array::from_fn(|joint| skeleton.joints()[joint].offset.as_dvec3());
    let mut before = [DQuat::IDENTITY; JOINTS];
    let mut world = Vec::with_capacity(frames.len());
    for joints in frames {
        before = orient(&double(joints), &rest, &before);
        world.push(before);
    }
    for (limb, axis) in HINGES {
        twist(&mut world, &rest, limb, axis);
    }
    let mut rotations = Vec::with_capacity(frames.len() * JOINTS);
    for turns in &world {
        rotations.push(turns[0].as_quat());
        rotations
            .extend((1..JOINTS).map(|joint| (turns[PARENTS[joint]].conjugate() * turns[joint]).as_quat()));
    }
    let values = frames.iter().map(|joints| joints[0]).collect();
    Clip::new(Arc::clone(skeleton), frame_rate, rotations, vec![TranslationTrack { joint: 0, values }])
}

/// World rotations of all joints at a frame, from the root outwards.
fn orient(target: &Pose, rest: &Pose, before: &[DQuat; JOINTS]) -> [DQuat; JOINTS] {
    let mut turns = [DQuat::IDENTITY; JOINTS];
    let mut places = [target[0]; JOINTS];
    let fit = |joint: usize, children: [usize; 3], from: DVec3| {
        let pair =
            |child: usize| (rest[child].normalize_or_zero(), (target[child] - from).normalize_or_zero());
        best_rotation(&children.map(pair), before[joint])
    };
    let [(_, pelvis), (_, chest)] = HUBS;
    turns[0] = fit(0, pelvis, target[0]);
    for joint in 1..JOINTS {
        let parent = PARENTS[joint];
        places[joint] = places[parent] + turns[parent] * rest[joint];
        let only_child = match joint {
            9 => {
                turns[9] = fit(9, chest, places[9]);
                continue;
            }
            // The head, the feet and the hands have nothing to point to: they go along.
            10 | 11 | 15 | 20 | 21 => {
                turns[joint] = turns[parent];
                continue;
            }
            joint => (joint + 1..JOINTS).find(|&child| PARENTS[child] == joint),
        };
        let Some(child) = only_child else { continue };
        let now = turns[parent] * rest[child].normalize_or_zero();
        turns[joint] = between(now, (target[child] - places[joint]).normalize_or_zero()) * turns[parent];
    }
    share_spine_twist(&mut turns);
    turns
}

/// The lower spine joints only bend so far; each takes its share of how the chest is turned against the pelvis.
fn share_spine_twist(turns: &mut [DQuat; JOINTS]) {
    let difference = turns[6].conjugate() * turns[9];
    let angle = 2.0 * difference.y.atan2(difference.w);
    let angle = (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    for (joint, share) in [(3, 1.0 / 3.0), (6, 2.0 / 3.0)] {
        turns[joint] *= DQuat::from_rotation_y(angle * share);
    }
}

/// Turns the first joint of a limb about its bone so that the second bends about its hinge. All bones stay where they
/// point; the joints after the first go along.
fn twist(world: &mut [[DQuat; JOINTS]], rest: &Pose, limb: &[usize], hinge: DVec3) {
    let [upper, lower, ..] = *limb else { return };
    let bone = rest[lower].normalize_or_zero();
    let wanted: Vec<(f64, f64)> = world
        .iter()
        .map(|turns| {
            // Where the lower bone points, seen from the upper joint: both bones lie along one line at rest.
            let bent = turns[upper].conjugate() * (turns[lower] * bone);
            let axis = bone.cross(bent);
            let part = ((axis.length() - BENDS.0) / (BENDS.1 - BENDS.0)).clamp(0.0, 1.0);
            let weight = part * part * (3.0 - 2.0 * part);
            let angle = hinge.cross(axis).dot(bone).atan2(hinge.dot(axis));
            (weight * angle.cos() + UNTURNED, weight * angle.sin())
        })
        .collect();
    let reach = (3.0 * TWIST_SIGMA) as usize;
    for (frame, turns) in world.iter_mut().enumerate() {
        let near = frame.saturating_sub(reach)..(frame + reach + 1).min(wanted.len());
        let (cos, sin) = near.fold((0.0, 0.0), |sum, other| {
            let weight = (-0.5 * (other.abs_diff(frame) as f64 / TWIST_SIGMA).powi(2)).exp();
            (sum.0 + weight * wanted[other].0, sum.1 + weight * wanted[other].1)
        });
        turns[upper] *= DQuat::from_axis_angle(bone, sin.atan2(cos));
        for triple in limb.windows(3) {
            let (parent, joint, child) = (triple[0], triple[1], triple[2]);
            let along = rest[child].normalize_or_zero();
            turns[joint] = between(turns[parent] * along, turns[joint] * along) * turns[parent];
        }
        if let [.., before, last] = *limb {
            turns[last] = turns[before];
        }
    }
}
