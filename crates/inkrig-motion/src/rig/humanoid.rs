//! A two-legged body found in a skeleton.

use super::names::Names;
use super::tree::Tree;
use super::trunk::Trunk;
use super::{NoBody, Part, Side, quadruped, topology};
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

impl Humanoid {
    /// Finds the body by the joints' names, checked against the tree: limbs hang on each other in order, and of two
    /// joints with the same meaning the one nearer to the root counts. Where names say nothing, by its build: two pairs
    /// of limbs that are mirror images, the lower ones legs, in a rest pose that stands upright.
    ///
    /// # Errors
    /// When hips, a thigh or a shin is missing, or the figure stands on four legs: [`Body::find`](super::Body::find)
    /// finds those too.
    pub fn find(skeleton: &Skeleton) -> Result<Self, NoBody> {
        let names = Names::of(skeleton);
        let tree = Tree::of(skeleton, &names);
        if quadruped::standing_limbs(&tree, &names).is_some() {
            return Err(NoBody::FourLegs);
        }
        Self::in_tree(&tree, &names)
    }

    /// The same for a skeleton that does not stand on four legs.
    pub(super) fn in_tree(tree: &Tree, names: &Names<'_>) -> Result<Self, NoBody> {
        let named = Self::by_names(tree, names);
        match named {
            Ok(body) if body.arms.iter().any(Option::is_some) => Ok(body),
            Ok(body) => {
                let built = topology::find(tree, names).filter(|built| built.legs == body.legs);
                match built {
                    Some(built) => Ok(built),
                    // A bird has legs like ours, and lies on them.
                    None if body.lies(tree) => {
                        Err(NoBody::Missing { part: Part::UpperArm, side: Some(Side::Left) })
                    }
                    None => Ok(body),
                }
            }
            Err(missing) => topology::find(tree, names).ok_or(missing),
        }
    }

    fn by_names(tree: &Tree, names: &Names<'_>) -> Result<Self, NoBody> {
        let [left, right] = Side::BOTH.map(|side| leg(names, side));
        let legs = [left?, right?];
        let hips = hips(names, legs).ok_or(NoBody::Missing { part: Part::Hips, side: None })?;
        let arms = Side::BOTH.map(|side| arm(names, side));
        let named_head = names.first(Part::Head, None, Some(hips));
        let head = named_head.or_else(|| names.all(Part::Neck, hips).last().copied());
        let trunk = Trunk::of(tree, names, hips, arms, head);
        Ok(Self { hips, spine: trunk.spine, neck: trunk.neck, head: trunk.head, arms, legs })
    }

    /// Whether the trunk lies in the rest pose rather than stands.
    fn lies(&self, tree: &Tree) -> bool {
        let Some(top) = self.head.or(self.neck.last().copied()).or(self.spine.last().copied()) else {
            return false;
        };
        let hips = 0.5 * (tree.rest[self.legs[0].upper] + tree.rest[self.legs[1].upper]);
        let trunk = tree.rest[top] - hips;
        trunk.y.abs() < 0.5 * trunk.length()
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

fn leg(names: &Names<'_>, side: Side) -> Result<Leg, NoBody> {
    let missing = |part| NoBody::Missing { part, side: Some(side) };
    let find = |part, above| names.first(part, Some(side), above);
    let upper = find(Part::UpperLeg, None).ok_or_else(|| missing(Part::UpperLeg))?;
    let lower = find(Part::LowerLeg, Some(upper)).ok_or_else(|| missing(Part::LowerLeg))?;
    let foot = find(Part::Foot, Some(lower));
    // A skeleton with an ankle and a foot means the ball of the foot by the latter.
    let ball = foot.and_then(|foot| names.all(Part::Foot, foot).into_iter().find(|&joint| joint != foot));
    let toes = foot.and_then(|foot| find(Part::Toes, Some(foot))).or(ball);
    Ok(Leg { upper, lower, foot, toes })
}

fn arm(names: &Names<'_>, side: Side) -> Option<Arm> {
    let find = |part, above| names.first(part, Some(side), above);
    let upper = find(Part::UpperArm, None)?;
    let lower = find(Part::LowerArm, Some(upper))?;
    let clavicle = find(Part::Clavicle, None).filter(|&clavicle| names.hangs_on(upper, clavicle));
    Some(Arm { clavicle, upper, lower, hand: find(Part::Hand, Some(lower)) })
}

/// The joint that both legs hang on: the one named so, or the last that they share.
fn hips(names: &Names<'_>, legs: [Leg; 2]) -> Option<usize> {
    let [left, right] = legs.map(|leg| leg.upper);
    let shared = |joint: usize| names.hangs_on(left, joint) && names.hangs_on(right, joint);
    let named = names.joints(Part::Hips).find(|&joint| shared(joint));
    named.or_else(|| {
        (0..names.words.len()).rev().find(|&joint| joint != left && joint != right && shared(joint))
    })
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
