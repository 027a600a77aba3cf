//! What a change costs.

use super::Goal;
use super::body::{Variables, WIDTH};
use inkrig_generate::guidance::Objective;
use inkrig_motion::glam::{DVec2, DVec3, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints};
use std::convert::Infallible;

/// Weights of squared metres. Change of acceleration a frame: motion stays as smooth as it was.
const SMOOTH: f64 = 100.0;
/// Change of speed a frame.
const STEADY: f64 = 0.5;
/// Change of place relative to the pelvis, and of the pelvis.
const NEAR: f64 = 0.05;
const ROOT: f64 = 0.01;
/// Steps of a foot that stands.
const STAND: f64 = 40.0;
/// How far such a foot is from where it stood.
const STAY: f64 = 60.0;
/// Feet below the floor.
const FLOOR: f64 = 40.0;
/// Goals that are only drawn to.
const LOOSE: f64 = 1.0;
/// Goals that have to be met, in the first round, and how much more in every later one.
const FIRM: f64 = 20.0;
const HARDER: f64 = 2.0;
const HARDEST: f64 = 20_000.0;
/// Ankles and balls of the feet: how high they are, at most, while they stand, and where the floor is for them, metres.
const FEET: [(usize, f64, f64); 4] = [(7, 0.14, 0.04), (8, 0.14, 0.04), (10, 0.08, 0.0), (11, 0.08, 0.0)];
/// A foot that moves less than this in a frame may stand, metres.
const STILL: f64 = 0.02;

/// The sum of all costs, with its gradient.
pub(super) struct Energy<'a> {
    variables: &'a Variables,
    reference: Vec<[DVec3; JOINTS]>,
    goals: &'a [Goal],
    /// Of firm goals, as large as [`Energy::goals`].
    multipliers: Vec<DVec2>,
    weight: f64,
    /// Frames at which a foot stands until the next: frame and joint.
    stands: Vec<(usize, usize)>,
    poses: Vec<[DVec3; JOINTS]>,
    forces: Vec<[DVec3; JOINTS]>,
}

impl<'a> Energy<'a> {
    pub(super) fn new(variables: &'a Variables, motion: &[Joints], goals: &'a [Goal]) -> Self {
        let reference: Vec<[DVec3; JOINTS]> = motion.iter().map(|pose| pose.map(double)).collect();
        let asked = |frame: usize, joint: usize| {
            let near = |goal: &&Goal| goal.joint == joint && goal.frame.abs_diff(frame) < 2;
            goals.iter().any(|goal| goal.firm && near(&goal))
        };
        let mut stands = Vec::new();
        for (frame, pair) in reference.windows(2).enumerate() {
            for (joint, high, _) in FEET {
                let (here, next) = (pair[0][joint], pair[1][joint]);
                if here.y.max(next.y) < high && here.distance(next) < STILL && !asked(frame, joint) {
                    stands.push((frame, joint));
                }
            }
        }
        Self {
            variables,
            goals,
            multipliers: vec![DVec2::ZERO; goals.len()],
            weight: FIRM,
            stands,
            poses: Vec::new(),
            forces: vec![[DVec3::ZERO; JOINTS]; reference.len()],
            reference,
        }
    }

    /// After a round: multipliers take over what is still missed, and misses cost more.
    pub(super) fn harden(&mut self, x: &[f32]) {
        self.take(x);
        for (goal, multiplier) in self.goals.iter().zip(&mut self.multipliers).filter(|(goal, _)| goal.firm) {
            if let Some(pose) = self.poses.get(goal.frame) {
                *multiplier += self.weight * miss(goal, pose[goal.joint]);
            }
        }
        self.weight = (HARDER * self.weight).min(HARDEST);
    }

    fn take(&mut self, x: &[f32]) {
        self.poses.clear();
        self.poses.extend(x.chunks_exact(WIDTH).map(|x| self.variables.pose(x)));
    }

    fn change(&self, frame: usize, joint: usize) -> DVec3 {
        self.poses[frame][joint] - self.reference[frame][joint]
    }

    /// Costs of changes; forces go into `forces`.
    fn changes(&mut self) -> f64 {
        let mut sum = 0.0;
        for joint in 0..JOINTS {
            for frame in 0..self.poses.len() {
                let own = self.change(frame, joint);
                let (off, weight) =
                    if joint == 0 { (own, ROOT) } else { (own - self.change(frame, 0), NEAR) };
                sum += weight * off.length_squared();
                self.forces[frame][joint] += 2.0 * weight * off;
                if joint > 0 {
                    self.forces[frame][0] -= 2.0 * weight * off;
                }
                let Some(before) = frame.checked_sub(1) else { continue };
                let step = own - self.change(before, joint);
                sum += STEADY * step.length_squared();
                self.forces[frame][joint] += 2.0 * STEADY * step;
                self.forces[before][joint] -= 2.0 * STEADY * step;
                let Some(first) = before.checked_sub(1) else { continue };
                let bend = own - 2.0 * self.change(before, joint) + self.change(first, joint);
                sum += SMOOTH * bend.length_squared();
                self.forces[frame][joint] += 2.0 * SMOOTH * bend;
                self.forces[before][joint] -= 4.0 * SMOOTH * bend;
                self.forces[first][joint] += 2.0 * SMOOTH * bend;
            }
        }
        sum
    }

    fn feet(&mut self) -> f64 {
        let mut sum = 0.0;
        for at in 0..self.stands.len() {
            let (frame, joint) = self.stands[at];
            let step = self.poses[frame + 1][joint] - self.poses[frame][joint];
            sum += STAND * step.length_squared();
            self.forces[frame + 1][joint] += 2.0 * STAND * step;
            self.forces[frame][joint] -= 2.0 * STAND * step;
            let off = self.change(frame, joint);
            sum += STAY * off.length_squared();
            self.forces[frame][joint] += 2.0 * STAY * off;
        }
        for (pose, (forces, reference)) in self.poses.iter().zip(self.forces.iter_mut().zip(&self.reference))
        {
            for (joint, _, floor) in FEET {
                // What was below the floor before is not this step's to lift.
                let low = pose[joint].y - floor.min(reference[joint].y);
                if low < 0.0 {
                    sum += FLOOR * low * low;
                    forces[joint].y += 2.0 * FLOOR * low;
                }
            }
        }
        sum
    }

    fn goals(&mut self) -> f64 {
        let mut sum = 0.0;
        for (goal, multiplier) in self.goals.iter().zip(&self.multipliers) {
            let miss = miss(goal, self.poses[goal.frame][goal.joint]);
            let (weight, multiplier) =
                if goal.firm { (self.weight, *multiplier) } else { (LOOSE, DVec2::ZERO) };
            sum += 0.5 * weight * miss.length_squared() + multiplier.dot(miss);
            let by = weight * miss + multiplier;
            let force = goal.axes[0].as_dvec3() * by.x + goal.axes[1].as_dvec3() * by.y;
            self.forces[goal.frame][goal.joint] += force;
        }
        sum
    }
}

fn double(place: Vec3) -> DVec3 {
    place.as_dvec3()
}

fn miss(goal: &Goal, place: DVec3) -> DVec2 {
    let along = goal.axes.map(|axis| axis.as_dvec3().dot(place));
    DVec2::new(along[0], along[1]) - goal.at.as_dvec2()
}

impl Objective for Energy<'_> {
    type Error = Infallible;

    fn evaluate(&mut self, x: &[f32], gradient: &mut [f32]) -> Result<f64, Infallible> {
        self.take(x);
        self.forces.iter_mut().for_each(|forces| *forces = [DVec3::ZERO; JOINTS]);
        let sum = self.changes() + self.feet() + self.goals();
        gradient.fill(0.0);
        let frames = x.chunks_exact(WIDTH).zip(gradient.chunks_exact_mut(WIDTH));
        for ((x, gradient), forces) in frames.zip(&mut self.forces) {
            self.variables.gradient(x, forces, gradient);
        }
        Ok(sum)
    }
}
