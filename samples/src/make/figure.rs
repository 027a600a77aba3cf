//! A figure under construction in double precision: rest skeleton, pose, and the way to a [`Clip`].

use inkrig_motion::{
    Clip, Joint, MotionError, Skeleton, TranslationTrack,
    glam::{DQuat, DVec3, Quat},
};
use std::sync::Arc;

/// Frames a second of all motion samples.
pub const FRAME_RATE: f64 = 30.0;

/// The rest skeleton. Joint 0 is the only root and carries the travel.
#[derive(Debug, Clone, Default)]
pub struct Rig {
    joints: Vec<(String, Option<usize>, DVec3, bool)>,
}

impl Rig {
    /// Adds a joint below the joint named `parent` (the first joint has none) and returns its index.
    pub fn joint(&mut self, name: &str, parent: &str, offset: [f64; 3]) -> usize {
        self.joints.push((name.to_owned(), self.find(parent), DVec3::from_array(offset), false));
        self.joints.len() - 1
    }

    /// Adds the tip of the chain that ends in the joint named `parent`.
    pub fn end(&mut self, parent: &str, offset: [f64; 3]) {
        self.joints.push((format!("{parent}_end"), self.find(parent), DVec3::from_array(offset), true));
    }

    /// Index of the joint of that name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.0 == name)
    }

    /// How many joints there are, end sites included.
    #[expect(clippy::len_without_is_empty, reason = "a figure without joints is never made")]
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Offset of a joint from its parent, metres.
    pub fn offset(&self, joint: usize) -> DVec3 {
        self.joints[joint].2
    }

    /// The pose in which nothing is turned.
    pub fn rest(&self) -> Pose<'_> {
        Pose { rig: self, root: self.offset(0), local: vec![DQuat::IDENTITY; self.len()] }
    }

    /// The motion that shows `poses` one after the other at [`FRAME_RATE`].
    ///
    /// # Errors
    /// When there is no pose or a number is not finite.
    pub fn clip(&self, poses: &[Pose<'_>]) -> Result<Clip, MotionError> {
        self.clip_against(&self.rest(), poses)
    }

    /// The same motion with the first pose as the rest pose.
    ///
    /// # Errors
    /// When there is no pose or a number is not finite.
    pub fn clip_from(&self, poses: &[Pose<'_>]) -> Result<Clip, MotionError> {
        self.clip_against(poses.first().unwrap_or(&self.rest()), poses)
    }

    fn clip_against(&self, rest: &Pose<'_>, poses: &[Pose<'_>]) -> Result<Clip, MotionError> {
        let turned: Vec<DQuat> = (0..self.len()).map(|joint| rest.world(joint).1).collect();
        let above = |joint: usize| self.joints[joint].1.map_or(DQuat::IDENTITY, |parent| turned[parent]);
        let joints = (self.joints.iter().enumerate())
            .map(|(index, (name, parent, offset, end_site))| Joint {
                name: name.clone(),
                parent: *parent,
                offset: if index == 0 { rest.root } else { above(index) * *offset }.as_vec3(),
                end_site: *end_site,
            })
            .collect();
        let local = |(joint, rotation): (usize, &DQuat)| {
            let end_site = self.joints[joint].3;
            let rotation = above(joint) * *rotation * turned[joint].inverse();
            if end_site { Quat::IDENTITY } else { rotation.as_quat() }
        };
        let rotations = poses.iter().flat_map(|pose| pose.local.iter().enumerate().map(local)).collect();
        let values = poses.iter().map(|pose| pose.root.as_vec3()).collect();
        let travel = TranslationTrack { joint: 0, values };
        Clip::new(Arc::new(Skeleton::new(joints)?), FRAME_RATE, rotations, vec![travel])
    }
}

/// One pose of a [`Rig`].
#[derive(Debug, Clone)]
pub struct Pose<'a> {
    rig: &'a Rig,
    /// Place of the root, metres, world.
    pub root: DVec3,
    /// Rotation of every joint in its parent's space.
    pub local: Vec<DQuat>,
}

impl<'a> Pose<'a> {
    /// The skeleton that is posed.
    pub fn rig(&self) -> &'a Rig {
        self.rig
    }

    /// World place and rotation of a joint.
    pub fn world(&self, joint: usize) -> (DVec3, DQuat) {
        let (_, parent, offset, _) = &self.rig.joints[joint];
        match parent {
            None => (self.root, self.local[joint]),
            Some(parent) => {
                let (place, rotation) = self.world(*parent);
                (place + rotation * *offset, rotation * self.local[joint])
            }
        }
    }

    /// World place of a point given in a joint's space.
    pub fn point(&self, joint: usize, local: DVec3) -> DVec3 {
        let (place, rotation) = self.world(joint);
        place + rotation * local
    }

    /// Turns a joint so that its world rotation is `rotation`. Its parents must have been turned before.
    pub fn set_world(&mut self, joint: usize, rotation: DQuat) {
        let parent = self.rig.joints[joint].1.map_or(DQuat::IDENTITY, |parent| self.world(parent).1);
        self.local[joint] = (parent.inverse() * rotation).normalize();
    }
}

/// The rotation with the given yaw about y, then pitch about x, then roll about z (intrinsic), radians.
pub fn turn(yaw: f64, pitch: f64, roll: f64) -> DQuat {
    DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch) * DQuat::from_rotation_z(roll)
}

/// The unit vector on the ground that a yaw of `heading` turns +z to.
pub fn ahead(heading: f64) -> DVec3 {
    DVec3::new(heading.sin(), 0.0, heading.cos())
}

/// The unit vector on the ground to the left of `heading`.
pub fn left_of(heading: f64) -> DVec3 {
    DVec3::new(heading.cos(), 0.0, -heading.sin())
}
