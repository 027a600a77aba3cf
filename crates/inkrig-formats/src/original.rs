//! A file kept as it was, so that a result can be put into it.

use std::{fmt, sync::Arc};

/// The bytes of a file that a clip can be put into; copies share them.
#[derive(Clone, PartialEq, Eq)]
pub struct Original(Arc<[u8]>);

impl Original {
    /// Keeps a whole file.
    pub fn new(bytes: impl Into<Arc<[u8]>>) -> Self {
        Self(bytes.into())
    }

    /// The file.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

impl fmt::Debug for Original {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Original({} bytes)", self.0.len())
    }
}
