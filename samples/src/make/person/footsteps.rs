//! Footsteps of a person: where and when each foot stands, and the pose of the foot at any time.
//!
//! A planted foot pivots about its heel while the toes come down and about its ball while the heel rises; the pivot
//! itself does not move, so that a foot cannot slide.

use super::super::{
    ease::{Keys, bump, coast, min_jerk, part},
    figure::{ahead, left_of, turn},
};
use inkrig_motion::glam::{DQuat, DVec3};

/// From the ankle to the ball of the foot (the toe joint), foot space, metres.
pub(crate) const BALL: DVec3 = DVec3::new(0.0, -0.055, 0.13);
/// From the ankle to the lowest point of the heel, foot space, metres.
pub(crate) const HEEL: DVec3 = DVec3::new(0.0, -0.08, -0.055);
/// Height of the toe joint of a flat foot, metres.
pub(crate) const BALL_HEIGHT: f64 = 0.025;

/// How a step is made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    /// Pitch of the foot as it lands, radians: below 0 on the heel, above 0 on the ball.
    pub(crate) land_pitch: f64,
    /// Pitch as it leaves the ground, radians.
    pub(crate) lift_pitch: f64,
    /// How high the ball rises on its way, metres.
    pub(crate) clearance: f64,
}

impl Style {
    /// A step forward of the given length, metres: heel first, off over the ball.
    pub(crate) fn forward(length: f64) -> Self {
        Self {
            land_pitch: -0.08 - 0.3 * length.abs(),
            lift_pitch: 0.3 + 0.78 * length.abs(),
            clearance: 0.05 + 0.03 * length.abs(),
        }
    }

    /// A step to the side or on the spot: ball first.
    pub(crate) fn aside(clearance: f64) -> Self {
        Self { land_pitch: 0.16, lift_pitch: 0.3, clearance }
    }
}

/// A foot on the ground.
#[derive(Debug, Clone, Copy)]
struct Plant {
    ball: DVec3,
    yaw: f64,
    land: f64,
    lift: f64,
    style: Style,
}

/// All footsteps of both feet; 0 is the left foot.
#[derive(Debug, Clone)]
pub(crate) struct Footsteps {
    plants: [Vec<Plant>; 2],
}

/// The pose of one foot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    /// Place of the ankle, metres.
    pub(crate) ankle: DVec3,
    /// World rotation of the foot.
    pub(crate) rotation: DQuat,
    /// Turn of the toes against the foot, radians, below 0 is up.
    pub(crate) toe: f64,
    /// Where the foot is on the ground when it stood flat, metres, y = 0: under the ankle and a little ahead of it.
    pub(crate) base: DVec3,
    /// Heading of the foot, radians.
    pub(crate) yaw: f64,
    /// 1 when it stands, 0 when it is in the air.
    pub(crate) support: f64,
}

impl Footsteps {
    /// Both feet side by side at the origin, `half_width` metres from the middle, toes turned out a little.
    pub(crate) fn standing(half_width: f64) -> Self {
        let plant = |side| Plant {
            ball: spot(DVec3::ZERO, 0.0, side, half_width),
            yaw: toe_out(side),
            land: f64::NEG_INFINITY,
            lift: f64::INFINITY,
            style: Style { land_pitch: 0.0, lift_pitch: 0.0, clearance: 0.0 },
        };
        Self { plants: [vec![plant(0)], vec![plant(1)]] }
    }

    /// Moves a foot in the seconds `lift..land` to stand beside `middle` (metres) under a body headed to `heading`.
    pub(crate) fn step(
        &mut self,
        side: usize,
        (lift, land): (f64, f64),
        (middle, heading): (DVec3, f64),
        half_width: f64,
        style: Style,
    ) {
        if let Some(last) = self.plants[side].last_mut() {
            last.lift = lift;
        }
        let ball = spot(middle, heading, side, half_width);
        let yaw = heading + toe_out(side);
        self.plants[side].push(Plant { ball, yaw, land, lift: f64::INFINITY, style });
    }

    /// The pose of a foot at every one of `times` (seconds, rising). `raise` is how far the heel of a standing foot
    /// is raised besides, radians.
    pub(crate) fn poses(&self, side: usize, times: &[f64], raise: &[f64]) -> Vec<Foot> {
        let plants = &self.plants[side];
        let pitches = pitch_keys(plants);
        (times.iter().zip(raise))
            .map(|(&time, &raise)| {
                let pitch = pitches.at(time);
                let current = plants.partition_point(|plant| plant.land <= time).max(1) - 1;
                let from = plants[current];
                match plants.get(current + 1) {
                    Some(to) if time > from.lift => swing(from, *to, part(time, from.lift, to.land), pitch),
                    _ => {
                        let pitch = pitch + raise;
                        let ball = if pitch < 0.0 { over_heel(from, pitch) } else { from.ball };
                        pose(ball, from.ball, from.yaw, pitch, 1.0, 1.0)
                    }
                }
            })
            .collect()
    }
}

fn spot(middle: DVec3, heading: f64, side: usize, half_width: f64) -> DVec3 {
    let outward = if side == 0 { half_width } else { -half_width };
    middle + left_of(heading) * outward + ahead(heading) * 0.1 + DVec3::Y * BALL_HEIGHT
}

fn toe_out(side: usize) -> f64 {
    if side == 0 { 0.12 } else { -0.12 }
}

/// The pitch of a foot over all its steps.
fn pitch_keys(plants: &[Plant]) -> Keys {
    let mut keys = vec![(-1.0, 0.0)];
    for pair in plants.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (swing, stance) = (to.land - from.lift, (from.lift - from.land).min(1.0));
        keys.push((from.lift - 0.42 * stance, 0.0));
        keys.push((from.lift, to.style.lift_pitch));
        keys.push((from.lift + 0.2 * swing, 1.25 * to.style.lift_pitch));
        keys.push((from.lift + 0.85 * swing, 1.1 * to.style.land_pitch));
        keys.push((to.land, to.style.land_pitch));
        keys.push((to.land + 0.12_f64.min(0.4 * (to.lift - to.land)), 0.0));
    }
    Keys::new(&keys)
}

/// Place of the ball when the heel of a planted foot stands and the toes point up.
fn over_heel(plant: Plant, pitch: f64) -> DVec3 {
    let heel_to_ball = BALL - HEEL;
    let heel = plant.ball - turn(plant.yaw, 0.0, 0.0) * heel_to_ball;
    heel + turn(plant.yaw, pitch, 0.0) * heel_to_ball
}

fn swing(from: Plant, to: Plant, part: f64, pitch: f64) -> Foot {
    // A walking foot goes evenly; one that steps aside is set down softly.
    let ease = if to.style.land_pitch < 0.0 { coast(part, 0.35) } else { min_jerk(part) };
    let landing = if to.style.land_pitch < 0.0 { over_heel(to, pitch) } else { to.ball };
    let ball = from.ball.lerp(landing, ease) + DVec3::Y * to.style.clearance * bump(part);
    let yaw = from.yaw + ease * (to.yaw - from.yaw);
    // In the air the toes straighten half-way, and are ready again for the ground.
    pose(ball, from.ball.lerp(to.ball, ease), yaw, pitch, 1.0 - 0.55 * bump(part), 0.0)
}

fn pose(ball: DVec3, flat: DVec3, yaw: f64, pitch: f64, toe_part: f64, support: f64) -> Foot {
    let rotation = turn(yaw, pitch, 0.0);
    let raised = 0.5 * (pitch + (pitch * pitch + 4e-4).sqrt());
    let base = flat - ahead(yaw) * 0.1 - DVec3::Y * BALL_HEIGHT;
    Foot { ankle: ball - rotation * BALL, rotation, toe: -raised * toe_part, base, yaw, support }
}
