//! The clips of a scene.

use super::bones::Bones;
use crate::{ClipInfo, figure::Figure};
use std::collections::BTreeSet;
use ufbx::{AnimCurve, AnimStack};

/// An animation stack.
pub(super) struct Stack<'s> {
    pub(super) stack: &'s AnimStack,
    /// Nodes that it moves, in order.
    pub(super) moving: Vec<usize>,
    /// Nodes whose scale it changes.
    pub(super) scaling: Vec<usize>,
}

impl<'s> Stack<'s> {
    pub(super) fn of(stack: &'s AnimStack, bones: &Bones<'_>) -> Self {
        let (mut moving, mut scaling) = (BTreeSet::new(), BTreeSet::new());
        for prop in stack.layers.iter().flat_map(|layer| layer.anim_props.iter()) {
            // Pivots and the like may move as well.
            let Some(place) = bones.place(prop.element.element_id) else { continue };
            moving.insert(place);
            if prop.prop_name.as_ref() == "Lcl Scaling" {
                scaling.insert(place);
            }
        }
        Self { stack, moving: moving.into_iter().collect(), scaling: scaling.into_iter().collect() }
    }

    pub(super) fn layers(&self) -> usize {
        self.stack.layers.count
    }

    /// Whether it moves a joint or what stands above one.
    pub(super) fn moves(&self, figure: &Figure) -> bool {
        figure.chain.iter().any(|node| self.moving.binary_search(node).is_ok())
    }

    /// The curves of the nodes that it moves.
    pub(super) fn curves(&self, bones: &Bones<'_>) -> impl Iterator<Item = &'s AnimCurve> {
        let props = self.stack.layers.iter().flat_map(|layer| layer.anim_props.iter());
        let props = props.filter(|prop| bones.place(prop.element.element_id).is_some());
        props.flat_map(|prop| prop.anim_value.curves.iter().flatten().map(AsRef::as_ref))
    }
}

/// Names of all stacks.
pub(super) fn list(stacks: &[Stack<'_>]) -> Vec<ClipInfo> {
    let clips = stacks.iter().enumerate().map(|(index, stack)| {
        let name = stack.stack.element.name.as_ref();
        ClipInfo {
            name: if name.is_empty() { format!("clip_{}", index + 1) } else { name.into() },
            channels: stack.stack.layers.iter().map(|layer| layer.anim_props.count).sum(),
        }
    });
    clips.collect()
}
