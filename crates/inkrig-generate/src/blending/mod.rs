//! Clips become one animation: placed end to end, joined, and made natural where they meet.

mod double_take;
mod inversion;
mod joining;
mod origin;
mod squad;

pub use double_take::{DoubleTakeOptions, double_take};
pub use inversion::{BlendOptions, Blended, blend};
pub use joining::{linear, placed_after};
pub use squad::squad;
