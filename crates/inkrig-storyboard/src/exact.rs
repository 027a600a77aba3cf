//! After sampling, a motion is moved until drawn ways and poses are met: by least change, with bones as long as they are, feet
//! that stand where they stand, and smoothly.
//!
//! What is moved are the root's place, the turns of pelvis and chest, and the directions of all other bones, so bone lengths hold
//! whatever happens. Goals are met by the method of multipliers (Nocedal and Wright 2006, algorithm 17.4), each round by L-BFGS.

mod body;
mod energy;

use body::Variables;
use energy::Energy;
use inkrig_generate::guidance::{Lbfgs, LbfgsOptions};
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{Camera, JOINTS, Joints};
use inkrig_motion::{Clip, kinematics};

/// A joint's place on a picture, at a frame of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Frame of the motion.
    pub frame: usize,
    /// Joint, 0 to 21.
    pub joint: usize,
    /// The picture's axes in the motion's world.
    pub axes: [Vec3; 2],
    /// The place along them, metres.
    pub at: Vec2,
    /// Whether it has to be met, or is only drawn to.
    pub firm: bool,
}

impl Goal {
    /// A place on the picture of a clip that was turned and shifted into the motion.
    pub fn placed(
        frame: usize,
        joint: usize,
        at: Vec2,
        camera: &Camera,
        (turn, shift): (Quat, Vec3),
        firm: bool,
    ) -> Self {
        let view = camera.view_from_world();
        let axes = [view.row(0), view.row(1)].map(|axis| turn * axis);
        let at = at + Vec2::new(axes[0].dot(shift), axes[1].dot(shift));
        Self { frame, joint, axes, at, firm }
    }

    /// How far a place is from it on the picture.
    pub fn miss(&self, place: Vec3) -> Vec2 {
        Vec2::new(self.axes[0].dot(place), self.axes[1].dot(place)) - self.at
    }
}

/// When goals are met well enough.
#[derive(Debug, Clone, PartialEq)]
pub struct MeetOptions {
    /// The largest miss that is fine, metres.
    pub tolerance: f32,
    /// Rounds at most.
    pub rounds: usize,
    /// Directions of a round.
    pub iterations: usize,
}

impl Default for MeetOptions {
    /// Half a centimetre, so that a centimetre is kept after the motion is written.
    fn default() -> Self {
        Self { tolerance: 0.005, rounds: 12, iterations: 60 }
    }
}

/// A motion that meets its goals, as far as it can.
#[derive(Debug, Clone, PartialEq)]
pub struct Met {
    /// All joints.
    pub motion: Vec<Joints>,
    /// Mean and largest miss of firm goals, before and after, metres.
    pub before: [f32; 2],
    /// See `before`.
    pub after: [f32; 2],
    /// How often the motion was looked at.
    pub evaluations: usize,
}

/// Moves a clip of the model's skeleton to its goals.
///
/// A clip of another skeleton stays as it is, as its misses say.
pub fn meet(clip: &Clip, goals: &[Goal], options: &MeetOptions) -> Met {
    let motion = joints_of(clip);
    let goals: Vec<Goal> =
        goals.iter().filter(|goal| goal.frame < motion.len() && goal.joint < JOINTS).copied().collect();
    let before = misses(&motion, &goals);
    if goals.is_empty() || clip.skeleton().len() != JOINTS {
        return Met { motion, before, after: before, evaluations: 0 };
    }
    let variables = Variables::of(clip);
    let mut x = variables.start(clip);
    let mut energy = Energy::new(&variables, &motion, &goals);
    let mut evaluations = 0;
    for _ in 0..options.rounds {
        let mut lbfgs = Lbfgs::new(LbfgsOptions {
            iterations: options.iterations,
            evaluations: 2 * options.iterations,
            history: 20,
            least_gradient: 1e-6,
            least_change: 1e-9,
            ..LbfgsOptions::default()
        });
        let Ok(_) = lbfgs.minimise(&mut x, &mut energy);
        evaluations += lbfgs.evaluations();
        if misses(&variables.joints(&x), &goals)[1] < options.tolerance {
            break;
        }
        energy.harden(&x);
    }
    let motion = variables.joints(&x);
    let after = misses(&motion, &goals);
    Met { motion, before, after, evaluations }
}

/// All joints of all frames.
pub(crate) fn joints_of(clip: &Clip) -> Vec<Joints> {
    let places = kinematics::positions(clip);
    (0..clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect()
}

/// Mean and largest miss of the firm goals.
pub fn misses(motion: &[Joints], goals: &[Goal]) -> [f32; 2] {
    let firm = goals.iter().filter(|goal| goal.firm);
    let off: Vec<f32> =
        firm.filter_map(|goal| Some(goal.miss(motion.get(goal.frame)?[goal.joint]).length())).collect();
    let mean = off.iter().sum::<f32>() / off.len().max(1) as f32;
    [mean, off.iter().copied().fold(0.0, f32::max)]
}

#[cfg(test)]
mod tests;
