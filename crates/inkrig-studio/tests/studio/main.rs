//! The real server on a real port: what it does, and what it refuses.

mod client;
mod crowd;
mod drawing;
mod files;
mod lan;
mod strangers;
