//! Which joint of a skeleton is which part of a body, by its name and its place in the tree.

mod body;
mod controls;
mod humanoid;
mod names;
mod quadruped;
mod role;
mod topology;
mod tree;
mod trunk;
mod words;

pub use body::{Body, NoBody};
pub use controls::controls;
pub use humanoid::{Arm, Humanoid, Leg};
pub use names::twist_joints;
pub use quadruped::{Quadruped, QuadrupedLeg};
pub use role::{Part, Side};
