//! Legs for feet that stand still.

use super::Pose;
use super::contacts::{LEGS, Planted, carried_by_feet, height, settled, step};
use super::kept::{Pins, eased, exact};
use super::smoother::{Little, smooth, smooth_above};
use crate::spans::spans;
use crate::two_bone::two_bone;
use glam::{DVec3, Vec3};

/// The time over which a foot goes over into standing and out of it, seconds.
const EASE: f64 = 0.7;
/// A leg is never stretched beyond this share of its length: at all of it the knee snaps.
const REACH: f32 = 0.998;
/// The pelvis comes down for a leg that is too short by at most this, metres, and within this time, seconds.
const DROP: f64 = 0.12;
const DROP_EASE: f64 = 0.6;
/// A foot that is quicker than this, metres a second, while the other stands, is at least so high over the floor, metres: it
/// swings.
const QUICK: f64 = 0.35;
const CLEAR: f64 = 0.055;
/// How much touching the floor counts for a foot that slides.
const TOUCH: f64 = 100.0;

/// Keeps feet that stand where they stand, on the floor, and the others out of it.
pub(super) fn hold(
    poses: &mut [Pose],
    planted: &Planted,
    airborne: &[bool],
    pins: &Pins,
    (rate, heel): (f64, f64),
) {
    let goals = [0, 1].map(|foot| goals(poses, (planted, airborne), pins, foot, (rate, heel)));
    let drops = drops(poses, &goals, pins, rate);
    for (frame, pose) in poses.iter_mut().enumerate() {
        let feet = LEGS.map(|[_, _, ankle, toe]| [pose[ankle], pose[toe]]);
        pose.iter_mut().for_each(|place| place.y -= drops[frame]);
        for (foot, places) in feet.into_iter().enumerate() {
            let stands = planted[frame][foot];
            let goal = places.map(|place| place + goals[foot][frame]);
            if drops[frame] != 0.0 || goals[foot][frame] != DVec3::ZERO {
                reach(pose, LEGS[foot], goal, stands);
            }
        }
    }
}

/// How far a foot is to be moved at every frame: while it stands by what keeps it still and on the floor, else as little and as
/// smoothly as can be, but not through the floor.
fn goals(
    poses: &[Pose],
    (planted, airborne): (&Planted, &[bool]),
    pins: &Pins,
    foot: usize,
    (rate, heel): (f64, f64),
) -> Vec<DVec3> {
    let (count, stiff) = (poses.len(), Little::Jerk.stiffness(EASE, rate));
    let (mut wanted, mut weights) = (vec![DVec3::ZERO; count], vec![1.0; count]);
    let stands: Vec<bool> = planted.iter().map(|feet| feet[foot]).collect();
    for (first, last) in spans(&stands, 1) {
        let mut shift = DVec3::ZERO;
        let mut shifts = vec![shift];
        for pair in poses[first..=last].windows(2) {
            shift -= step(&pair[0], &pair[1], foot, heel).with_y(0.0);
            shifts.push(shift);
        }
        let sure = settled((first, last), count, rate);
        // Most surely it stands where it is in the middle.
        let total: f64 = sure.iter().map(|sure| sure + 1e-3).sum();
        let mean: DVec3 =
            shifts.iter().zip(&sure).map(|(shift, sure)| *shift * ((sure + 1e-3) / total)).sum();
        for (frame, (shift, sure)) in (first..=last).zip(shifts.into_iter().zip(sure)) {
            wanted[frame] = (shift - mean).with_y(-height(&poses[frame], foot, heel));
            weights[frame] = exact(stiff).powf(sure);
        }
    }
    // Of a body on its feet at least one touches the floor.
    let mut upright = weights.clone();
    for frame in 0..count {
        let [own, other] = [foot, 1 - foot].map(|foot| height(&poses[frame], foot, heel));
        let slides = planted[frame] == [false; 2] && !airborne[frame] && carried_by_feet(&poses[frame], heel);
        if slides && own <= other {
            wanted[frame].y = -own;
            upright[frame] = TOUCH;
        }
    }
    let leg = &LEGS[foot][1..];
    for frame in (0..count).filter(|frame| pins.any(*frame, Some(leg))) {
        wanted[frame] = DVec3::ZERO;
        (weights[frame], upright[frame]) = (exact(stiff), exact(stiff));
    }
    let axis = |axis: usize| wanted.iter().map(|wanted| wanted[axis]).collect::<Vec<f64>>();
    let [x, z] = [0, 2].map(|own| smooth(&axis(own), &weights, Little::Jerk, stiff));
    let least: Vec<f64> = (0..count)
        .map(|frame| {
            let next = (frame + 1).min(count - 1);
            let before = next.saturating_sub(1);
            let slide = DVec3::new(x[next] - x[before], 0.0, z[next] - z[before]);
            let speed = (step(&poses[before], &poses[next], foot, heel) + slide).with_y(0.0).length() * rate;
            let swings = speed > QUICK && !stands[frame] && planted[frame][1 - foot];
            let clear = if swings { CLEAR } else { 0.0 };
            clear - height(&poses[frame], foot, heel)
        })
        .collect();
    let y = smooth_above(&axis(1), &upright, &least, Little::Jerk, stiff);
    (0..count).map(|frame| DVec3::new(x[frame], y[frame], z[frame])).collect()
}

/// How far the pelvis has to come down so that no leg has to be longer than it is.
fn drops(poses: &[Pose], goals: &[Vec<DVec3>; 2], pins: &Pins, rate: f64) -> Vec<f64> {
    let needed = |(frame, pose): (usize, &Pose)| {
        let legs = LEGS.iter().zip(goals).map(|([hip, knee, ankle, _], goals)| {
            let (goal, hip, knee) = (pose[*ankle] + goals[frame], pose[*hip], pose[*knee]);
            let length = f64::from(REACH) * (knee.distance(hip) + pose[*ankle].distance(knee));
            let aside = (goal - hip).with_y(0.0).length();
            let reach = (length * length - aside * aside).max(0.0).sqrt();
            // A leg that was as long keeps its length.
            if goals[frame].length_squared() > 1e-12 { hip.y - goal.y - reach } else { 0.0 }
        });
        legs.fold(0.0, f64::max).min(DROP)
    };
    let above = |least: &[f64]| {
        let (none, ones) = (vec![0.0; least.len()], vec![1.0; least.len()]);
        smooth_above(&none, &ones, least, Little::Jerk, Little::Jerk.stiffness(DROP_EASE, rate))
    };
    let drops = above(&poses.iter().enumerate().map(needed).collect::<Vec<_>>());
    // Hands and knees that are on the floor stay on it.
    let excess = |(drop, pose): (&f64, &Pose)| {
        let others = (0..pose.len()).filter(|joint| !LEGS.iter().any(|leg| leg[2..].contains(joint)));
        (drop - others.map(|joint| pose[joint].y).fold(f64::INFINITY, f64::min).max(0.0)).max(0.0)
    };
    let excess = above(&drops.iter().zip(poses).map(excess).collect::<Vec<_>>());
    let smooth = drops.iter().zip(excess).map(|(drop, excess)| (drop - excess).max(0.0));
    if pins.is_empty() {
        return smooth.collect();
    }
    let kept: Vec<Option<f64>> = (0..poses.len()).map(|frame| pins.any(frame, None).then_some(1.0)).collect();
    smooth.zip(eased(&kept, rate)).map(|(drop, kept)| drop * (1.0 - kept).clamp(0.0, 1.0)).collect()
}

/// Brings ankle and toe of a leg to their places; a foot that stands and is too far away lifts its heel.
fn reach(pose: &mut Pose, [hip, knee, ankle, toe]: [usize; 4], goal: [DVec3; 2], stands: bool) {
    let from = pose[hip];
    let at = |place: DVec3| (place - from).as_vec3();
    let (own_knee, own_ankle) = (at(pose[knee]), at(pose[ankle]));
    let [mut to, toes] = goal.map(at);
    let foot = toes - to;
    let most = REACH * (own_knee.length() + own_ankle.distance(own_knee));
    let far = to.length() > most;
    if far && stands {
        let middle = most * to.normalize_or(Vec3::NEG_Y);
        if let Some([heel, _]) = two_bone([Vec3::ZERO, middle, middle + foot], toes, 1.0, to) {
            to = heel;
        }
    }
    let along = to.normalize_or(Vec3::NEG_Y);
    // A straight knee bends to where the toes point.
    let pole = own_knee.reject_from_normalized(along) + 0.02 * foot.reject_from_normalized(along);
    let Some([new_knee, new_ankle]) = two_bone([Vec3::ZERO, own_knee, own_ankle], to, REACH, pole) else {
        return;
    };
    let foot = if far && stands { (toes - new_ankle).normalize_or(foot) * foot.length() } else { foot };
    pose[knee] = from + new_knee.as_dvec3();
    pose[ankle] = from + new_ankle.as_dvec3();
    pose[toe] = from + (new_ankle + foot).as_dvec3();
}
