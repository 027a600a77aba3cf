//! The way of the body over the ground, so that feet which stand need not slide.

use super::Pose;
use super::contacts::{Planted, settled, step};
use super::kept::{Pins, exact};
use super::smoother::{Little, smooth};
use crate::spans::spans;
use glam::DVec3;

/// Slides that last longer than this are the body's; shorter ones are left to the legs. Seconds.
const SLOW: f64 = 0.5;
/// How much a body would rather travel as it did, against 1 for a foot that stands.
const AS_IT_WAS: f64 = 0.02;

/// What is slower than this is left to the legs too, metres a second: real feet roll.
const CREEP: f64 = 0.1;

/// Moves the whole body over the ground by what feet slide that stand, both in the mean.
pub(super) fn travel(poses: &mut [Pose], planted: &Planted, pins: &Pins, (rate, heel): (f64, f64)) {
    let count = poses.len();
    let (mut slides, mut weights) = (vec![DVec3::ZERO; count], vec![AS_IT_WAS; count]);
    for foot in 0..2 {
        let stands: Vec<bool> = planted.iter().map(|feet| feet[foot]).collect();
        for (first, last) in spans(&stands, 2) {
            let sure = settled((first, last), count, rate);
            for (frame, pair) in (first..last).zip(sure.windows(2)) {
                let slide = step(&poses[frame], &poses[frame + 1], foot, heel).with_y(0.0);
                let weight = pair[0].min(pair[1]);
                let creep = CREEP / rate;
                let own = slide * (1.0 - creep / slide.length().max(creep));
                slides[frame] += weight * own;
                weights[frame] += weight;
            }
        }
    }
    slides.iter_mut().zip(&weights).for_each(|(slide, weight)| *slide /= *weight);
    slides.truncate(count.saturating_sub(1));
    let along = |axis: usize| -> Vec<f64> {
        let values: Vec<f64> = slides.iter().map(|slide| -slide[axis]).collect();
        let mut place = 0.0;
        let mut places = vec![0.0];
        places.extend(
            smooth(&values, &weights, Little::Bend, Little::Bend.stiffness(SLOW, rate)).iter().map(|step| {
                place += step;
                place
            }),
        );
        places.truncate(poses.len());
        back_at_pins(&mut places, pins, rate);
        places
    };
    let (x, z) = (along(0), along(2));
    for ((pose, x), z) in poses.iter_mut().zip(x).zip(z) {
        pose.iter_mut().for_each(|place| *place += DVec3::new(x, 0.0, z));
    }
}

/// Bends a way so that it is nothing where a joint is kept, and between these no farther off than it has to be.
fn back_at_pins(places: &mut [f64], pins: &Pins, rate: f64) {
    let kept: Vec<usize> = (0..places.len()).filter(|frame| pins.any(*frame, None)).collect();
    let (Some(&first), Some(&last)) = (kept.first(), kept.last()) else { return };
    let (mut values, mut weights) = (vec![0.0; places.len()], vec![0.1; places.len()]);
    values[..first].fill(-places[first]);
    values[last..].fill(-places[last]);
    for pair in kept.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        for (step, value) in values[from..to].iter_mut().enumerate() {
            let share = step as f64 / (to - from) as f64;
            *value = -(1.0 - share) * places[from] - share * places[to];
        }
    }
    let stiff = Little::Bend.stiffness(SLOW, rate);
    kept.iter().for_each(|frame| weights[*frame] = exact(stiff));
    let back = smooth(&values, &weights, Little::Bend, stiff);
    places.iter_mut().zip(back).for_each(|(place, back)| *place += back);
}
