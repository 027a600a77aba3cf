//! Whole characters put elsewhere on the ground, frame by frame.

use super::turned;
use crate::{Clip, MotionError, TranslationTrack};
use glam::{DQuat, DVec2, DVec3, Quat, Vec3};

/// A rigid move over the ground: a turn to the left about `from`, which then comes to lie at `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundMove {
    /// Radians.
    pub turn: f64,
    /// Metres.
    pub from: DVec2,
    /// Metres.
    pub to: DVec2,
}

impl GroundMove {
    /// Where a point of the ground comes to lie.
    pub(super) fn of(&self, point: DVec2) -> DVec2 {
        self.to + turned(point - self.from, self.turn)
    }

    fn of_world(&self, place: Placement) -> Placement {
        let ground = self.of(DVec2::new(place.position.x, place.position.z));
        Placement {
            rotation: DQuat::from_rotation_y(self.turn) * place.rotation,
            position: DVec3::new(ground.x, place.position.y, ground.y),
        }
    }
}

/// A joint in the world or in its parent's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub(super) rotation: DQuat,
    pub(super) position: DVec3,
}

impl Placement {
    pub(super) const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, position: DVec3::ZERO };

    /// The place of something that is at `local` in this joint's space.
    pub(super) fn then(self, local: Self) -> Self {
        Self {
            rotation: self.rotation * local.rotation,
            position: self.position + self.rotation * local.position,
        }
    }

    /// The place in this joint's space of something that is at `world`.
    pub(super) fn seen(self, world: Self) -> Self {
        let back = self.rotation.inverse();
        Self { rotation: back * world.rotation, position: back * (world.position - self.position) }
    }

    /// A joint's place in its parent's space.
    pub(super) fn local(clip: &Clip, joint: usize, frame: usize) -> Self {
        let rest = clip.skeleton().joints()[joint].offset;
        let position = clip.track(joint).map_or(rest, |values| values[frame]);
        Self { rotation: clip.rotations(frame)[joint].as_dquat().normalize(), position: position.as_dvec3() }
    }

    /// A joint's place in the world.
    pub(super) fn world(clip: &Clip, joint: usize, frame: usize) -> Self {
        let mut place = Self::local(clip, joint, frame);
        let mut above = clip.skeleton().joints()[joint].parent;
        while let Some(parent) = above {
            place = Self::local(clip, parent, frame).then(place);
            above = clip.skeleton().joints()[parent].parent;
        }
        place
    }

    /// The world where there is no parent, else the parent's place.
    pub(super) fn of_parent(clip: &Clip, parent: Option<usize>, frame: usize) -> Self {
        parent.map_or(Self::IDENTITY, |parent| Self::world(clip, parent, frame))
    }

    /// As a clip holds it.
    pub(super) fn parts(self) -> (Quat, Vec3) {
        (self.rotation.normalize().as_quat(), self.position.as_vec3())
    }
}

/// The clip with everything moved over the ground, one move a frame (frames without one stay): the travelling joint, other
/// roots, and what else hangs on the joints above the travelling one. Those themselves stay.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn move_over_ground(clip: &Clip, travel_joint: usize, moves: &[GroundMove]) -> Result<Clip, MotionError> {
    carry(clip, travel_joint, |frame, place| moves.get(frame).map_or(place, |step| step.of_world(place)))
}

/// The clip shifted as a whole, by a vector a frame (frames without one stay), metres.
///
/// # Errors
/// As [`move_over_ground`].
pub fn shift(clip: &Clip, travel_joint: usize, by: &[Vec3]) -> Result<Clip, MotionError> {
    carry(clip, travel_joint, |frame, place| {
        let by = by.get(frame).map_or(DVec3::ZERO, |by| by.as_dvec3());
        Placement { position: place.position + by, ..place }
    })
}

/// Moves all that travels, as it is placed in the world.
fn carry(
    clip: &Clip,
    travel_joint: usize,
    moved: impl Fn(usize, Placement) -> Placement,
) -> Result<Clip, MotionError> {
    let joints = clip.skeleton().joints();
    let above = clip.skeleton().ancestors(travel_joint);
    let carried: Vec<usize> = (0..joints.len())
        .filter(|&joint| {
            let hangs = joints[joint].parent.is_none_or(|parent| above[parent]);
            hangs && !above[joint] && (!joints[joint].end_site || joint == travel_joint)
        })
        .collect();
    let mut parts = Parts::of(clip);
    for joint in carried {
        let places = (0..clip.frames()).map(|frame| {
            let parent = Placement::of_parent(clip, joints[joint].parent, frame);
            parent.seen(moved(frame, parent.then(Placement::local(clip, joint, frame))))
        });
        parts.place(joint, places);
    }
    parts.finish(clip)
}

/// Rotations and translations of a clip that is being changed.
pub(super) struct Parts {
    joints: usize,
    pub(super) rotations: Vec<Quat>,
    pub(super) tracks: Vec<TranslationTrack>,
}

impl Parts {
    pub(super) fn of(clip: &Clip) -> Self {
        let rotations = (0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied()).collect();
        Self { joints: clip.skeleton().len(), rotations, tracks: clip.translations().to_vec() }
    }

    /// Sets a joint's local places at all frames.
    pub(super) fn place(&mut self, joint: usize, places: impl Iterator<Item = Placement>) {
        let mut values = Vec::with_capacity(self.rotations.len() / self.joints);
        for (pose, place) in self.rotations.chunks_mut(self.joints).zip(places) {
            let (rotation, translation) = place.parts();
            pose[joint] = rotation;
            values.push(translation);
        }
        self.tracks.retain(|track| track.joint != joint);
        self.tracks.push(TranslationTrack { joint, values });
        self.tracks.sort_by_key(|track| track.joint);
    }

    pub(super) fn finish(self, clip: &Clip) -> Result<Clip, MotionError> {
        Clip::new(clip.skeleton().clone(), clip.frame_rate(), self.rotations, self.tracks)
    }
}
