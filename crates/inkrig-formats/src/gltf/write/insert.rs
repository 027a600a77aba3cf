//! A clip put into a file that is there: an animation more, and nothing else touched.

use super::{
    CLIP_NAME,
    animation::{NodeMotion, animation},
    bone::Bone,
    keys,
    parts::Parts,
    shortest,
    splice::{Object, list_text},
};
use crate::{
    ExportOptions, Finding, FormatError, Limits, Written,
    figure::{Figure, Placed, Stage, clip_from_file, rotation_of},
    finding::shown,
    gltf::{
        clips,
        container::{self, Container},
        document::{self, Document},
        figure,
        forest::{Forest, Transform},
        pose,
    },
};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use inkrig_motion::{
    Clip,
    glam::{DMat3, DQuat, DVec3},
    keyframes::KeyedClip,
};
use serde_json::json;
use std::{borrow::Cow, collections::HashSet};

/// Puts `clip` into the file; the result is a GLB, or a text like the file.
pub(super) fn insert(
    original: &[u8],
    clip: &Clip,
    options: &ExportOptions,
    binary: bool,
) -> Result<Written, FormatError> {
    crate::import::check_metres_per_unit(options.metres_per_unit)?;
    let container = container::open(original)?;
    if container.binary && !binary {
        return Err(FormatError::Write {
            what: "the clip is to be put into a GLB, and that does not become a .gltf".into(),
            hint: "write a .glb instead".into(),
        });
    }
    let text = std::str::from_utf8(container.json).unwrap_or_default();
    let mut text = Cow::Borrowed(text);
    let mut document = document::parse(container.json)?;
    let mut forest = Forest::of(&document)?;
    let mut figure = figure::figure(&document, &forest, &Limits::default(), &mut Vec::new())?;
    let mut findings = Vec::new();
    let bone = Bone::of(clip, &figure, &document);
    if let Some(bone) = &bone {
        text = bone.put_into(&text, &forest)?.into();
        document = document::parse(text.as_bytes())?;
        forest = Forest::of(&document)?;
        figure = bone.join(figure);
        findings.push(bone.finding(&figure));
    }
    let clip_from_file = clip_from_file(options.metres_per_unit, options.up);
    let stage = pose::stage(&figure, &forest, clip_from_file);
    check_skeleton(&stage, clip, bone.as_ref())?;
    let locals = Locals::new(&stage, &forest, Placed::origin(clip_from_file), clip);
    let motion = locals.motions(options.keys.as_ref(), &mut findings)?;
    let mut top = Object::parse(&text)?;
    free_matrices(&mut top, &figure, &forest, &mut findings)?;
    let mut parts = parts_after(&document, &container);
    let (name, replaced) = name_and_place(&document, options);
    let animation = animation(&name, clip.frame_rate(), &motion, &mut parts)?;
    match replaced {
        None => top.extend_list("animations", &[animation])?,
        Some(index) => {
            let animation = animation.to_string();
            let mut animations = top.list("animations")?;
            if let Some(slot) = animations.get_mut(index) {
                *slot = &animation;
            }
            let text = list_text(&animations);
            top.set("animations", text);
        }
    }
    top.extend_list("accessors", &parts.accessors)?;
    top.extend_list("bufferViews", &parts.views)?;
    let grows = grows(&document, &container);
    let (text, bin) = finish(top, &parts, &container, grows)?;
    let bytes = if binary { container::glb(text.as_bytes(), &bin)? } else { text.into_bytes() };
    Ok(Written { bytes, findings })
}

/// The clip must be of the very skeleton that the file has. A bone that was put in, and what hangs on it, have places of
/// their own in every frame.
fn check_skeleton(stage: &Stage<'_>, clip: &Clip, bone: Option<&Bone>) -> Result<(), FormatError> {
    let skeleton = stage.skeleton()?;
    let other = |what: String| FormatError::Write {
        what,
        hint: "retarget the clip to the character first, or write a file of its own".into(),
    };
    let (ours, theirs) = (clip.skeleton().joints(), skeleton.joints());
    if ours.len() != theirs.len() {
        return Err(other(format!("the clip has {} joints, and the file {}", ours.len(), theirs.len())));
    }
    let near = 1e-3 * skeleton.extent().max(1e-6);
    for (index, (a, b)) in ours.iter().zip(theirs).enumerate() {
        let moved = bone.is_some_and(|bone| index == bone.joint || index == bone.joint + 1);
        let apart = !moved && a.offset.distance(b.offset) > near;
        if a.name != b.name || a.parent != b.parent || apart {
            let (a, b) = (shown(&a.name), shown(&b.name));
            return Err(other(format!(
                "joint `{a}` of the clip is not joint `{b}` of the file, or elsewhere"
            )));
        }
    }
    Ok(())
}

/// What nodes do in their parents so that joints are where a clip has them: the way back from [`Stage`].
struct Locals<'s> {
    stage: &'s Stage<'s>,
    forest: &'s Forest,
    /// What the roots stand in.
    origin: Placed,
    clip: &'s Clip,
    /// The joint of a node.
    joint: Vec<Option<usize>>,
}

impl<'s> Locals<'s> {
    fn new(stage: &'s Stage<'s>, forest: &'s Forest, origin: Placed, clip: &'s Clip) -> Self {
        let mut joint = vec![None; forest.parents.len()];
        for (index, described) in stage.figure.joints.iter().enumerate() {
            if let Some(slot) = joint.get_mut(described.node) {
                *slot = Some(index);
            }
        }
        Self { stage, forest, origin, clip, joint }
    }

    fn motions(
        &self,
        keyed: Option<&KeyedClip>,
        findings: &mut Vec<Finding>,
    ) -> Result<Vec<NodeMotion>, FormatError> {
        let frames = self.clip.frames();
        let mut motions: Vec<Option<NodeMotion>> = (self.stage.figure.joints.iter())
            .map(|joint| {
                let (rotations, translations) =
                    (Vec::with_capacity(frames), Some(Vec::with_capacity(frames)));
                let node = joint.node;
                (!joint.end_site).then_some(NodeMotion { node, rotations, translations, keys: None })
            })
            .collect();
        let mut leaves = vec![false; motions.len()];
        let still = self.stage.still(self.clip.skeleton());
        let mut placed = self.stage.rest.clone();
        let mut turns = vec![DQuat::IDENTITY; motions.len()];
        let mut places = vec![DVec3::ZERO; motions.len()];
        for frame in 0..frames {
            self.world(frame, &mut turns, &mut places);
            for &node in &self.stage.figure.chain {
                let above = self.above(node, &placed);
                let Some(mut local) = self.forest.rest.get(node).copied() else { continue };
                let joint = self.joint.get(node).copied().flatten();
                let motion = joint.and_then(|joint| motions.get_mut(joint)).and_then(Option::as_mut);
                if let (Some(joint), Some(motion)) = (joint, motion) {
                    let (Some(&turn), Some(&place)) = (turns.get(joint), places.get(joint)) else { continue };
                    let rest = local.translation;
                    local = self.local(node, &above, turn, place);
                    motion.rotations.push(local.rotation.as_quat());
                    if let Some(values) = &mut motion.translations {
                        values.push(local.translation.as_vec3());
                    }
                    let left = above.world.transform_vector3(local.translation - rest).length() > still;
                    if let Some(leaves) = leaves.get_mut(joint) {
                        *leaves |= left;
                    }
                }
                if let Some(slot) = placed.get_mut(node) {
                    let turned = (above.turned * local.rotation).normalize();
                    *slot = Placed { world: above.world * local.affine(), turned };
                }
            }
        }
        for (index, (motion, leaves)) in motions.iter_mut().zip(leaves).enumerate() {
            if let Some(motion) = motion.as_mut().filter(|_| !leaves && self.clip.track(index).is_none()) {
                motion.translations = None;
            }
        }
        if let Some(keyed) = keyed {
            self.add_keys(keyed, &mut motions, findings);
        }
        Ok(motions.into_iter().flatten().collect())
    }

    /// Few keys where a node's numbers go along with its joint's in a fixed way.
    fn add_keys(&self, keyed: &KeyedClip, motions: &mut [Option<NodeMotion>], findings: &mut Vec<Finding>) {
        let mut dense = 0;
        for (joint, motion) in motions.iter_mut().enumerate() {
            let Some(motion) = motion else { continue };
            let rest = self.stage.rest.get(motion.node).map_or(DQuat::IDENTITY, |placed| placed.turned);
            let above = self.above(motion.node, &self.stage.rest).world.matrix3;
            motion.keys = keys::of_node(keyed, self.clip, joint, motion, (rest, above));
            dense += usize::from(motion.keys.is_none());
            // What the joint never does the node does by rounding alone.
            let keys = motion.keys.as_ref();
            if let (true, Some(&first)) =
                (keys.is_some_and(|keys| keys.rotations.len() == 1), motion.rotations.first())
            {
                motion.rotations.fill(first);
            }
        }
        if dense > 0 {
            let message = format!("joints whose scales allow no few keys: {dense}; they have a key a frame");
            findings.push(Finding::warning("gltf-dense-keys", message));
        }
    }

    /// How a joint's node has to stand in its parent for the joint to be at `place`, turned by `turn` since the rest
    /// pose.
    fn local(&self, node: usize, above: &Placed, turn: DQuat, place: DVec3) -> Transform {
        let rest = self.forest.rest.get(node).copied();
        let mut local = Transform { matrix: None, ..rest.unwrap_or_else(Transform::identity) };
        let Some(rest) = self.stage.rest.get(node) else { return local };
        let matrix = DMat3::from_quat(turn) * rest.world.matrix3;
        let unscaled = above.world.matrix3.inverse() * matrix * DMat3::from_diagonal(local.scale.recip());
        let found = unscaled.is_finite().then(|| rotation_of(unscaled)).flatten();
        // Where something is flat or mirrored, only the rotations tell.
        let flat = || (above.turned.inverse() * turn * rest.turned).normalize();
        local.rotation = found.unwrap_or_else(flat);
        let translation = above.world.inverse().transform_point3(place);
        if translation.is_finite() {
            local.translation = translation;
        }
        local
    }

    fn above(&self, node: usize, placed: &[Placed]) -> Placed {
        let parent = self.forest.parents.get(node).copied().flatten();
        parent.and_then(|parent| placed.get(parent)).copied().unwrap_or(self.origin)
    }

    /// Where the clip has the joints, and what they have turned, in the world.
    fn world(&self, frame: usize, turns: &mut [DQuat], places: &mut [DVec3]) {
        let rotations = self.clip.rotations(frame);
        for (index, joint) in self.clip.skeleton().joints().iter().enumerate() {
            let track = self.clip.track(index).and_then(|track| track.get(frame));
            let offset = track.copied().unwrap_or(joint.offset).as_dvec3();
            let above = |values: &[DQuat]| joint.parent.and_then(|parent| values.get(parent)).copied();
            let turn = above(turns).unwrap_or(DQuat::IDENTITY);
            let origin = joint.parent.and_then(|parent| places.get(parent)).copied().unwrap_or(DVec3::ZERO);
            let local = rotations.get(index).map_or(DQuat::IDENTITY, |rotation| rotation.as_dquat());
            if let (Some(slot), Some(place)) = (turns.get_mut(index), places.get_mut(index)) {
                *slot = (turn * local).normalize();
                *place = origin + turn * offset;
            }
        }
    }
}

/// A node that is placed by a matrix cannot be moved; it gets the parts of that matrix.
fn free_matrices(
    top: &mut Object<'_>,
    figure: &Figure,
    forest: &Forest,
    findings: &mut Vec<Finding>,
) -> Result<(), FormatError> {
    let fixed = |node: usize| forest.rest.get(node).is_some_and(|rest| rest.matrix.is_some());
    let nodes: Vec<usize> = (figure.joints.iter())
        .filter(|joint| !joint.end_site && fixed(joint.node))
        .map(|joint| joint.node)
        .collect();
    if nodes.is_empty() {
        return Ok(());
    }
    let mut texts: Vec<String> = top.list("nodes")?.into_iter().map(String::from).collect();
    for &node in &nodes {
        let (Some(text), Some(rest)) = (texts.get_mut(node), forest.rest.get(node)) else { continue };
        let mut object = Object::parse(text)?;
        object.remove("matrix");
        let numbers =
            |values: &[f64]| json!(values.iter().map(|value| shortest(*value as f32)).collect::<Vec<_>>());
        object.set("translation", numbers(&rest.translation.to_array()).to_string());
        object.set("rotation", numbers(&rest.rotation.to_array()).to_string());
        object.set("scale", numbers(&rest.scale.to_array()).to_string());
        let changed = object.text();
        *text = changed;
    }
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let text = list_text(&texts);
    top.set("nodes", text);
    let message =
        format!("joints that were placed by a matrix: {}; they are placed by its parts now", nodes.len());
    findings.push(Finding::info("gltf-matrix", message));
    Ok(())
}

fn parts_after(document: &Document, container: &Container<'_>) -> Parts {
    let (first_accessor, first_view) = (document.accessors.0.len(), document.buffer_views.0.len());
    let base = Parts { first_accessor, first_view, ..Parts::default() };
    if grows(document, container) {
        Parts { first_byte: container.bin.map_or(0, |bin| bin.len().next_multiple_of(4)), ..base }
    } else {
        Parts { buffer: document.buffers.0.len(), ..base }
    }
}

/// Whether the bytes go to the end of a GLB's own buffer; else they get a buffer in the text.
fn grows(document: &Document, container: &Container<'_>) -> bool {
    container.binary && document.buffers.0.first().is_none_or(|buffer| buffer.uri.is_none())
}

/// The text and the bytes of the whole file.
fn finish(
    mut top: Object<'_>,
    parts: &Parts,
    container: &Container<'_>,
    grows: bool,
) -> Result<(String, Vec<u8>), FormatError> {
    let mut bin = container.bin.unwrap_or(&[]).to_vec();
    if !grows {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&parts.bin));
        top.extend_list("buffers", &[json!({ "byteLength": parts.bin.len(), "uri": uri })])?;
        return Ok((top.text(), bin));
    }
    bin.resize(parts.first_byte, 0);
    bin.extend_from_slice(&parts.bin);
    let mut buffers: Vec<String> = top.list("buffers")?.into_iter().map(String::from).collect();
    let mut first = Object::parse(buffers.first().map_or("{}", String::as_str))?;
    first.set("byteLength", bin.len().to_string());
    let first = first.text();
    match buffers.first_mut() {
        Some(slot) => *slot = first,
        None => buffers.push(first),
    }
    top.set("buffers", list_text(&buffers.iter().map(String::as_str).collect::<Vec<_>>()));
    Ok((top.text(), bin))
}

/// The clip's name, and the place of the clip that it takes the place of.
fn name_and_place(document: &Document, options: &ExportOptions) -> (String, Option<usize>) {
    let clips = clips::list(document);
    let wanted = options.name.as_deref().unwrap_or(CLIP_NAME);
    let place = clips.iter().position(|clip| clip.name == wanted).filter(|_| options.replace);
    if place.is_some() {
        return (wanted.into(), place);
    }
    let taken: HashSet<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
    let numbered =
        |number: usize| if number == 1 { wanted.to_string() } else { format!("{wanted} {number}") };
    let free = (1..=clips.len() + 1).map(numbered).find(|name| !taken.contains(name.as_str()));
    (free.unwrap_or_else(|| wanted.into()), None)
}
