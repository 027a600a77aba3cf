//! Which joint leads which.

use super::chains;
use super::figure::Figure;
use crate::kinematics::Pose;
use crate::rig::{Humanoid, Part, Side};
use glam::Vec3;

/// What a target joint follows, and where its bone goes.
#[derive(Debug, Clone, Default)]
pub(super) struct Plan {
    /// One for every target joint that is led, parents before children.
    pub(super) links: Vec<Link>,
}

/// A target joint and what leads it.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub(super) target: usize,
    pub(super) lead: Lead,
    pub(super) aim: Aim,
}

/// A place on a chain of the source: a joint, or between two for chains of unequal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lead {
    pub(super) low: usize,
    pub(super) high: usize,
    /// 0 is all of `low`, 1 all of `high`.
    pub(super) part: f32,
}

/// What a target joint is turned by in the reference pose.
#[derive(Debug, Clone)]
pub(super) enum Aim {
    /// Its bone, which goes to the target's joint, points where the source does between two places.
    Bone { target: usize, from: Lead, to: Lead },
    /// Several neighbours: target joint, source joint.
    Hub(Vec<(usize, usize)>),
    /// As a foot: round the vertical only, so that soles stay flat.
    Sole { target: usize, from: usize, to: usize },
    /// As the body stands: spine, neck and head.
    Upright,
    /// With the bone before it: hands and toes.
    Along,
    /// So far that a hip or shoulder moves over the trunk as the source's does: target joint, source joint. A shoulder
    /// blade lies otherwise in every rig, and its turns by themselves say nothing about where it takes a leg.
    Girdle { target: usize, source: usize },
}

impl Plan {
    /// For two bodies of one kind; `None` for others.
    pub(super) fn of(from: (&Figure, &Pose), onto: (&Figure, &Pose)) -> Option<Self> {
        let mut links = match (from.0.humanoid(), onto.0.humanoid()) {
            (Some(own), Some(other)) => humanoid(own, other),
            _ => chains::links((from.0.quadruped()?, from), (onto.0.quadruped()?, onto)),
        };
        links.sort_by_key(|link| link.target);
        links.dedup_by_key(|link| link.target);
        Some(Self { links })
    }

    /// Target joints with the source joint that leads each most.
    pub(super) fn pairs(&self) -> Vec<(usize, usize)> {
        self.links.iter().map(|link| (link.target, link.lead.nearest())).collect()
    }
}

fn humanoid(from: &Humanoid, onto: &Humanoid) -> Vec<Link> {
    let mut links = Vec::new();
    let legs = [0, 1].map(|side| (onto.legs[side].upper, from.legs[side].upper));
    let mut hips: Vec<(usize, usize)> = legs.into();
    if let (Some(&own), Some(&other)) = (onto.spine.first(), from.spine.first()) {
        hips.push((own, other));
    }
    links.push(Link { target: onto.hips, lead: Lead::one(from.hips), aim: Aim::Hub(hips) });
    // The spine from the joint above the hips, the neck from the joint above the chest.
    let source_spine: Vec<usize> = std::iter::once(from.hips).chain(from.spine.iter().copied()).collect();
    let chest_neighbours = chest(from, onto);
    for (index, &target) in onto.spine.iter().enumerate() {
        let last = index + 1 == onto.spine.len();
        let lead = Lead::between(&source_spine, (index + 1) as f32 / onto.spine.len() as f32);
        let aim = if last && chest_neighbours.len() > 1 {
            Aim::Hub(chest_neighbours.clone())
        } else {
            Aim::Upright
        };
        links.push(Link { target, lead, aim });
    }
    let chest = *source_spine.last().unwrap_or(&from.hips);
    let source_neck: Vec<usize> =
        std::iter::once(chest).chain(from.neck.iter().copied()).chain(from.head).collect();
    let count = onto.neck.len() + usize::from(onto.head.is_some());
    for (index, target) in onto.neck.iter().copied().chain(onto.head).enumerate() {
        let lead = Lead::between(&source_neck, (index + 1) as f32 / count as f32);
        links.push(Link { target, lead, aim: Aim::Upright });
    }
    for side in Side::BOTH {
        limb(from, onto, side, &[Part::Clavicle, Part::UpperArm, Part::LowerArm, Part::Hand], &mut links);
        limb(from, onto, side, &[Part::UpperLeg, Part::LowerLeg, Part::Foot, Part::Toes], &mut links);
    }
    links
}

impl Lead {
    pub(super) fn one(joint: usize) -> Self {
        Self { low: joint, high: joint, part: 0.0 }
    }

    /// A place on a chain that has a joint: 0 its first one, 1 its last.
    pub(super) fn between(chain: &[usize], place: f32) -> Self {
        let last = chain.len() - 1;
        let at = place * last as f32;
        let low = (at.floor() as usize).min(last);
        let high = (low + 1).min(last);
        Self { low: chain[low], high: chain[high], part: at - low as f32 }
    }

    /// Where that is among the joints' places.
    pub(super) fn place(self, places: &[Vec3]) -> Vec3 {
        places[self.low].lerp(places[self.high], self.part)
    }

    pub(super) fn nearest(self) -> usize {
        if self.part < 0.5 { self.low } else { self.high }
    }
}

/// What hangs on the chest of both: neck or head, and the arms.
fn chest(from: &Humanoid, onto: &Humanoid) -> Vec<(usize, usize)> {
    let top = |body: &Humanoid| body.neck.first().copied().or(body.head);
    let arm = |body: &Humanoid, side: usize| body.arms[side].map(|arm| arm.upper);
    let pairs = [(top(onto), top(from)), (arm(onto, 0), arm(from, 0)), (arm(onto, 1), arm(from, 1))];
    pairs.into_iter().filter_map(|(own, other)| Some((own?, other?))).collect()
}

/// The joints of an arm or a leg that both have.
fn limb(from: &Humanoid, onto: &Humanoid, side: Side, parts: &[Part; 4], links: &mut Vec<Link>) {
    for (index, &part) in parts.iter().enumerate() {
        let (Some(target), Some(source)) = (onto.joint(part, side), from.joint(part, side)) else { continue };
        let next =
            parts.get(index + 1).and_then(|&next| Some((onto.joint(next, side)?, from.joint(next, side)?)));
        let aim = match (part, next) {
            (Part::Foot, Some((own, other))) => Aim::Sole { target: own, from: source, to: other },
            (_, Some((own, other))) => {
                Aim::Bone { target: own, from: Lead::one(source), to: Lead::one(other) }
            }
            (_, None) => Aim::Along,
        };
        links.push(Link { target, lead: Lead::one(source), aim });
    }
}
