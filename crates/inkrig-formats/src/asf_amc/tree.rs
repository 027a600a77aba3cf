//! Which bone hangs on which: from blocks in any order to bones with parents before children.

use super::angles::Order;
use super::bone::{Bone, Dof};
use super::error;
use crate::finding::shown;
use crate::lexer::{Lexer, Word};
use crate::{Finding, FormatError};
use inkrig_motion::glam::{DQuat, DVec3};
use std::collections::HashMap;

/// A bone's block as it stands.
pub(super) struct Block<'a> {
    pub(super) begin: Word<'a>,
    pub(super) name: String,
    pub(super) direction: DVec3,
    pub(super) length: f64,
    pub(super) axis: DVec3,
    pub(super) order: Order,
    pub(super) dofs: Vec<Dof>,
}

/// `parent child child ...`, one pair each, at the child's word.
pub(super) struct Edge<'a> {
    pub(super) parent: Word<'a>,
    pub(super) child: Word<'a>,
}

/// Sorts bones so that parents stand before children and gives each its joint. Also the number of children of each.
pub(super) fn tree(
    lexer: &Lexer<'_>,
    blocks: Vec<Block<'_>>,
    edges: &[Edge<'_>],
    degrees_per_unit: f64,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<Bone>, Vec<usize>), FormatError> {
    let mut by_name = HashMap::with_capacity(blocks.len());
    for (index, block) in blocks.iter().enumerate() {
        if by_name.insert(block.name.as_bytes(), index).is_some() {
            let what = "another bone has this name too";
            let place = lexer.place(&block.begin, Some(&block.name));
            return Err(error("asf-duplicate", place, what, "give each bone a name of its own"));
        }
    }
    let mut parents: Vec<Option<Option<usize>>> = vec![None; blocks.len()];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); blocks.len()];
    let mut tops = Vec::new();
    for edge in edges {
        let find = |word: &Word<'_>| {
            by_name.get(word.text).copied().ok_or_else(|| {
                let what = format!("there is no bone {}", word.shown());
                error("asf-hierarchy", lexer.place(word, None), what, "name bones as in :bonedata")
            })
        };
        let parent = if edge.parent.is("root") { None } else { Some(find(&edge.parent)?) };
        let child = find(&edge.child)?;
        if let Some(slot) = parents.get_mut(child).filter(|slot| slot.is_none()) {
            *slot = Some(parent);
        } else {
            let what = format!("{} hangs on two bones", edge.child.shown());
            let place = lexer.place(&edge.child, None);
            return Err(error("asf-hierarchy", place, what, "let every bone hang on one"));
        }
        match parent.and_then(|parent| children.get_mut(parent)) {
            Some(list) => list.push(child),
            None => tops.push(child),
        }
    }
    let mut bones = Vec::with_capacity(blocks.len());
    let mut counts = Vec::with_capacity(blocks.len());
    let mut joint = 1;
    let mut waiting: Vec<(usize, Option<usize>, usize)> =
        tops.iter().rev().map(|&top| (top, None, 0)).collect();
    let mut blocks: Vec<Option<Block<'_>>> = blocks.into_iter().map(Some).collect();
    // Every bone is reached once: it hangs on one. Bones of a ring hang on each other and are never reached.
    while let Some((index, parent, parent_joint)) = waiting.pop() {
        let Some(block) = blocks.get_mut(index).and_then(Option::take) else { continue };
        let below = children.get(index).map_or(&[][..], Vec::as_slice);
        let own = bones.len();
        waiting.extend(below.iter().rev().map(|&child| (child, Some(own), joint)));
        bones.push(block.into_bone(parent, joint, parent_joint, degrees_per_unit));
        counts.push(below.len());
        joint += if below.is_empty() { 2 } else { 1 };
    }
    let mut lost = blocks.iter().flatten();
    if let Some(first) = lost.next() {
        let more = lost.count();
        let others = if more > 0 { format!(" and {more} more") } else { String::new() };
        let message =
            format!("the bone `{}`{others} does not hang on the root and is left out", shown(&first.name));
        findings.push(Finding::warning("asf-loose-bone", message).at(lexer.place(&first.begin, None)));
    }
    if bones.is_empty() {
        let begin = edges.first().map(|edge| edge.parent);
        let place =
            begin.map(|word| lexer.place(&word, None)).unwrap_or_else(|| lexer.place(&lexer.peek(), None));
        return Err(error(
            "asf-hierarchy",
            place,
            "no bone hangs on `root`",
            "name what hangs on root in :hierarchy",
        ));
    }
    Ok((bones, counts))
}

impl Block<'_> {
    fn into_bone(
        self,
        parent: Option<usize>,
        joint: usize,
        parent_joint: usize,
        degrees_per_unit: f64,
    ) -> Bone {
        let frame: DQuat = self.order.rotation(self.axis * degrees_per_unit);
        Bone {
            name: self.name,
            direction: self.direction,
            length: self.length,
            frame,
            order: self.order,
            dofs: self.dofs,
            parent,
            joint,
            parent_joint,
        }
    }
}
