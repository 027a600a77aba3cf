//! What a person is said to do, in words.

mod lexicon;
mod verbs;

pub use lexicon::{actions_in, mirrored, nearest_verbs};
pub use verbs::{VERBS, Verb};
