//! Why a file of weights could not be read or written.

use crate::GenerateError;

/// What stood in the way, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The system said no.
    #[error("the file could not be read or written: {cause}")]
    Io {
        /// What it said. Not a `source`: it stands in the text already.
        cause: std::io::Error,
    },
    /// The file ends, or is laid out, as no whole file of its kind is.
    #[error("{what}: the file is damaged or was cut off; get it again")]
    Damaged {
        /// Where, and what is wrong there.
        what: String,
    },
    /// A file of another kind, or of a kind that is not read.
    #[error("{what}; {todo}")]
    Unsupported {
        /// What it is.
        what: String,
        /// What to do instead.
        todo: &'static str,
    },
    /// The pickle names code that a file of weights does not need.
    #[error(
        "the file asks for {name} (byte {at} of its pickle), which weights do not need: nothing of it was run, and it is not read. Where you trust its maker, load it in PyTorch and save its state_dict alone"
    )]
    Refused {
        /// Module and name.
        name: String,
        /// Where in the pickle.
        at: usize,
    },
    /// The pickle does something that no file of weights does.
    #[error("byte {at} of the pickle: {what}")]
    Pickle {
        /// Where in the pickle.
        at: usize,
        /// What is wrong.
        what: String,
    },
    /// One name for two things.
    #[error("{what} {name} is there twice: the file says two things at once and is not read")]
    Twice {
        /// What it names.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// More than a model of this kind can have.
    #[error("{what}: {got}, more than the {most} that are read")]
    TooMuch {
        /// What there is too much of.
        what: String,
        /// How much.
        got: u64,
        /// The limit.
        most: u64,
    },
    /// A tensor that cannot be read as it is described.
    #[error("the tensor {name}: {what}")]
    Tensor {
        /// Its name.
        name: String,
        /// What is wrong.
        what: String,
    },
    /// A header that cannot be understood.
    #[error("the header: {what}")]
    Header {
        /// Where and what.
        what: String,
    },
    /// A NumPy file that cannot be used.
    #[error("{name}: {what}")]
    Npy {
        /// Which of the files.
        name: String,
        /// What is wrong.
        what: String,
    },
    /// Tensors are there that belong to no model that is known.
    #[error("this is no model that inkrig knows: {what}")]
    Unknown {
        /// What is missing or strange.
        what: String,
    },
    /// The model lacks something without which no motion can be made.
    #[error("the model cannot be used yet: {what}")]
    Incomplete {
        /// What is missing, and how to give it.
        what: String,
    },
    /// The networks cannot be built of it.
    #[error(transparent)]
    Generate(#[from] GenerateError),
}

impl From<std::io::Error> for CheckpointError {
    fn from(cause: std::io::Error) -> Self {
        Self::Io { cause }
    }
}

impl CheckpointError {
    pub(super) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged { what: what.into() }
    }

    pub(crate) fn tensor(name: &str, what: impl Into<String>) -> Self {
        Self::Tensor { name: shown(name), what: what.into() }
    }
}

/// The beginning of a name that came from a file: a message is no place for a megabyte.
pub(super) fn shown(name: &str) -> String {
    const MOST: usize = 120;
    match name.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &name[..end]),
        None => name.to_owned(),
    }
}
