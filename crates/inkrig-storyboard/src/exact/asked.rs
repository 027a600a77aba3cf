//! What a motion is moved for.

use super::Constraint;
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{Camera, JOINTS, Joints};

/// How much more others hold still than the limb of a joint that is put in space.
const STIFF: f64 = 20.0;
/// At so many frames from a place in space, frames stay as they are by so much more.
const NEARBY: (f64, f64) = (8.0, 50.0);

/// What a goal comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A trajectory.
    Way,
    /// A way over the ground that was taken over from another clip.
    Path,
    /// A joint that the user has placed on the picture.
    Pin,
    /// A joint that was read of the figure: it gives way to the others where a body cannot have all.
    Pose,
    /// A joint that the user has placed in space. It is met whatever the drawing counts.
    Edit,
}

/// A joint's place at a frame of a motion, on a picture or in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Frame of the motion.
    pub frame: usize,
    /// Joint of the skeleton: of the model's, 0 to 21.
    pub joint: usize,
    /// The picture's axes in the motion's world.
    pub axes: [Vec3; 2],
    /// The place along them, metres.
    pub at: Vec2,
    /// Towards the viewer, and the place along that; a picture alone does not say it.
    pub away: Option<(Vec3, f32)>,
    /// What asks for it.
    pub source: Source,
}

impl Goal {
    /// A place on the picture of a clip that was turned and shifted into the motion.
    pub fn placed(
        frame: usize,
        joint: usize,
        at: Vec2,
        camera: &Camera,
        (turn, shift): (Quat, Vec3),
        source: Source,
    ) -> Self {
        let view = camera.view_from_world();
        let axes = [view.row(0), view.row(1)].map(|axis| turn * axis);
        let at = at + Vec2::new(axes[0].dot(shift), axes[1].dot(shift));
        Self { frame, joint, axes, at, away: None, source }
    }

    /// A place in the space of such a clip.
    pub fn in_space(
        frame: usize,
        joint: usize,
        at: Vec3,
        camera: &Camera,
        (turn, shift): (Quat, Vec3),
    ) -> Self {
        let view = camera.view_from_world();
        let [right, up, near] = [0, 1, 2].map(|axis| turn * view.row(axis));
        let at = turn * at + shift;
        let (seen, away) = (Vec2::new(right.dot(at), up.dot(at)), Some((near, near.dot(at))));
        Self { frame, joint, axes: [right, up], at: seen, away, source: Source::Edit }
    }

    /// How far a place is from it, along its axes; 0 along one that does not count.
    pub fn miss(&self, place: Vec3) -> Vec3 {
        let away = self.away.map_or(0.0, |(axis, at)| axis.dot(place) - at);
        (Vec2::new(self.axes[0].dot(place), self.axes[1].dot(place)) - self.at).extend(away)
    }

    /// The place nearest to another that meets it.
    pub fn nearest(&self, place: Vec3) -> Vec3 {
        let axes = self.measured().map(|(axis, _)| axis).zip(self.miss(place).to_array());
        axes.fold(place, |place, (axis, off)| place - off * axis)
    }

    /// Axes that count, and the place along each.
    pub(super) fn measured(&self) -> impl Iterator<Item = (Vec3, f32)> {
        self.axes.into_iter().zip(self.at.to_array()).chain(self.away)
    }
}

/// Goals, what holds, and what stays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked<'a> {
    /// Places of joints.
    pub goals: &'a [Goal],
    /// What holds over frames.
    pub constraints: &'a [Constraint],
    /// Frames that stay as they are, for each; none beyond the end.
    pub frozen: &'a [bool],
}

impl Asked<'_> {
    /// Whether a joint is put on a plane or a box.
    pub(super) fn on_something(&self, frame: usize, joint: usize) -> bool {
        let on = |constraint: &Constraint| {
            constraint.rule.on() == Some(joint) && constraint.frames.contains(&frame)
        };
        self.constraints.iter().any(on)
    }

    /// Whether it is said where in space each joint is, for so many frames.
    pub(super) fn held(&self, frames: usize) -> Vec<[bool; JOINTS]> {
        let mut held = vec![[false; JOINTS]; frames];
        let on = self.constraints.iter().filter_map(|own| Some((own.rule.on()?, own.frames.clone())));
        let put = self.edits().map(|goal| (goal.joint, goal.frame..goal.frame + 1));
        for (joint, own) in on.chain(put) {
            let own = own.start.min(frames)..own.end.min(frames);
            held[own].iter_mut().filter_map(|held| held.get_mut(joint)).for_each(|held| *held = true);
        }
        held
    }

    /// The largest miss of places in space, and, where `drawn` counts, of all that is asked for, metres.
    pub(super) fn worst(&self, motion: &[Joints], standing: &[[bool; 2]], drawn: bool) -> f32 {
        let goals = self.goals.iter().filter(|goal| drawn || goal.source == Source::Edit);
        let goals = goals.filter_map(|goal| Some(goal.miss(motion.get(goal.frame)?[goal.joint]).length()));
        let held = self.constraints.iter().filter(|_| drawn);
        let held = held.filter_map(|constraint| constraint.miss(motion, standing)).map(|(miss, _)| miss);
        goals.chain(held).fold(0.0, f32::max)
    }

    pub(super) fn edits(&self) -> impl Iterator<Item = &Goal> {
        self.goals.iter().filter(|goal| goal.source == Source::Edit)
    }

    /// Where joints were put in space, frames that are farther from these change less: the factors of their weights.
    pub(super) fn stays(&self, frames: usize) -> Vec<f64> {
        let mut edited: Vec<usize> = self.edits().map(|goal| goal.frame).collect();
        edited.sort_unstable();
        let factor = |frame: usize| {
            let after = edited.partition_point(|edit| *edit < frame);
            let sides = [edited.get(after), after.checked_sub(1).and_then(|before| edited.get(before))];
            let near = sides.into_iter().flatten().map(|edit| edit.abs_diff(frame)).min();
            near.map_or(1.0, |near| 1.0 + NEARBY.1 * (near as f64 / NEARBY.0).powi(4))
        };
        (0..frames).map(factor).collect()
    }

    /// Where joints were put in space, what changes are their limbs.
    pub(super) fn stiffen(&self, weights: &mut [f64; JOINTS]) {
        let mut own = [false; JOINTS];
        let mut any = false;
        for goal in self.edits() {
            let limb = LIMBS.iter().find(|limb| limb.contains(&goal.joint));
            // Pelvis and hips are everything's.
            let Some(limb) = limb else { return };
            limb.iter().for_each(|joint| own[*joint] = true);
            any = true;
        }
        if any {
            weights.iter_mut().zip(own).filter(|(_, own)| !own).for_each(|(weight, _)| *weight *= STIFF);
        }
    }
}

/// Joints that move with each other: arms, legs, trunk and head.
const LIMBS: [&[usize]; 5] =
    [&[16, 18, 20], &[17, 19, 21], &[4, 7, 10], &[5, 8, 11], &[3, 6, 9, 12, 13, 14, 15]];
