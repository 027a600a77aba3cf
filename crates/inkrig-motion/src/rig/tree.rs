//! How a skeleton's joints hang together, and which of its chains are mirror images.

use super::Side;
use super::names::Names;
use crate::Skeleton;
use glam::Vec3;

/// Limbs are at least this long, in lengths of the skeleton's longest chain.
const LIMB: f32 = 0.15;
/// Two limbs are a pair when their joints' distances from where they hang differ by less, in lengths of the limb.
const ALIKE: f32 = 0.15;

/// A skeleton as a tree of chains at rest. Controls and targets are left out.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    pub(super) rest: Vec<Vec3>,
    parents: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    /// Length of the longest chain below each joint, metres.
    reach: Vec<f32>,
    helper: Vec<bool>,
    ends: Vec<bool>,
    /// Length of the longest chain of all, metres.
    pub(super) size: f32,
}

/// Two chains that are mirror images, each from the joint below the one that they share to its tip.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    /// The joint that both hang on.
    pub(super) on: usize,
    pub(super) chains: [Vec<usize>; 2],
    /// Length of one of them, metres.
    pub(super) reach: f32,
}

impl Tree {
    pub(super) fn of(skeleton: &Skeleton, names: &Names<'_>) -> Self {
        let joints = skeleton.joints();
        let mut helper = vec![false; joints.len()];
        let mut children = vec![Vec::new(); joints.len()];
        for (index, joint) in joints.iter().enumerate() {
            let above = joint.parent.is_some_and(|parent| helper[parent]);
            helper[index] = above || names.is_helper(index);
            if let Some(parent) = joint.parent.filter(|_| !helper[index]) {
                children[parent].push(index);
            }
        }
        let mut reach = vec![0.0_f32; joints.len()];
        for (index, joint) in joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent.filter(|_| !helper[index]) {
                reach[parent] = reach[parent].max(reach[index] + joint.offset.length());
            }
        }
        let rest = skeleton.rest_positions();
        let size = branching_size(&children, &reach, skeleton);
        let parents = joints.iter().map(|joint| joint.parent).collect();
        let ends = joints.iter().map(|joint| joint.end_site).collect();
        Self { rest, parents, children, reach, helper, ends, size }
    }

    /// The longest chain from a joint down to its tip, the joint itself first.
    pub(super) fn longest(&self, joint: usize) -> Vec<usize> {
        let mut chain = vec![joint];
        let mut at = joint;
        while let Some(next) = self.next(at) {
            chain.push(next);
            at = next;
        }
        chain
    }

    /// The child that the longest chain goes on with.
    fn next(&self, joint: usize) -> Option<usize> {
        let length = |child: &usize| self.reach[*child] + self.rest[*child].distance(self.rest[joint]);
        let longest = |best: Option<usize>, child: usize| match best {
            Some(best) if length(&best) >= length(&child) => Some(best),
            _ => Some(child),
        };
        self.children[joint].iter().copied().fold(None, longest)
    }

    /// Joints that hang on a joint, controls and targets left out.
    pub(super) fn children(&self, joint: usize) -> &[usize] {
        self.children.get(joint).map(Vec::as_slice).unwrap_or_default()
    }

    pub(super) fn is_helper(&self, joint: usize) -> bool {
        self.helper.get(joint) == Some(&true)
    }

    /// Whether a joint is the tip of a chain, which cannot turn.
    pub(super) fn is_end(&self, joint: usize) -> bool {
        self.ends.get(joint) == Some(&true)
    }

    pub(super) fn parent(&self, joint: usize) -> Option<usize> {
        self.parents.get(joint).copied().flatten()
    }

    /// Length of the longest chain below a joint, metres.
    pub(super) fn reach(&self, joint: usize) -> f32 {
        self.reach.get(joint).copied().unwrap_or(0.0)
    }

    /// Whether a joint hangs on another, at whatever distance, or is it.
    pub(super) fn hangs_on(&self, joint: usize, above: usize) -> bool {
        std::iter::successors(Some(joint), |&joint| self.parent(joint)).any(|own| own == above)
    }

    /// The joints from one to another along the tree, both included; empty when they have different roots.
    pub(super) fn between(&self, from: usize, to: usize) -> Vec<usize> {
        let up = |joint: usize| -> Vec<usize> {
            std::iter::successors(Some(joint), |&joint| self.parent(joint)).collect()
        };
        let (own, other) = (up(from), up(to));
        let Some(meet) = own.iter().position(|joint| other.contains(joint)) else { return Vec::new() };
        let down = other.iter().position(|joint| *joint == own[meet]).unwrap_or(0);
        let mut path: Vec<usize> = own[..=meet].to_vec();
        path.extend(other[..down].iter().rev());
        path
    }

    /// Limbs that are mirror images, the longest first. A limb's own fingers and toes are too short to be any.
    pub(super) fn pairs(&self, names: &Names<'_>) -> Vec<Pair> {
        let mut pairs = Vec::new();
        for (on, children) in self.children.iter().enumerate() {
            let mut free: Vec<usize> = (children.iter().copied())
                .filter(|&child| self.length(on, child) > LIMB * self.size)
                .collect();
            while let Some(first) = free.first().copied() {
                free.remove(0);
                // Of several the one that is most alike.
                let other = (free.iter().enumerate())
                    .filter_map(|(place, &other)| Some((place, self.unlike(names, on, first, other)?)))
                    .min_by(|a, b| a.1.total_cmp(&b.1));
                if let Some((place, _)) = other {
                    let other = free.remove(place);
                    let reach = 0.5 * (self.length(on, first) + self.length(on, other));
                    pairs.push(Pair { on, chains: [self.longest(first), self.longest(other)], reach });
                }
            }
        }
        pairs.sort_by(|a, b| b.reach.total_cmp(&a.reach));
        pairs
    }

    fn length(&self, on: usize, child: usize) -> f32 {
        self.reach[child] + self.rest[child].distance(self.rest[on])
    }

    /// How little two chains are mirror images; `None` when they are none.
    fn unlike(&self, names: &Names<'_>, on: usize, first: usize, other: usize) -> Option<f32> {
        let lengths = [self.length(on, first), self.length(on, other)];
        let length = lengths[0].max(lengths[1]);
        let mut unlike = (lengths[0] - lengths[1]).abs() / length;
        match (names.side(first), names.side(other)) {
            // Names are believed: rest poses need not be symmetric.
            (Some(own), Some(others)) if own != others => {
                let (a, b) = (names.words.get(first)?, names.words.get(other)?);
                return (a.text == b.text && unlike < 0.4).then_some(unlike);
            }
            (Some(_), Some(_)) => return None,
            _ => {}
        }
        let (a, b) = (self.longest(first), self.longest(other));
        if a.len().abs_diff(b.len()) > 1 {
            return None;
        }
        let mut across = Vec3::ZERO;
        for (&own, &mirrored) in a.iter().zip(&b) {
            let from_on = |joint: usize| self.rest[joint].distance(self.rest[on]);
            unlike = unlike.max((from_on(own) - from_on(mirrored)).abs() / length);
            let apart = self.rest[own] - self.rest[mirrored];
            if apart.length() > across.length() {
                across = apart;
            }
        }
        // What lies in one line is no pair, and joints of a mirror image lie across from each other.
        if unlike > ALIKE || across.length() < 0.05 * length {
            return None;
        }
        let plane = across.normalize();
        for (&own, &mirrored) in a.iter().zip(&b) {
            let apart = self.rest[own] - self.rest[mirrored];
            unlike = unlike.max(apart.reject_from_normalized(plane).length() / length);
        }
        (unlike <= ALIKE).then_some(unlike)
    }
}

/// Length of the longest chain that begins where the figure first branches: what stands above only places it.
fn branching_size(children: &[Vec<usize>], reach: &[f32], skeleton: &Skeleton) -> f32 {
    let mut size = 0.0_f32;
    for root in skeleton.roots() {
        let mut at = root;
        while let [only] = children[at].as_slice() {
            at = *only;
        }
        size = size.max(if children[at].is_empty() { reach[root] } else { reach[at] });
    }
    size
}

/// Which of two chains is the left one: as their names say, else by where they lie when `forward` is ahead.
pub(super) fn left_first(
    names: &Names<'_>,
    tree: &Tree,
    chains: &[Vec<usize>; 2],
    forward: Vec3,
) -> [Vec<usize>; 2] {
    let [a, b] = chains;
    let named = |chain: &[usize]| chain.iter().find_map(|&joint| names.side(joint));
    let left = match (named(a), named(b)) {
        (Some(own), Some(other)) if own != other => own == Side::Left,
        _ => {
            let middle = |chain: &[usize]| {
                chain.iter().map(|&joint| tree.rest[joint]).sum::<Vec3>() / chain.len().max(1) as f32
            };
            (middle(a) - middle(b)).dot(Vec3::Y.cross(forward)) >= 0.0
        }
    };
    if left { [a.clone(), b.clone()] } else { [b.clone(), a.clone()] }
}
