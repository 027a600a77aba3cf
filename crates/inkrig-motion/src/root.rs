//! Root motion: how the character travels and where it is headed.

use crate::{Takes, kinematics::Pose, rotation::twist_angle};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// How the travel joint of a character moves, in a frame whose y axis is up. Built once by [`RootMotion::of`].
#[derive(Debug, Clone, PartialEq)]
pub struct RootMotion {
    /// The joint that travels: see [`Clip::travel_joint`](crate::Clip::travel_joint).
    pub joint: usize,
    /// Turns the space of the travel joint's parent so that y is up there too. Identity for an ordinary root.
    pub world_from_parent: Quat,
    /// Where the travel joint's parent is, metres; the origin for an ordinary root.
    pub parent_in_world: Vec3,
    /// Its place at every frame, metres, y up.
    pub places: Vec<Vec3>,
    /// Its rotation at every frame, y up.
    pub rotations: Vec<Quat>,
    /// Its heading at every frame: the turn about the vertical since the first frame, radians, without jumps of a
    /// full turn (so a dancer who spins twice ends at 4 pi).
    pub headings: Vec<f32>,
    /// First frames of the takes: no step leads into these.
    starts: Vec<usize>,
}

impl RootMotion {
    /// Reads the travel of one or more takes. What stands above the travel joint is taken as still, as it is in its first frame.
    pub fn of(takes: &Takes) -> Self {
        Self::of_joint(takes, takes.clip().travel_joint())
    }

    /// The same for a given joint: one that travels in another motion of the same skeleton.
    ///
    /// # Panics
    /// When the skeleton has no such joint.
    pub fn of_joint(takes: &Takes, joint: usize) -> Self {
        let clip = takes.clip();
        let mut pose = Pose::new(clip.skeleton());
        pose.set(clip, 0);
        let joints = clip.skeleton().joints();
        let parent = joints[joint].parent;
        let world_from_parent = parent.map_or(Quat::IDENTITY, |parent| pose.rotations[parent]);
        let parent_in_world = parent.map_or(Vec3::ZERO, |parent| pose.positions[parent]);
        let places = (0..clip.frames())
            .map(|frame| {
                let local = clip.track(joint).map_or(joints[joint].offset, |values| values[frame]);
                parent_in_world + world_from_parent * local
            })
            .collect();
        let rotations: Vec<Quat> =
            (0..clip.frames()).map(|frame| world_from_parent * clip.rotations(frame)[joint]).collect();
        let headings = headings(&rotations);
        let starts = takes.ranges().map(|range| range.start).collect();
        Self { joint, world_from_parent, parent_in_world, places, rotations, headings, starts }
    }

    /// Displacement since the frame before, metres a frame; the first of a take is a copy of its second.
    pub fn velocities(&self) -> Vec<Vec3> {
        self.steps(&self.places, |from, to| to - from)
    }

    /// Turn about the vertical since the frame before, radians a frame; the first of a take is a copy of its second.
    pub fn yaw_rates(&self) -> Vec<f32> {
        self.steps(&self.headings, |from, to| to - from)
    }

    fn steps<T: Copy + Default>(&self, values: &[T], step: impl Fn(T, T) -> T) -> Vec<T> {
        let mut steps: Vec<T> = std::iter::once(T::default())
            .chain(values.windows(2).map(|pair| step(pair[0], pair[1])))
            .take(values.len())
            .collect();
        for (index, &start) in self.starts.iter().enumerate() {
            let end = self.starts.get(index + 1).copied().unwrap_or(values.len());
            steps[start] = if start + 1 < end { steps[start + 1] } else { T::default() };
        }
        steps
    }
}

/// The turn about the vertical since the first rotation, radians, continuous.
fn headings(rotations: &[Quat]) -> Vec<f32> {
    let Some(first) = rotations.first() else { return Vec::new() };
    let from_first = first.inverse();
    let mut heading = 0.0_f32;
    (rotations.iter())
        .map(|&rotation| {
            heading += wrap_angle(twist_angle(rotation * from_first, Vec3::Y) - heading);
            heading
        })
        .collect()
}

/// The same angle in -pi..=pi.
pub fn wrap_angle(angle: f32) -> f32 {
    let wrapped = angle - TAU * (angle / TAU).round();
    wrapped.clamp(-PI, PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Clip, Joint, Skeleton, TranslationTrack};
    use std::sync::Arc;

    #[test]
    fn a_spin_is_counted_on() {
        let skeleton = Arc::new(Skeleton::new(vec![Joint::new("root", None, Vec3::ZERO)]).unwrap());
        let rotations =
            (0..50).map(|f| Quat::from_rotation_y(0.3 * f as f32) * Quat::from_rotation_x(0.2)).collect();
        let values = (0..50).map(|f| Vec3::new(0.0, 1.0, 0.1 * f as f32)).collect();
        let clip = Clip::new(skeleton, 30.0, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap();
        let root = RootMotion::of(&clip.into());
        assert!((root.headings[49] - 14.7).abs() < 1e-3);
        assert!(root.velocities()[0].distance(Vec3::Z * 0.1) < 1e-6);
        assert!((root.yaw_rates()[0] - 0.3).abs() < 1e-4);
    }

    #[test]
    fn a_root_that_lies_on_its_side_is_stood_up() {
        let skeleton = Skeleton::new(vec![
            Joint::new("world", None, Vec3::ZERO),
            Joint::new("hips", Some(0), Vec3::ZERO),
        ]);
        let tilt = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let rotations = vec![tilt, Quat::IDENTITY, tilt, Quat::from_rotation_z(0.5)];
        let values = vec![Vec3::Z, Vec3::new(1.0, 0.0, 1.0)];
        let clip = Clip::new(
            Arc::new(skeleton.unwrap()),
            30.0,
            rotations,
            vec![TranslationTrack { joint: 1, values }],
        );
        let root = RootMotion::of(&clip.unwrap().into());
        assert!(root.places[0].distance(Vec3::Y) < 1e-6);
        assert!((root.headings[1] - 0.5).abs() < 1e-5);
    }
}
