//! The solvers against reference vectors, against each other, and their promises: determinism, no allocation, no NaN.

// Helpers stand outside of test functions; a test may stop at an error, and says what it measured.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod fixture;
mod limits;
mod low_rank;
mod promises;
mod quality;
mod sparse;
mod vectors;
