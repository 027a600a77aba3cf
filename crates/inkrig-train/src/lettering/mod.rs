//! Words as people write them, made of fonts: what the reader of words learns from.

mod fonts;
mod write;

pub use fonts::{Font, read_fonts};
pub use write::{Case, write_word};

#[cfg(test)]
mod tests;
