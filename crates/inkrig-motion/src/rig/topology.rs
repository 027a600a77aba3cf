//! A two-legged body by its build alone, for skeletons whose names say nothing.

use super::names::Names;
use super::tree::{Pair, Tree, left_first};
use super::trunk::Trunk;
use super::{Arm, Humanoid, Leg};
use glam::Vec3;

/// Finds two pairs of mirrored limbs in a rest pose that stands upright: the lower ones are legs, the others arms.
pub(super) fn find(tree: &Tree, names: &Names<'_>) -> Option<Humanoid> {
    let pairs = tree.pairs(names);
    // Fingers of a large hand hang on a limb; only what hangs on the trunk is one.
    let on_limb = |pair: &Pair| {
        let others = pairs.iter().filter(|other| *other != pair);
        others.flat_map(|other| &other.chains).any(|chain| chain.contains(&pair.on))
    };
    let limbs: Vec<&Pair> = pairs.iter().filter(|pair| !on_limb(pair)).collect();
    let tip = |pair: &Pair| {
        let ends = pair.chains.iter().filter_map(|chain| chain.last()).map(|&joint| tree.rest[joint].y);
        ends.fold(f32::INFINITY, f32::min)
    };
    let legs = *limbs.iter().min_by(|a, b| tip(a).total_cmp(&tip(b)))?;
    // Two that reach the ground beside each other are some other animal's.
    let grounded = |pair: &&&Pair| tip(pair) < tip(legs) + 0.15 * legs.reach;
    if limbs.iter().filter(grounded).count() != 1 {
        return None;
    }
    let above = |pair: &&&Pair| tree.rest[pair.on].y > tree.rest[legs.on].y + 0.15 * legs.reach;
    let arms = *limbs.iter().find(above)?;
    let forward = toes_ahead(tree, legs);
    let legs_of = left_first(names, tree, &legs.chains, forward);
    let arms_of = left_first(names, tree, &arms.chains, forward);
    let [left, right] = legs_of.map(|chain| leg(tree, &chain));
    let legs_found = [left?, right?];
    let arms_found = arms_of.map(|chain| arm(tree, &chain));
    let [Some(_), Some(_)] = arms_found else { return None };
    let trunk = Trunk::of(tree, names, legs.on, arms_found, None);
    Some(Humanoid {
        hips: legs.on,
        spine: trunk.spine,
        neck: trunk.neck,
        head: trunk.head,
        arms: arms_found,
        legs: legs_found,
    })
}

/// Where the feet point, without their height; ahead is z where they point nowhere.
fn toes_ahead(tree: &Tree, legs: &Pair) -> Vec3 {
    let mut forward = Vec3::ZERO;
    for chain in &legs.chains {
        let Some(found) = leg(tree, chain) else { continue };
        if let (Some(foot), Some(&tip)) = (found.foot, chain.last()) {
            forward += (tree.rest[tip] - tree.rest[foot]).with_y(0.0);
        }
    }
    if forward.length() > 0.02 * legs.reach { forward.normalize() } else { Vec3::Z }
}

fn leg(tree: &Tree, chain: &[usize]) -> Option<Leg> {
    // What comes before the thigh is short; a short shin may be as long as the foot.
    let upper = two_long_bones(tree, chain).into_iter().next()?;
    let foot = chain[upper + 2];
    // The tip of a foot is no joint that could turn.
    let toes = chain.get(upper + 3).copied().filter(|&toes| !tree.is_end(toes));
    Some(Leg { upper: chain[upper], lower: chain[upper + 1], foot: Some(foot), toes })
}

fn arm(tree: &Tree, chain: &[usize]) -> Option<Arm> {
    // The hand is where fingers begin.
    let hand = (2..chain.len()).find(|&place| tree.children(chain[place]).len() > 1);
    let arm = hand.and_then(|hand| chain.get(..=hand)).unwrap_or(chain);
    // A collar bone may be as long as a forearm.
    let upper = two_long_bones(tree, arm).into_iter().next_back()?;
    let clavicle = upper.checked_sub(1).map(|place| chain[place]);
    Some(Arm { clavicle, upper: chain[upper], lower: chain[upper + 1], hand: Some(chain[upper + 2]) })
}

/// Where in a chain two long bones follow each other: all places that are about as good as the best.
fn two_long_bones(tree: &Tree, chain: &[usize]) -> Vec<usize> {
    let bones: Vec<f32> =
        chain.windows(2).map(|pair| tree.rest[pair[1]].distance(tree.rest[pair[0]])).collect();
    let shorter: Vec<f32> = bones.windows(2).map(|pair| pair[0].min(pair[1])).collect();
    let longest = shorter.iter().copied().fold(0.0, f32::max);
    let good = |place: &usize| longest > 0.0 && shorter[*place] > 0.8 * longest;
    (0..shorter.len()).filter(good).collect()
}
