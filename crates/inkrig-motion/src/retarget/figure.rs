//! What retargeting needs to know of a body, whether it goes on two legs or on four.

use crate::kinematics::Pose;
use crate::rig::{Body, Humanoid, Quadruped, QuadrupedLeg};
use glam::{DQuat, DVec3, Vec3};

/// A body as joints that carry, stand and say where it faces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Figure {
    /// `None` for a figure of which only a map is known.
    pub(super) body: Option<Body>,
    /// The joint that carries the figure.
    pub(super) hips: usize,
    /// Legs that stand: left and right, of an animal the hind legs first.
    pub(super) legs: Vec<Limb>,
}

/// A leg as two bones and a foot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Limb {
    pub(super) upper: usize,
    pub(super) lower: usize,
    pub(super) foot: Option<usize>,
    pub(super) toes: Option<usize>,
}

impl Limb {
    /// What may touch the ground.
    pub(super) fn sole(&self) -> impl Iterator<Item = usize> {
        self.foot.into_iter().chain(self.toes)
    }
}

impl Figure {
    pub(super) fn of(body: Body) -> Self {
        let legs = match &body {
            Body::Humanoid(body) => (body.legs.iter())
                .map(|leg| Limb { upper: leg.upper, lower: leg.lower, foot: leg.foot, toes: leg.toes })
                .collect(),
            Body::Quadruped(body) => body.hind.iter().chain(&body.fore).map(four_legged).collect(),
        };
        Self { hips: body.hips(), body: Some(body), legs }
    }

    /// Only a joint that carries the figure.
    pub(super) fn unknown(hips: usize) -> Self {
        Self { body: None, hips, legs: Vec::new() }
    }

    /// The lowest point of all feet, or of the whole figure where none are known.
    pub(super) fn sole(&self, pose: &Pose) -> f32 {
        let feet = self.legs.iter().flat_map(|leg| leg.sole().chain([leg.lower]));
        let lowest = |joints: &mut dyn Iterator<Item = usize>| {
            joints.map(|joint| pose.positions[joint].y).fold(f32::INFINITY, f32::min)
        };
        if self.legs.is_empty() { lowest(&mut (0..pose.positions.len())) } else { lowest(&mut { feet }) }
    }

    /// The place that is carried over: the middle of where the legs begin.
    pub(super) fn middle(&self, places: &[Vec3]) -> Vec3 {
        if self.legs.is_empty() {
            return places[self.hips];
        }
        self.legs.iter().map(|leg| places[leg.upper]).sum::<Vec3>() / self.legs.len() as f32
    }

    /// From where the legs begin to where the arms do, of an animal from the hind legs to the forelegs.
    pub(super) fn trunk(&self, places: &[Vec3]) -> Option<Vec3> {
        let mean = |a: usize, b: usize| 0.5 * (places[a] + places[b]);
        match self.body.as_ref()? {
            Body::Humanoid(body) => {
                let [Some(left), Some(right)] = body.arms else { return None };
                Some(mean(left.upper, right.upper) - self.middle(places))
            }
            Body::Quadruped(body) => {
                let begin = |legs: &[QuadrupedLeg; 2]| mean(legs[0].joints[0], legs[1].joints[0]);
                Some(begin(&body.fore) - begin(&body.hind))
            }
        }
    }

    /// From right to left between the hip joints, and between the shoulders.
    pub(super) fn across(&self, places: &[Vec3]) -> Vec<Vec3> {
        let pairs = match &self.body {
            Some(Body::Humanoid(body)) => {
                let arms = body.arms[0].zip(body.arms[1]).map(|(left, right)| [left.upper, right.upper]);
                [Some([body.legs[0].upper, body.legs[1].upper]), arms]
            }
            Some(Body::Quadruped(body)) => {
                [&body.hind, &body.fore].map(|legs| Some([legs[0].joints[0], legs[1].joints[0]]))
            }
            None => [None, None],
        };
        pairs.into_iter().flatten().map(|[left, right]| places[left] - places[right]).collect()
    }

    /// How high the legs begin above the lowest foot; of an unknown figure its height.
    pub(super) fn height(&self, pose: &Pose) -> f32 {
        let top = if self.legs.is_empty() {
            pose.positions.iter().map(|place| place.y).fold(f32::NEG_INFINITY, f32::max)
        } else {
            self.middle(&pose.positions).y
        };
        top - self.sole(pose)
    }

    /// Mean length of a leg, metres.
    pub(super) fn leg_length(&self, pose: &Pose) -> f32 {
        let at = |joint: usize| pose.positions[joint];
        let length = |leg: &Limb| {
            let shin = leg.foot.map_or(0.0, |foot| at(foot).distance(at(leg.lower)));
            at(leg.lower).distance(at(leg.upper)) + shin
        };
        if self.legs.is_empty() {
            return self.height(pose).max(0.0);
        }
        self.legs.iter().map(length).sum::<f32>() / self.legs.len() as f32
    }

    /// The rotation about y from z to where the body faces.
    pub(super) fn facing(&self, pose: &Pose) -> DQuat {
        let at = |joint: usize| pose.positions[joint].as_dvec3();
        let forward = match &self.body {
            Some(Body::Humanoid(body)) => {
                let mut left = at(body.legs[0].upper) - at(body.legs[1].upper);
                if let [Some(own), Some(other)] = body.arms {
                    left += at(own.upper) - at(other.upper);
                }
                DVec3::new(left.x, 0.0, left.z).cross(DVec3::Y)
            }
            Some(Body::Quadruped(body)) => {
                let mean = |legs: &[QuadrupedLeg; 2]| at(legs[0].joints[0]) + at(legs[1].joints[0]);
                (mean(&body.fore) - mean(&body.hind)).with_y(0.0)
            }
            None => DVec3::Z,
        };
        let forward = forward.normalize_or(DVec3::Z);
        DQuat::from_rotation_y(forward.x.atan2(forward.z))
    }

    pub(super) fn humanoid(&self) -> Option<&Humanoid> {
        match &self.body {
            Some(Body::Humanoid(body)) => Some(body),
            _ => None,
        }
    }

    pub(super) fn quadruped(&self) -> Option<&Quadruped> {
        match &self.body {
            Some(Body::Quadruped(body)) => Some(body),
            _ => None,
        }
    }

    /// 1 for one who stands with straight legs and an upright spine, less the further from it; animals on four legs are
    /// found by how they stand at rest.
    pub(super) fn stands(&self, pose: &Pose) -> f32 {
        let Some(body) = self.humanoid() else { return 1.0 };
        let at = |joint: usize| pose.positions[joint];
        let mut score = 1.0_f32;
        for leg in body.legs {
            let (hip, knee) = (at(leg.upper), at(leg.lower));
            score = score.min((knee - hip).normalize_or_zero().dot(Vec3::NEG_Y));
            if let Some(foot) = leg.foot {
                score = score.min((at(foot) - knee).normalize_or_zero().dot(Vec3::NEG_Y));
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
        if score.is_finite() { score } else { -1.0 }
    }
}

fn four_legged(leg: &QuadrupedLeg) -> Limb {
    let [upper, lower, foot] = leg.hip_knee_foot();
    let tip = leg.joints.last().copied().filter(|&tip| tip != foot);
    Limb { upper, lower, foot: Some(foot), toes: tip }
}
