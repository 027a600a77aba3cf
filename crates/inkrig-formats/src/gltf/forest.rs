//! How the nodes of a document hang together, and where they rest.

use super::{damaged, document::Document};
use crate::{FormatError, finding::shown, lexer::LARGEST_NUMBER};
use inkrig_motion::glam::{DAffine3, DMat4, DQuat, DVec3};

/// The nodes as a forest.
#[derive(Debug)]
pub(super) struct Forest {
    pub(super) parents: Vec<Option<usize>>,
    /// All nodes, parents before children, siblings in file order, depth first.
    pub(super) depth_first: Vec<usize>,
    /// Where each node rests in its parent.
    pub(super) rest: Vec<Transform>,
}

/// A place in the parent: scaled first, then turned, then moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Transform {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
    /// What the file says instead, which may shear as well; gone as soon as a part is moved.
    pub(super) matrix: Option<DAffine3>,
}

impl Transform {
    pub(super) fn identity() -> Self {
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE, matrix: None }
    }

    pub(super) fn affine(&self) -> DAffine3 {
        let parts = || DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation);
        self.matrix.unwrap_or_else(parts)
    }
}

impl Forest {
    /// Checks that the nodes are a forest and that their places are numbers.
    pub(super) fn of(document: &Document) -> Result<Self, FormatError> {
        let nodes = &document.nodes.0;
        let mut parents = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for &child in &node.children.0 {
                let child = child as usize;
                let part = || node_name(document, index);
                let hint = "the file is damaged; export it again";
                match parents.get_mut(child) {
                    None => {
                        let what = format!("its child {child} does not exist");
                        return Err(damaged("gltf-index", part(), what, hint));
                    }
                    Some(Some(other)) => {
                        let what = format!("its child {child} is also a child of node {other}");
                        return Err(damaged("gltf-two-parents", part(), what, hint));
                    }
                    Some(slot) => *slot = Some(index),
                }
            }
        }
        let depth_first = depth_first(document, &parents)?;
        let rest = (0..nodes.len()).map(|index| rest(document, index)).collect::<Result<_, _>>()?;
        Ok(Self { parents, depth_first, rest })
    }
}

/// A node as messages call it.
pub(super) fn node_name(document: &Document, index: usize) -> String {
    match document.nodes.0.get(index).map(|node| node.name.as_str()).filter(|name| !name.is_empty()) {
        Some(name) => format!("node {index} `{}`", shown(name)),
        None => format!("node {index}"),
    }
}

fn depth_first(document: &Document, parents: &[Option<usize>]) -> Result<Vec<usize>, FormatError> {
    let mut order = Vec::with_capacity(parents.len());
    let mut met = vec![false; parents.len()];
    let mut stack: Vec<usize> = Vec::new();
    for (root, _) in parents.iter().enumerate().filter(|(_, parent)| parent.is_none()) {
        stack.push(root);
        while let Some(node) = stack.pop() {
            order.push(node);
            if let Some(met) = met.get_mut(node) {
                *met = true;
            }
            let children = document.nodes.0.get(node).map_or(&[][..], |node| node.children.0.as_slice());
            stack.extend(children.iter().rev().map(|&child| child as usize));
        }
    }
    // With one parent each, what hangs on no root hangs on itself.
    match met.iter().position(|met| !met) {
        None => Ok(order),
        Some(node) => {
            let hint = "the file is damaged; export it again";
            Err(damaged("gltf-cycle", node_name(document, node), "it hangs below itself", hint))
        }
    }
}

fn rest(document: &Document, index: usize) -> Result<Transform, FormatError> {
    let bad = |what: &str| {
        let hint = "the file is damaged; export it again";
        damaged("gltf-node", node_name(document, index), what, hint)
    };
    let Some(node) = document.nodes.0.get(index) else { return Err(bad("it does not exist")) };
    // f32 is what other programs read; far beyond it nothing can be reckoned with.
    let usable = |values: &[f64]| values.iter().all(|value| value.abs() <= LARGEST_NUMBER);
    if let Some(matrix) = &node.matrix {
        let affine = DAffine3::from_mat4(DMat4::from_cols_array(matrix));
        if !usable(matrix.as_slice()) {
            return Err(bad("its matrix has a number that is none or too large"));
        }
        let (scale, rotation, translation) = affine.to_scale_rotation_translation();
        let parts = scale.is_finite() && rotation.is_finite() && rotation.length_squared() > 0.5;
        let (scale, rotation) =
            if parts { (scale, rotation.normalize()) } else { (DVec3::ONE, DQuat::IDENTITY) };
        return Ok(Transform { translation, rotation, scale, matrix: Some(affine) });
    }
    let translation = node.translation.unwrap_or_default();
    let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.scale.unwrap_or([1.0; 3]);
    if !(usable(&translation) && usable(&rotation) && usable(&scale)) {
        return Err(bad("its place has a number that is none or too large"));
    }
    let rotation = DQuat::from_array(rotation);
    if rotation.length_squared() < 1e-12 {
        return Err(bad("its rotation is zero"));
    }
    Ok(Transform {
        translation: DVec3::from_array(translation),
        rotation: rotation.normalize(),
        scale: DVec3::from_array(scale),
        matrix: None,
    })
}
