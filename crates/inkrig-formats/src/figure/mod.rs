//! From nodes placed in a world to a skeleton and a clip, for formats whose nodes rest at any angle and scale.

mod rotation;
mod stage;

pub(crate) use rotation::rotation_of;
pub(crate) use stage::{Placed, Stage, clip_from_file};

use crate::{Finding, FormatError, Limits, finding::shown};
use std::collections::HashSet;

/// The nodes of a skeleton.
#[derive(Debug)]
pub(crate) struct Figure {
    /// In the skeleton's order.
    pub(crate) joints: Vec<FigureJoint>,
    /// The joints and all nodes above them, parents before children: what has to be placed.
    pub(crate) chain: Vec<usize>,
}

/// A node that is a joint.
#[derive(Debug, Clone)]
pub(crate) struct FigureJoint {
    pub(crate) node: usize,
    /// The nearest joint above, by place in [`Figure::joints`].
    pub(crate) parent: Option<usize>,
    pub(crate) name: String,
    pub(crate) end_site: bool,
}

/// The nodes of a file, and what they are.
pub(crate) struct Nodes<'n> {
    pub(crate) parents: &'n [Option<usize>],
    /// All nodes, parents before children, depth first.
    pub(crate) depth_first: &'n [usize],
    /// Which are joints that can turn.
    pub(crate) joint: &'n [bool],
    /// Which are the tips of chains; none of them is a joint.
    pub(crate) end_site: &'n [bool],
    pub(crate) name: &'n dyn Fn(usize) -> &'n str,
}

impl Figure {
    /// The joints and end sites; what stands between or above joints is folded into them.
    ///
    /// # Errors
    /// When there are too many, or a name is too long.
    pub(crate) fn of(
        nodes: &Nodes<'_>,
        limits: &Limits,
        findings: &mut Vec<Finding>,
    ) -> Result<Self, FormatError> {
        let taken =
            |node: &usize| nodes.joint.get(*node) == Some(&true) || nodes.end_site.get(*node) == Some(&true);
        // Exporters differ; the file's own order is kept where it is one.
        let mut order: Vec<usize> = (0..nodes.joint.len()).filter(taken).collect();
        let above = nodes.above_all();
        let parent_joint = |node: usize| above.get(node).copied().flatten();
        if order.iter().any(|&node| parent_joint(node).is_some_and(|parent| parent > node)) {
            order = nodes.depth_first.iter().copied().filter(taken).collect();
        }
        if order.len() > limits.joints {
            return Err(FormatError::Limit {
                what: format!("the skeleton has {} joints", order.len()),
                limit: limits.joints,
                place: None,
                hint: "leave joints out that do not matter".into(),
            });
        }
        let mut places = vec![None; nodes.joint.len()];
        let mut joints = Vec::with_capacity(order.len());
        for (place, &node) in order.iter().enumerate() {
            if let Some(slot) = places.get_mut(node) {
                *slot = Some(place);
            }
            let parent = parent_joint(node).and_then(|parent| places.get(parent).copied().flatten());
            let end_site = nodes.end_site.get(node) == Some(&true);
            joints.push(FigureJoint { node, parent, name: nodes.name(node, limits)?, end_site });
        }
        findings.extend(nodes.name_findings(&joints));
        let chain = nodes.chain(&joints);
        Ok(Self { joints, chain })
    }
}

impl Nodes<'_> {
    fn parent(&self, node: usize) -> Option<usize> {
        self.parents.get(node).copied().flatten()
    }

    /// The nearest joint above every node.
    fn above_all(&self) -> Vec<Option<usize>> {
        let mut above: Vec<Option<usize>> = vec![None; self.joint.len()];
        for &node in self.depth_first {
            let Some(parent) = self.parent(node) else { continue };
            let found = if self.joint.get(parent) == Some(&true) {
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

    fn chain(&self, joints: &[FigureJoint]) -> Vec<usize> {
        let mut needed = vec![false; self.parents.len()];
        for joint in joints {
            let mut next = Some(joint.node);
            // What is marked has all above it marked.
            while let Some(node) = next.filter(|&node| needed.get(node) == Some(&false)) {
                if let Some(slot) = needed.get_mut(node) {
                    *slot = true;
                }
                next = self.parent(node);
            }
        }
        self.depth_first.iter().copied().filter(|&node| needed.get(node) == Some(&true)).collect()
    }

    fn name(&self, node: usize, limits: &Limits) -> Result<String, FormatError> {
        let name = (self.name)(node);
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

    fn name_findings(&self, joints: &[FigureJoint]) -> Vec<Finding> {
        let mut findings = Vec::new();
        let count = joints.iter().filter(|joint| (self.name)(joint.node).is_empty()).count();
        if count > 0 {
            let message = format!("joints without a name: {count}; they are called by their node's number");
            findings.push(Finding::warning("joint-no-name", message));
        }
        let mut seen = HashSet::with_capacity(joints.len());
        if let Some(joint) = joints.iter().find(|joint| !seen.insert(joint.name.as_str())) {
            let message = format!(
                "the joint name `{}` is used more than once; such joints are told apart by order",
                shown(&joint.name)
            );
            findings.push(Finding::warning("joint-duplicate-name", message));
        }
        findings
    }
}
