//! The storyboards of this project, from file to motion, with the weights that come with the program; and drawings that cannot
//! be made a motion, each with what is said of it.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may panic, and prints what it measures"
)]

mod constraints;
mod edits;
mod examples;
mod motions;
mod onto;
mod pages;
mod paths;
mod support;
mod understanding;
