//! A pose of the source in which it stands as people stand.

use crate::kinematics::Pose;
use crate::rig::Humanoid;
use crate::{Clip, Skeleton};
use glam::Vec3;

/// The source's pose that the target is turned to.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) pose: Pose,
    /// It is the pose in which nothing is turned.
    pub(super) at_rest: bool,
    /// Lowest of all frames' feet, metres.
    pub(super) ground: f32,
    /// Hips above the lowest foot in this pose, metres.
    pub(super) hips: f32,
    pub(super) body: Humanoid,
}

/// The pose in which nothing is turned, where that is one that a person can stand in; else the frame that is most
/// upright with its legs straightest. Files of some programs have bones in any direction while nothing is turned.
pub(super) fn find(source: &Clip, body: &Humanoid) -> Reference {
    let rest = Pose::new(source.skeleton());
    let mut lowest = f32::INFINITY;
    let (mut best, mut best_score) = (rest.clone(), score(&rest, body, source.skeleton()));
    let stands = best_score > 0.9;
    let mut pose = rest;
    for frame in 0..source.frames() {
        pose.set(source, frame);
        lowest = lowest.min(sole(&pose, body));
        let own = score(&pose, body, source.skeleton());
        if !stands && own > best_score {
            best_score = own;
            best = pose.clone();
        }
    }
    let hips = hip_height(&best, body);
    Reference { pose: best, at_rest: stands, ground: lowest, hips, body: body.clone() }
}

/// The lowest point of both feet.
pub(super) fn sole(pose: &Pose, body: &Humanoid) -> f32 {
    let feet = body.legs.iter().flat_map(|leg| [leg.foot, leg.toes, Some(leg.lower)]).flatten();
    feet.map(|joint| pose.positions[joint].y).fold(f32::INFINITY, f32::min)
}

/// How high the legs begin above the lowest foot.
pub(super) fn hip_height(pose: &Pose, body: &Humanoid) -> f32 {
    let hips = body.legs.map(|leg| pose.positions[leg.upper].y);
    0.5 * (hips[0] + hips[1]) - sole(pose, body)
}

/// 1 for a person who stands with straight legs and an upright spine, less the further from it.
fn score(pose: &Pose, body: &Humanoid, skeleton: &Skeleton) -> f32 {
    let at = |joint: usize| pose.positions[joint];
    let mut score = 1.0_f32;
    for leg in body.legs {
        let (hip, knee) = (at(leg.upper), at(leg.lower));
        let below = leg.foot.map_or(knee, at);
        score = score.min((knee - hip).normalize_or_zero().dot(Vec3::NEG_Y));
        if leg.foot.is_some() {
            score = score.min((below - knee).normalize_or_zero().dot(Vec3::NEG_Y));
        }
    }
    let hips = 0.5 * (at(body.legs[0].upper) + at(body.legs[1].upper));
    let top = body.head.or(body.neck.first().copied()).or(body.spine.last().copied());
    if let Some(top) = top {
        score = score.min((at(top) - hips).normalize_or_zero().dot(Vec3::Y));
    }
    // Arms that hang on the wrong side say that left and right are not where they should be.
    if let [Some(left), Some(right)] = body.arms {
        let across = (at(left.upper) - at(right.upper)).normalize_or_zero();
        let legs = (at(body.legs[0].upper) - at(body.legs[1].upper)).normalize_or_zero();
        score = score.min(across.dot(legs));
    }
    if skeleton.len() != pose.positions.len() || !score.is_finite() { -1.0 } else { score }
}
