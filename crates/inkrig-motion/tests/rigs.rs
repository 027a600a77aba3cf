//! Bodies are found in the skeletons of common programs, and in skeletons whose names say nothing.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic")]

#[path = "rigs/build.rs"]
mod build;
#[path = "rigs/conventions.rs"]
mod conventions;
#[path = "rigs/nameless.rs"]
mod nameless;
