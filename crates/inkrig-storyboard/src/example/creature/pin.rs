//! Drawn ways met: the body as a whole by a shift in the picture, ends of limbs by turning the joints above them.

use crate::error::StoryboardError;
use crate::exact::Goal;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, TranslationTrack, ground, kinematics};

/// A limb is turned at most at so many joints.
const CHAIN: usize = 4;
/// Rounds of turning, and when a place is near enough, as a share of the body.
const ROUNDS: usize = 40;
const NEAR: f32 = 1e-3;
/// A turn fades in and out over so many seconds where its way begins and ends.
const FADE: f64 = 0.3;

/// The share of a shift at the end of a way that is left so many frames later: it is given back over a second.
pub(super) fn left(rate: f64, frames: usize) -> f32 {
    (1.0 - 1.0 / rate.max(1.0)).powf(frames as f64) as f32
}

/// Shifts the body so that the goals of the joint that carries it are met. What is shifted at the end of a way is given [back](left).
pub(super) fn carried(clip: &Clip, goals: &[Goal]) -> Result<Clip, StoryboardError> {
    let joint = clip.travel_joint();
    let places = kinematics::positions(clip);
    let mut by = vec![Vec3::ZERO; clip.frames()];
    let mut before = Vec3::ZERO;
    let keep = left(clip.frame_rate(), 1);
    for (frame, by) in by.iter_mut().enumerate() {
        let goal = goals.iter().find(|goal| goal.frame == frame && goal.joint == joint);
        before = match (goal, places.frame(frame).get(joint)) {
            (Some(goal), Some(place)) => goal.nearest(*place) - *place,
            _ => before * keep,
        };
        *by = before;
    }
    Ok(ground::shift(clip, joint, &by)?)
}

/// Turns the joints above a joint so that its goals are met as far as they reach (cyclic coordinate descent).
pub(super) fn reached(clip: &Clip, joint: usize, goals: &[Goal]) -> Result<Clip, StoryboardError> {
    let joints = clip.skeleton().joints();
    let carrier = clip.travel_joint();
    let mut chain = Vec::new();
    let mut above = joints.get(joint).and_then(|joint| joint.parent);
    while let Some(parent) = above.filter(|parent| *parent != carrier && chain.len() < CHAIN) {
        chain.push(parent);
        above = joints[parent].parent;
    }
    let own: Vec<&Goal> =
        goals.iter().filter(|goal| goal.joint == joint && goal.frame < clip.frames()).collect();
    if own.is_empty() {
        return Ok(clip.clone());
    }
    let near = NEAR * clip.skeleton().extent();
    let count = joints.len();
    let mut rotations: Vec<Quat> =
        (0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied()).collect();
    let mut world = Vec::new();
    let mut turns: Vec<Vec<Quat>> = vec![vec![Quat::IDENTITY; chain.len()]; clip.frames()];
    for goal in &own {
        let mut locals = clip.rotations(goal.frame).to_vec();
        let mut offsets = vec![Vec3::ZERO; count];
        clip.local_translations(goal.frame, &mut offsets);
        for _ in 0..ROUNDS {
            place(joints, &locals, &offsets, &mut world);
            let miss = goal.miss(world[joint].1);
            if miss.length() < near {
                break;
            }
            let target = goal.nearest(world[joint].1);
            for &turned in &chain {
                place(joints, &locals, &offsets, &mut world);
                let (at, end) = (world[turned].1, world[joint].1);
                let (from, to) = ((end - at).normalize_or_zero(), (target - at).normalize_or_zero());
                if from == Vec3::ZERO || to == Vec3::ZERO {
                    continue;
                }
                // Half of the way, so that all joints take part.
                let turn = Quat::IDENTITY.slerp(Quat::from_rotation_arc(from, to), 0.5);
                let parent = joints[turned].parent.map_or(Quat::IDENTITY, |parent| world[parent].0);
                locals[turned] = (parent.inverse() * turn * parent * locals[turned]).normalize();
            }
        }
        for (number, &turned) in chain.iter().enumerate() {
            turns[goal.frame][number] = locals[turned] * clip.rotations(goal.frame)[turned].inverse();
        }
    }
    let fade = (FADE * clip.frame_rate()).max(1.0) as f32;
    let mut known: Vec<usize> = own.iter().map(|goal| goal.frame).collect();
    known.sort_unstable();
    known.dedup();
    for frame in 0..clip.frames() {
        // What stands nearest decides, also between two ways.
        let after = known.partition_point(|at| *at < frame);
        let sides = [known.get(after), after.checked_sub(1).and_then(|before| known.get(before))];
        let Some(nearest) = sides.into_iter().flatten().copied().min_by_key(|at| at.abs_diff(frame)) else {
            continue;
        };
        let away = nearest.abs_diff(frame);
        let t = (1.0 - away as f32 / fade).max(0.0);
        for (number, &turned) in chain.iter().enumerate() {
            let turn = Quat::IDENTITY.slerp(turns[nearest][number], t * t * (3.0 - 2.0 * t));
            let own = &mut rotations[frame * count + turned];
            *own = (turn * *own).normalize();
        }
    }
    let tracks: Vec<TranslationTrack> = clip.translations().to_vec();
    Ok(Clip::new(clip.skeleton().clone(), clip.frame_rate(), rotations, tracks)?)
}

/// Turn and place of every joint in the world.
fn place(joints: &[inkrig_motion::Joint], locals: &[Quat], offsets: &[Vec3], world: &mut Vec<(Quat, Vec3)>) {
    world.clear();
    for (number, joint) in joints.iter().enumerate() {
        let (turn, at) = joint
            .parent
            .and_then(|parent| world.get(parent).copied())
            .unwrap_or((Quat::IDENTITY, Vec3::ZERO));
        world.push((turn * locals[number], at + turn * offsets[number]));
    }
}
