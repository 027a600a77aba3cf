//! A four-legged body found in a skeleton.

use super::names::Names;
use super::tree::{Pair, Tree, left_first};
use super::{NoBody, Part};
use crate::Skeleton;
use glam::Vec3;

/// The joints of an animal on four legs. Numbers are indices into the skeleton; chains go from the trunk outwards.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quadruped {
    /// Where the hind legs hang.
    pub hips: usize,
    /// From the hips to the joint that the forelegs hang on, the latter included.
    pub spine: Vec<usize>,
    /// From there on to the head, which is not included.
    pub neck: Vec<usize>,
    /// The base of the skull.
    pub head: Option<usize>,
    /// From its root to its tip; empty where there is none.
    pub tail: Vec<usize>,
    /// Forelegs, left and right.
    pub fore: [QuadrupedLeg; 2],
    /// Hind legs, left and right.
    pub hind: [QuadrupedLeg; 2],
    /// Ears, left and right, where both were found.
    pub ears: Option<[Vec<usize>; 2]>,
}

/// A leg of an animal on four legs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuadrupedLeg {
    /// Shoulder blade or half of the pelvis: what hangs on the trunk and is no part of the free leg.
    pub girdle: Vec<usize>,
    /// From shoulder or hip joint to the tip of the toes, at least three. Some rigs keep the paw under a root of its
    /// own, at the place where the leg ends: such joints are part of the chain, and `detached` is where they begin.
    pub joints: Vec<usize>,
    /// Place in `joints` of the first joint that hangs on another root.
    pub detached: Option<usize>,
}

/// Legs reach down at least so much of their length.
const DOWN: f32 = 0.6;
/// Paws stand on one level, within this share of the legs' length.
const LEVEL: f32 = 0.3;
/// Forelegs stand at least so far from hind legs, in lengths of a leg: hands of a person who lets them hang do not.
const APART: f32 = 0.4;

impl Quadruped {
    /// Finds four legs by build: two pairs of limbs that are mirror images and stand on one ground under a trunk that
    /// lies. Names only tell left from right and where a shoulder blade is.
    ///
    /// # Errors
    /// When the rest pose does not stand on four legs.
    pub fn find(skeleton: &Skeleton) -> Result<Self, NoBody> {
        let names = Names::of(skeleton);
        let tree = Tree::of(skeleton, &names);
        Self::in_tree(&tree, &names, skeleton).ok_or(NoBody::NotFourLegs)
    }

    pub(super) fn in_tree(tree: &Tree, names: &Names<'_>, skeleton: &Skeleton) -> Option<Self> {
        let [hind, fore] = standing_limbs(tree, names)?;
        let forward = (middle(tree, &fore) - middle(tree, &hind)).with_y(0.0).normalize_or(Vec3::Z);
        let legs = |pair: &Pair, back: bool| {
            left_first(names, tree, &pair.chains, forward)
                .map(|chain| leg(tree, names, skeleton, &chain, forward, back))
        };
        let hips = hind.on;
        let mut spine = tree.between(hips, fore.on);
        spine.retain(|&joint| joint != hips && !tree.hangs_on(hips, joint));
        let limbs: Vec<usize> = hind.chains.iter().chain(&fore.chains).flatten().copied().collect();
        let (neck, head) = neck(tree, names, &fore, &spine, &limbs);
        let tail = tail(tree, names, hips, &spine, &limbs, forward);
        let ears = ears(tree, names, forward);
        Some(Self { hips, spine, neck, head, tail, fore: legs(&fore, false), hind: legs(&hind, true), ears })
    }
}

impl QuadrupedLeg {
    /// Hip or shoulder, knee or elbow, and the joint that ends the leg above the toes.
    pub fn hip_knee_foot(&self) -> [usize; 3] {
        let joints = &self.joints;
        let last = joints.len() - 1;
        [joints[0], joints[1], joints[last.saturating_sub(1).max(2).min(last)]]
    }
}

/// The pairs of limbs that an animal stands on, hind legs first; `None` for a figure that does not stand on four.
pub(super) fn standing_limbs(tree: &Tree, names: &Names<'_>) -> Option<[Pair; 2]> {
    let low = |pair: &Pair| {
        let tips = pair.chains.iter().filter_map(|chain| lowest(tree, chain));
        tips.fold(f32::INFINITY, f32::min)
    };
    let hangs_down = |pair: &Pair| {
        pair.chains.iter().all(|chain| {
            let Some((&first, lowest)) = chain.first().zip(lowest(tree, chain)) else { return false };
            tree.rest[first].y - lowest > DOWN * tree.reach(first)
        })
    };
    let mut legs: Vec<Pair> = tree.pairs(names).into_iter().filter(hangs_down).collect();
    // What hangs on another leg is a part of it.
    let all = legs.clone();
    legs.retain(|pair| !all.iter().flat_map(|other| &other.chains).any(|chain| chain.contains(&pair.on)));
    let ground = legs.iter().map(&low).fold(f32::INFINITY, f32::min);
    legs.retain(|pair| low(pair) - ground < LEVEL * pair.reach);
    let [one, other] = <[Pair; 2]>::try_from(legs).ok()?;
    let apart = (middle(tree, &one) - middle(tree, &other)).with_y(0.0);
    if apart.length() < APART * one.reach.min(other.reach) {
        return None;
    }
    let swap = is_fore(tree, names, &one, &other);
    Some(if swap { [other, one] } else { [one, other] })
}

/// Whether `one` is the pair of forelegs: by names, by where the head hangs, or by the root, which is at the hips.
fn is_fore(tree: &Tree, names: &Names<'_>, one: &Pair, other: &Pair) -> bool {
    let says = |pair: &Pair| {
        let texts = pair.chains.iter().flatten().map(|&joint| names.words[joint].text.as_str());
        let (mut front, mut back) = (false, false);
        for text in texts {
            front |=
                ["front", "fore", "arm", "hand", "scapula", "humerus"].iter().any(|word| text.contains(word));
            back |= ["back", "hind", "rear", "thigh", "upleg", "femur", "pelvis"]
                .iter()
                .any(|word| text.contains(word));
        }
        i32::from(front) - i32::from(back)
    };
    if says(one) != says(other) {
        return says(one) > says(other);
    }
    let head = names.joints(Part::Head).chain(names.joints(Part::Neck)).next();
    if let Some(head) = head {
        return tree.between(one.on, head).len() < tree.between(other.on, head).len();
    }
    tree.hangs_on(one.on, other.on)
}

/// Middle of where a pair of limbs stands: shoulder blades and pelvis may reach far over each other.
fn middle(tree: &Tree, pair: &Pair) -> Vec3 {
    let tip = |chain: &Vec<usize>| chain.last().map_or(Vec3::ZERO, |&joint| tree.rest[joint]);
    0.5 * (tip(&pair.chains[0]) + tip(&pair.chains[1]))
}

fn lowest(tree: &Tree, chain: &[usize]) -> Option<f32> {
    chain.iter().map(|&joint| tree.rest[joint].y).reduce(f32::min)
}

/// A leg: its girdle cut off, its paw joined where that hangs elsewhere.
fn leg(
    tree: &Tree,
    names: &Names<'_>,
    skeleton: &Skeleton,
    chain: &[usize],
    forward: Vec3,
    hind: bool,
) -> QuadrupedLeg {
    let girdle = girdle(tree, names, chain, forward, hind).min(chain.len().saturating_sub(3));
    let (girdle, free) = chain.split_at(girdle);
    let mut joints = free.to_vec();
    let mut detached = None;
    if let Some(paw) = detached_paw(tree, skeleton, &joints) {
        // The tip of the leg and the root of the paw are one place; the latter can turn.
        joints.pop();
        detached = Some(joints.len());
        joints.extend(paw);
    }
    QuadrupedLeg { girdle: girdle.to_vec(), joints, detached }
}

/// How many joints of a chain belong to shoulder blade or pelvis.
fn girdle(tree: &Tree, names: &Names<'_>, chain: &[usize], forward: Vec3, hind: bool) -> usize {
    let text = |place: usize| chain.get(place).map_or("", |&joint| names.words[joint].text.as_str());
    let has = |place: usize, words: &[&str]| words.iter().any(|word| text(place).contains(word));
    if has(0, &["scapula", "shoulder", "clavicle", "collar", "pelvis", "hip"]) {
        // A shoulder that an elbow follows is the joint, not the blade.
        return usize::from(!has(1, &["forearm", "lower", "elbow", "knee", "radius", "shin"]));
    }
    if names.part(chain[0]).is_some() {
        return 0;
    }
    let bone = |place: usize| tree.rest[chain[place + 1]].distance(tree.rest[chain[place]]);
    if chain.len() > 3 && bone(0) < 0.12 * tree.reach(chain[0]) {
        return 1;
    }
    // Without words: elbows bend back and knees ahead; the joint above begins the leg.
    let along = |place: usize| tree.rest[chain[place]].dot(forward) * if hind { 1.0 } else { -1.0 };
    let (first, last) = (tree.rest[chain[0]], tree.rest[chain[chain.len() - 1]]);
    let height = (first.y - last.y).max(f32::MIN_POSITIVE);
    let upper_half = (1..chain.len().saturating_sub(1))
        .filter(|&place| (tree.rest[chain[place]].y - last.y) / height > 0.35);
    let bend = |place: usize| along(place) - 0.5 * (along(place - 1) + along(place + 1));
    let joint = upper_half.max_by(|&a, &b| bend(a).total_cmp(&bend(b)));
    match joint {
        Some(place) if bend(place) > 0.03 * height => place - 1,
        _ => 0,
    }
}

/// The joints of a paw that stands under a root of its own, where the leg ends.
fn detached_paw(tree: &Tree, skeleton: &Skeleton, leg: &[usize]) -> Option<Vec<usize>> {
    let &end = leg.last()?;
    let near = |joint: &usize| tree.rest[*joint].distance(tree.rest[end]) < 0.01 * tree.size;
    let paw = skeleton.roots().find(|root| !tree.hangs_on(end, *root) && near(root))?;
    // Named as a target of the leg, it is left out of the tree: its own children are looked for.
    let joints = skeleton.joints();
    let mut chain = vec![paw];
    while let Some(next) =
        joints.iter().position(|joint| joint.parent.is_some() && joint.parent == chain.last().copied())
    {
        chain.push(next);
    }
    Some(chain)
}

/// Neck and head above the forelegs.
fn neck(
    tree: &Tree,
    names: &Names<'_>,
    fore: &Pair,
    spine: &[usize],
    limbs: &[usize],
) -> (Vec<usize>, Option<usize>) {
    let named = names.joints(Part::Head).find(|&joint| !limbs.contains(&joint));
    let free = |joint: &usize| !limbs.contains(joint) && !spine.contains(joint);
    let longest = || {
        let children = tree.children(fore.on).iter().copied().filter(|joint| free(joint));
        let first = children.max_by(|&a, &b| tree.reach(a).total_cmp(&tree.reach(b)))?;
        let chain = tree.longest(first);
        // Where ears and jaws begin is the head.
        let branches = chain.iter().copied().find(|&joint| tree.children(joint).len() > 1);
        branches.or_else(|| chain.iter().rev().nth(1).or(chain.last()).copied())
    };
    let Some(head) = named.or_else(longest) else { return (Vec::new(), None) };
    let mut neck = tree.between(fore.on, head);
    neck.retain(|joint| *joint != fore.on && *joint != head && free(joint));
    (neck, Some(head))
}

/// The tail: the chain named so that hangs on the hips, else the longest that points back.
fn tail(
    tree: &Tree,
    names: &Names<'_>,
    hips: usize,
    spine: &[usize],
    limbs: &[usize],
    forward: Vec3,
) -> Vec<usize> {
    let named = (0..names.words.len())
        .find(|&joint| names.words[joint].text.starts_with("tail") && !tree.is_helper(joint));
    let first = named.or_else(|| {
        let free = |joint: &usize| !limbs.contains(joint) && !spine.contains(joint);
        let back = |joint: &usize| {
            let chain = tree.longest(*joint);
            let way = chain.last().map_or(Vec3::ZERO, |&tip| tree.rest[tip] - tree.rest[hips]);
            way.dot(forward) < -0.1 * tree.size
        };
        let children = tree.children(hips).iter().copied().filter(free).filter(|joint| back(joint));
        children.max_by(|&a, &b| tree.reach(a).total_cmp(&tree.reach(b)))
    });
    first.map(|first| tree.longest(first)).unwrap_or_default()
}

/// Ears by name: some rigs hang them on the neck.
fn ears(tree: &Tree, names: &Names<'_>, forward: Vec3) -> Option<[Vec<usize>; 2]> {
    let ear = |joint: usize| names.words[joint].text.starts_with("ear") && names.side(joint).is_some();
    let first = |joint: &usize| ear(*joint) && !tree.parent(*joint).is_some_and(ear);
    let named: Vec<usize> = (0..names.words.len()).filter(first).collect();
    let [one, other] = named.as_slice() else { return None };
    Some(left_first(names, tree, &[tree.longest(*one), tree.longest(*other)], forward))
}
