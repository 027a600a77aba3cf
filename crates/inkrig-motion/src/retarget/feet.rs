//! Feet that stand in the source stand in the target: two-bone inverse kinematics, eased in and out.

mod settle;
mod tail;

use super::contacts::Standing;
use super::figure::{Figure, Limb};
use super::transfer::Moved;
use crate::Skeleton;
use crate::kinematics::Positions;
use crate::orientation::between;
use crate::spans::upper_envelope;
use crate::two_bone::two_bone;
use glam::{Quat, Vec3};

/// The time over which a foot goes over into standing and out of it, seconds.
const EASE: f64 = 0.12;
/// A leg is never stretched beyond this share of its length: at all of it the knee snaps.
const REACH: f32 = 0.9995;
/// The hips come down for a leg that is too short by at most this share of its length.
const DROP: f32 = 0.15;

/// What a foot is to stand on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) standing: &'a Standing,
    /// Where the source's joints are.
    pub(super) source: &'a Positions,
    pub(super) scale: f32,
    /// Height of the target's ground, metres.
    pub(super) height: f32,
    /// How high each leg's ankle and ball stand over it.
    pub(super) clearance: &'a [[f32; 2]],
    pub(super) rate: f64,
    /// Target joints that turn by themselves.
    pub(super) led: &'a [usize],
}

/// Points an animal's legs, from hip or shoulder to the paw, where the source's point, as much longer or shorter than at
/// rest: bones of other proportions that point alike would put the paw elsewhere.
pub(super) fn point_legs(
    moved: &mut Moved,
    target: &Skeleton,
    (from, reference, source): (&Figure, &[Vec3], &Positions),
    (onto, rest): (&Figure, &[Vec3]),
) {
    if onto.quadruped().is_none() {
        return;
    }
    for (own, leg) in from.legs.iter().zip(&onto.legs) {
        let (Some(paw), Some(foot)) = (own.foot, leg.foot) else { continue };
        let length = |places: &[Vec3], upper: usize, foot: usize| places[foot].distance(places[upper]);
        let ratio = length(rest, leg.upper, foot) / length(reference, own.upper, paw).max(f32::MIN_POSITIVE);
        for frame in 0..moved.turns.len().min(source.frames()) {
            let now = moved.places(frame, target);
            let chord = source.frame(frame)[paw] - source.frame(frame)[own.upper];
            let goal = now[leg.upper] + ratio * chord;
            bend(&mut moved.turns[frame], &now, leg, foot, goal, target);
        }
    }
}

/// How high the ankle and ball of each leg are over the ground when it stands: of left and right the lower one, since
/// a stance may have one foot lifted.
pub(super) fn clearance(figure: &Figure, rest: &[Vec3], ground: f32) -> Vec<[f32; 2]> {
    let over = |joint: Option<usize>| joint.map_or(f32::INFINITY, |joint| (rest[joint].y - ground).max(0.0));
    let own: Vec<[f32; 2]> = figure.legs.iter().map(|leg| [over(leg.foot), over(leg.toes)]).collect();
    (0..own.len())
        .map(|index| {
            let other = own.get(index ^ 1).unwrap_or(&own[index]);
            [0, 1].map(|part| own[index][part].min(other[part]))
        })
        .collect()
}

/// Keeps feet where they are put down: while one stands, what stands of it stays where it is over the ground, as high
/// as it stands at rest. Hips come down where a leg would be too short.
pub(super) fn keep(moved: &mut Moved, target: &Skeleton, from: &Figure, onto: &Figure, ground: &Ground<'_>) {
    let frames = moved.turns.len();
    settle::settle(moved, target, from, onto, ground);
    let places: Vec<Vec<Vec3>> = (0..frames).map(|frame| moved.places(frame, target)).collect();
    let legs: Vec<Vec<(Vec3, f32)>> = (0..onto.legs.len().min(from.legs.len()))
        .map(|index| goals(index, (&from.legs[index], &onto.legs[index]), &places, ground))
        .collect();
    lower_hips(moved, onto, &places, &legs, ground.rate);
    for (index, goals) in legs.iter().enumerate() {
        let leg = &onto.legs[index];
        let Some(foot) = leg.foot else { continue };
        for (frame, &(goal, share)) in goals.iter().enumerate().skip(ground.standing.rest_pose_frames) {
            let now = moved.places(frame, target);
            let under = below(leg, &now, ground, index);
            let goal = (now[foot] + Vec3::Y * under).lerp(goal, share);
            if goal.distance(now[foot]) > 1e-6 {
                bend(&mut moved.turns[frame], &now, leg, foot, goal, target);
            }
        }
    }
    tail::lift(moved, target, onto, ground.height);
}

/// For every frame where the ankle is to be, and how much: 1 while the foot stands, fading around it.
fn goals(
    index: usize,
    (source, leg): (&Limb, &Limb),
    places: &[Vec<Vec3>],
    ground: &Ground<'_>,
) -> Vec<(Vec3, f32)> {
    let Some(foot) = leg.foot else { return vec![(Vec3::ZERO, 0.0); places.len()] };
    let ease = (EASE * ground.rate).round().max(1.0);
    let contacts = ground.standing.contacts.iter().filter(|contact| contact.0 == index);
    let belt = ground.standing.treadmill.and(source.foot).map(|own| belt(index, (own, foot), places, ground));
    let own: Vec<(usize, usize, Vec<Vec3>)> = contacts
        .map(|&(_, first, last)| {
            let shifts = match &belt {
                Some(belt) => belt[first..=last].to_vec(),
                None => shifts(&places[first..=last], foot, leg.toes),
            };
            (first, last, shifts)
        })
        .collect();
    (places.iter().enumerate())
        .map(|(frame, now)| {
            // Pulls of the contacts around, each 1 while it lasts and fading outside of it.
            let (mut pull, mut weight, mut strongest) = (Vec3::ZERO, 0.0_f32, 0.0_f32);
            for (first, last, shifts) in &own {
                let share = ground.share(frame, (*first, *last), ease);
                pull += share * shifts[frame.clamp(*first, *last) - first];
                weight += share;
                strongest = strongest.max(share);
            }
            if weight == 0.0 {
                return (now[foot], 0.0);
            }
            let height = lift(index, (source, leg), now, frame, ground);
            (now[foot] + pull / weight + Vec3::Y * height, strongest)
        })
        .collect()
}

impl Ground<'_> {
    /// How much a foot stands at a frame by one contact: 1 while it lasts, fading outside of it.
    fn share(&self, frame: usize, (first, last): (usize, usize), ease: f64) -> f32 {
        if frame < self.standing.rest_pose_frames {
            return 0.0;
        }
        let outside = first.saturating_sub(frame).max(frame.saturating_sub(last)) as f64;
        let share = (1.0 - outside / ease).max(0.0) as f32;
        share * share * (3.0 - 2.0 * share)
    }
}

/// How far a foot is to be moved over the ground in every frame so that it goes as far as the scaled source's: of one who
/// goes on the spot the ground goes along as each foot does. They are 0 in the mean of the contacts, so that a leg points
/// on the whole where it did, and the same for all of them, so that a loop stays one.
fn belt(index: usize, (own, foot): (usize, usize), places: &[Vec<Vec3>], ground: &Ground<'_>) -> Vec<Vec3> {
    let off =
        |frame: usize| (ground.scale * ground.source.frame(frame)[own] - places[frame][foot]).with_y(0.0);
    let contacts = ground.standing.contacts.iter().filter(|contact| contact.0 == index);
    let (sum, count) = contacts
        .flat_map(|&(_, first, last)| first..=last)
        .fold((Vec3::ZERO, 0_u32), |(sum, count), frame| (sum + off(frame), count + 1));
    let mean = sum / count.max(1) as f32;
    (0..places.len()).map(|frame| off(frame) - mean).collect()
}

/// How far a foot is to be moved over the ground in each frame of a contact so that of ankle and ball the stiller one
/// does not slide: a foot that rolls over its ball stands on it while the ankle goes on. They are 0 in the mean.
fn shifts(places: &[Vec<Vec3>], foot: usize, toes: Option<usize>) -> Vec<Vec3> {
    let mut shift = Vec3::ZERO;
    let mut shifts = vec![shift];
    for pair in places.windows(2) {
        let step = |joint: usize| (pair[1][joint] - pair[0][joint]).with_y(0.0);
        let (ankle, ball) = (step(foot), toes.map_or(Vec3::INFINITY, step));
        shift -= if ball.length_squared() < ankle.length_squared() { ball } else { ankle };
        shifts.push(shift);
    }
    let mean = shifts.iter().sum::<Vec3>() / shifts.len() as f32;
    shifts.iter().map(|shift| *shift - mean).collect()
}

/// How far a standing foot is to be lifted so that ankle and ball are as high over the ground as they stand at rest,
/// and as much higher as the source's are over where they stand.
fn lift(index: usize, (source, leg): (&Limb, &Limb), now: &[Vec3], frame: usize, ground: &Ground<'_>) -> f32 {
    let parts = [(source.foot, leg.foot), (source.toes, leg.toes)];
    let mut lift = f32::NEG_INFINITY;
    for (part, (own, other)) in parts.into_iter().enumerate() {
        let low = ground.standing.low.get(index).and_then(|low| low[part]);
        let (Some(own), Some(other), Some(low)) = (own, other, low) else { continue };
        let over = ground.source.frame(frame)[own].y - low;
        let height = ground.height + ground.clearance[index][part] + ground.scale * over;
        lift = lift.max(height - now[other].y);
    }
    if lift.is_finite() { lift } else { 0.0 }
}

/// How deep a foot is below the ground, 0 above it. Toes that point down come lower than they stand.
fn below(leg: &Limb, now: &[Vec3], ground: &Ground<'_>, index: usize) -> f32 {
    let parts = [leg.foot, leg.toes].into_iter().zip(ground.clearance[index]);
    let deep = parts.filter_map(|(joint, over)| Some(ground.height + 0.3 * over - now[joint?].y));
    deep.fold(0.0, f32::max)
}

/// Brings the hips down where a leg that stands would have to be longer than it is, slowly before and after.
fn lower_hips(moved: &mut Moved, onto: &Figure, places: &[Vec<Vec3>], legs: &[Vec<(Vec3, f32)>], rate: f64) {
    let drops: Vec<f32> = (places.iter().enumerate())
        .map(|(frame, now)| {
            let drop = |(leg, goals): (&Limb, &Vec<(Vec3, f32)>)| {
                let foot = leg.foot?;
                let (goal, share) = goals[frame];
                let (hip, knee, ankle) = (now[leg.upper], now[leg.lower], now[foot]);
                let length = REACH * (knee.distance(hip) + ankle.distance(knee));
                let aside = (goal - hip).with_y(0.0).length();
                let reach = (length * length - aside * aside).max(0.0).sqrt();
                Some((share * (hip.y - goal.y - reach)).clamp(0.0, DROP * length))
            };
            onto.legs.iter().zip(legs).filter_map(drop).fold(0.0, f32::max)
        })
        .collect();
    let wide = (EASE * rate).round().max(1.0) as usize;
    for (place, drop) in moved.hips.iter_mut().zip(upper_envelope(&drops, wide)) {
        place.y -= drop;
    }
}

/// Turns a leg so that its ankle comes to a place; the foot keeps its direction in the world, the knee its plane.
fn bend(turns: &mut [Quat], places: &[Vec3], leg: &Limb, foot: usize, goal: Vec3, target: &Skeleton) {
    let (hip, knee, ankle) = (places[leg.upper], places[leg.lower], places[foot]);
    let Some(along) = (goal - hip).try_normalize() else { return };
    // The plane of the knee as it is; a straight leg keeps the direction that its hinge has.
    let bent = (knee - hip).reject_from_normalized(along);
    let pole = bent.try_normalize().unwrap_or(turns[leg.upper] * Vec3::Z);
    let Some([new_knee, new_ankle]) = two_bone([hip, knee, ankle], goal, REACH, pole) else { return };
    let upper = between((knee - hip).as_dvec3(), (new_knee - hip).as_dvec3()).as_quat();
    let lower = between((ankle - knee).as_dvec3(), (new_ankle - new_knee).as_dvec3()).as_quat();
    // Twist joints between hip and knee go with the hip, those between knee and ankle with the knee.
    let mut part = vec![0_u8; turns.len()];
    for (index, joint) in target.joints().iter().enumerate() {
        part[index] = match index {
            _ if index == foot => 3,
            _ if index == leg.lower => 2,
            _ if index == leg.upper => 1,
            _ => joint.parent.map_or(0, |parent| part[parent]),
        };
        match part[index] {
            1 => turns[index] = (upper * turns[index]).normalize(),
            2 => turns[index] = (lower * turns[index]).normalize(),
            _ => {}
        }
    }
}
