//! Which nodes of a document make up the skeleton.

use super::{damaged, document::Document, forest::Forest, humanoid};
use crate::{Finding, FormatError, Limits, finding::shown};
use std::collections::HashSet;

/// The nodes of a skeleton.
#[derive(Debug)]
pub(super) struct Figure {
    /// In the skeleton's order.
    pub(super) joints: Vec<FigureJoint>,
    /// The joints and all nodes above them, parents before children: what has to be placed.
    pub(super) chain: Vec<usize>,
}

/// A node that is a joint.
#[derive(Debug, Clone)]
pub(super) struct FigureJoint {
    pub(super) node: usize,
    /// The nearest joint above, by place in [`Figure::joints`].
    pub(super) parent: Option<usize>,
    pub(super) name: String,
    pub(super) end_site: bool,
}

impl Figure {
    /// The joints of all skins and the bones of a humanoid; in a document without them, all nodes that clips move.
    /// Bare leaves below joints are end sites. What stands between or above joints is folded into them.
    pub(super) fn of(
        document: &Document,
        forest: &Forest,
        limits: &Limits,
        findings: &mut Vec<Finding>,
    ) -> Result<Self, FormatError> {
        let mut joint = vec![false; forest.parents.len()];
        mark(document, &mut joint, findings)?;
        let is_joint = |node: usize| joint.get(node).copied().unwrap_or(false);
        let parent = |node: usize| forest.parents.get(node).copied().flatten();
        let end_site = |node: usize| {
            let bare = document.nodes.0.get(node).is_some_and(super::document::Node::is_bare);
            !is_joint(node) && bare && parent(node).is_some_and(is_joint)
        };
        let taken = |node: &usize| is_joint(*node) || end_site(*node);
        // Exporters differ; the file's own order is kept where it is one.
        let mut order: Vec<usize> = (0..joint.len()).filter(taken).collect();
        let mut places = vec![None; joint.len()];
        let above = above_all(forest, &joint);
        let parent_joint = |node: usize| above.get(node).copied().flatten();
        if order.iter().any(|&node| parent_joint(node).is_some_and(|parent| parent > node)) {
            order = forest.depth_first.iter().copied().filter(taken).collect();
        }
        if order.len() > limits.joints {
            return Err(FormatError::Limit {
                what: format!("the skeleton has {} joints", order.len()),
                limit: limits.joints,
                place: None,
                hint: "leave joints out that do not matter".into(),
            });
        }
        let mut joints = Vec::with_capacity(order.len());
        for (place, &node) in order.iter().enumerate() {
            if let Some(slot) = places.get_mut(node) {
                *slot = Some(place);
            }
            let parent = parent_joint(node).and_then(|parent| places.get(parent).copied().flatten());
            let name = name(document, node, limits)?;
            joints.push(FigureJoint { node, parent, name, end_site: end_site(node) });
        }
        findings.extend(name_findings(document, &joints));
        let chain = chain(forest, &joints);
        Ok(Self { joints, chain })
    }
}

/// Marks the joints.
fn mark(document: &Document, joint: &mut [bool], findings: &mut Vec<Finding>) -> Result<(), FormatError> {
    let humanoid = humanoid::nodes(document);
    let mut mark = |node: u32, part: String| match joint.get_mut(node as usize) {
        Some(slot) => {
            *slot = true;
            Ok(())
        }
        None => {
            let what = format!("its joint {node} does not exist");
            Err(damaged("gltf-index", part, what, "the file is damaged; export it again"))
        }
    };
    for (index, skin) in document.skins.0.iter().enumerate() {
        for &node in &skin.joints.0 {
            mark(node, format!("skin {index}"))?;
        }
    }
    for (name, node) in &humanoid {
        mark(*node, format!("the humanoid bone {name}"))?;
    }
    if document.skins.0.len() > 1 {
        let message =
            format!("the file has {} skins; their joints are taken together", document.skins.0.len());
        findings.push(Finding::info("gltf-skins", message));
    }
    if joint.contains(&true) {
        return Ok(());
    }
    let channels = document.animations.0.iter().flat_map(|animation| &animation.channels.0);
    for channel in channels {
        let place = channel.target.path != super::document::Path::Other;
        if let Some(slot) =
            channel.target.node.filter(|_| place).and_then(|node| joint.get_mut(node as usize))
        {
            *slot = true;
        }
    }
    if joint.contains(&true) {
        let message = "no skin says which nodes are joints; those that clips move are taken";
        findings.push(Finding::info("gltf-no-skin", message.into()));
        return Ok(());
    }
    let meshes = document.nodes.0.iter().any(super::document::Node::has_mesh);
    let what = if meshes { "a mesh without a skeleton" } else { "neither a skeleton nor a clip" };
    let hint = "a motion needs joints; rig the mesh first, or export it together with its armature";
    Err(damaged("gltf-no-skeleton", "the file", what, hint))
}

/// The nearest joint above every node.
fn above_all(forest: &Forest, joint: &[bool]) -> Vec<Option<usize>> {
    let mut above: Vec<Option<usize>> = vec![None; joint.len()];
    for &node in &forest.depth_first {
        let Some(parent) = forest.parents.get(node).copied().flatten() else { continue };
        let found = if joint.get(parent) == Some(&true) {
            Some(parent)
        } else {
            above.get(parent).copied().flatten()
        };
        if let Some(slot) = above.get_mut(node) {
            *slot = found;
        }
    }
    above
}

fn chain(forest: &Forest, joints: &[FigureJoint]) -> Vec<usize> {
    let mut needed = vec![false; forest.parents.len()];
    for joint in joints {
        let mut next = Some(joint.node);
        // What is marked has all above it marked.
        while let Some(node) = next.filter(|&node| needed.get(node) == Some(&false)) {
            if let Some(slot) = needed.get_mut(node) {
                *slot = true;
            }
            next = forest.parents.get(node).copied().flatten();
        }
    }
    forest.depth_first.iter().copied().filter(|&node| needed.get(node) == Some(&true)).collect()
}

fn name(document: &Document, node: usize, limits: &Limits) -> Result<String, FormatError> {
    let name = document.nodes.0.get(node).map_or("", |node| node.name.as_str());
    if name.len() > limits.name_bytes {
        return Err(FormatError::Limit {
            what: format!("the name of node {node} `{}` has {} bytes", shown(name), name.len()),
            limit: limits.name_bytes,
            place: None,
            hint: "give the joint a shorter name".into(),
        });
    }
    Ok(if name.is_empty() { format!("node_{node}") } else { name.into() })
}

fn name_findings(document: &Document, joints: &[FigureJoint]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let nameless =
        |joint: &&FigureJoint| document.nodes.0.get(joint.node).is_some_and(|node| node.name.is_empty());
    let count = joints.iter().filter(nameless).count();
    if count > 0 {
        let message = format!("joints without a name: {count}; they are called by their node's number");
        findings.push(Finding::warning("gltf-no-name", message));
    }
    let mut seen = HashSet::with_capacity(joints.len());
    if let Some(joint) = joints.iter().find(|joint| !seen.insert(joint.name.as_str())) {
        let message = format!(
            "the joint name `{}` is used more than once; such joints are told apart by order",
            shown(&joint.name)
        );
        findings.push(Finding::warning("gltf-duplicate-name", message));
    }
    findings
}
