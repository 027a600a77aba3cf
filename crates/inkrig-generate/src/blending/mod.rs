//! Clips become one animation: placed end to end, joined, and made natural where they meet.

mod joining;

pub use joining::{linear, placed_after};
