//! Where the animal goes, and where its paws stand.

use super::{
    super::{
        ease::{Keys, part},
        figure::{ahead, left_of, turn},
        gait::{Gait, STEP, Stance},
    },
    BOW, LENGTH,
    hound::{FORE, HIND, PAW_HEIGHT, TOES, TRUNK},
};
use inkrig_motion::glam::{DQuat, DVec3};

/// The line on the ground that the body follows.
pub(crate) struct Paths {
    /// Metres passed, heading and place of the body's middle, every [`STEP`] seconds.
    passed: Vec<f64>,
    headings: Vec<f64>,
    places: Vec<DVec3>,
}

/// The pose of one paw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paw {
    /// Place of the paw's joint, metres.
    pub(crate) place: DVec3,
    pub(super) heading: f64,
    /// How far the leg folds, 0 on the ground, 1 in the middle of a high swing.
    pub(crate) fold: f64,
    /// How freely the paw hangs: 0 on the ground and at its touch, 1 in the air.
    pub(crate) air: f64,
    /// Whether it stands on the ground.
    pub(crate) stands: bool,
}

impl Paw {
    /// Direction on the ground in which the leg bends.
    pub(crate) fn forward(&self) -> DVec3 {
        ahead(self.heading)
    }

    /// World rotation of the paw. On the ground it is flat; in the air it has the given pitch, radians, toes down, as
    /// far as the toes stay above the ground.
    pub(crate) fn rotation(&self, pitch: f64) -> DQuat {
        let pitch = self.air * pitch;
        let room = ((self.place.y - PAW_HEIGHT) / TOES).max(1e-6);
        turn(self.heading, if pitch > 0.0 { pitch * room / pitch.hypot(room) } else { pitch }, 0.0)
    }
}

impl Paths {
    /// Follows the gait's speed, turning by `turning` radians a second (less when slow).
    pub(crate) fn new(gait: &Gait, turning: &Keys, length: f64) -> Self {
        let (mut passed, mut heading, mut place) = (0.0, 0.0, DVec3::ZERO);
        let mut paths = Self { passed: vec![0.0], headings: vec![0.0], places: vec![place] };
        for step in 0..(length / STEP).ceil() as usize {
            let time = (step as f64 + 0.5) * STEP;
            let speed = gait.speed(time);
            passed += STEP * speed;
            heading += STEP * turning.at(time) * (speed / 0.6).min(1.0);
            place += ahead(heading) * (STEP * speed);
            paths.passed.push(passed);
            paths.headings.push(heading);
            paths.places.push(place);
        }
        paths
    }

    /// Place on the ground of a point of the body `offset` metres ahead of its middle.
    pub(crate) fn place(&self, time: f64, offset: f64) -> DVec3 {
        let (low, high, between) = self.find(time, offset);
        let inside = self.places[low].lerp(self.places[high], between);
        // Before the first place and behind the last the line goes on straight.
        let beyond = self.target(time, offset) - self.mix(&self.passed, (low, high, between));
        inside + ahead(self.headings[low]) * beyond
    }

    /// Heading of the line there, radians.
    pub(crate) fn heading(&self, time: f64, offset: f64) -> f64 {
        self.mix(&self.headings, self.find(time, offset))
    }

    /// When the body has gone `metres` since `time`, seconds; far in the future when it never does.
    fn time_after(&self, time: f64, metres: f64) -> f64 {
        let target = self.target(time, metres);
        let step = self.passed.partition_point(|&passed| passed < target);
        if step < self.passed.len() { step as f64 * STEP } else { 1e3 }
    }

    fn target(&self, time: f64, offset: f64) -> f64 {
        let last = self.passed.len() - 1;
        let place = (time / STEP).clamp(0.0, last as f64);
        let low = place.floor() as usize;
        self.mix(&self.passed, (low, (low + 1).min(last), place - low as f64)) + offset
    }

    fn find(&self, time: f64, offset: f64) -> (usize, usize, f64) {
        let target = self.target(time, offset);
        let high = self.passed.partition_point(|&passed| passed < target).min(self.passed.len() - 1);
        let low = high.saturating_sub(1);
        let span = self.passed[high] - self.passed[low];
        let between = if span > 0.0 { ((target - self.passed[low]) / span).clamp(0.0, 1.0) } else { 0.0 };
        (low, high, between)
    }

    fn mix(&self, values: &[f64], (low, high, between): (usize, usize, f64)) -> f64 {
        values[low] + between * (values[high] - values[low])
    }
}

/// A paw on the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plant {
    pub(super) stance: Stance,
    pub(super) place: DVec3,
    pub(super) heading: f64,
    /// How high the paw rises on its way here, metres.
    pub(super) rise: f64,
}

/// Where and when a leg stands, in the order of time.
pub(super) fn plants(gait: &Gait, paths: &Paths, leg: usize) -> Vec<Plant> {
    let hind = leg < 2;
    let sign = if leg.is_multiple_of(2) { 1.0 } else { -1.0 };
    let (along, beside) =
        if hind { (HIND.z - 0.5 * TRUNK, HIND.x) } else { (FORE.z + 0.5 * TRUNK, FORE.x + 0.02) };
    let spot = |time: f64, narrow: f64, forward: f64| {
        let heading = paths.heading(time, along);
        let aside = left_of(heading) * (sign * beside * narrow);
        (paths.place(time, along) + aside + ahead(heading) * forward + DVec3::Y * PAW_HEIGHT, heading)
    };
    let stagger = [0.035, -0.035, -0.03, 0.02][leg];
    let mut plants: Vec<Plant> = (gait.stances(leg).into_iter())
        .map(|mut stance| {
            // A stance that would outlast the leg's reach ends early. How far the body goes meanwhile, metres:
            if stance.land > 0.0 {
                let longest = 0.6 - 0.18 * part(gait.speed(stance.land), 1.0, 2.0);
                stance.lift = stance.lift.min(paths.time_after(stance.land, longest));
            }
            // A foot stands where the body passes over it in the middle of the stance.
            let middle =
                if stance.lift > LENGTH { LENGTH } else { 0.5 * (stance.land.max(0.0) + stance.lift) };
            let middle = if stance.land < 0.0 { 0.0 } else { middle };
            let still = if stance.land < 0.0 || stance.lift > LENGTH { stagger } else { 0.0 };
            let speed = gait.speed(0.5 * (stance.land.max(0.0) + middle));
            let (place, heading) = spot(middle, 1.0 - 0.07 * speed.min(4.0), 0.02 + still);
            Plant { stance, place, heading, rise: 0.1 + 0.038 * speed.min(5.0) }
        })
        .collect();
    if !hind {
        // For the bow the fore paws go ahead one after the other, and come back.
        let late = if leg.is_multiple_of(2) { 0.0 } else { 0.2 };
        for (lift, forward) in [(BOW.0 - 0.1 + late, 0.27 + stagger), (BOW.1 - 0.5 + late, 0.02 + stagger)] {
            let (place, heading) = spot(LENGTH, 1.0, forward);
            if let Some(last) = plants.last_mut() {
                last.stance.lift = lift;
            }
            plants.push(Plant {
                stance: Stance { land: lift + 0.34, lift: 1e3 },
                place,
                heading,
                rise: 0.06,
            });
        }
    }
    plants
}
