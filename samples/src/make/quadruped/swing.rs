//! How a paw goes from one stand to the next.
//!
//! Seen from the joint that carries the leg, the leg swings (an angle) and folds (a length). Both leave the ground with
//! the speed that the standing leg has there and meet it again with the speed it needs, so that neither the paw nor a
//! joint jerks when it lifts or lands.

use super::{
    super::{
        ease::{bump, coast, min_jerk, part, window},
        figure::{FRAME_RATE, ahead, left_of},
    },
    hound::PAW_HEIGHT,
    paws::{Paw, Plant},
};
use inkrig_motion::glam::DVec3;

/// Part of the swing in which the leg speeds up, and in which it slows down.
const RAMP: f64 = 0.33;
/// Height in the middle of a swing, metres, below which a paw is lifted.
const CLEARANCE: f64 = 0.04;

/// A paw at `time`. `carriers` is the place of the joint that carries the leg, metres, one a frame; a leg in the air
/// is hardly longer than `relaxed`, metres.
pub(super) fn paw(plants: &[Plant], carriers: &[DVec3], relaxed: f64, time: f64) -> Paw {
    let current = plants.partition_point(|plant| plant.stance.land <= time).max(1) - 1;
    let from = plants[current];
    match plants.get(current + 1) {
        Some(to) if time > from.stance.lift => swing(from, *to, carriers, relaxed, time),
        _ => Paw { place: from.place, heading: from.heading, fold: 0.0, air: 0.0, stands: true },
    }
}

fn swing(from: Plant, to: Plant, carriers: &[DVec3], relaxed: f64, time: f64) -> Paw {
    let (lift, land) = (from.stance.lift, to.stance.land);
    let passed = part(time, lift, land);
    let heading = from.heading + min_jerk(passed) * (to.heading - from.heading);
    let (start, end) = (Leaving::at(&from, carriers, lift), Leaving::at(&to, carriers, land));
    let span = land - lift;
    // The leg goes on as it left, and comes as it will stand; the ease passes from the one to the other.
    let ease = coast(passed, RAMP);
    let [angle, length, aside] = [0, 1, 2].map(|index| {
        let on = start.reach[index] + start.rate[index] * span * passed;
        let back = end.reach[index] - end.rate[index] * span * (1.0 - passed);
        on + ease * (back - on)
    });
    let air = window(passed, 0.0, 1.0, 0.45, 0.45);
    // The paw leaves quickly and comes down slowly: the leg is shortest early.
    let fold = bump(passed * (1.2 - 0.2 * passed));
    let length = length - to.rise * fold;
    let length = length + window(passed, 0.0, 1.0, 0.25, 0.3) * (relax(length, relaxed) - length);
    let reach = ahead(heading) * (length * angle.sin()) - DVec3::Y * (length * angle.cos());
    let mut place = place_at(carriers, time) + reach + left_of(heading) * aside;
    // However the trunk moves meanwhile, the paw stays above the ground.
    let height = place.y - PAW_HEIGHT;
    place.y = PAW_HEIGHT + 0.5 * (height + height.hypot(CLEARANCE * air));
    Paw { place, heading, fold: fold * (to.rise / 0.24).min(1.2), air, stands: false }
}

/// Lengths above `from` are squeezed into the next few centimetres.
fn relax(length: f64, from: f64) -> f64 {
    const ROOM: f64 = 0.06;
    if length > from { from + ROOM * ((length - from) / ROOM).tanh() } else { length }
}

/// How a standing leg is seen from its carrier: angle to the front (radians), length and distance to the left
/// (metres); and how these change a second.
struct Leaving {
    reach: [f64; 3],
    rate: [f64; 3],
}

impl Leaving {
    fn at(plant: &Plant, carriers: &[DVec3], time: f64) -> Self {
        const STEP: f64 = 0.25 / FRAME_RATE;
        let reach = |time: f64| {
            let line = plant.place - place_at(carriers, time);
            let (front, down) = (line.dot(ahead(plant.heading)), -line.y);
            [front.atan2(down), front.hypot(down), line.dot(left_of(plant.heading))]
        };
        let (before, after) = (reach(time - STEP), reach(time + STEP));
        let rate = [0, 1, 2].map(|index: usize| (after[index] - before[index]) / (2.0 * STEP));
        Self { reach: reach(time), rate }
    }
}

/// Between the frames, by the cubic of Catmull and Rom (1974).
fn place_at(places: &[DVec3], time: f64) -> DVec3 {
    let last = places.len() - 1;
    let frame = (time * FRAME_RATE).clamp(0.0, last as f64);
    let low = (frame.floor() as usize).min(last.saturating_sub(1));
    let x = frame - low as f64;
    let at = |index: usize| places[index.min(last)];
    let (p0, p1, p2, p3) = (at(low.saturating_sub(1)), at(low), at(low + 1), at(low + 2));
    p1 + ((p2 - p0) + ((2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) + (3.0 * (p1 - p2) + p3 - p0) * x) * x)
        * (0.5 * x)
}
