//! Why the studio cannot do what it was asked.

use inkrig_align::AlignError;
use inkrig_formats::FormatError;
use inkrig_motion::MotionError;
use inkrig_motion::retarget::RetargetError;
use inkrig_sketch::SketchError;
use inkrig_sound::SoundError;
use std::path::PathBuf;

/// What stood in the way, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudioError {
    /// An id that refers to nothing.
    #[error("there is no {kind} `{id}`: load the project again")]
    Unknown {
        /// What it should be.
        kind: &'static str,
        /// The id.
        id: String,
    },
    /// More than a project holds.
    #[error("{count} {what} are too many: {most} at most")]
    TooMuch {
        /// What there is too much of.
        what: &'static str,
        /// How much.
        count: usize,
        /// The limit.
        most: usize,
    },
    /// A request that makes no sense.
    #[error("{what}")]
    Invalid {
        /// Why.
        what: String,
    },
    /// The history has no step in this direction.
    #[error("there is nothing to {0}")]
    NoStep(&'static str),
    /// Nothing is arranged yet.
    #[error("no clip is chosen: drop a motion on the page, or take a sample")]
    NoSource,
    /// Nothing is followed yet.
    #[error("there is nothing to follow: draw something")]
    NoControl,
    /// A file whose kind is not known.
    #[error("`{name}`: what kind of file this is cannot be told from its name; {known}")]
    Kind {
        /// The name.
        name: String,
        /// What is known.
        known: &'static str,
    },
    /// A motion file that cannot be read.
    #[error("`{name}`: {cause}")]
    Clip {
        /// The name.
        name: String,
        /// Where and what.
        cause: Box<FormatError>,
    },
    /// The folder of a project cannot be used.
    #[error("the project `{}`: {what}", path.display())]
    Folder {
        /// The folder or a file in it.
        path: PathBuf,
        /// Why.
        what: String,
    },
    /// A file of a project cannot be read or written.
    #[error("`{}`: {cause}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The server cannot listen.
    #[error("port {port} cannot be opened: {cause}; give another --port, or 0 for any that is free")]
    Listen {
        /// The port.
        port: u16,
        /// What the system says.
        cause: std::io::Error,
    },
    /// From the engine.
    #[error(transparent)]
    Align(#[from] AlignError),
    /// From the motion core.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// From writing a file.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// From a drawing.
    #[error(transparent)]
    Sketch(#[from] SketchError),
    /// From a sound.
    #[error(transparent)]
    Sound(#[from] SoundError),
    /// From retargeting.
    #[error(transparent)]
    Retarget(#[from] RetargetError),
    /// Something went wrong that should not.
    #[error("the studio itself failed: {0}")]
    Internal(String),
}

impl StudioError {
    pub(crate) fn unknown(kind: &'static str, id: &str) -> Self {
        Self::Unknown { kind, id: id.chars().take(80).collect() }
    }

    pub(crate) fn invalid(what: impl Into<String>) -> Self {
        Self::Invalid { what: what.into() }
    }
}
