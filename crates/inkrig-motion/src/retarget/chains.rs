//! Animals on four legs: chain by chain, whatever the number of joints.

use super::figure::Figure;
use super::plan::{Aim, Lead, Link};
use crate::kinematics::Pose;
use crate::rig::{Quadruped, QuadrupedLeg};
use glam::Vec3;

/// Two joints of a leg stand for each other when they are nearer than the root of this, in heights of the leg.
const NEAR: f32 = 0.06;

type Side<'a> = (&'a Quadruped, (&'a Figure, &'a Pose));

/// Links for spine, neck, head, tail, ears and four legs.
pub(super) fn links((from, own): Side<'_>, (onto, other): Side<'_>) -> Vec<Link> {
    let hips =
        [(onto.hind[0].joints[0], from.hind[0].joints[0]), (onto.hind[1].joints[0], from.hind[1].joints[0])];
    let mut links = vec![Link { target: onto.hips, lead: Lead::one(from.hips), aim: Aim::Hub(hips.into()) }];
    let spine = with_first(from.hips, &from.spine);
    turned(&onto.spine, &spine, &mut links);
    let (chest, target_neck) = (*spine.last().unwrap_or(&from.hips), joined(&onto.neck, onto.head));
    turned(&target_neck, &with_first(chest, &joined(&from.neck, from.head)), &mut links);
    if let (Some(ears), Some(others)) = (&from.ears, &onto.ears) {
        for (source, target) in ears.iter().zip(others) {
            turned(target, source, &mut links);
        }
    }
    // A tail hangs one way while nothing is turned and is carried another: where it points counts.
    pointed((&from.tail, &own.1.positions), (&onto.tail, &other.1.positions), &mut links);
    for (source, target) in from.hind.iter().chain(&from.fore).zip(onto.hind.iter().chain(&onto.fore)) {
        // Without a shoulder blade of its own it goes with what carries it.
        if let (Some(&lead), Some(&joint)) = (source.girdle.last(), target.girdle.last()) {
            let aim = Aim::Girdle { target: target.joints[0], source: source.joints[0] };
            links.push(Link { target: joint, lead: Lead::one(lead), aim });
        }
        leg((source, own), (target, other), &mut links);
    }
    links
}

fn with_first(first: usize, chain: &[usize]) -> Vec<usize> {
    std::iter::once(first).chain(chain.iter().copied()).collect()
}

fn joined(chain: &[usize], last: Option<usize>) -> Vec<usize> {
    chain.iter().copied().chain(last).collect()
}

/// A chain that turns as another does, by share of its joints.
fn turned(target: &[usize], source: &[usize], links: &mut Vec<Link>) {
    if source.is_empty() {
        return;
    }
    for (index, &joint) in target.iter().enumerate() {
        let lead = Lead::between(source, (index + 1) as f32 / target.len() as f32);
        links.push(Link { target: joint, lead, aim: Aim::Upright });
    }
}

/// A chain whose bones point where another does at the same share of its length.
fn pointed(
    (source, source_rest): (&[usize], &[Vec3]),
    (target, target_rest): (&[usize], &[Vec3]),
    links: &mut Vec<Link>,
) {
    if source.len() < 2 {
        return;
    }
    let (own, others) = (shares(target, target_rest), shares(source, source_rest));
    for index in 0..target.len().saturating_sub(1) {
        let (from, to) = (at_share(source, &others, own[index]), at_share(source, &others, own[index + 1]));
        let aim = Aim::Bone { target: target[index + 1], from, to };
        // What turns a bone is the joint at its beginning.
        links.push(Link { target: target[index], lead: Lead::one(from.low), aim });
    }
}

/// How far along its chain each joint is, 0 to 1.
fn shares(chain: &[usize], rest: &[Vec3]) -> Vec<f32> {
    let mut lengths = vec![0.0_f32];
    for pair in chain.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + rest[pair[1]].distance(rest[pair[0]]));
    }
    let all = lengths[lengths.len() - 1].max(f32::MIN_POSITIVE);
    lengths.iter().map(|length| length / all).collect()
}

/// The place on a chain at a share of its length.
fn at_share(chain: &[usize], shares: &[f32], share: f32) -> Lead {
    let last = chain.len() - 1;
    let high = (1..last).find(|&place| shares[place] > share).unwrap_or(last);
    let (begin, end) = (shares[high - 1], shares[high]);
    let part = if end > begin { ((share - begin) / (end - begin)).clamp(0.0, 1.0) } else { 0.0 };
    Lead { low: chain[high - 1], high: chain[high], part }
}

type LegOf<'a> = (&'a QuadrupedLeg, (&'a Figure, &'a Pose));

/// A leg: joints that stand for each other are matched by where they are at rest; between them it is stiff. Each turns
/// as the other does, so that an animal keeps the angles of its own knees and hocks; where the whole leg points is
/// seen to later.
fn leg((source, own): LegOf<'_>, (target, other): LegOf<'_>, links: &mut Vec<Link>) {
    let matched = matching(&outline(source, own), &outline(target, other));
    // The last pair are the tips, which turn nothing.
    for &(from, onto) in matched.iter().take(matched.len().saturating_sub(1)) {
        let lead = Lead::one(source.joints[from]);
        links.push(Link { target: target.joints[onto], lead, aim: Aim::Upright });
    }
}

/// Where a leg's joints are in its own heights: how far above its tip, how far ahead of its first joint.
fn outline(leg: &QuadrupedLeg, (figure, pose): (&Figure, &Pose)) -> Vec<[f32; 2]> {
    let place = |joint: usize| pose.positions[joint];
    let ahead = figure.facing(pose).as_quat() * Vec3::Z;
    let (first, last) = (leg.joints[0], leg.joints[leg.joints.len() - 1]);
    let height = (place(first).y - place(last).y).max(f32::MIN_POSITIVE);
    let of = |&joint: &usize| {
        let over = place(joint) - place(first);
        [1.0 + over.y / height, over.dot(ahead) / height]
    };
    leg.joints.iter().map(of).collect()
}

/// Pairs of joints in rising order, the first and the last among them: of all such rows of pairs the one whose joints
/// are nearest to each other. Stretching ahead counts half: animals stand differently.
fn matching(source: &[[f32; 2]], target: &[[f32; 2]]) -> Vec<(usize, usize)> {
    let gain = |i: usize, j: usize| {
        let ends = (i == 0 && j == 0) || (i + 1 == source.len() && j + 1 == target.len());
        let (up, ahead) = (source[i][0] - target[j][0], 0.5 * (source[i][1] - target[j][1]));
        if ends { 10.0 } else { NEAR - up * up - ahead * ahead }
    };
    let (rows, columns) = (source.len(), target.len());
    // best[i][j]: the most that joints from i and j on can gain.
    let mut best = vec![vec![0.0_f32; columns + 1]; rows + 1];
    for i in (0..rows).rev() {
        for j in (0..columns).rev() {
            best[i][j] = best[i + 1][j].max(best[i][j + 1]).max(best[i + 1][j + 1] + gain(i, j));
        }
    }
    let (mut pairs, mut i, mut j) = (Vec::new(), 0, 0);
    while i < rows && j < columns {
        if best[i][j] == best[i + 1][j + 1] + gain(i, j) {
            pairs.push((i, j));
            (i, j) = (i + 1, j + 1);
        } else if best[i][j] == best[i + 1][j] {
            i += 1;
        } else {
            j += 1;
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knees_stand_for_knees_whatever_is_missing() {
        let wolf = [[1.0, 0.0], [0.75, 0.15], [0.45, -0.38], [0.08, -0.25], [0.0, -0.16], [0.0, -0.08]];
        let fox = [[1.0, 0.0], [0.68, 0.13], [0.33, -0.13], [0.08, -0.09], [0.0, -0.02], [0.0, 0.04]];
        let all: Vec<(usize, usize)> = (0..6).map(|place| (place, place)).collect();
        assert_eq!(matching(&wolf, &fox), all);
        // A foreleg with its wrist, and one without.
        let horse = [[1.0, 0.0], [0.85, -0.15], [0.46, -0.17], [0.18, -0.2], [0.07, -0.17], [0.0, -0.15]];
        let short = [[1.0, 0.0], [0.76, -0.1], [0.12, 0.08], [0.02, 0.16], [0.0, 0.26]];
        assert_eq!(matching(&horse, &short), [(0, 0), (1, 1), (3, 2), (4, 3), (5, 4)]);
    }

    #[test]
    fn places_on_a_chain_go_by_length() {
        let rest = [Vec3::ZERO, Vec3::X, 3.0 * Vec3::X, 4.0 * Vec3::X];
        let chain = [0, 1, 2, 3];
        let own = shares(&chain, &rest);
        assert_eq!(own, [0.0, 0.25, 0.75, 1.0]);
        for share in [0.0, 0.1, 0.25, 0.5, 0.9, 1.0] {
            let place = at_share(&chain, &own, share).place(&rest);
            assert!((place.x - 4.0 * share).abs() < 1e-6, "{share}");
        }
    }
}
