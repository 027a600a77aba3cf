//! The person: walks, turns, waves, crouches and sways, each from small to large.
//!
//! The footsteps come first. Where the hips are follows from where the feet are, how the trunk and the arms swing
//! follows from how far the feet are apart, and the script's acting is laid over it.

mod acting;
mod footsteps;
mod limbs;
mod script;

use super::{
    ease::{gaussian, lag, lowest},
    figure::{FRAME_RATE, Pose, Rig, ahead, left_of, turn},
};
use acting::Acting;
use footsteps::{BALL, BALL_HEIGHT, Foot};
use inkrig_motion::{
    Clip, MotionError,
    glam::{DQuat, DVec3},
};
use script::Script;

const THIGH: f64 = 0.42;
const SHANK: f64 = 0.41;
const HIP: DVec3 = DVec3::new(0.09, -0.045, 0.0);
/// Height of the hips' joint of a person who stands with knees hardly bent, metres.
const STANDING: f64 = 0.951;
const SIDES: [&str; 2] = ["Left", "Right"];

/// The motion, 24 seconds.
///
/// # Errors
/// Never in practice: when a computed number is not finite.
pub fn clip() -> Result<Clip, MotionError> {
    let rig = rig();
    let body = Body::new();
    let poses: Vec<Pose<'_>> = (0..body.frames()).map(|frame| body.pose(&rig, frame)).collect();
    rig.clip(&poses)
}

/// 22 joints and 5 tips, 1.72 m tall, arms out to the sides, facing +z.
fn rig() -> Rig {
    let mut rig = Rig::default();
    rig.joint("Hips", "", [0.0, 0.955, 0.0]);
    rig.joint("Spine", "Hips", [0.0, 0.09, -0.005]);
    rig.joint("Spine1", "Spine", [0.0, 0.12, 0.0]);
    rig.joint("Chest", "Spine1", [0.0, 0.13, 0.0]);
    rig.joint("Neck", "Chest", [0.0, 0.195, -0.01]);
    rig.joint("Head", "Neck", [0.0, 0.09, 0.02]);
    rig.end("Head", [0.0, 0.14, 0.0]);
    for (side, sign) in SIDES.into_iter().zip([1.0, -1.0]) {
        let name = |part: &str| format!("{side}{part}");
        rig.joint(&name("Shoulder"), "Chest", [0.03 * sign, 0.15, 0.0]);
        rig.joint(&name("Arm"), &name("Shoulder"), [0.145 * sign, 0.0, -0.01]);
        rig.joint(&name("ForeArm"), &name("Arm"), [0.28 * sign, 0.0, 0.0]);
        rig.joint(&name("Hand"), &name("ForeArm"), [0.25 * sign, 0.0, 0.0]);
        rig.end(&name("Hand"), [0.15 * sign, 0.0, 0.0]);
    }
    for (side, sign) in SIDES.into_iter().zip([1.0, -1.0]) {
        let name = |part: &str| format!("{side}{part}");
        rig.joint(&name("UpLeg"), "Hips", [HIP.x * sign, HIP.y, HIP.z]);
        rig.joint(&name("Leg"), &name("UpLeg"), [0.0, -THIGH, 0.0]);
        rig.joint(&name("Foot"), &name("Leg"), [0.0, -SHANK, 0.0]);
        rig.joint(&name("Toe"), &name("Foot"), BALL.to_array());
        rig.end(&name("Toe"), [0.0, 0.01 - BALL_HEIGHT, 0.07]);
    }
    rig
}

/// Everything that varies over time, one value a frame.
struct Body {
    acting: Vec<Acting>,
    feet: [Vec<Foot>; 2],
    place: [Vec<f64>; 3],
    heading: Vec<f64>,
    /// Heading a moment later: where the eyes go.
    seen: Vec<f64>,
    speed: Vec<f64>,
    /// How far the left foot is ahead of the right one, metres.
    lead: Vec<f64>,
    /// The same a moment ago, for the arms.
    lead_late: Vec<f64>,
    /// The weight on the left foot less that on the right one, -1..=1.
    weight: Vec<f64>,
    /// Lean into the curve, radians, to the left.
    banking: Vec<f64>,
    /// Lean with the acceleration, radians, ahead.
    pushing: Vec<f64>,
    /// The bounce of the hips, metres, for what hangs and follows late.
    bounce: Vec<f64>,
}

impl Body {
    fn new() -> Self {
        let times: Vec<f64> =
            (0..=(script::LENGTH * FRAME_RATE) as usize).map(|frame| frame as f64 / FRAME_RATE).collect();
        let script = Script::new();
        let acting: Vec<Acting> = times.iter().map(|&time| script.at(time)).collect();
        let heels: Vec<f64> = acting.iter().map(|acting| acting.heels).collect();
        let steps = script::footsteps();
        let feet = [steps.poses(0, &times, &heels), steps.poses(1, &times, &heels)];
        let both = |pick: fn(&Foot) -> f64| -> Vec<f64> {
            feet[0].iter().zip(&feet[1]).map(|(left, right)| 0.5 * (pick(left) + pick(right))).collect()
        };
        let heading = gaussian(&both(|foot| foot.yaw), 4.5);
        let middle = [gaussian(&both(|foot| foot.base.x), 4.5), gaussian(&both(|foot| foot.base.z), 4.5)];
        let weight = gaussian(&differences(&feet, |_, foot| foot.support), 3.2);
        let lead = gaussian(&differences(&feet, |frame, foot| foot.base.dot(ahead(heading[frame]))), 1.8);
        let apart = differences(&feet, |frame, foot| foot.base.dot(left_of(heading[frame])));
        let speed: Vec<f64> =
            rates(&middle[0]).iter().zip(rates(&middle[1])).map(|(x, z)| x.hypot(z)).collect();
        let speed = gaussian(&speed, 4.0);
        let yaw_rate = gaussian(&rates(&heading), 5.0);
        let banking = speed.iter().zip(&yaw_rate).map(|(speed, rate)| 0.055 * speed * rate).collect();
        let pushing = gaussian(&rates(&speed), 5.0).iter().map(|rate| 0.045 * rate).collect();
        let mut body = Self {
            seen: lag(&heading, -8.0),
            lead_late: lag(&lead, 1.2),
            bounce: Vec::new(),
            place: [middle[0].clone(), vec![0.0; times.len()], middle[1].clone()],
            acting,
            feet,
            heading,
            speed,
            lead,
            weight,
            banking,
            pushing,
        };
        body.shift(&apart);
        body.raise();
        body
    }

    fn frames(&self) -> usize {
        self.heading.len()
    }

    /// Moves the hips over the foot that carries, ahead with the speed of a walk, and where the acting wants them.
    fn shift(&mut self, apart: &[f64]) {
        for (frame, apart) in apart.iter().enumerate() {
            let acting = &self.acting[frame];
            let carried = 0.5 * apart * self.weight[frame] * (0.62 - 0.12 * self.speed[frame]);
            let (left, front) = (left_of(self.heading[frame]), ahead(self.heading[frame]));
            let moved =
                left * (carried + acting.sway[0]) + front * (acting.sway[1] + 0.036 * self.speed[frame]);
            self.place[0][frame] += moved.x;
            self.place[2][frame] += moved.z;
        }
    }

    /// Finds the height of the hips: what the acting wants, as far as both legs reach the ground.
    fn raise(&mut self) {
        /// How far a leg stretches at most, of its full length.
        const REACH: f64 = 0.98;
        const SOFT: f64 = 0.01;
        let wanted: Vec<f64> = self.acting.iter().map(|acting| STANDING - acting.crouch).collect();
        let heights: Vec<f64> = (gaussian(&wanted, 1.5).into_iter().enumerate())
            .map(|(frame, wanted)| {
                let pelvis = self.pelvis(frame);
                let limits = [0, 1].map(|side| {
                    let hip = pelvis * mirrored(HIP, side);
                    let ankle = self.feet[side][frame].ankle;
                    let across = (self.place[0][frame] + hip.x - ankle.x)
                        .hypot(self.place[2][frame] + hip.z - ankle.z);
                    let length = REACH * (THIGH + SHANK);
                    ankle.y + (length * length - across * across).max(0.0).sqrt() - hip.y
                });
                // The smooth minimum of the three.
                let lowest = wanted.min(limits[0]).min(limits[1]);
                let terms = [wanted, limits[0], limits[1]].map(|height| (-(height - lowest) / SOFT).exp());
                lowest - SOFT * terms.iter().sum::<f64>().ln()
            })
            .collect();
        // No leg may be pulled off the ground by the smoothing.
        self.place[1] = gaussian(&lowest(&heights, 2), 1.4);
        let slow = gaussian(&self.place[1], 9.0);
        let bounce: Vec<f64> = self.place[1].iter().zip(&slow).map(|(height, slow)| height - slow).collect();
        self.bounce = lag(&gaussian(&bounce, 1.5), 2.2);
    }

    /// World rotation of the hips.
    fn pelvis(&self, frame: usize) -> DQuat {
        let acting = &self.acting[frame];
        let [ahead, aside, twist] = acting.trunk;
        turn(
            self.heading[frame] - 0.17 * self.lead[frame] - 0.35 * twist,
            0.3 * ahead + 0.02 + 0.02 * self.speed[frame],
            0.065 * self.weight[frame] * (0.4 + 0.6 * self.speed[frame].min(1.0)) - 0.4 * self.banking[frame]
                + 0.25 * aside,
        )
    }

    fn pose<'a>(&self, rig: &'a Rig, frame: usize) -> Pose<'a> {
        let mut pose = rig.rest();
        pose.root = DVec3::new(self.place[0][frame], self.place[1][frame], self.place[2][frame]);
        let mut set = |name: &str, rotation: DQuat| {
            if let Some(joint) = rig.find(name) {
                pose.set_world(joint, rotation);
            }
        };
        let acting = &self.acting[frame];
        let pelvis = self.pelvis(frame);
        set("Hips", pelvis);
        let [lean, aside, twist] = acting.trunk;
        let chest = turn(
            self.heading[frame] + 0.24 * self.lead[frame] + twist,
            lean + 0.02 + 0.045 * self.speed[frame] + self.pushing[frame] - 0.5 * self.bounce[frame],
            -aside - self.banking[frame] - 0.035 * self.weight[frame],
        );
        set("Spine", pelvis.slerp(chest, 0.3));
        set("Spine1", pelvis.slerp(chest, 0.65));
        set("Chest", chest);
        let [nod, tilt, look] = acting.head;
        // The head stays level and looks where the walk goes.
        let head = turn(
            self.seen[frame] + 0.35 * twist + look,
            0.35 * lean + nod + 0.03 + 0.9 * self.bounce[frame],
            -0.35 * aside - tilt - 0.3 * self.banking[frame],
        );
        set("Neck", chest.slerp(head, 0.45));
        set("Head", head);
        for side in 0..2 {
            self.arm(&mut pose, side, frame);
            self.leg(&mut pose, side, frame);
        }
        pose
    }
}

fn mirrored(point: DVec3, side: usize) -> DVec3 {
    if side == 0 { point } else { DVec3::new(-point.x, point.y, point.z) }
}

/// Left less right, every frame.
fn differences(feet: &[Vec<Foot>; 2], pick: impl Fn(usize, &Foot) -> f64) -> Vec<f64> {
    let pairs = feet[0].iter().zip(&feet[1]).enumerate();
    pairs.map(|(frame, (left, right))| pick(frame, left) - pick(frame, right)).collect()
}

/// Change a second, central differences.
fn rates(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    (0..=last)
        .map(|index| {
            let (low, high) = (index.saturating_sub(1), (index + 1).min(last));
            (values[high] - values[low]) * FRAME_RATE / (high - low) as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use footsteps::HEEL;
    use limbs::find;

    /// Metres a second.
    const SLIDING: f64 = 0.01;

    #[test]
    fn standing_feet_do_not_slide() {
        let rig = rig();
        let body = Body::new();
        let poses: Vec<Pose<'_>> = (0..body.frames()).map(|frame| body.pose(&rig, frame)).collect();
        let (mut standing, mut worst) = (0, 0.0_f64);
        for side in 0..2 {
            let foot = find(&poses[0], side, "Foot").unwrap();
            for frame in 1..poses.len() {
                let support = |frame: usize| body.feet[side][frame].support > 0.5;
                if !(support(frame - 1) && support(frame)) {
                    continue;
                }
                standing += 1;
                let moved = |point: DVec3| {
                    (poses[frame].point(foot, point) - poses[frame - 1].point(foot, point)).length()
                        * FRAME_RATE
                };
                // It stands on its heel or on its ball.
                let slides = moved(BALL).min(moved(HEEL));
                assert!(slides < SLIDING, "side {side}, frame {frame}: {slides:.4} m/s");
                worst = worst.max(slides);
            }
        }
        println!("a standing foot slides by at most {worst:.1e} m/s");
        assert!(standing > body.frames(), "feet stand more than they swing");
    }

    #[test]
    fn the_figure_is_tall_as_a_person_and_ends_as_it_began() {
        let rig = rig();
        let rest = rig.rest();
        let head = rig.find("Head_end").unwrap();
        assert!((rest.world(head).0.y - 1.72).abs() < 0.005);
        assert_eq!(rig.len(), 22 + 5);
        let body = Body::new();
        let turned = body.heading[body.frames() - 1] - body.heading[0];
        assert!((turned - std::f64::consts::TAU).abs() < 1e-6, "one full turn, {turned}");
    }
}
