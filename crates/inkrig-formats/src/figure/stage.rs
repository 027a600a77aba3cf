//! From moving nodes to a clip.
//!
//! A [`Clip`] has joints whose axes lie along the world's while the figure rests; nodes rest at any angle and scale.
//! Every frame is therefore placed in the world as the file says it, scales and matrices included, and taken apart
//! again: a joint's rotation is what it has turned since the rest pose, and where its place in its parent is not that
//! of the rest pose it gets a translation track.

use super::{Figure, rotation_of};
use crate::{FormatError, UpAxis};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{DAffine3, DMat3, DQuat, DVec3, Quat},
};
use std::sync::Arc;

/// Joints that leave their places by less than this part of the figure's size, all of a chain together, have no
/// translation: more than rounding does, and less than matters.
const STILL: f64 = 2e-6;

/// Where things are in the world when the figure rests.
pub(crate) struct Stage<'f> {
    pub(crate) figure: &'f Figure,
    /// The clip's world from each node, at rest.
    pub(crate) rest: Vec<Placed>,
    /// See [`STILL`].
    still: f64,
}

/// A node in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    /// World from node.
    pub(crate) world: DAffine3,
    /// The rotations on the way, without what scales and matrices do.
    pub(crate) turned: DQuat,
}

/// Puts the nodes of a chain where they are at a frame.
pub(crate) type Placing<'p> = &'p mut dyn FnMut(usize, &mut [Placed]) -> Result<(), FormatError>;

impl Placed {
    pub(crate) const STILL: Self = Self { world: DAffine3::IDENTITY, turned: DQuat::IDENTITY };

    /// What the roots stand in: the file's unit and axes.
    pub(crate) fn origin(clip_from_file: DAffine3) -> Self {
        let matrix = clip_from_file.matrix3;
        let unscaled = matrix * (1.0 / matrix.determinant().cbrt());
        Self { world: clip_from_file, turned: DQuat::from_mat3(&unscaled) }
    }
}

/// The clip's world from the file's, for the axes that a clip can be written in.
pub(crate) fn clip_from_file(metres_per_unit: f64, up: UpAxis) -> DAffine3 {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.clip_from_file(axis) * metres_per_unit);
    DAffine3::from_mat3(DMat3::from_cols(x, y, z))
}

impl<'f> Stage<'f> {
    /// `rest` has the place of every node of the figure's chain.
    pub(crate) fn new(figure: &'f Figure, rest: Vec<Placed>) -> Self {
        Self { figure, rest, still: STILL }
    }

    /// For files whose rest pose and whose motion were reckoned apart from each other, `still` being how far places may lie
    /// apart for that, as a part of the figure's size.
    pub(crate) fn with_still(self, still: f64) -> Self {
        Self { still, ..self }
    }

    /// Whether a joint's children see it stretched along some axes more than along others, or mirrored.
    pub(crate) fn has_uneven_scale(&self) -> bool {
        let parents = self.figure.joints.iter().filter_map(|joint| self.joint_node(joint.parent));
        parents.filter_map(|node| self.rest.get(node)).any(|placed| {
            let axes =
                [placed.world.matrix3.x_axis, placed.world.matrix3.y_axis, placed.world.matrix3.z_axis];
            let lengths = axes.map(DVec3::length);
            let (low, high) = (
                lengths.iter().copied().fold(f64::MAX, f64::min),
                lengths.iter().copied().fold(0.0, f64::max),
            );
            high > low * 1.001 || placed.world.matrix3.determinant() < 0.0
        })
    }

    /// The skeleton at rest.
    pub(crate) fn skeleton(&self) -> Result<Skeleton, FormatError> {
        let joints = self.figure.joints.iter().map(|joint| Joint {
            name: joint.name.clone(),
            parent: joint.parent,
            offset: self.rest_offset(joint.parent, joint.node).as_vec3(),
            end_site: joint.end_site,
        });
        Ok(Skeleton::new(joints.collect())?)
    }

    /// What a joint may leave its place by and still have no translation, metres.
    pub(crate) fn still(&self, skeleton: &Skeleton) -> f64 {
        let depth = skeleton.depths().into_iter().max().unwrap_or(0) as f64;
        self.still / (1.0 + depth) * f64::from(skeleton.extent()).max(1e-6)
    }

    /// The clip of `frames` frames. `place` is asked for all of them twice, in order.
    pub(crate) fn clip(
        &self,
        frames: usize,
        frame_rate: f64,
        place: Placing<'_>,
    ) -> Result<Clip, FormatError> {
        let skeleton = Arc::new(self.skeleton()?);
        let joints = skeleton.len();
        let mut pose = Pose { stage: self, placed: self.rest.clone(), turns: vec![DQuat::IDENTITY; joints] };
        // Once to see which joints leave their places, once to write it all down.
        let still = self.still(&skeleton);
        let mut moved = vec![false; joints];
        for frame in 0..frames {
            place(frame, &mut pose.placed)?;
            pose.turn_all();
            for (joint, moved) in moved.iter_mut().enumerate().filter(|(_, moved)| !**moved) {
                *moved = pose.offset(joint).distance(pose.rest_offset(joint)) > still;
            }
        }
        let mut rotations = Vec::with_capacity(frames * joints);
        let mut translations: Vec<TranslationTrack> = (0..joints)
            .filter(|joint| moved.get(*joint) == Some(&true))
            .map(|joint| TranslationTrack { joint, values: Vec::with_capacity(frames) })
            .collect();
        for frame in 0..frames {
            place(frame, &mut pose.placed)?;
            pose.turn_all();
            rotations.extend((0..joints).map(|joint| pose.rotation(joint)));
            for track in &mut translations {
                track.values.push(pose.offset(track.joint).as_vec3());
            }
        }
        Ok(Clip::new(skeleton, frame_rate, rotations, translations)?)
    }

    fn rest_offset(&self, parent: Option<usize>, node: usize) -> DVec3 {
        let place = |node: usize| self.rest.get(node).map_or(DVec3::ZERO, |placed| placed.world.translation);
        place(node) - self.joint_node(parent).map_or(DVec3::ZERO, place)
    }

    /// The node of a joint.
    pub(crate) fn joint_node(&self, joint: Option<usize>) -> Option<usize> {
        Some(self.figure.joints.get(joint?)?.node)
    }

    /// What a node has turned since the rest pose, along the world's axes.
    fn turned(&self, node: usize, now: &Placed) -> DQuat {
        let Some(rest) = self.rest.get(node) else { return DQuat::IDENTITY };
        // Mirrors and uneven scales need the matrices; where something is flat, only the rotations tell.
        let flat = || now.turned * rest.turned.inverse();
        let inverse = rest.world.matrix3.inverse();
        if inverse.is_finite() {
            rotation_of(now.world.matrix3 * inverse).unwrap_or_else(flat)
        } else {
            flat()
        }
    }
}

/// One frame being taken apart.
struct Pose<'s, 'f> {
    stage: &'s Stage<'f>,
    placed: Vec<Placed>,
    /// What each joint has turned since the rest pose, along the world's axes.
    turns: Vec<DQuat>,
}

impl Pose<'_, '_> {
    fn turn_all(&mut self) {
        let joints = self.stage.figure.joints.iter();
        for (turn, joint) in self.turns.iter_mut().zip(joints) {
            if let Some(placed) = self.placed.get(joint.node) {
                *turn = self.stage.turned(joint.node, placed);
            }
        }
    }

    fn turn(&self, joint: Option<usize>) -> DQuat {
        joint.and_then(|joint| self.turns.get(joint)).copied().unwrap_or(DQuat::IDENTITY)
    }

    fn parent(&self, joint: usize) -> Option<usize> {
        self.stage.figure.joints.get(joint)?.parent
    }

    fn rotation(&self, joint: usize) -> Quat {
        (self.turn(self.parent(joint)).inverse() * self.turn(Some(joint))).normalize().as_quat()
    }

    /// The joint's place in its parent, along the axes that the parent has turned.
    fn offset(&self, joint: usize) -> DVec3 {
        let place = |node: Option<usize>| {
            node.and_then(|node| self.placed.get(node)).map_or(DVec3::ZERO, |placed| placed.world.translation)
        };
        let parent = self.parent(joint);
        let way = place(self.stage.joint_node(Some(joint))) - place(self.stage.joint_node(parent));
        self.turn(parent).inverse() * way
    }

    fn rest_offset(&self, joint: usize) -> DVec3 {
        let node = self.stage.joint_node(Some(joint));
        node.map_or(DVec3::ZERO, |node| self.stage.rest_offset(self.parent(joint), node))
    }
}
