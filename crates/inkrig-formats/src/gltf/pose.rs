//! From moving nodes to a clip.
//!
//! A [`Clip`] has joints whose axes lie along the world's while the figure rests; nodes rest at any angle and scale.
//! Every frame is therefore placed in the world as the file says it, scales and matrices included, and taken apart
//! again: a joint's rotation is what it has turned since the rest pose, and where its place in its parent is not that
//! of the rest pose it gets a translation track.

use super::{
    document::Path,
    figure::Figure,
    forest::{Forest, Transform, rotation_of},
    timing::Timing,
    track::Track,
};
use crate::{Finding, FormatError};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{DAffine3, DMat3, DQuat, DVec3, Quat},
};
use std::sync::Arc;

/// Joints that leave their places by less than this part of the figure's size, all of a chain together, have no
/// translation: more than rounding does, and less than matters.
const STILL: f64 = 2e-6;

/// Where things are in the world, and what that is when the figure rests.
pub(super) struct Stage<'f> {
    pub(super) figure: &'f Figure,
    forest: &'f Forest,
    /// The file's unit and axes.
    clip_from_file: DAffine3,
    /// The clip's world from each node, at rest.
    pub(super) rest: Vec<Placed>,
}

/// A node in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    /// World from node.
    pub(super) world: DAffine3,
    /// The rotations on the way, without what scales and matrices do.
    pub(super) turned: DQuat,
}

impl<'f> Stage<'f> {
    pub(super) fn new(figure: &'f Figure, forest: &'f Forest, clip_from_file: DAffine3) -> Self {
        let still = Placed { world: DAffine3::IDENTITY, turned: DQuat::IDENTITY };
        let mut stage = Self { figure, forest, clip_from_file, rest: vec![still; forest.parents.len()] };
        let mut rest = stage.rest.clone();
        stage.place(&forest.rest, &mut rest);
        stage.rest = rest;
        stage
    }

    /// Places the nodes of the figure's chain.
    fn place(&self, local: &[Transform], placed: &mut [Placed]) {
        let origin = self.origin();
        for &node in &self.figure.chain {
            let parent = self.forest.parents.get(node).copied().flatten();
            let above = parent.and_then(|parent| placed.get(parent)).copied().unwrap_or(origin);
            let (Some(slot), Some(local)) = (placed.get_mut(node), local.get(node)) else { continue };
            let turned = (above.turned * local.rotation).normalize();
            *slot = Placed { world: above.world * local.affine(), turned };
        }
    }

    /// What the roots stand in.
    pub(super) fn origin(&self) -> Placed {
        Placed { world: self.clip_from_file, turned: DQuat::from_mat3(&self.unscaled()) }
    }

    fn unscaled(&self) -> DMat3 {
        let matrix = self.clip_from_file.matrix3;
        matrix * (1.0 / matrix.determinant().cbrt())
    }

    /// Whether a joint's children see it stretched along some axes more than along others, or mirrored.
    pub(super) fn has_uneven_scale(&self) -> bool {
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
    pub(super) fn skeleton(&self) -> Result<Skeleton, FormatError> {
        let joints = self.figure.joints.iter().map(|joint| Joint {
            name: joint.name.clone(),
            parent: joint.parent,
            offset: self.rest_offset(joint.parent, joint.node).as_vec3(),
            end_site: joint.end_site,
        });
        Ok(Skeleton::new(joints.collect())?)
    }

    /// What a joint may leave its place by and still have no translation, metres.
    pub(super) fn still(&self, skeleton: &Skeleton) -> f64 {
        let depth = skeleton.depths().into_iter().max().unwrap_or(0) as f64;
        STILL / (1.0 + depth) * f64::from(skeleton.extent()).max(1e-6)
    }

    fn rest_offset(&self, parent: Option<usize>, node: usize) -> DVec3 {
        let place = |node: usize| self.rest.get(node).map_or(DVec3::ZERO, |placed| placed.world.translation);
        place(node) - self.joint_node(parent).map_or(DVec3::ZERO, place)
    }

    /// The node of a joint.
    pub(super) fn joint_node(&self, joint: Option<usize>) -> Option<usize> {
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

/// Plays tracks over a skeleton.
pub(super) struct Player<'s, 'f, 'a> {
    stage: &'s Stage<'f>,
    tracks: Vec<Track<'a>>,
    timing: Timing,
    local: Vec<Transform>,
    placed: Vec<Placed>,
    turns: Vec<DQuat>,
}

impl<'s, 'f, 'a> Player<'s, 'f, 'a> {
    pub(super) fn new(stage: &'s Stage<'f>, tracks: Vec<Track<'a>>, timing: Timing) -> Self {
        let local = stage.forest.rest.clone();
        let placed = stage.rest.clone();
        let turns = vec![DQuat::IDENTITY; stage.figure.joints.len()];
        Self { stage, tracks, timing, local, placed, turns }
    }

    /// The whole clip of `frames` frames.
    pub(super) fn clip(&mut self, frames: usize, findings: &mut Vec<Finding>) -> Result<Clip, FormatError> {
        let skeleton = Arc::new(self.stage.skeleton()?);
        let joints = skeleton.len();
        // Once to see which joints leave their places, once to write it all down.
        let still = self.stage.still(&skeleton);
        let mut moved = vec![false; joints];
        let mut scaled = 0.0_f64;
        for frame in 0..frames {
            self.go_to(frame);
            scaled = scaled.max(self.largest_scaling());
            for (joint, moved) in moved.iter_mut().enumerate().filter(|(_, moved)| !**moved) {
                *moved = self.offset(joint).distance(self.rest_offset(joint)) > still;
            }
        }
        if scaled > 1e-3 {
            let message = "joints change their size in the clip; their places are kept, their sizes are not";
            findings.push(Finding::warning("gltf-scale", message.into()));
        }
        let mut rotations = Vec::with_capacity(frames * joints);
        let mut translations: Vec<TranslationTrack> = (0..joints)
            .filter(|joint| moved.get(*joint) == Some(&true))
            .map(|joint| TranslationTrack { joint, values: Vec::with_capacity(frames) })
            .collect();
        self.rewind();
        for frame in 0..frames {
            self.go_to(frame);
            rotations.extend((0..joints).map(|joint| self.rotation(joint)));
            for track in &mut translations {
                track.values.push(self.offset(track.joint).as_vec3());
            }
        }
        Ok(Clip::new(skeleton, self.timing.rate, rotations, translations)?)
    }

    fn rewind(&mut self) {
        self.tracks.iter_mut().for_each(Track::rewind);
    }

    fn go_to(&mut self, frame: usize) {
        let (time, slack) = (self.timing.start + frame as f64 / self.timing.rate, self.timing.slack);
        for track in &mut self.tracks {
            let Some(local) = self.local.get_mut(track.node) else { continue };
            local.matrix = None;
            match track.path {
                Path::Translation => local.translation = track.vector(time, slack),
                Path::Rotation => local.rotation = track.rotation(time, slack),
                Path::Scale => local.scale = track.vector(time, slack),
                Path::Other => {}
            }
        }
        self.stage.place(&self.local, &mut self.placed);
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

    /// How far any node's scale is from that of its rest, by ratio.
    fn largest_scaling(&self) -> f64 {
        let scales = self.tracks.iter().filter(|track| track.path == Path::Scale).filter_map(|track| {
            let (now, rest) =
                (self.local.get(track.node)?.scale, self.stage.forest.rest.get(track.node)?.scale);
            Some((now - rest).abs().max_element() / rest.abs().max_element().max(1e-9))
        });
        scales.fold(0.0, f64::max)
    }
}
