//! A two-legged body found in a skeleton.

use super::role::{Ambiguous, Said, said};
use super::{Part, Side};
use crate::Skeleton;

/// The joints of a two-legged body. Numbers are indices into the skeleton.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Humanoid {
    /// Where legs and spine meet.
    pub hips: usize,
    /// From the hips upwards, hips and neck not included.
    pub spine: Vec<usize>,
    /// From the spine upwards, the head not included.
    pub neck: Vec<usize>,
    /// The base of the skull.
    pub head: Option<usize>,
    /// Left and right.
    pub arms: [Option<Arm>; 2],
    /// Left and right.
    pub legs: [Leg; 2],
}

/// One arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Arm {
    /// The collar bone.
    pub clavicle: Option<usize>,
    /// The shoulder.
    pub upper: usize,
    /// The elbow.
    pub lower: usize,
    /// The wrist.
    pub hand: Option<usize>,
}

/// One leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leg {
    /// The hip.
    pub upper: usize,
    /// The knee.
    pub lower: usize,
    /// The ankle.
    pub foot: Option<usize>,
    /// The ball of the foot.
    pub toes: Option<usize>,
}

/// What a skeleton lacks to be a two-legged body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("no joint was found that is the {part:?}{}", side.map_or_else(String::new, |side| format!(" ({side:?})")))]
pub struct Missing {
    /// The first part that was not found.
    pub part: Part,
    /// Its side, for parts that come in pairs.
    pub side: Option<Side>,
}

impl Humanoid {
    /// Finds the body by the joints' names, checked against the tree: limbs hang on each other in order, and of two
    /// joints with the same meaning the one nearer to the root counts.
    ///
    /// # Errors
    /// When hips, a thigh or a shin is missing: the skeleton is none of a person, or its names are of another tongue.
    pub fn find(skeleton: &Skeleton) -> Result<Self, Missing> {
        let names = Names::of(skeleton);
        let legs = Side::BOTH.map(|side| names.leg(side));
        let [left, right] = legs;
        let legs = [left?, right?];
        let hips = names.hips(legs).ok_or(Missing { part: Part::Hips, side: None })?;
        let arms = Side::BOTH.map(|side| names.arm(side));
        let head =
            names.first(Part::Head, None, Some(hips)).or_else(|| names.first(Part::Neck, None, Some(hips)));
        let neck = names.all(Part::Neck, hips).into_iter().filter(|&joint| Some(joint) != head).collect();
        let mut spine = names.all(Part::Spine, hips);
        // The spine is the one line that carries head or arms; a belly bone at its side is none of it.
        let carried =
            head.or_else(|| arms.iter().flatten().next().map(|arm| arm.clavicle.unwrap_or(arm.upper)));
        if let Some(carried) = carried {
            spine.retain(|&joint| names.hangs_on(carried, joint));
        }
        Ok(Self { hips, spine, neck, head, arms, legs })
    }

    /// The joint of a part, where the body has it; for [`Part::Spine`] the uppermost, for [`Part::Neck`] the lowest.
    pub fn joint(&self, part: Part, side: Side) -> Option<usize> {
        let index = usize::from(side == Side::Right);
        let (arm, leg) = (self.arms[index], self.legs[index]);
        match part {
            Part::Hips => Some(self.hips),
            Part::Spine => self.spine.last().copied(),
            Part::Neck => self.neck.first().copied(),
            Part::Head => self.head,
            Part::Clavicle => arm.and_then(|arm| arm.clavicle),
            Part::UpperArm => arm.map(|arm| arm.upper),
            Part::LowerArm => arm.map(|arm| arm.lower),
            Part::Hand => arm.and_then(|arm| arm.hand),
            Part::UpperLeg => Some(leg.upper),
            Part::LowerLeg => Some(leg.lower),
            Part::Foot => leg.foot,
            Part::Toes => leg.toes,
        }
    }
}

/// What the joints' names say, and how the joints hang together.
struct Names<'s> {
    skeleton: &'s Skeleton,
    said: Vec<Option<Said>>,
}

impl<'s> Names<'s> {
    fn of(skeleton: &'s Skeleton) -> Self {
        let joints = skeleton.joints();
        let mut all: Vec<Option<Said>> =
            joints.iter().map(|joint| if joint.end_site { None } else { said(&joint.name) }).collect();
        let has = |part: Part| all.iter().flatten().any(|said| said.part == part && said.ambiguous.is_none());
        let (upper_arm, upper_leg) = (has(Part::UpperArm), has(Part::UpperLeg));
        for said in all.iter_mut().flatten() {
            match said.ambiguous {
                Some(Ambiguous::Shoulder) if !upper_arm => said.part = Part::UpperArm,
                Some(Ambiguous::Leg) if !upper_leg => said.part = Part::UpperLeg,
                _ => {}
            }
        }
        Self { skeleton, said: all }
    }

    fn leg(&self, side: Side) -> Result<Leg, Missing> {
        let missing = |part| Missing { part, side: Some(side) };
        let find = |part, above| self.first(part, Some(side), above);
        let upper = find(Part::UpperLeg, None).ok_or_else(|| missing(Part::UpperLeg))?;
        let lower = find(Part::LowerLeg, Some(upper)).ok_or_else(|| missing(Part::LowerLeg))?;
        let foot = find(Part::Foot, Some(lower));
        // A skeleton with an ankle and a foot means the ball of the foot by the latter.
        let ball = foot.and_then(|foot| self.all(Part::Foot, foot).into_iter().find(|&joint| joint != foot));
        let toes = foot.and_then(|foot| find(Part::Toes, Some(foot))).or(ball);
        Ok(Leg { upper, lower, foot, toes })
    }

    fn arm(&self, side: Side) -> Option<Arm> {
        let find = |part, above| self.first(part, Some(side), above);
        let upper = find(Part::UpperArm, None)?;
        let lower = find(Part::LowerArm, Some(upper))?;
        let clavicle = find(Part::Clavicle, None).filter(|&clavicle| self.hangs_on(upper, clavicle));
        Some(Arm { clavicle, upper, lower, hand: find(Part::Hand, Some(lower)) })
    }

    /// The joint that both legs hang on: the one named so, or the last that they share.
    fn hips(&self, legs: [Leg; 2]) -> Option<usize> {
        let [left, right] = legs.map(|leg| leg.upper);
        let shared = |joint: usize| self.hangs_on(left, joint) && self.hangs_on(right, joint);
        let named =
            self.said.iter().enumerate().filter(|(_, said)| said.is_some_and(|said| said.part == Part::Hips));
        let named = named.map(|(joint, _)| joint).find(|&joint| shared(joint));
        named.or_else(|| {
            (0..self.said.len()).rev().find(|&joint| joint != left && joint != right && shared(joint))
        })
    }

    /// The first joint of a part, below another where that is given; parents stand before children, so it is the nearest to
    /// the root.
    fn first(&self, part: Part, side: Option<Side>, above: Option<usize>) -> Option<usize> {
        let fits = |said: &Option<Said>| said.is_some_and(|said| said.part == part && said.side == side);
        let below = |joint: usize| above.is_none_or(|above| self.hangs_on(joint, above));
        (self.said.iter().enumerate())
            .find(|(joint, said)| fits(said) && below(*joint))
            .map(|(joint, _)| joint)
    }

    /// All joints of a part below another, in order, on whatever side.
    fn all(&self, part: Part, above: usize) -> Vec<usize> {
        let fits = |said: &Option<Said>| said.is_some_and(|said| said.part == part);
        let found =
            self.said.iter().enumerate().filter(|(joint, said)| fits(said) && self.hangs_on(*joint, above));
        found.map(|(joint, _)| joint).collect()
    }

    /// Whether a joint hangs on another, at whatever distance, or is it.
    fn hangs_on(&self, joint: usize, above: usize) -> bool {
        let parent = |joint: &usize| self.skeleton.joints().get(*joint).and_then(|joint| joint.parent);
        std::iter::successors(Some(joint), parent).any(|own| own == above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;
    use glam::Vec3;

    /// A skeleton of names with the index of each parent.
    fn skeleton(joints: &[(&str, Option<usize>)]) -> Skeleton {
        Skeleton::new(joints.iter().map(|&(name, parent)| Joint::new(name, parent, Vec3::Y)).collect())
            .unwrap()
    }

    #[test]
    fn shoulders_and_legs_mean_what_the_rest_of_the_names_leave() {
        // As motion builders name them: shoulder is a collar bone, leg a shin.
        let one = skeleton(&[
            ("Hips", None),
            ("LeftUpLeg", Some(0)),
            ("LeftLeg", Some(1)),
            ("LeftFoot", Some(2)),
            ("RightUpLeg", Some(0)),
            ("RightLeg", Some(4)),
            ("Spine", Some(0)),
            ("LeftShoulder", Some(6)),
            ("LeftArm", Some(7)),
            ("LeftForeArm", Some(8)),
        ]);
        let body = Humanoid::find(&one).unwrap();
        assert_eq!(body.arms[0], Some(Arm { clavicle: Some(7), upper: 8, lower: 9, hand: None }));
        assert_eq!(body.legs[0], Leg { upper: 1, lower: 2, foot: Some(3), toes: None });
        assert_eq!((body.spine.as_slice(), body.arms[1]), (&[6][..], None));
        // As the SMPL body has them: hip, knee, ankle, foot; shoulder, elbow.
        let other = skeleton(&[
            ("pelvis", None),
            ("left_hip", Some(0)),
            ("right_hip", Some(0)),
            ("left_knee", Some(1)),
            ("right_knee", Some(2)),
            ("left_ankle", Some(3)),
            ("left_foot", Some(5)),
            ("left_shoulder", Some(0)),
            ("left_elbow", Some(7)),
            ("left_wrist", Some(8)),
        ]);
        let body = Humanoid::find(&other).unwrap();
        assert_eq!(body.legs[0], Leg { upper: 1, lower: 3, foot: Some(5), toes: Some(6) });
        assert_eq!(body.arms[0], Some(Arm { clavicle: None, upper: 7, lower: 8, hand: Some(9) }));
    }

    #[test]
    fn what_is_missing_is_named() {
        let error = Humanoid::find(&skeleton(&[("Hips", None), ("LeftUpLeg", Some(0))])).unwrap_err();
        assert_eq!(error.to_string(), "no joint was found that is the LowerLeg (Left)");
    }

    #[test]
    fn hips_need_no_name() {
        let joints = [
            ("body", None),
            ("l_thigh", Some(0)),
            ("l_calf", Some(1)),
            ("r_thigh", Some(0)),
            ("r_calf", Some(3)),
        ];
        assert_eq!(Humanoid::find(&skeleton(&joints)).unwrap().hips, 0);
    }
}
