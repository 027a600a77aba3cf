//! The nodes of a scene, and which of them make up the skeleton.

use super::damaged;
use crate::{
    Finding, FormatError, Limits,
    fbx::END_SITE,
    figure::{Figure, Nodes},
};
use std::collections::{HashMap, HashSet};
use ufbx::{ElementType, Node, Scene, Transform};

/// The nodes in the order of the file, without the scene's own root.
pub(super) struct Bones<'s> {
    pub(super) nodes: Vec<&'s Node>,
    pub(super) parents: Vec<Option<usize>>,
    /// Where each node rests in its parent.
    pub(super) locals: Vec<Transform>,
    /// The node whose scale a node takes over on its own way.
    pub(super) scale_nodes: Vec<Option<usize>>,
    depth_first: Vec<usize>,
    /// Place in [`Self::nodes`] by the number of the element.
    places: HashMap<u32, usize>,
}

impl<'s> Bones<'s> {
    pub(super) fn of(scene: &'s Scene) -> Self {
        let mut nodes: Vec<&Node> =
            scene.nodes.iter().map(AsRef::as_ref).filter(|node| !node.is_root).collect();
        nodes.sort_by_key(|node| node.element.element_id);
        let places: HashMap<u32, usize> =
            nodes.iter().enumerate().map(|(place, node)| (node.element.element_id, place)).collect();
        let place = |node: Option<&Node>| places.get(&node?.element.element_id).copied();
        let parents: Vec<_> = nodes.iter().map(|node| place(node.parent.as_deref())).collect();
        let scale_nodes = nodes.iter().map(|node| place(node.inherit_scale_node.as_deref())).collect();
        let locals = nodes.iter().map(|node| node.local_transform).collect();
        let depth_first = depth_first(&parents);
        Self { nodes, parents, locals, scale_nodes, depth_first, places }
    }

    /// The place of an element that is a node.
    pub(super) fn place(&self, element: u32) -> Option<usize> {
        self.places.get(&element).copied()
    }

    /// The bones and what skins hang on; in a scene without them, all nodes that are moved.
    pub(super) fn figure(
        &self,
        scene: &Scene,
        limits: &Limits,
        findings: &mut Vec<Finding>,
    ) -> Result<Figure, FormatError> {
        let moved = self.moved(scene);
        let mut joint: Vec<bool> = self.nodes.iter().map(|node| node.bone.is_some()).collect();
        for cluster in scene.skin_clusters.iter() {
            let bone = cluster.bone_node.as_deref().and_then(|node| self.place(node.element.element_id));
            if let Some(slot) = bone.and_then(|place| joint.get_mut(place)) {
                *slot = true;
            }
        }
        if !joint.contains(&true) {
            for (place, slot) in joint.iter_mut().enumerate() {
                let seen = |node: &&&Node| node.camera.is_none() && node.light.is_none();
                *slot = moved.contains(&place) && self.nodes.get(place).filter(seen).is_some();
            }
            if !joint.contains(&true) {
                return Err(no_skeleton(scene));
            }
            let message = "the file has no bones; the nodes that clips move are taken";
            findings.push(Finding::info("fbx-no-bones", message.into()));
        }
        let end_site: Vec<bool> =
            (0..self.nodes.len()).map(|place| self.is_end_site(place, &joint, &moved)).collect();
        for (slot, end_site) in joint.iter_mut().zip(&end_site) {
            *slot &= !end_site;
        }
        let name = |place: usize| self.name(place);
        let nodes = Nodes {
            parents: &self.parents,
            depth_first: &self.depth_first,
            joint: &joint,
            end_site: &end_site,
            name: &name,
        };
        Figure::of(&nodes, limits, findings)
    }

    pub(super) fn name(&self, place: usize) -> &'s str {
        self.nodes.get(place).map_or("", |node| node.element.name.as_ref())
    }

    /// A leaf below a joint: one that says that it is an end site, or one that no clip moves and that only has a
    /// place, or is the bone that Blender adds behind the last one, which has its name with `_end` behind it.
    fn is_end_site(&self, place: usize, joint: &[bool], moved: &HashSet<usize>) -> bool {
        let (Some(node), Some(parent)) = (self.nodes.get(place), self.parents.get(place).copied().flatten())
        else {
            return false;
        };
        if joint.get(parent) != Some(&true) || node.children.count > 0 {
            return false;
        }
        if moved.contains(&place) {
            return node.element.props.find_prop(END_SITE).is_some();
        }
        let added = || self.name(place).strip_suffix("_end").is_some_and(|name| name == self.name(parent));
        match node.attrib_type {
            ElementType::Unknown | ElementType::Empty => true,
            ElementType::Bone => node.element.props.find_prop(END_SITE).is_some() || added(),
            _ => false,
        }
    }

    /// Nodes that any clip moves.
    fn moved(&self, scene: &Scene) -> HashSet<usize> {
        let props = scene.anim_layers.iter().flat_map(|layer| layer.anim_props.iter());
        let places = props.filter(|prop| prop.prop_name.starts_with("Lcl "));
        places.filter_map(|prop| self.place(prop.element.element_id)).collect()
    }
}

fn no_skeleton(scene: &Scene) -> FormatError {
    let (what, hint) = if scene.meshes.count > 0 {
        ("a mesh without a skeleton", "rig the mesh first, or export it together with its armature")
    } else {
        ("neither a skeleton nor anything that moves", "export the armature with its animation")
    };
    damaged("fbx-no-skeleton", "the file", what, hint)
}

fn depth_first(parents: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut stack = Vec::new();
    for (place, parent) in parents.iter().enumerate().rev() {
        match parent.and_then(|parent| children.get_mut(parent)) {
            Some(list) => list.push(place),
            None => stack.push(place),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(place) = stack.pop() {
        order.push(place);
        stack.extend(children.get_mut(place).map(std::mem::take).unwrap_or_default());
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_stand_before_children_and_siblings_in_order() {
        let parents = [Some(2), Some(0), None, Some(2), Some(0), None];
        assert_eq!(depth_first(&parents), [2, 0, 1, 4, 3, 5]);
        // What hangs on itself is not met.
        assert_eq!(depth_first(&[Some(1), Some(0)]), Vec::<usize>::new());
    }
}
