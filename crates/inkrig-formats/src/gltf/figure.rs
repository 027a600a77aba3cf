//! Which nodes of a document make up the skeleton.

use super::{damaged, document::Document, forest::Forest, humanoid};
use crate::{
    Finding, FormatError, Limits,
    figure::{Figure, Nodes},
};

/// The joints of all skins and the bones of a humanoid; in a document without them, all nodes that clips move.
/// Bare leaves below joints are end sites.
pub(super) fn figure(
    document: &Document,
    forest: &Forest,
    limits: &Limits,
    findings: &mut Vec<Finding>,
) -> Result<Figure, FormatError> {
    let mut joint = vec![false; forest.parents.len()];
    mark(document, &mut joint, findings)?;
    let is_joint = |node: usize| joint.get(node).copied().unwrap_or(false);
    let end_site = |node: usize| {
        let bare = document.nodes.0.get(node).is_some_and(super::document::Node::is_bare);
        let parent = forest.parents.get(node).copied().flatten();
        !is_joint(node) && bare && parent.is_some_and(is_joint)
    };
    let end_site: Vec<bool> = (0..joint.len()).map(end_site).collect();
    let name = |node: usize| document.nodes.0.get(node).map_or("", |node| node.name.as_str());
    let nodes = Nodes {
        parents: &forest.parents,
        depth_first: &forest.depth_first,
        joint: &joint,
        end_site: &end_site,
        name: &name,
    };
    Figure::of(&nodes, limits, findings)
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
