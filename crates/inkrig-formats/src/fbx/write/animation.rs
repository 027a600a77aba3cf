//! The clip: a stack with one layer, and a node of three curves for each property that is moved.

use super::{
    Scene,
    curve::{self, Key, Shape},
    document::{Document, Value, object_name},
    ids::Ids,
    keys::{Dense, thinned},
};
use crate::{Axis, Channel, FormatError, euler::EulerSolver, fbx::TICKS};
use Value::{Double, Long, Text};
use inkrig_motion::glam::Vec3;

/// The curves of a clip.
pub(super) struct Animation {
    name: String,
    last_tick: i64,
    moves: Vec<Move>,
}

/// What one property of a joint does.
struct Move {
    joint: usize,
    property: Property,
    /// Of x, y, z.
    keys: [Vec<Key>; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Property {
    Translation,
    Rotation,
}

impl Animation {
    /// One linear key a frame, or the few that were asked for; of what does not change, one at each end.
    pub(super) fn of(scene: &Scene<'_>) -> Result<Self, FormatError> {
        let (clip, keyed) = (scene.clip, scene.options.keys.as_ref());
        let ticks: Vec<i64> = (0..clip.frames())
            .map(|frame| (frame as f64 / clip.frame_rate() * TICKS).round() as i64)
            .collect();
        let mut moves = Vec::new();
        for (index, joint) in clip.skeleton().joints().iter().enumerate() {
            if let Some(track) = clip.track(index) {
                let places: Vec<[f64; 3]> = (track.iter())
                    .map(|place| Ok(scene.place(*place, index)?.to_array()))
                    .collect::<Result<_, FormatError>>()?;
                let numbers = |value| Ok(scene.place(Vec3::from_array(value), index)?.to_array());
                let keys =
                    thinned(linear(&ticks, &places), keyed, |keyed| &keyed.translations, index, numbers)?;
                moves.push(Move {
                    joint: index,
                    property: Property::Translation,
                    keys: keys.map(ends_of_what_stays),
                });
            }
            if !joint.end_site {
                let dense = linear(&ticks, &angles(scene, index));
                let degrees =
                    |[x, y, z, _]: [f32; 4]| Ok([x, y, z].map(|angle| f64::from(angle).to_degrees()));
                let keys = thinned(dense, keyed, |keyed| &keyed.rotations, index, degrees)?;
                moves.push(Move {
                    joint: index,
                    property: Property::Rotation,
                    keys: keys.map(ends_of_what_stays),
                });
            }
        }
        Ok(Self { name: scene.name.clone(), last_tick: ticks.last().copied().unwrap_or(0), moves })
    }

    /// How many nodes of curves there are.
    pub(super) fn curve_nodes(&self) -> usize {
        self.moves.len()
    }

    /// When the last frame is.
    pub(super) fn last_tick(&self) -> i64 {
        self.last_tick
    }

    pub(super) fn objects(&self, document: &mut Document, ids: &Ids) -> Result<(), FormatError> {
        let title = object_name(&self.name, "AnimStack");
        document.open("AnimationStack", &[Long(Ids::STACK), Text(&title), Text("")])?;
        document.open("Properties70", &[])?;
        let times = [("LocalStart", 0), ("LocalStop", self.last_tick), ("ReferenceStart", 0)];
        for (name, tick) in times.into_iter().chain([("ReferenceStop", self.last_tick)]) {
            document.property(name, ["KTime", "Time", ""], &[Long(tick)])?;
        }
        document.close()?;
        document.close()?;
        let title = object_name(&self.name, "AnimLayer");
        document.open("AnimationLayer", &[Long(Ids::LAYER), Text(&title), Text("")])?;
        document.open("Properties70", &[])?;
        document.property("Weight", ["Number", "", "A"], &[Double(100.0)])?;
        document.close()?;
        document.close()?;
        for (index, moved) in self.moves.iter().enumerate() {
            let title = object_name(moved.property.short(), "AnimCurveNode");
            document.open("AnimationCurveNode", &[Long(ids.curve_node(index)), Text(&title), Text("")])?;
            document.open("Properties70", &[])?;
            for (axis, keys) in ["d|X", "d|Y", "d|Z"].into_iter().zip(&moved.keys) {
                let first = keys.first().map_or(0.0, |key| key.value);
                document.property(axis, ["Number", "", "A"], &[Double(first)])?;
            }
            document.close()?;
            document.close()?;
            for (axis, keys) in moved.keys.iter().enumerate() {
                curve::object(document, ids.curve(index, axis), keys)?;
            }
        }
        Ok(())
    }

    pub(super) fn connections(&self, document: &mut Document, ids: &Ids) -> Result<(), FormatError> {
        document.leaf("C", &[Text("OO"), Long(Ids::LAYER), Long(Ids::STACK)])?;
        for (index, moved) in self.moves.iter().enumerate() {
            let node = ids.curve_node(index);
            document.leaf("C", &[Text("OO"), Long(node), Long(Ids::LAYER)])?;
            let joint = Long(ids.model(moved.joint));
            document.leaf("C", &[Text("OP"), Long(node), joint, Text(moved.property.name())])?;
            for (axis, name) in ["d|X", "d|Y", "d|Z"].into_iter().enumerate() {
                document.leaf("C", &[Text("OP"), Long(ids.curve(index, axis)), Long(node), Text(name)])?;
            }
        }
        Ok(())
    }
}

impl Property {
    fn name(self) -> &'static str {
        match self {
            Self::Translation => "Lcl Translation",
            Self::Rotation => "Lcl Rotation",
        }
    }

    fn short(self) -> &'static str {
        match self {
            Self::Translation => "T",
            Self::Rotation => "R",
        }
    }
}

/// Angles about x, y and z of every frame, degrees. The format's usual order turns about x first, y next and z last,
/// all of them axes that stay where they are; so z comes first when each is turned by those before it.
fn angles(scene: &Scene<'_>, joint: usize) -> Vec<[f64; 3]> {
    let mut solver = EulerSolver::new(&[Axis::Z, Axis::Y, Axis::X].map(Channel::Rotation));
    let rotations = (0..scene.clip.frames()).filter_map(|frame| scene.clip.rotations(frame).get(joint));
    let angles = rotations.map(|rotation| {
        solver.next(scene.options.up.file_from_clip_rotation(rotation.as_dquat()));
        let mut angles = [0.0; 3];
        for (slot, degrees) in angles.iter_mut().rev().zip(solver.degrees()) {
            *slot = degrees;
        }
        angles
    });
    angles.collect()
}

fn linear(ticks: &[i64], values: &[[f64; 3]]) -> Dense {
    let [mut x, mut y, mut z] = [Vec::new(), Vec::new(), Vec::new()];
    for (&tick, &values) in ticks.iter().zip(values) {
        for (keys, value) in [&mut x, &mut y, &mut z].into_iter().zip(values) {
            keys.push(Key { tick, value, shape: Shape::Linear });
        }
    }
    [x, y, z]
}

fn ends_of_what_stays(mut keys: Vec<Key>) -> Vec<Key> {
    let (Some(first), Some(last)) = (keys.first().copied(), keys.last().copied()) else { return keys };
    let stays = |key: &Key| {
        let level =
            !matches!(key.shape, Shape::Cubic { slope, next_slope } if slope != 0.0 || next_slope != 0.0);
        level && key.value as f32 == first.value as f32
    };
    if keys.len() > 2 && keys.iter().all(stays) {
        keys = vec![first, last];
    }
    keys
}
