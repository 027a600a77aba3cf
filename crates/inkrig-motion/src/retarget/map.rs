//! Bodies and plans by a map that says which joint follows which.

use super::figure::Figure;
use super::plan::{Aim, Lead, Link, Plan};
use super::{RetargetError, RetargetOptions};
use crate::Skeleton;
use crate::rig::{Arm, Body, Humanoid, Leg, NoBody, Quadruped, QuadrupedLeg};

/// Pairs of a joint of the motion and one of the character that follows it.
pub(super) type Pairs = [(usize, usize)];

/// The figures of both: as they are found, or, with a map, as the map says of the character what is known of the motion.
pub(super) fn figures(
    source: &Skeleton,
    target: &Skeleton,
    options: &RetargetOptions,
) -> Result<(Figure, Figure), RetargetError> {
    let (from, onto) = (Body::find(source), Body::find(target));
    let Some(pairs) = options.map.as_deref() else {
        let (from, onto) = (from.map_err(RetargetError::Source)?, onto.map_err(RetargetError::Target)?);
        return match (&from, &onto) {
            (Body::Humanoid(_), Body::Humanoid(_)) | (Body::Quadruped(_), Body::Quadruped(_)) => {
                Ok((Figure::of(from), Figure::of(onto)))
            }
            (Body::Humanoid(_), Body::Quadruped(_)) => Err(RetargetError::Target(NoBody::FourLegs)),
            (Body::Quadruped(_), Body::Humanoid(_)) => Err(RetargetError::Source(NoBody::FourLegs)),
        };
    };
    check(pairs, source, target)?;
    let onwards = |joint: usize| -> Vec<usize> {
        pairs.iter().filter(|pair| pair.0 == joint).map(|pair| pair.1).collect()
    };
    let backwards = |joint: usize| -> Vec<usize> {
        pairs.iter().filter(|pair| pair.1 == joint).map(|pair| pair.0).collect()
    };
    if let Some((own, other)) = from.ok().and_then(|own| Some((carried(&own, &onwards)?, own))) {
        return Ok((Figure::of(other), Figure::of(own)));
    }
    if let Some((own, other)) = onto.ok().and_then(|own| Some((carried(&own, &backwards)?, own))) {
        return Ok((Figure::of(own), Figure::of(other)));
    }
    // Nothing is known but the map: its first joint of the character, parents first, carries it.
    let &(own, other) = pairs.iter().min_by_key(|pair| pair.1).ok_or(RetargetError::EmptyMap)?;
    Ok((Figure::unknown(own), Figure::unknown(other)))
}

fn check(pairs: &Pairs, source: &Skeleton, target: &Skeleton) -> Result<(), RetargetError> {
    for &(own, other) in pairs {
        if own >= source.len() || other >= target.len() {
            return Err(RetargetError::MapJoint { motion: own, character: other });
        }
    }
    let mut followers: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
    followers.sort_unstable();
    match followers.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(RetargetError::MapTwice(pair[0])),
        None if pairs.is_empty() => Err(RetargetError::EmptyMap),
        None => Ok(()),
    }
}

/// The same body of the other skeleton; `None` where the map says too little of it.
fn carried(body: &Body, map: &dyn Fn(usize) -> Vec<usize>) -> Option<Body> {
    let one = |joint: usize| map(joint).first().copied();
    let maybe = |joint: Option<usize>| joint.and_then(one);
    let all = |joints: &[usize]| -> Vec<usize> {
        let mut found: Vec<usize> = joints.iter().flat_map(|&joint| map(joint)).collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    match body {
        Body::Humanoid(body) => {
            let leg = |leg: &Leg| {
                let (upper, lower) = (one(leg.upper)?, one(leg.lower)?);
                Some(Leg { upper, lower, foot: maybe(leg.foot), toes: maybe(leg.toes) })
            };
            let arm = |arm: &Option<Arm>| {
                let arm = arm.as_ref()?;
                let (upper, lower) = (one(arm.upper)?, one(arm.lower)?);
                Some(Arm { clavicle: maybe(arm.clavicle), upper, lower, hand: maybe(arm.hand) })
            };
            let hips = one(body.hips)?;
            Some(Body::Humanoid(Humanoid {
                hips,
                // One joint of the motion may lead hips and spine.
                spine: all(&body.spine).into_iter().filter(|&joint| joint != hips).collect(),
                neck: all(&body.neck),
                head: maybe(body.head),
                arms: [arm(&body.arms[0]), arm(&body.arms[1])],
                legs: [leg(&body.legs[0])?, leg(&body.legs[1])?],
            }))
        }
        Body::Quadruped(body) => {
            let leg = |leg: &QuadrupedLeg| {
                let joints = all(&leg.joints);
                (joints.len() >= 3).then(|| QuadrupedLeg { girdle: all(&leg.girdle), joints, detached: None })
            };
            Some(Body::Quadruped(Quadruped {
                hips: one(body.hips)?,
                spine: all(&body.spine),
                neck: all(&body.neck),
                head: maybe(body.head),
                tail: all(&body.tail),
                fore: [leg(&body.fore[0])?, leg(&body.fore[1])?],
                hind: [leg(&body.hind[0])?, leg(&body.hind[1])?],
                ears: None,
            }))
        }
    }
}

/// Makes a plan do what a map says, no more and no less: links that agree with it stay as they are.
pub(super) fn obey(plan: &mut Plan, pairs: &Pairs, target: &Skeleton) {
    let mut links = Vec::with_capacity(pairs.len());
    for &(own, other) in pairs {
        let found = plan.links.iter().find(|link| link.target == other && link.lead.nearest() == own);
        links.push(found.cloned().unwrap_or_else(|| link(own, other, pairs, target)));
    }
    links.sort_by_key(|link| link.target);
    plan.links = links;
}

/// A link by the map alone: a bone points as the source's between the same two, what branches turns along.
fn link(source: usize, target: usize, pairs: &Pairs, skeleton: &Skeleton) -> Link {
    let parent = |joint: &usize| skeleton.joints().get(*joint).and_then(|joint| joint.parent);
    let led = |joint: &usize| pairs.iter().any(|pair| pair.1 == *joint);
    // Mapped joints below with none between.
    let below = pairs.iter().filter(|pair| {
        pair.1 != target && std::iter::successors(parent(&pair.1), parent).find(led) == Some(target)
    });
    let below: Vec<&(usize, usize)> = below.collect();
    let aim = match below.as_slice() {
        [] => Aim::Along,
        [next] if next.0 != source => {
            Aim::Bone { target: next.1, from: Lead::one(source), to: Lead::one(next.0) }
        }
        [_] => Aim::Along,
        _ => Aim::Hub(below.iter().map(|pair| (pair.1, pair.0)).collect()),
    };
    Link { target, lead: Lead::one(source), aim }
}
