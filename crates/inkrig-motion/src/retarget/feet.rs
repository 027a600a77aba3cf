//! Feet that stand in the source stand in the target: two-bone inverse kinematics, eased in and out.

use super::transfer::Moved;
use crate::orientation::between;
use crate::rig::{Humanoid, Leg};
use crate::{Clip, Skeleton, kinematics};
use glam::{Quat, Vec3};

/// A foot is down when its ankle is at most this far above its own lowest place, in leg lengths.
const HEIGHT: f32 = 0.06;
/// A foot that stands moves slower than this, leg lengths a second.
const SPEED: f32 = 0.25;
/// Shorter contacts are passing by, and shorter gaps between two are none, seconds.
const SHORTEST: f64 = 0.1;
/// The time over which a foot goes over into standing and out of it, seconds.
const EASE: f64 = 0.12;
/// A leg is never stretched beyond this share of its length: at all of it the knee snaps.
const REACH: f32 = 0.9995;

/// When each foot stands: side, first frame, last frame.
pub(super) fn contacts(source: &Clip, body: &Humanoid, ground: f32, leg: f32) -> Vec<(usize, usize, usize)> {
    let positions = kinematics::positions(source);
    let (frames, rate) = (source.frames(), source.frame_rate());
    let shortest = (SHORTEST * rate).ceil().max(2.0) as usize;
    let mut spans = Vec::new();
    for (side, own) in body.legs.iter().enumerate() {
        let Some(foot) = own.foot else { continue };
        // The lower of ankle and ball decides: heels lift before the foot does.
        let joints: Vec<usize> = std::iter::once(foot).chain(own.toes).collect();
        let mut stands = vec![false; frames];
        for &joint in &joints {
            let lowest =
                (0..frames).map(|frame| positions.frame(frame)[joint].y).fold(f32::INFINITY, f32::min);
            if lowest > ground + 0.35 * leg {
                continue;
            }
            for (frame, slot) in stands.iter_mut().enumerate() {
                let (before, after) = (frame.saturating_sub(1), (frame + 1).min(frames - 1));
                let step = positions.frame(after)[joint].distance(positions.frame(before)[joint]);
                let seconds = ((after - before).max(1) as f64 / rate) as f32;
                let low = positions.frame(frame)[joint].y < lowest + HEIGHT * leg;
                *slot |= low && step < SPEED * leg * seconds;
            }
        }
        let mut begin = None;
        for frame in 0..=frames {
            match (begin, stands.get(frame) == Some(&true)) {
                (None, true) => begin = Some(frame),
                (Some(first), false) => {
                    if frame - first >= shortest {
                        spans.push((side, first, frame - 1));
                    }
                    begin = None;
                }
                _ => {}
            }
        }
    }
    spans
}

/// Keeps feet where they are put down: while one stands, what stands of it stays where it is over the ground.
pub(super) fn keep(
    moved: &mut Moved,
    target: &Skeleton,
    body: &Humanoid,
    contacts: &[(usize, usize, usize)],
    rate: f64,
) {
    let ease = (EASE * rate).round().max(1.0);
    let places: Vec<Vec<Vec3>> = (0..moved.turns.len()).map(|frame| moved.places(frame, target)).collect();
    for (side, leg) in body.legs.iter().enumerate() {
        let Some(foot) = leg.foot else { continue };
        let own: Vec<(usize, usize, Vec<Vec3>)> = contacts
            .iter()
            .filter(|contact| contact.0 == side)
            .map(|&(_, first, last)| (first, last, shifts(&places[first..=last], foot, leg.toes)))
            .collect();
        for (frame, now) in places.iter().enumerate() {
            // Pulls of the contacts around, each 1 while it lasts and fading outside of it.
            let (mut pull, mut weight) = (Vec3::ZERO, 0.0_f32);
            let mut strongest = 0.0_f32;
            for (first, last, shifts) in &own {
                let (first, last) = (*first, *last);
                let outside = first.saturating_sub(frame).max(frame.saturating_sub(last)) as f64;
                let share = (1.0 - outside / ease).max(0.0) as f32;
                let share = share * share * (3.0 - 2.0 * share);
                pull += share * shifts[frame.clamp(first, last) - first];
                weight += share;
                strongest = strongest.max(share);
            }
            if weight > 0.0 {
                let goal = now[foot] + pull / weight * strongest;
                bend(&mut moved.turns[frame], now, leg, foot, goal, target);
            }
        }
    }
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

/// Turns a leg so that its ankle comes to a place; the foot keeps its direction in the world, the knee its plane.
fn bend(turns: &mut [Quat], places: &[Vec3], leg: &Leg, foot: usize, goal: Vec3, target: &Skeleton) {
    let (hip, knee, ankle) = (places[leg.upper], places[leg.lower], places[foot]);
    let (thigh, shin) = (knee.distance(hip), ankle.distance(knee));
    let reach = goal - hip;
    let distance = reach.length().clamp((thigh - shin).abs() + 1e-4, REACH * (thigh + shin));
    let Some(along) = reach.try_normalize() else { return };
    // The plane of the knee as it is; a straight leg keeps the direction that its hinge has.
    let bent = (knee - hip).reject_from_normalized(along);
    let Some(outwards) = bent
        .try_normalize()
        .or_else(|| (turns[leg.upper] * Vec3::Z).reject_from_normalized(along).try_normalize())
    else {
        return;
    };
    let cos =
        ((thigh * thigh + distance * distance - shin * shin) / (2.0 * thigh * distance)).clamp(-1.0, 1.0);
    let new_knee = hip + thigh * (cos * along + (1.0 - cos * cos).sqrt() * outwards);
    let new_ankle = hip + distance * along;
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
