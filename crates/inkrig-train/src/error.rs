//! What can go wrong.

use std::path::PathBuf;

/// Why a corpus was not built.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// The system said no.
    #[error("{}: {cause}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said. Not a `source`: it stands in the text already.
        cause: std::io::Error,
    },
    /// A configuration, an index or a part is not what it should be.
    #[error("{}: {what}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// No clip was usable.
    #[error("no clip of the corpus can be used: see the reasons in {}", report.display())]
    Nothing {
        /// The page that has them.
        report: PathBuf,
    },
    /// The caller said stop.
    #[error("stopped; what is done stays, and the same command goes on from there")]
    Stopped,
    /// A network, or the device that it runs on, says no.
    #[error("{0}")]
    Device(String),
    /// Training ran off.
    #[error(
        "the loss is no number at step {step}; the last checkpoint is good: give a smaller rate, or a larger warm_up"
    )]
    Diverged {
        /// The step.
        step: u64,
    },
    /// No threads to work with.
    #[error("no threads could be started: {0}")]
    Threads(String),
    /// A share of the work that is none.
    #[error("shard {index}/{count}: give a number from 1 to the count of shards, such as 1/4")]
    Shard {
        /// Which, from 1.
        index: usize,
        /// Of how many.
        count: usize,
    },
}

impl From<inkrig_generate::GenerateError> for TrainError {
    fn from(error: inkrig_generate::GenerateError) -> Self {
        Self::Device(error.to_string())
    }
}

impl From<inkrig_motion::MotionError> for TrainError {
    fn from(error: inkrig_motion::MotionError) -> Self {
        Self::Device(error.to_string())
    }
}
