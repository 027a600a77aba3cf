//! What the program says when it cannot go on.

use crate::output::OutputError;
use crate::sheet::SheetError;
use inkrig_align::AlignError;
use inkrig_formats::FormatError;
use inkrig_motion::MotionError;
use inkrig_sketch::SketchError;
use miette::Diagnostic;
use std::path::PathBuf;

/// An error with the file that it is about.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CliError {
    /// A file could not be opened or read.
    #[error("{path} could not be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is larger than anything that is read.
    #[error("{path} is larger than {most} bytes, the most that is read")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        most: usize,
    },
    /// The name does not say what is inside.
    #[error("{path}: what kind of file this is cannot be told from its name")]
    #[diagnostic(help("{known}"))]
    Kind {
        /// The file.
        path: PathBuf,
        /// The endings that are known.
        known: &'static str,
    },
    /// A motion file that cannot be understood.
    #[error("{path}: {source}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Where and what.
        source: Box<FormatError>,
    },
    /// A clip that cannot be used as asked.
    #[error("{path}: {source}")]
    Clip {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MotionError,
    },
    /// A drawing that cannot be understood.
    #[error("{path}: {source}")]
    Curve {
        /// The file.
        path: PathBuf,
        /// Where and what.
        source: SketchError,
    },
    /// Two results would go to one file, or a result over an input.
    #[error("{0} is named twice: every input and result needs a name of its own")]
    SameFile(PathBuf),
    /// The engine could not align.
    #[error(transparent)]
    Align(#[from] AlignError),
    /// A clip could not be cut or resampled.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The contact sheet could not be made.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// A result could not be put in its file format.
    #[error("the result could not be written: {0}")]
    Export(Box<FormatError>),
    /// Text could not be turned into JSON.
    #[error("the report could not be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl From<FormatError> for CliError {
    /// An error of writing; errors of reading carry their file's path.
    fn from(error: FormatError) -> Self {
        Self::Export(Box::new(error))
    }
}

impl CliError {
    /// The process's exit code: 130 when the user stopped it (as shells expect), else 1. Wrong usage is 2, by clap.
    pub fn exit_code(&self) -> u8 {
        if matches!(self, Self::Align(AlignError::Cancelled)) { 130 } else { 1 }
    }
}
