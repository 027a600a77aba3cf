//! Where the floor is under a body, and when the body is in the air.

use super::Pose;
use super::kept::Pins;
use super::smoother::{Little, smooth, smooth_above};
use crate::spans::spans;

/// What is quicker than this is no floor: seconds. First roughly, to find flights, then between them.
const ROUGH: f64 = 2.0;
const FINE: f64 = 1.0;
/// A body whose lowest part is higher than this over the rough floor may be in the air, metres.
const HIGH: f64 = 0.05;
/// A flight begins and ends at this height, metres.
const LEAVES: f64 = 0.02;
/// A flight as high as it is takes off at so much of the speed that gravity asks for. Generated ones are slow.
const TAKE_OFF: f64 = 0.4;
/// And it lasts at most so many times as long as gravity lets it.
const LASTS: f64 = 2.0;
/// Metres a second squared.
const GRAVITY: f64 = 9.81;
/// How often the rough floor is fitted anew to what is near it.
const ROUNDS: usize = 12;
/// How much what is above the rough floor counts, against what is below.
const ABOVE: f64 = 0.05;
/// Lowest parts that are no feet do not go through the floor; the time over which the body gives way, seconds.
const EASE: f64 = 0.6;

/// Raises and lowers the whole body, slowly, until what is lowest is on the floor (y = 0) where it is not in the air; says where it is.
pub(super) fn stand(poses: &mut [Pose], (rate, heel): (f64, f64), pins: &Pins) -> Vec<bool> {
    let low: Vec<f64> = poses.iter().map(|pose| lowest(pose, heel)).collect();
    let airborne = airborne(&low, rate);
    let weights: Vec<f64> = airborne.iter().map(|airborne| if *airborne { 0.0 } else { 1.0 }).collect();
    let fine = Little::Bend.stiffness(FINE, rate);
    let mut raise: Vec<f64> = smooth(&low, &weights, Little::Bend, fine).iter().map(|low| -low).collect();
    // What hands, knees or the head would sink in, legs cannot take.
    let sinks: Vec<f64> = (poses.iter().zip(&raise))
        .map(|(pose, raise)| {
            let others =
                (0..pose.len()).filter(|joint| !(7..=8).contains(joint) && !(10..=11).contains(joint));
            others.map(|joint| -(pose[joint].y + raise)).fold(0.0, f64::max)
        })
        .collect();
    let (none, ones) = (vec![0.0; sinks.len()], vec![1.0; sinks.len()]);
    let lifts = smooth_above(&none, &ones, &sinks, Little::Jerk, Little::Jerk.stiffness(EASE, rate));
    raise.iter_mut().zip(lifts).for_each(|(raise, lift)| *raise += lift);
    pins.limit_heights(&mut raise, poses, rate);
    for (pose, raise) in poses.iter_mut().zip(&raise) {
        pose.iter_mut().for_each(|place| place.y += raise);
    }
    airborne
}

/// The height of the lowest part of a body.
pub(super) fn lowest(pose: &Pose, heel: f64) -> f64 {
    let height = |joint: usize| pose[joint].y - if (7..=8).contains(&joint) { heel } else { 0.0 };
    (0..pose.len()).map(height).fold(f64::INFINITY, f64::min)
}

/// Stretches in which the lowest part is above the floor and came there as quickly as a flight does.
fn airborne(low: &[f64], rate: f64) -> Vec<bool> {
    // Asymmetric least squares (Eilers 2003): a slow curve along the lower side.
    let mut weights = vec![1.0; low.len()];
    let mut floor = Vec::new();
    for _ in 0..ROUNDS {
        floor = smooth(low, &weights, Little::Bend, Little::Bend.stiffness(ROUGH, rate));
        for ((weight, low), floor) in weights.iter_mut().zip(low).zip(&floor) {
            *weight = if low > floor { ABOVE } else { 1.0 };
        }
    }
    let over: Vec<f64> = low.iter().zip(&floor).map(|(low, floor)| low - floor).collect();
    let high: Vec<bool> = over.iter().map(|over| *over > HIGH).collect();
    let mut airborne = vec![false; low.len()];
    for (first, last) in spans(&high, 2) {
        let peak = over[first..=last].iter().copied().fold(0.0, f64::max);
        let near = &over[first.saturating_sub(1)..(last + 2).min(over.len())];
        let quickest = near.windows(2).map(|pair| (pair[1] - pair[0]).abs() * rate).fold(0.0, f64::max);
        let takes = (last - first + 1) as f64 / rate;
        let (speed, time) = ((2.0 * GRAVITY * peak).sqrt(), (8.0 * peak / GRAVITY).sqrt());
        if quickest > TAKE_OFF * speed && takes < LASTS * time {
            // From where it leaves the floor to where it comes back.
            let leaves = (0..first).rev().take_while(|at| over[*at] > LEAVES).last().unwrap_or(first);
            let lands = (last + 1..over.len()).take_while(|at| over[*at] > LEAVES).last().unwrap_or(last);
            airborne[leaves..=lands].fill(true);
        }
    }
    airborne
}
