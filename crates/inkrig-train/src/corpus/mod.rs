//! The corpus: motion of anybody in the form that the networks see.
//!
//! [`Config`] names folders of motion files. [`build`] reads every file, finds the body of each clip, gives it the
//! proportions of one body and writes its 263 numbers a frame and those of its mirror image to one part a file, with
//! words, split and licence. A part that is there already and still true is kept, so that a stopped run goes on.
//! `manifest.jsonl` lists all clips, `rejected.jsonl` those that were left out and why, `statistics.json` holds means and
//! deviations of the training split, `report.html` shows it all.

mod build;
mod captions;
mod check;
mod clip;
mod config;
mod files;
mod humanml_folder;
mod index;
mod manifest;
mod part;
mod place;
mod poses;
mod report;
mod statistics;
mod table;
mod toml_text;
mod walk;

pub use build::{Built, Progress, Shard, build, finish};
pub use check::Rejected;
pub use clip::{Prepared, prepare};
pub use config::{Config, Source, SourceFormat, Split, TextFrom, Up};
pub use manifest::{Entry, Manifest, RejectedEntry};
pub use part::{Part, PartClip};
pub use poses::key_pose_frames;
pub use statistics::CorpusStatistics;

pub(crate) use build::write;
pub(crate) use config::read_text;
pub(crate) use toml_text::{parse_toml, toml_error};
