//! What a person is said to do, in words, and the vectors that the networks take for them: a table of action verbs that is part of a
//! model, or a text encoder from files that the user has.

mod bpe;
mod clip;
mod encoder;
mod layers;
mod lexicon;
mod t5;
mod unigram;
mod verbs;

pub use clip::ClipEncoder;
pub use encoder::{TextEncoder, VerbTable};
pub use lexicon::{actions_in, mirrored, nearest_verbs};
pub use t5::T5Encoder;
pub use verbs::{VERBS, Verb};

#[cfg(test)]
mod tests;
