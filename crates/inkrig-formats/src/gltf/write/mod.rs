//! The glTF writers: a file of its own, a clip put into a file that is there, VRMA.

mod animation;
mod body;
mod bone;
mod insert;
mod keys;
mod parts;
mod splice;
mod vrma;

pub use vrma::write_vrma;

use super::container;
use crate::{ExportOptions, FormatError, Written};
use animation::{NodeMotion, animation, check_places};
use inkrig_motion::{
    Clip,
    glam::Vec3,
    keyframes::{KeyedClip, RotationForm},
};
use parts::Parts;
use serde_json::{Map, Value, json};

/// What a clip without a name is called.
const CLIP_NAME: &str = "motion";

/// Writes a clip as a GLB: metres, y up, one key a frame, or the few of [`ExportOptions::keys`].
///
/// With [`ExportOptions::original`] the clip is put into that file, whose mesh, skin, materials and textures stay as
/// they are; the clip must be of its skeleton, or have one joint more, above another: that becomes a node of the file, which
/// no skin lists. Without, the file holds the skeleton, the clip, and a body of capsules.
///
/// # Errors
/// [`FormatError::Write`] when the clip has another skeleton than the original, a joint stands beyond 1e12 m, or the file
/// would be larger than a GLB may be; what the reader says of the original.
pub fn write_glb(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    options.check_curves("glTF", RotationForm::Quaternion)?;
    match &options.original {
        Some(original) => insert::insert(original.bytes(), clip, options, true),
        None => {
            let (document, bin) = bare(clip, options)?;
            let bytes = container::glb(document.to_string().as_bytes(), &bin)?;
            Ok(Written { bytes, findings: Vec::new() })
        }
    }
}

/// Puts a clip into a text file ([`ExportOptions::original`]), the new numbers inside of the text.
pub(crate) fn write_into_gltf(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    options.check_curves("glTF", RotationForm::Quaternion)?;
    match &options.original {
        Some(original) => insert::insert(original.bytes(), clip, options, false),
        None => Err(FormatError::Write {
            what: "inkrig writes .gltf files only into one that it has read".into(),
            hint: "write a .glb instead".into(),
        }),
    }
}

/// Skeleton, body and clip.
fn bare(clip: &Clip, options: &ExportOptions) -> Result<(Value, Vec<u8>), FormatError> {
    for (index, joint) in clip.skeleton().joints().iter().enumerate() {
        check_places(index, &[joint.offset])?;
    }
    let mut parts = Parts::default();
    let skeleton = clip.skeleton();
    let mut nodes = nodes(clip);
    let mut top: Vec<usize> = skeleton.roots().collect();
    if top.len() > 1 {
        // The joints of a skin must have one node above them all.
        nodes.push(json!({ "name": "roots", "children": top }));
        top = vec![nodes.len() - 1];
    }
    let joints: Vec<usize> = (0..skeleton.len()).filter(|&joint| !is_tip(clip, joint)).collect();
    let mut skin_place = vec![None; skeleton.len()];
    for (place, &joint) in joints.iter().enumerate() {
        if let Some(slot) = skin_place.get_mut(joint) {
            *slot = u16::try_from(place).ok();
        }
    }
    let mesh = body::mesh(clip, &skin_place, &mut parts);
    let matrices = inverse_binds(&skeleton.rest_positions(), &joints, &mut parts);
    nodes.push(json!({ "name": "body", "mesh": 0, "skin": 0 }));
    top.push(nodes.len() - 1);
    let motion = motions(clip, options.keys.as_ref());
    let name = options.name.as_deref().unwrap_or(CLIP_NAME);
    let animation = animation(name, clip.frame_rate(), &motion, &mut parts)?;
    let material = json!({
        "name": "body",
        "pbrMetallicRoughness": { "baseColorFactor": [0.42, 0.52, 0.63, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
    });
    let mut document = document(&nodes, &top, &animation, &parts);
    document.insert("meshes".into(), json!([mesh]));
    document.insert("materials".into(), json!([material]));
    document.insert("skins".into(), json!([{ "inverseBindMatrices": matrices, "joints": joints }]));
    Ok((Value::Object(document), parts.bin))
}

/// What every file has; the bytes of `parts` are its one buffer.
fn document(nodes: &[Value], top: &[usize], animation: &Value, parts: &Parts) -> Map<String, Value> {
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("inkrig ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": top }],
        "nodes": nodes,
        "animations": [animation],
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{ "byteLength": parts.bin.len() }],
    });
    if let Value::Object(document) = document { document } else { Map::new() }
}

/// The joints in order, each at its rest offset.
fn nodes(clip: &Clip) -> Vec<Value> {
    let joints = clip.skeleton().joints();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
    for (index, joint) in joints.iter().enumerate() {
        if let Some(children) = joint.parent.and_then(|parent| children.get_mut(parent)) {
            children.push(index);
        }
    }
    let nodes = joints.iter().zip(children).map(|(joint, children)| {
        let mut node = Map::new();
        if !joint.name.is_empty() {
            node.insert("name".into(), json!(joint.name));
        }
        if joint.offset != Vec3::ZERO {
            node.insert("translation".into(), json!(joint.offset.to_array().map(shortest)));
        }
        if !children.is_empty() {
            node.insert("children".into(), json!(children));
        }
        Value::Object(node)
    });
    nodes.collect()
}

/// An end site that nothing hangs on; it needs no key and no skin.
fn is_tip(clip: &Clip, joint: usize) -> bool {
    let joints = clip.skeleton().joints();
    let end_site = joints.get(joint).is_some_and(|joint| joint.end_site && joint.parent.is_some());
    end_site && !joints.iter().any(|other| other.parent == Some(joint))
}

/// What each joint does, in a skeleton whose nodes are its joints.
fn motions(clip: &Clip, keyed: Option<&KeyedClip>) -> Vec<NodeMotion> {
    let joints = (0..clip.skeleton().len()).filter(|&joint| !is_tip(clip, joint));
    let motion = |joint: usize| NodeMotion {
        node: joint,
        rotations: (0..clip.frames()).filter_map(|frame| clip.rotations(frame).get(joint).copied()).collect(),
        translations: clip.track(joint).map(<[Vec3]>::to_vec),
        keys: keyed.map(|keyed| keys::plain(keyed, joint)),
    };
    joints.map(motion).collect()
}

/// For each joint of the skin the way back from its place.
fn inverse_binds(places: &[Vec3], joints: &[usize], parts: &mut Parts) -> usize {
    let matrices = joints.iter().flat_map(|&joint| {
        let back = -places.get(joint).copied().unwrap_or_default();
        inkrig_motion::glam::Mat4::from_translation(back).to_cols_array()
    });
    let described = json!({ "componentType": 5126, "count": joints.len(), "type": "MAT4" });
    parts.other(matrices.flat_map(f32::to_le_bytes), described, None)
}

/// The number with the fewest digits that is this f32.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
