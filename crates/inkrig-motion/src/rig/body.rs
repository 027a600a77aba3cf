//! Who a skeleton is: a person, or an animal on four legs.

use super::names::Names;
use super::tree::Tree;
use super::{Humanoid, Part, Quadruped, Side};
use crate::Skeleton;

/// A body found in a skeleton.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Body {
    /// On two legs, upright.
    Humanoid(Humanoid),
    /// On four legs.
    Quadruped(Quadruped),
}

/// Why a skeleton is not the body that was looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoBody {
    /// A part is missing.
    #[error("no joint was found that is the {part:?}{}", side.map_or_else(String::new, |side| format!(" ({side:?})")))]
    Missing {
        /// The first part that was not found.
        part: Part,
        /// Its side, for parts that come in pairs.
        side: Option<Side>,
    },
    /// A person was looked for, and it stands on four legs.
    #[error("it stands on four legs")]
    FourLegs,
    /// Four legs were looked for.
    #[error("no two pairs of legs were found that stand on the ground in the rest pose")]
    NotFourLegs,
}

impl Body {
    /// Finds the body: four limbs that stand on the ground beside each other under a lying trunk in the rest pose are
    /// legs, whatever their names; else it is a person by names or by build.
    ///
    /// # Errors
    /// When it is neither; the error says what is missing to a person.
    pub fn find(skeleton: &Skeleton) -> Result<Self, NoBody> {
        let names = Names::of(skeleton);
        let tree = Tree::of(skeleton, &names);
        match Quadruped::in_tree(&tree, &names, skeleton) {
            Some(found) => Ok(Self::Quadruped(found)),
            None => Humanoid::in_tree(&tree, &names).map(Self::Humanoid),
        }
    }

    /// Where the legs meet the trunk: the joint that carries the figure.
    pub fn hips(&self) -> usize {
        match self {
            Self::Humanoid(body) => body.hips,
            Self::Quadruped(body) => body.hips,
        }
    }
}
