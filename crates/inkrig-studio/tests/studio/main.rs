//! The real server on a real port: what it does, and what it refuses.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::needless_pass_by_value,
    reason = "a test may panic, and prints"
)]

mod client;
mod crowd;
mod drawing;
mod files;
mod lan;
mod storyboard;
mod strangers;
mod wishes;
