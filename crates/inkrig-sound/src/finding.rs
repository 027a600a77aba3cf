//! What there is to say about a sound that was read all the same.

use std::fmt;

/// Something to know about a file that was read nevertheless, such as that its end is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// A short stable name for tests and filters: `sound-cut-short`, `sound-packets-lost`, `sound-bad-samples`,
    /// `sound-checksum`, `sound-extension`, `sound-chained`, `sound-silent`.
    pub code: &'static str,
    /// One sentence for people.
    pub message: String,
}

impl Finding {
    pub(crate) fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] {}", self.code, self.message)
    }
}
