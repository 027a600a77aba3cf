//! Feet on the floor: what a generator makes floats and slides a little; people do not.
//!
//! In three steps, each no more than is needed: the whole body is raised and lowered slowly until what carries it is on the floor
//! (`floor.rs`), it travels so that standing feet stay where they are (`travel.rs`), and what is left is taken by the legs, which are solved
//! for feet that stand still, as in footskate cleanup (Kovar, Schreiner and Gleicher 2002), and by the pelvis, which comes down
//! where a leg is too short (`legs.rs`). Flights keep their arc. The floor is y = 0; a toe that stands is on it.

mod contacts;
mod floor;
mod kept;
mod legs;
mod smoother;
mod travel;

use super::Joints;
use super::body::check;
use super::bones::{double, single};
use super::facing::Pose;
use crate::{Clip, MotionError};
use glam::{DVec3, Vec3};
use kept::Pins;

pub use kept::Kept;

/// A motion whose feet are on the floor, and what was changed for that.
#[derive(Debug, Clone, PartialEq)]
pub struct Footing {
    /// The motion: every bone is as long at each frame as it was.
    pub frames: Vec<Joints>,
    /// Whether the left and the right foot stand.
    pub standing: Vec<[bool; 2]>,
    /// Whether the body is in the air, with nothing on the floor.
    pub airborne: Vec<bool>,
    /// How far the whole body was moved, metres; legs and what the pelvis gives way to them come on top.
    pub moved: Vec<Vec3>,
}

impl Footing {
    /// The largest distance of a joint from where it was in `before` beyond what the whole body was moved, metres.
    pub fn largest_bend(&self, before: &[Joints]) -> f32 {
        let pairs = self.frames.iter().zip(before).zip(&self.moved);
        let change = |((own, before), moved): ((&Joints, &Joints), &Vec3)| {
            own.iter().zip(before).map(|(own, before)| own.distance(*before + *moved)).fold(0.0, f32::max)
        };
        pairs.map(change).fold(0.0, f32::max)
    }
}

/// Puts a motion on the floor and keeps its feet where they stand.
///
/// `contacts` are a network's opinion of left ankle, left foot, right ankle, right foot, from 0 (moves) to 1 (stands), in
/// the order of [`Blocks::CONTACTS`](super::Blocks::CONTACTS); none for frames beyond its end. They are a hint among others: heights and speeds count more.
/// `kept` joints are, on average over a frame, brought no farther from the heights that they are asked to have than they were by moving the body, and
/// stay as they are otherwise; those of frames beyond the motion do not count.
///
/// # Errors
/// When a position is not finite, the rate is none that a clip may have, or a kept joint is none of the body's.
pub fn keep_footing(
    frames: &[Joints],
    contacts: &[[f32; 4]],
    frame_rate: f64,
    kept: &[Kept],
) -> Result<Footing, MotionError> {
    check(frames)?;
    if !Clip::FRAME_RATES.contains(&frame_rate) {
        return Err(MotionError::FrameRate(frame_rate));
    }
    let pins = Pins::of(kept, frames.len())?;
    let before: Vec<Pose> = frames.iter().map(double).collect();
    let mut poses = before.clone();
    let form = (frame_rate, contacts::heel(&before, frame_rate));
    let airborne = floor::stand(&mut poses, form, &pins);
    let first = contacts::planted(&poses, contacts, &airborne, form);
    travel::travel(&mut poses, &first, &pins, form);
    let planted = contacts::planted(&poses, contacts, &airborne, form);
    let moved: Vec<DVec3> = poses.iter().zip(&before).map(|(pose, before)| pose[0] - before[0]).collect();
    legs::hold(&mut poses, &planted, &airborne, &pins, form);
    Ok(Footing {
        frames: poses.iter().map(single).collect(),
        standing: planted,
        airborne,
        moved: moved.iter().map(|moved| moved.as_vec3()).collect(),
    })
}
