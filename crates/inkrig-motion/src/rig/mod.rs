//! Which joint of a skeleton is which part of a body, by its name and its place in the tree.

mod humanoid;
mod role;
mod words;

pub use humanoid::{Arm, Humanoid, Leg, Missing};
pub use role::{Part, Side};
