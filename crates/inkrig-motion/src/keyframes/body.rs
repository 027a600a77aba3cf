//! Where all joints are in the world while one of them gets another curve.

use super::fit::{Numbers, SAMPLES};
use super::reference::{Reference, distance, length, unit};
use crate::Skeleton;
use glam::{DMat3, DQuat, DVec3};
use std::ops::Range;

/// Poses at every sample: as they should be, and as the keys make them.
pub(super) struct Body<'s> {
    skeleton: &'s Skeleton,
    /// For each joint all that hang on it, itself not among them.
    below: Vec<Vec<usize>>,
    /// Of those the ones that no other joint with a curve of its own can bring back to their places.
    near: Vec<Vec<usize>>,
    /// Samples x joints.
    wanted: Vec<Placed>,
    now: Vec<Placed>,
}

/// A joint in the world.
#[derive(Debug, Clone, Copy)]
struct Placed {
    place: DVec3,
    turn: DQuat,
}

/// How far what is there may be from what should be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Allowed {
    pub(super) metres: f64,
    /// Of rotations local to the parent.
    pub(super) radians: f64,
}

/// What is looked at when a joint gets another curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scope {
    /// All that hangs on it.
    All,
    /// What joints below cannot make up for, to a share of what is allowed.
    Near(f64),
}

impl<'s> Body<'s> {
    /// Poses of the samples `range` of the references; they are as they should be.
    pub(super) fn new(skeleton: &'s Skeleton, references: &[Reference], range: Range<usize>) -> Self {
        let joints = skeleton.len();
        let mut free = vec![false; joints];
        references.iter().filter(|reference| !reference.still).for_each(|r| free[r.joint] = true);
        let (mut below, mut near) = (vec![Vec::new(); joints], vec![Vec::new(); joints]);
        for joint in 0..joints {
            let mut direct = true;
            let mut above = skeleton.joints()[joint].parent;
            while let Some(index) = above {
                below[index].push(joint);
                if direct {
                    near[index].push(joint);
                }
                direct &= !free[index];
                above = skeleton.joints()[index].parent;
            }
        }
        let mut wanted: Vec<Placed> = Vec::with_capacity(range.len() * joints);
        let mut offsets: Vec<DVec3> = Vec::with_capacity(joints);
        let mut locals = vec![DQuat::IDENTITY; joints];
        for sample in range {
            offsets.clear();
            offsets.extend(skeleton.joints().iter().map(|joint| joint.offset.as_dvec3()));
            for reference in references {
                let Some(value) = reference.samples.get(sample) else { continue };
                if reference.turns {
                    locals[reference.joint] = DQuat::from_array(*value);
                } else {
                    offsets[reference.joint] = vector(value);
                }
            }
            let start = wanted.len();
            for (index, joint) in skeleton.joints().iter().enumerate() {
                let above = joint.parent.map_or(ORIGIN, |parent| wanted[start + parent]);
                let place = above.place + above.turn * offsets[index];
                wanted.push(Placed { place, turn: (above.turn * locals[index]).normalize() });
            }
        }
        Self { skeleton, below, near, now: wanted.clone(), wanted }
    }

    /// What a joint would have to do so that all below is where it should be, whatever the joints above do.
    /// `offset`: where the body's samples begin among those of the reference.
    pub(super) fn target(&self, reference: &Reference, offset: usize, allowed: Allowed) -> Vec<Numbers> {
        let (joint, joints) = (reference.joint, self.skeleton.len());
        let samples = self.now.chunks(joints).zip(self.wanted.chunks(joints));
        let values = samples.zip(reference.samples.iter().skip(offset)).map(|((now, wanted), local)| {
            let above = self.above(joint, now);
            if !reference.turns {
                let DVec3 { x, y, z } = above.turn.inverse() * (wanted[joint].place - above.place);
                return [x, y, z, 0.0];
            }
            // Its own rotation may be off only so far, and what is above has taken a part of that.
            let left = 0.9 * allowed.radians - angle_between(above.turn, self.above(joint, wanted).turn);
            let aim = self.aim(joint, now, wanted).clamp_length_max(left.max(0.0));
            let turn = above.turn.inverse() * DQuat::from_scaled_axis(aim) * wanted[joint].turn;
            let same_sign = turn.dot(DQuat::from_array(*local)) >= 0.0;
            unit((if same_sign { turn } else { -turn }).to_array())
        });
        values.collect()
    }

    /// The turn in the world by which a joint that is not in its place aims at where the joints near below it should be
    /// (least squares for small turns); none where one of them would be farther off than without.
    fn aim(&self, joint: usize, now: &[Placed], wanted: &[Placed]) -> DVec3 {
        let apart = now[joint].place - wanted[joint].place;
        let arms = || self.near[joint].iter().map(|&other| wanted[other].place - wanted[joint].place);
        let mut matrix = DMat3::from_diagonal(DVec3::splat(SHORT * SHORT));
        let mut moment = DVec3::ZERO;
        for arm in arms() {
            matrix += DMat3::from_diagonal(DVec3::splat(arm.length_squared()))
                - DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            moment += arm.cross(apart);
        }
        let turn = -(matrix.inverse() * moment);
        let worse = arms().any(|arm| (apart + turn.cross(arm)).length() > apart.length());
        if worse || !turn.is_finite() { DVec3::ZERO } else { turn }
    }

    /// What a joint would have to do so that all that hangs on it is on the whole nearest to where it should be, and the
    /// joint to its own rotation, while all others do what they do (least squares by what is allowed, for small turns).
    pub(super) fn centre(&self, reference: &Reference, offset: usize, allowed: Allowed) -> Vec<Numbers> {
        let (joint, joints) = (reference.joint, self.skeleton.len());
        let samples = self.now.chunks(joints).zip(self.wanted.chunks(joints));
        let values = samples.zip(reference.samples.iter().skip(offset)).map(|((now, wanted), local)| {
            let above = self.above(joint, now);
            let below = &self.below[joint];
            if !reference.turns {
                let apart = |joint: usize| wanted[joint].place - now[joint].place;
                let mean = (apart(joint) + below.iter().map(|&other| apart(other)).sum::<DVec3>())
                    / (below.len() + 1) as f64;
                let DVec3 { x, y, z } = above.turn.inverse() * (now[joint].place + mean - above.place);
                return [x, y, z, 0.0];
            }
            // What its own rotation should be where the joints above are.
            let own = above.turn * DQuat::from_array(*local);
            let weight = (allowed.metres / allowed.radians).powi(2);
            let mut matrix = DMat3::from_diagonal(DVec3::splat(weight));
            let off = now[joint].turn * own.inverse();
            let mut moment = weight * if off.w < 0.0 { -off } else { off }.to_scaled_axis();
            for &other in below {
                let arm = now[other].place - now[joint].place;
                matrix += DMat3::from_diagonal(DVec3::splat(arm.length_squared()))
                    - DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
                moment += arm.cross(now[other].place - wanted[other].place);
            }
            let turn = -(matrix.inverse() * moment);
            let turn = if turn.is_finite() { turn } else { DVec3::ZERO };
            let turn = above.turn.inverse() * DQuat::from_scaled_axis(turn) * now[joint].turn;
            let same_sign = turn.dot(DQuat::from_array(*local)) >= 0.0;
            unit((if same_sign { turn } else { -turn }).to_array())
        });
        values.collect()
    }

    fn above(&self, joint: usize, pose: &[Placed]) -> Placed {
        self.skeleton.joints()[joint].parent.map_or(ORIGIN, |parent| pose[parent])
    }

    /// The error at one sample by what is allowed, were the joint to do `value` there: the largest of its own rotation's and
    /// the places' of what hangs on it. Between two frames the straight way is as good as the curve, and more is allowed.
    /// `offset`: where the body's samples begin among those of the reference.
    pub(super) fn error(
        &self,
        reference: &Reference,
        (sample, offset): (usize, usize),
        value: &Numbers,
        (allowed, scope): (Allowed, Scope),
    ) -> f64 {
        let (joint, joints) = (reference.joint, self.skeleton.len());
        let between = !sample.is_multiple_of(SAMPLES);
        let mut worst = 0.0_f64;
        if reference.turns {
            let wanted = |step: usize| &reference.samples[offset + sample + step - 1];
            // Both signs are the same rotation.
            let sign = value.iter().zip(wanted(1)).map(|(a, b)| a * b).sum::<f64>().signum();
            let value = &value.map(|number| sign * number);
            let mut apart = distance(value, wanted(1));
            if between {
                apart = apart.min(from_line(value, wanted(0), wanted(2)));
            }
            worst = angle_of(apart) / allowed.radians;
        }
        let (share, others) = match scope {
            Scope::All => (1.0, &self.below[joint]),
            Scope::Near(share) => (share, &self.near[joint]),
        };
        let moved = self.moved(reference, sample, value);
        if let (Scope::Near(_), true, false) = (scope, reference.turns, between) {
            // What hangs on it has to turn back by as much.
            let turn = moved.turn * self.now[sample * joints + joint].turn;
            let apart = angle_between(turn, self.wanted[sample * joints + joint].turn);
            if !self.below[joint].is_empty() {
                worst = worst.max(apart / (0.9 * allowed.radians));
            }
        }
        let own = (!reference.turns).then_some(joint);
        let mut far = 0.0_f64;
        for &other in own.iter().chain(others) {
            let at = |step: usize| self.wanted[(sample + step - 1) * joints + other].place;
            let place = moved.place(self.now[sample * joints + other].place);
            let mut apart = place.distance(at(1));
            if between && apart > far {
                let (from, to) = (at(0), at(2));
                let way = to - from;
                let part = (place - from).dot(way) / way.length_squared().max(1e-300);
                apart = apart.min(place.distance(from + way * part.clamp(0.0, 1.0)));
            }
            far = far.max(apart);
        }
        let worst = worst.max(far / (share * allowed.metres));
        if between { worst / BETWEEN } else { worst }
    }

    /// Makes it so.
    pub(super) fn set(&mut self, reference: &Reference, first: usize, values: impl Iterator<Item = Numbers>) {
        for (sample, value) in (first..).zip(values) {
            let start = sample * self.skeleton.len();
            let moved = self.moved(reference, sample, &value);
            for &joint in [reference.joint].iter().chain(&self.below[reference.joint]) {
                let slot = &mut self.now[start + joint];
                *slot = Placed { place: moved.place(slot.place), turn: (moved.turn * slot.turn).normalize() };
            }
        }
    }

    /// Everything below a joint moves as one.
    fn moved(&self, reference: &Reference, sample: usize, value: &Numbers) -> Moved {
        let joint = reference.joint;
        let start = sample * self.skeleton.len();
        let above = self.skeleton.joints()[joint].parent.map_or(ORIGIN, |parent| self.now[start + parent]);
        let own = self.now[start + joint];
        if reference.turns {
            let turn = above.turn * DQuat::from_array(*value) * own.turn.inverse();
            Moved { pivot: own.place, turn, shift: DVec3::ZERO }
        } else {
            let shift = above.place + above.turn * vector(value) - own.place;
            Moved { pivot: DVec3::ZERO, turn: DQuat::IDENTITY, shift }
        }
    }
}

const ORIGIN: Placed = Placed { place: DVec3::ZERO, turn: DQuat::IDENTITY };

/// Shorter bones are hardly turned to make up for what is above them, metres.
const SHORT: f64 = 0.3;

/// How much more is allowed half way between two frames than on them.
const BETWEEN: f64 = 2.5;

struct Moved {
    pivot: DVec3,
    turn: DQuat,
    shift: DVec3,
}

impl Moved {
    fn place(&self, before: DVec3) -> DVec3 {
        self.pivot + self.turn * (before - self.pivot) + self.shift
    }
}

fn vector(value: &Numbers) -> DVec3 {
    DVec3::new(value[0], value[1], value[2])
}

/// From the straight way between two others.
fn from_line(value: &Numbers, from: &Numbers, to: &Numbers) -> f64 {
    let way: Numbers = std::array::from_fn(|i| to[i] - from[i]);
    let along: f64 = (0..4).map(|i| (value[i] - from[i]) * way[i]).sum();
    let part = (along / length(&way).powi(2).max(1e-300)).clamp(0.0, 1.0);
    distance(value, &std::array::from_fn(|i| from[i] + part * way[i]))
}

fn angle_between(a: DQuat, b: DQuat) -> f64 {
    angle_of((a - b).length().min((a + b).length()))
}

/// Of two rotations of unit length whose four numbers are so far apart, radians.
fn angle_of(apart: f64) -> f64 {
    4.0 * (0.5 * apart).min(1.0).asin()
}
