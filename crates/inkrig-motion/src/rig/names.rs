//! What the names of a skeleton's joints say, all of them together.

use super::role::{Ambiguous, Said, said_by, twist_of};
use super::words::{Words, shared_prefix, tokens, words};
use super::{Part, Side};
use crate::Skeleton;

/// What the joints' names say, and how the joints hang together.
#[derive(Debug, Clone)]
pub(super) struct Names<'s> {
    skeleton: &'s Skeleton,
    /// The words of every joint.
    pub(super) words: Vec<Words>,
    said: Vec<Option<Said>>,
}

impl<'s> Names<'s> {
    pub(super) fn of(skeleton: &'s Skeleton) -> Self {
        let joints = skeleton.joints();
        let mut all: Vec<Vec<String>> = joints.iter().map(|joint| tokens(&joint.name)).collect();
        let prefix = shared_prefix(&all);
        for own in &mut all {
            own.drain(..prefix.min(own.len().saturating_sub(1)));
        }
        // A rig that says which joints deform the mesh has controls of the same names beside them.
        let deforms = |name: &str| name.starts_with("DEF-") || name.starts_with("DEF_");
        let only = joints.iter().filter(|joint| deforms(&joint.name)).count() >= 8;
        let words: Vec<Words> = all.into_iter().map(words).collect();
        let mut said: Vec<Option<Said>> = (joints.iter().zip(&words))
            .map(|(joint, words)| {
                let none = joint.end_site || (only && !deforms(&joint.name));
                if none { None } else { said_by(words) }
            })
            .collect();
        let has =
            |part: Part| said.iter().flatten().any(|said| said.part == part && said.ambiguous.is_none());
        let (upper_arm, upper_leg) = (has(Part::UpperArm), has(Part::UpperLeg));
        for slot in &mut said {
            let Some(own) = slot else { continue };
            match own.ambiguous {
                Some(Ambiguous::Shoulder) if !upper_arm => own.part = Part::UpperArm,
                Some(Ambiguous::Leg) if !upper_leg => own.part = Part::UpperLeg,
                Some(Ambiguous::HipJoint) if upper_leg => *slot = None,
                _ => {}
            }
        }
        Self { skeleton, words, said }
    }

    /// What a joint is said to be.
    pub(super) fn part(&self, joint: usize) -> Option<Part> {
        self.said.get(joint).copied().flatten().map(|said| said.part)
    }

    /// The side that a joint's name says.
    pub(super) fn side(&self, joint: usize) -> Option<Side> {
        let words = self.words.get(joint)?;
        words.side.or_else(|| self.said.get(joint).copied().flatten()?.side)
    }

    /// The limb whose twist a joint is said to share.
    pub(super) fn twist(&self, joint: usize) -> Option<(Part, Side)> {
        twist_of(self.words.get(joint)?)
    }

    /// Whether a joint is named as a control, a target or the like; tips of chains are none.
    pub(super) fn is_helper(&self, joint: usize) -> bool {
        self.words.get(joint).is_some_and(|words| words.helper && !words.tip)
    }

    /// All joints said to be a part, in order.
    pub(super) fn joints(&self, part: Part) -> impl Iterator<Item = usize> + '_ {
        let fits = move |said: &Option<Said>| said.is_some_and(|said| said.part == part);
        self.said.iter().enumerate().filter(move |(_, said)| fits(said)).map(|(joint, _)| joint)
    }

    /// The first joint of a part, below another where that is given; parents stand before children, so it is the nearest to
    /// the root.
    pub(super) fn first(&self, part: Part, side: Option<Side>, above: Option<usize>) -> Option<usize> {
        let sided =
            |joint: &usize| self.said.get(*joint).copied().flatten().is_some_and(|said| said.side == side);
        let below = |joint: &usize| above.is_none_or(|above| self.hangs_on(*joint, above));
        self.joints(part).find(|joint| sided(joint) && below(joint))
    }

    /// All joints of a part below another, in order, on whatever side.
    pub(super) fn all(&self, part: Part, above: usize) -> Vec<usize> {
        self.joints(part).filter(|&joint| self.hangs_on(joint, above)).collect()
    }

    /// Whether a joint hangs on another, at whatever distance, or is it.
    pub(super) fn hangs_on(&self, joint: usize, above: usize) -> bool {
        self.upwards(joint).any(|own| own == above)
    }

    /// A joint and all that it hangs on, up to its root.
    pub(super) fn upwards(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        let parent = |joint: &usize| self.skeleton.joints().get(*joint).and_then(|joint| joint.parent);
        std::iter::successors(Some(joint), parent)
    }
}

/// Joints that share the twist of a limb's bone, as their names say: the joint, the part that it belongs to, its side.
pub fn twist_joints(skeleton: &Skeleton) -> Vec<(usize, Part, Side)> {
    let names = Names::of(skeleton);
    let limb = |joint: usize| names.twist(joint).map(|(part, side)| (joint, part, side));
    (0..skeleton.len()).filter_map(limb).collect()
}
