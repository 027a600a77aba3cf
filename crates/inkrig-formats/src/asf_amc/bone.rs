//! A bone as the skeleton file says it, and its place in the tree.

use super::angles::Order;
use inkrig_motion::glam::{DQuat, DVec3};

/// One degree of freedom: what one number of a motion row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dof {
    /// Rotation about an axis (0, 1, 2) of the bone's own frame.
    Rotation(usize),
    /// Translation along an axis; used at the root only.
    Translation(usize),
    /// A change of length: has no place in a skeleton of fixed bones.
    Length,
}

impl Dof {
    /// The degree of freedom of a word such as `rx` or `TZ`.
    pub(super) fn of(word: &[u8]) -> Option<Self> {
        let axis = |byte: u8| match byte.to_ascii_lowercase() {
            b'x' => Some(0),
            b'y' => Some(1),
            b'z' => Some(2),
            _ => None,
        };
        match word {
            [b'r' | b'R', end] => axis(*end).map(Self::Rotation),
            [b't' | b'T', end] => axis(*end).map(Self::Translation),
            [b'l' | b'L'] => Some(Self::Length),
            _ => None,
        }
    }
}

/// The root's own place in the rest pose, and what its row holds.
#[derive(Debug, Clone)]
pub(super) struct Root {
    /// In the file's units and axes.
    pub(super) position: DVec3,
    /// Its frame in the rest pose.
    pub(super) frame: DQuat,
    /// How its angles follow each other.
    pub(super) order: Order,
    /// What its row holds, in order.
    pub(super) dofs: Vec<Dof>,
}

/// A bone of the tree.
#[derive(Debug, Clone)]
pub(super) struct Bone {
    pub(super) name: String,
    /// Unit vector in the world of the rest pose; zero for a bone without length.
    pub(super) direction: DVec3,
    /// In the file's units.
    pub(super) length: f64,
    /// Its own frame in the world of the rest pose.
    pub(super) frame: DQuat,
    /// How its angles follow each other.
    pub(super) order: Order,
    /// What its row holds, in order; empty for a bone that does not move.
    pub(super) dofs: Vec<Dof>,
    /// The bone at whose end it begins; `None` at the root.
    pub(super) parent: Option<usize>,
    /// Joint of the skeleton at its beginning, and that of its parent.
    pub(super) joint: usize,
    pub(super) parent_joint: usize,
}

impl Bone {
    /// From its beginning to its end in the rest pose, in the file's units.
    pub(super) fn reach(&self) -> DVec3 {
        self.direction * self.length
    }
}
