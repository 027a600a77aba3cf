//! Forward kinematics: from local rotations to places in the world.

use crate::{Clip, Skeleton};
use glam::{Quat, Vec3};

/// Joint positions over time: frames x joints, metres, world space.
#[derive(Debug, Clone, PartialEq)]
pub struct Positions {
    joints: usize,
    values: Vec<Vec3>,
}

impl Positions {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.len() / self.joints
    }

    /// Number of joints, end sites included.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// World positions of all joints at a frame, metres.
    ///
    /// # Panics
    /// When `frame` is not below [`Self::frames`].
    pub fn frame(&self, frame: usize) -> &[Vec3] {
        &self.values[frame * self.joints..(frame + 1) * self.joints]
    }

    /// Position differences to one joint of the same frame (frames x joints, metres, world axes): what the body
    /// does, without where it is.
    ///
    /// # Panics
    /// When `joint` is not below [`Self::joints`].
    pub fn relative_to(&self, joint: usize) -> Self {
        let mut values = self.values.clone();
        for frame in values.chunks_mut(self.joints) {
            let origin = frame[joint];
            frame.iter_mut().for_each(|value| *value -= origin);
        }
        Self { joints: self.joints, values }
    }
}

/// World positions of all joints at all frames.
pub fn positions(clip: &Clip) -> Positions {
    let joints = clip.skeleton().len();
    let mut pose = Pose::new(clip.skeleton());
    let mut values = Vec::with_capacity(joints * clip.frames());
    for frame in 0..clip.frames() {
        pose.set(clip, frame);
        values.extend_from_slice(&pose.positions);
    }
    Positions { joints, values }
}

/// One pose in the world; keep it between frames so that nothing is allocated again.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// World position of every joint, metres.
    pub positions: Vec<Vec3>,
    /// World rotation of every joint.
    pub rotations: Vec<Quat>,
}

impl Pose {
    /// The rest pose.
    pub fn new(skeleton: &Skeleton) -> Self {
        Self { positions: skeleton.rest_positions(), rotations: vec![Quat::IDENTITY; skeleton.len()] }
    }

    /// Takes the pose of `clip` at `frame`. The clip's skeleton must have as many joints as this pose.
    ///
    /// # Panics
    /// When `frame` is not below the clip's frames or the sizes differ.
    pub fn set(&mut self, clip: &Clip, frame: usize) {
        clip.local_translations(frame, &mut self.positions);
        let local = clip.rotations(frame);
        for (index, joint) in clip.skeleton().joints().iter().enumerate() {
            match joint.parent {
                None => self.rotations[index] = local[index],
                Some(parent) => {
                    let turned = self.rotations[parent] * self.positions[index];
                    self.positions[index] = self.positions[parent] + turned;
                    // Deep chains would otherwise drift off unit length.
                    self.rotations[index] = (self.rotations[parent] * local[index]).normalize();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, TranslationTrack};
    use std::{f32::consts::FRAC_PI_2, sync::Arc};

    #[test]
    fn a_bent_arm_is_where_it_should_be() {
        let skeleton = Skeleton::new(vec![
            Joint::new("shoulder", None, Vec3::ZERO),
            Joint::new("elbow", Some(0), Vec3::X),
            Joint::end("elbow_end", 1, Vec3::X),
        ]);
        let quarter = Quat::from_rotation_z(FRAC_PI_2);
        let track = TranslationTrack { joint: 0, values: vec![Vec3::new(0.0, 0.0, 5.0)] };
        let clip =
            Clip::new(Arc::new(skeleton.unwrap()), 30.0, vec![quarter, quarter, Quat::IDENTITY], vec![track]);
        let positions = positions(&clip.unwrap());
        assert!(positions.frame(0)[1].distance(Vec3::new(0.0, 1.0, 5.0)) < 1e-6);
        assert!(positions.frame(0)[2].distance(Vec3::new(-1.0, 1.0, 5.0)) < 1e-6);
        assert!(positions.relative_to(0).frame(0)[2].distance(Vec3::new(-1.0, 1.0, 0.0)) < 1e-6);
    }
}
