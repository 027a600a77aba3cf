//! The line of joints from the hips to the head.

use super::names::Names;
use super::tree::Tree;
use super::{Arm, Part};

/// What stands between hips, arms and head.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Trunk {
    pub(super) spine: Vec<usize>,
    pub(super) neck: Vec<usize>,
    pub(super) head: Option<usize>,
}

impl Trunk {
    /// The spine carries arms, the neck the head; a belly bone at the side of that line is none of it.
    pub(super) fn of(
        tree: &Tree,
        names: &Names<'_>,
        hips: usize,
        arms: [Option<Arm>; 2],
        head: Option<usize>,
    ) -> Self {
        let shoulder = arms.iter().flatten().next().map(|arm| arm.clavicle.unwrap_or(arm.upper));
        let line = |to: Option<usize>| -> Vec<usize> {
            let mut line = to.map(|to| tree.between(hips, to)).unwrap_or_default();
            // What stands above the hips only leads over to the spine.
            line.retain(|&joint| !tree.hangs_on(hips, joint) && Some(joint) != to);
            line.retain(|&joint| !tree.is_helper(joint));
            line
        };
        let mut spine = match shoulder {
            Some(shoulder) => line(Some(shoulder)),
            None => line(head),
        };
        // Some hang the collar bones on the neck.
        spine.retain(|&joint| names.part(joint) != Some(Part::Neck));
        let head = head.or_else(|| Self::unnamed_head(tree, &spine, shoulder));
        let mut neck = line(head);
        neck.retain(|joint| !spine.contains(joint));
        Self { spine, neck, head }
    }

    /// The head of a skeleton that names none: where the line above the arms branches, else its last joint that can
    /// turn.
    fn unnamed_head(tree: &Tree, spine: &[usize], shoulder: Option<usize>) -> Option<usize> {
        let (&chest, shoulder) = (spine.last()?, shoulder?);
        let above = tree.children(chest).iter().copied().filter(|&child| !tree.hangs_on(shoulder, child));
        // Not an arm: what lies nearest over the chest.
        let aside = |joint: usize| {
            let tip = tree.longest(joint).last().copied().unwrap_or(joint);
            let way = tree.rest[tip] - tree.rest[chest];
            way.with_y(0.0).length() / way.length().max(f32::MIN_POSITIVE)
        };
        let first =
            above.min_by(|&a, &b| aside(a).total_cmp(&aside(b))).filter(|&joint| aside(joint) < 0.5)?;
        let chain = tree.longest(first);
        let branches = chain.iter().copied().find(|&joint| tree.children(joint).len() > 1);
        // A chain of one is a head without neck; the last of several only ends it, unless nothing else is left.
        branches.or_else(|| match chain.as_slice() {
            [.., head, tip] if chain.len() > 2 || tree.is_end(*tip) => Some(*head),
            _ => chain.last().copied(),
        })
    }
}
