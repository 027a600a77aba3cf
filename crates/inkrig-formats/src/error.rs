//! What can go wrong between a file and a clip.

use crate::Place;
use inkrig_motion::MotionError;

/// Why a file could not be read or a clip not be written. Printed, it says where, what, and what to do; the parts
/// are at hand one by one for a program that lays them out itself.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file is not as the format wants it.
    #[error("{place}: {what}; {hint}")]
    Read {
        /// A short stable name, such as `bvh-number`.
        code: &'static str,
        /// Where in the file.
        place: Place,
        /// What was found, and what was expected.
        what: String,
        /// What to do.
        hint: String,
    },
    /// A part of a file that is no text, or whose parts have names, is not as the format wants it.
    #[error("{part}: {what}; {hint}")]
    Part {
        /// A short stable name, such as `gltf-accessor`.
        code: &'static str,
        /// Which part, such as ``node 3 `Hips` ``.
        part: String,
        /// What was found, and what was expected.
        what: String,
        /// What to do.
        hint: String,
    },
    /// The file asks for more than [`Limits`](crate::Limits) allow.
    #[error("{}{what}, more than the limit of {limit}; {hint}", before(.place.as_ref()))]
    Limit {
        /// What there is too much of, with its number.
        what: String,
        /// The largest number that is allowed.
        limit: usize,
        /// Where it went over, when that is one place.
        place: Option<Place>,
        /// What to do.
        hint: String,
    },
    /// An import or export option has a value that cannot be used.
    #[error("{what}; {hint}")]
    Options {
        /// Which option, and its value.
        what: String,
        /// What to do.
        hint: String,
    },
    /// The format cannot hold the clip.
    #[error("{what}; {hint}")]
    Write {
        /// What cannot be written, with joint and frame.
        what: String,
        /// What to do.
        hint: String,
    },
    /// The parts that were read do not make a motion.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

impl FormatError {
    /// A short stable name.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Read { code, .. } | Self::Part { code, .. } => code,
            Self::Limit { .. } => "limit",
            Self::Options { .. } => "options",
            Self::Write { .. } => "write",
            Self::Motion(_) => "motion",
        }
    }

    /// Where in the file, when that is known.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Read { place, .. } => Some(place),
            Self::Limit { place, .. } => place.as_ref(),
            Self::Part { .. } | Self::Options { .. } | Self::Write { .. } | Self::Motion(_) => None,
        }
    }

    /// The same, said of one of several files that make a motion.
    pub(crate) fn in_file(mut self, file: &str) -> Self {
        if let Self::Read { what, .. } | Self::Limit { what, .. } = &mut self {
            *what = format!("{what} (in the {file} file)");
        }
        self
    }

    /// What is wrong, without where and what to do.
    pub fn what(&self) -> String {
        match self {
            Self::Read { what, .. } | Self::Options { what, .. } | Self::Write { what, .. } => what.clone(),
            Self::Part { part, what, .. } => format!("{part}: {what}"),
            Self::Limit { what, limit, .. } => format!("{what}, more than the limit of {limit}"),
            Self::Motion(error) => error.to_string(),
        }
    }

    /// What to do; empty when [`Self::what`] says it already.
    pub fn hint(&self) -> &str {
        match self {
            Self::Read { hint, .. } | Self::Limit { hint, .. } => hint,
            Self::Options { hint, .. } | Self::Write { hint, .. } | Self::Part { hint, .. } => hint,
            Self::Motion(_) => "",
        }
    }
}

fn before(place: Option<&Place>) -> String {
    place.map_or_else(String::new, |place| format!("{place}: "))
}
