//! Root motion and ground paths on characters of every build.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "ground/build.rs"]
mod build;
#[path = "ground/loops.rs"]
mod loops;
#[path = "ground/paths.rs"]
mod paths;
#[path = "ground/root_bones.rs"]
mod root_bones;
