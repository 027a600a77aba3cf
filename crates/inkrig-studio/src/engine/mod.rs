//! From a document to motions: what is loaded, what is asked of the engine, and the thread on which it works.

pub mod command_line;
pub(crate) mod drawings;
pub mod gauges;
mod keys;
pub mod media;
mod over_ground;
pub mod plan;
pub mod poses;
mod prepare;
pub mod results;
pub mod solver;
mod source_map;
pub mod suggest;
pub mod take_home;

pub use keys::Waiting;
pub(crate) use over_ground::over_ground;
pub(crate) use prepare::clip;
pub use prepare::{Prepared, SourceKey, Wishes};
pub use source_map::SourceMap;
