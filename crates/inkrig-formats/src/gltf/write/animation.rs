//! A clip as channels of nodes.

use super::parts::Parts;
use crate::{FormatError, lexer::LARGEST_NUMBER};
use inkrig_motion::{
    glam::{Quat, Vec3},
    keyframes::{Interpolation, Key},
};
use serde_json::{Value, json};

/// What one node does: a value a frame, in the node's parent.
#[derive(Debug)]
pub(super) struct NodeMotion {
    pub(super) node: usize,
    pub(super) rotations: Vec<Quat>,
    /// None where the node stays in its place.
    pub(super) translations: Option<Vec<Vec3>>,
    /// The same as few keys, where it is written so.
    pub(super) keys: Option<NodeKeys>,
}

/// What one node does, as few keys: in its parent, like all of [`NodeMotion`].
#[derive(Debug)]
pub(super) struct NodeKeys {
    pub(super) interpolation: Interpolation,
    pub(super) rotations: Vec<Key<4>>,
    pub(super) translations: Vec<Key<3>>,
}

/// The animation; its numbers go to `parts`. What does not change gets a key at each end, but without few keys the first
/// node always has all of them, so that the frames can be counted.
///
/// # Errors
/// When a node would stand further off than any reader takes for a place.
pub(super) fn animation(
    name: &str,
    frame_rate: f64,
    nodes: &[NodeMotion],
    parts: &mut Parts,
) -> Result<Value, FormatError> {
    let frames = nodes.first().map_or(0, |node| node.rotations.len());
    let seconds = |frame: usize| (frame as f64 / frame_rate) as f32;
    let mut times = Times { lists: Vec::new(), seconds: &seconds };
    let all: Vec<usize> = (0..frames).collect();
    let ends: Vec<usize> = all.first().into_iter().chain(all.last()).copied().collect();
    let mut out = Channels::default();
    for (index, motion) in nodes.iter().enumerate() {
        let counts = index == 0 && motion.keys.is_none();
        let keys = motion.keys.as_ref().filter(|keys| keys.rotations.len() > 1);
        if !counts && frames > 2 && unchanging(&motion.rotations) {
            let output = parts.rotations(&both_ends(&motion.rotations));
            out.add(motion.node, "rotation", "LINEAR", times.of(&ends, parts), output);
        } else if let Some(keys) = keys {
            let output = parts.rotations(&sampler(&keys.rotations, keys.interpolation, Quat::from_array));
            out.add(motion.node, "rotation", mode(keys), times.at(&keys.rotations, parts), output);
        } else {
            let output = parts.rotations(&continuous(&motion.rotations));
            out.add(motion.node, "rotation", "LINEAR", times.of(&all, parts), output);
        }
        let Some(places) = &motion.translations else { continue };
        check_places(motion.node, places)?;
        let keys = motion.keys.as_ref().filter(|keys| keys.translations.len() > 1);
        if frames > 2 && unchanging(places) {
            let output = parts.vectors(&both_ends(places), None);
            out.add(motion.node, "translation", "LINEAR", times.of(&ends, parts), output);
        } else if let Some(keys) = keys {
            let values = sampler(&keys.translations, keys.interpolation, Vec3::from_array);
            check_places(motion.node, &values)?;
            let output = parts.vectors(&values, None);
            out.add(motion.node, "translation", mode(keys), times.at(&keys.translations, parts), output);
        } else {
            let output = parts.vectors(places, None);
            out.add(motion.node, "translation", "LINEAR", times.of(&all, parts), output);
        }
    }
    Ok(json!({ "name": name, "channels": out.channels, "samplers": out.samplers }))
}

/// Lists of times that were written, so that none is written twice.
struct Times<'s> {
    lists: Vec<(Vec<usize>, usize)>,
    seconds: &'s dyn Fn(usize) -> f32,
}

impl Times<'_> {
    fn of(&mut self, frames: &[usize], parts: &mut Parts) -> usize {
        if let Some((_, accessor)) = self.lists.iter().find(|(list, _)| list == frames) {
            return *accessor;
        }
        let times: Vec<f32> = frames.iter().map(|&frame| (self.seconds)(frame)).collect();
        let accessor = parts.times(&times);
        self.lists.push((frames.to_vec(), accessor));
        accessor
    }

    fn at<const N: usize>(&mut self, keys: &[Key<N>], parts: &mut Parts) -> usize {
        let frames: Vec<usize> = keys.iter().map(|key| key.frame).collect();
        self.of(&frames, parts)
    }
}

fn mode(keys: &NodeKeys) -> &'static str {
    match keys.interpolation {
        Interpolation::Step => "STEP",
        Interpolation::Spline => "CUBICSPLINE",
    }
}

/// The numbers of a sampler: a value a key, for a spline between its tangents (glTF 2.0, 3.11).
fn sampler<const N: usize, T>(
    keys: &[Key<N>],
    interpolation: Interpolation,
    value: impl Fn([f32; N]) -> T,
) -> Vec<T> {
    let parts = |key: &Key<N>| match interpolation {
        Interpolation::Step => vec![key.value],
        Interpolation::Spline => vec![key.slope_in, key.value, key.slope_out],
    };
    keys.iter().flat_map(parts).map(value).collect()
}

/// Refuses places that could not be read again.
pub(super) fn check_places(node: usize, places: &[Vec3]) -> Result<(), FormatError> {
    let furthest = places.iter().map(|place| f64::from(place.abs().max_element())).fold(0.0, f64::max);
    if furthest <= LARGEST_NUMBER {
        return Ok(());
    }
    Err(FormatError::Write {
        what: format!("node {node} would stand {furthest:e} away from its parent, and numbers go up to 1e12"),
        hint: "the scales of the figure are far from 1; apply them in a 3D program first".into(),
    })
}

#[derive(Default)]
struct Channels {
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Channels {
    fn add(&mut self, node: usize, path: &str, mode: &str, input: usize, output: usize) {
        let target = json!({ "node": node, "path": path });
        self.channels.push(json!({ "sampler": self.samplers.len(), "target": target }));
        self.samplers.push(json!({ "input": input, "output": output, "interpolation": mode }));
    }
}

fn unchanging<T: PartialEq>(values: &[T]) -> bool {
    values.windows(2).all(|pair| pair.first() == pair.last())
}

fn both_ends<T: Copy>(values: &[T]) -> Vec<T> {
    values.first().into_iter().chain(values.last()).copied().collect()
}

/// Of the two signs of a rotation the one nearer to the key before: some programs mix the numbers as they are.
fn continuous(rotations: &[Quat]) -> Vec<Quat> {
    let mut before = Quat::IDENTITY;
    let signed = rotations.iter().map(|&rotation| {
        before = if before.dot(rotation) < 0.0 { -rotation } else { rotation };
        before
    });
    signed.collect()
}
