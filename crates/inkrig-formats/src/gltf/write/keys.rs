//! Few keys of a clip as few keys of nodes.
//!
//! Nodes rest at any angle and scale, so their numbers are not a clip's. What takes a joint's rotation to its node's is a
//! product with two fixed quaternions, what takes its translation there a fixed matrix and shift: both are linear, so a
//! spline stays one, and its tangents go the same way as its values.

use super::animation::{NodeKeys, NodeMotion};
use inkrig_motion::{
    Clip,
    glam::{DMat3, DQuat, DVec3, Quat, Vec3},
    keyframes::{Key, KeyedClip},
};

/// The keys of a joint whose node has the joint's own axes.
pub(super) fn plain(keyed: &KeyedClip, joint: usize) -> NodeKeys {
    let rotations = keyed.rotations.iter().find(|track| track.joint == joint);
    let translations = keyed.translations.iter().find(|track| track.joint == joint);
    NodeKeys {
        interpolation: keyed.interpolation,
        rotations: rotations.map(|track| track.keys.clone()).unwrap_or_default(),
        translations: translations.map(|track| track.keys.clone()).unwrap_or_default(),
    }
}

/// The keys of a joint for a node at rest turned by `rest` in the world, in a parent that is there as `above`. None where
/// the node does not go along in a fixed way (uneven scales), or moves where the joint does not.
pub(super) fn of_node(
    keyed: &KeyedClip,
    clip: &Clip,
    joint: usize,
    motion: &NodeMotion,
    (rest, above): (DQuat, DMat3),
) -> Option<NodeKeys> {
    let mut keys = plain(keyed, joint);
    let local = |frame: usize| clip.rotations(frame).get(joint).map(|turn| turn.as_dquat());
    let before = motion.rotations.first()?.as_dquat() * (local(0)? * rest).inverse();
    let node = |value: DQuat| before * value * rest;
    for (frame, written) in motion.rotations.iter().enumerate() {
        let (made, written) = (node(local(frame)?), written.as_dquat());
        if (made - written).length().min((made + written).length()) > 1e-5 {
            return None;
        }
    }
    let turned = |value: [f32; 4]| node(Quat::from_array(value).as_dquat()).as_quat().to_array();
    map(&mut keys.rotations, turned, turned);
    let Some(places) = &motion.translations else {
        keys.translations.clear();
        return Some(keys);
    };
    let track = clip.track(joint)?;
    let into = above.inverse();
    let shift = places.first()?.as_dvec3() - into * track.first()?.as_dvec3();
    let size = places.iter().map(|place| place.as_dvec3().length()).fold(1e-6, f64::max);
    for (place, value) in places.iter().zip(track) {
        let apart = (into * value.as_dvec3() + shift).distance(place.as_dvec3());
        // Not a number where the parent is flat.
        if apart.is_nan() || apart > 1e-5 * size {
            return None;
        }
    }
    let vector = |value: [f32; 3], shift: DVec3| {
        (into * Vec3::from_array(value).as_dvec3() + shift).as_vec3().to_array()
    };
    map(&mut keys.translations, |value| vector(value, shift), |slope| vector(slope, DVec3::ZERO));
    Some(keys)
}

fn map<const N: usize>(
    keys: &mut [Key<N>],
    value: impl Fn([f32; N]) -> [f32; N],
    slope: impl Fn([f32; N]) -> [f32; N],
) {
    for key in keys {
        key.value = value(key.value);
        key.slope_in = slope(key.slope_in);
        key.slope_out = slope(key.slope_out);
    }
}
