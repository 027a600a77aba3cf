//! A root bone that a clip has and its file has not: a node more, above one that is there.

use super::splice::{Object, list_text};
use crate::{
    Finding, FormatError,
    figure::{Figure, FigureJoint},
    finding::shown,
    gltf::{document::Document, forest::Forest},
};
use inkrig_motion::Clip;
use serde_json::json;

/// A joint that a clip has more than a file, with one joint below it.
pub(super) struct Bone {
    /// Its place in the clip's skeleton; the joint below it is the next.
    pub(super) joint: usize,
    name: String,
    /// The node that it gets, behind all others.
    node: usize,
    /// The node of the joint below it.
    below: usize,
}

impl Bone {
    /// The one joint that a clip has more; `None` where that is not all that differs in number.
    pub(super) fn of(clip: &Clip, figure: &Figure, document: &Document) -> Option<Self> {
        let joints = clip.skeleton().joints();
        if joints.len() != figure.joints.len() + 1 {
            return None;
        }
        let joint = joints.iter().zip(&figure.joints).position(|(ours, theirs)| ours.name != theirs.name)?;
        let carries = joints.iter().filter(|other| other.parent == Some(joint)).count();
        let below = figure.joints.get(joint)?;
        let next = joints.get(joint + 1).is_some_and(|next| next.parent == Some(joint));
        let name = joints.get(joint)?.name.clone();
        let node = document.nodes.0.len();
        (carries == 1 && next).then_some(Self { joint, name, node, below: below.node })
    }

    /// Puts the node in. It rests where its parent is, so that the file's other clips stay as they are.
    pub(super) fn put_into(&self, text: &str, forest: &Forest) -> Result<String, FormatError> {
        let mut top = Object::parse(text)?;
        let mut nodes: Vec<String> = top.list("nodes")?.into_iter().map(String::from).collect();
        match forest.parents.get(self.below).copied().flatten() {
            Some(parent) => {
                if let Some(text) = nodes.get_mut(parent) {
                    let changed = self.instead(text, "children")?;
                    *text = changed;
                }
            }
            None => {
                let scenes: Result<Vec<String>, _> =
                    top.list("scenes")?.into_iter().map(|scene| self.instead(scene, "nodes")).collect();
                let scenes = scenes?;
                if !scenes.is_empty() {
                    top.set("scenes", list(&scenes));
                }
            }
        }
        nodes.push(json!({ "name": self.name, "children": [self.below] }).to_string());
        top.set("nodes", list(&nodes));
        Ok(top.text())
    }

    /// The figure with the bone in it; the nodes are those of the new text.
    pub(super) fn join(&self, figure: Figure) -> Figure {
        let Figure { mut joints, mut chain } = figure;
        for joint in &mut joints {
            joint.parent = joint.parent.map(|parent| parent + usize::from(parent >= self.joint));
        }
        let parent = joints.get(self.joint).and_then(|below| below.parent);
        if let Some(below) = joints.get_mut(self.joint) {
            below.parent = Some(self.joint);
        }
        let bone = FigureJoint { node: self.node, parent, name: self.name.clone(), end_site: false };
        joints.insert(self.joint.min(joints.len()), bone);
        let place = chain.iter().position(|&node| node == self.below).unwrap_or(chain.len());
        chain.insert(place, self.node);
        Figure { joints, chain }
    }

    pub(super) fn finding(&self, figure: &Figure) -> Finding {
        let below = figure.joints.get(self.joint + 1).map_or("", |joint| joint.name.as_str());
        let message = format!(
            "a node `{}` was put in above `{}`; the skin does not list it, so that the mesh stays as it is",
            shown(&self.name),
            shown(below)
        );
        Finding::info("gltf-bone", message)
    }

    /// An object in whose list the bone stands in the place of the node below it.
    fn instead(&self, object: &str, list_name: &str) -> Result<String, FormatError> {
        let mut object = Object::parse(object)?;
        let (below, node) = (self.below.to_string(), self.node.to_string());
        let nodes: Vec<String> = (object.list(list_name)?.into_iter())
            .map(|number| if number == below { node.clone() } else { number.to_string() })
            .collect();
        if !nodes.is_empty() {
            object.set(list_name, list(&nodes));
        }
        Ok(object.text())
    }
}

fn list(elements: &[String]) -> String {
    list_text(&elements.iter().map(String::as_str).collect::<Vec<_>>())
}
