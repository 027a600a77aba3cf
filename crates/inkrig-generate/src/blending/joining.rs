//! Clips placed end to end.

use crate::GenerateError;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::Joints;

/// Turns and moves a clip over the ground so that it begins as another ends: with the same heading, the root above the
/// same place. Heights stay.
pub fn placed_after(first: &[Joints], second: &[Joints]) -> Vec<Joints> {
    let (Some(end), Some(begin)) = (first.last(), second.first()) else { return second.to_vec() };
    let turn = Quat::from_rotation_y(heading(end) - heading(begin));
    let flat = |place: Vec3| Vec3::new(place.x, 0.0, place.z);
    let (from, to) = (flat(begin[0]), flat(end[0]));
    second.iter().map(|pose| pose.map(|place| turn * (place - from) + to)).collect()
}

/// Two clips one after the other, the second [placed](placed_after); the `transition` frames around the seam are straight
/// lines from the last pose that stays of the first to the first that stays of the second.
///
/// # Errors
/// When the transition does not leave a frame of each clip.
pub fn linear(first: &[Joints], second: &[Joints], transition: usize) -> Result<Vec<Joints>, GenerateError> {
    let (before, after) = (transition / 2, transition - transition / 2);
    if first.len() <= before || second.len() <= after {
        let (setting, value) = ("the transition", format!("{transition} frames"));
        return Err(GenerateError::Setting { setting, value, needed: "shorter than both clips" });
    }
    let mut all = first.to_vec();
    all.extend(placed_after(first, second));
    let (start, end) = (first.len() - before, first.len() + after);
    let (from, to) = (all[start - 1], all[end]);
    for (step, pose) in all[start..end].iter_mut().enumerate() {
        let share = (step + 1) as f32 / (transition + 1) as f32;
        *pose = std::array::from_fn(|joint| from[joint].lerp(to[joint], share));
    }
    Ok(all)
}

/// The angle about the vertical that +z is turned to, by hips and shoulders.
pub(crate) fn heading(pose: &Joints) -> f32 {
    let across = (pose[2] - pose[1]) + (pose[17] - pose[16]);
    let forward = Vec3::Y.cross(across);
    forward.x.atan2(forward.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A figure that walks along a heading, one joint a place of its own.
    fn walk(heading: f32, frames: usize) -> Vec<Joints> {
        let turn = Quat::from_rotation_y(heading);
        let pose: Joints = std::array::from_fn(|joint| {
            // Left is at +x when +z is forward.
            let side = if [1, 16].contains(&joint) {
                0.2
            } else if [2, 17].contains(&joint) {
                -0.2
            } else {
                0.0
            };
            Vec3::new(side, joint as f32 * 0.1, 0.0)
        });
        let place = |frame: usize| turn * Vec3::new(0.0, 0.0, 0.05 * frame as f32);
        (0..frames).map(|frame| pose.map(|joint| turn * joint + place(frame))).collect()
    }

    #[test]
    fn the_second_clip_goes_on_where_the_first_ends() {
        let first = walk(0.7, 30);
        let placed = placed_after(&first, &walk(-2.0, 30));
        assert!(placed[0].iter().zip(&first[29]).all(|(a, b)| a.distance(*b) < 1e-5));
        let step = placed[1][0] - placed[0][0];
        assert!(step.distance(first[1][0] - first[0][0]) < 1e-5);
    }

    #[test]
    fn the_seam_is_straight() {
        let all = linear(&walk(0.0, 30), &walk(1.0, 30), 20).unwrap();
        assert_eq!(all.len(), 60);
        let steps: Vec<f32> = all[19..41].windows(2).map(|pair| pair[0][0].distance(pair[1][0])).collect();
        assert!(steps.iter().all(|step| (step - steps[0]).abs() < 1e-5), "{steps:?}");
        assert!(linear(&walk(0.0, 10), &walk(1.0, 30), 20).is_err());
    }
}
