//! A clip as channels of nodes.

use super::parts::Parts;
use crate::{FormatError, lexer::LARGEST_NUMBER};
use inkrig_motion::glam::{Quat, Vec3};
use serde_json::{Value, json};

/// What one node does: a value a frame, in the node's parent.
///
/// Every frame is a key here. A writer of few keys would give times of its own and tangents, and the channel would say
/// CUBICSPLINE instead of LINEAR.
#[derive(Debug)]
pub(super) struct NodeMotion {
    pub(super) node: usize,
    pub(super) rotations: Vec<Quat>,
    /// None where the node stays in its place.
    pub(super) translations: Option<Vec<Vec3>>,
}

/// The animation; its numbers go to `parts`. What does not change gets a key at each end, but the first node always
/// has all keys, so that the frames can be counted.
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
    let times: Vec<f32> = (0..frames).map(|frame| (frame as f64 / frame_rate) as f32).collect();
    let all = parts.times(&times);
    let mut ends: Option<usize> = None;
    let mut out = Channels::default();
    for (index, motion) in nodes.iter().enumerate() {
        let mut ends = |parts: &mut Parts| {
            let times: Vec<f32> = times.first().into_iter().chain(times.last()).copied().collect();
            *ends.get_or_insert_with(|| parts.times(&times))
        };
        let still = index > 0 && frames > 2 && unchanging(&motion.rotations);
        let (input, output) = if still {
            (ends(parts), parts.rotations(&both_ends(&motion.rotations)))
        } else {
            (all, parts.rotations(&continuous(&motion.rotations)))
        };
        out.add(motion.node, "rotation", input, output);
        if let Some(places) = &motion.translations {
            check_places(motion.node, places)?;
            let (input, output) = if frames > 2 && unchanging(places) {
                (ends(parts), parts.vectors(&both_ends(places), None))
            } else {
                (all, parts.vectors(places, None))
            };
            out.add(motion.node, "translation", input, output);
        }
    }
    Ok(json!({ "name": name, "channels": out.channels, "samplers": out.samplers }))
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
    fn add(&mut self, node: usize, path: &str, input: usize, output: usize) {
        let target = json!({ "node": node, "path": path });
        self.channels.push(json!({ "sampler": self.samplers.len(), "target": target }));
        self.samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
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
