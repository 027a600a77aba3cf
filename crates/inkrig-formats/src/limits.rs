//! How much a file may ask for.

use crate::FormatError;

/// Upper bounds of a reader, checked before anything is allocated. The defaults let every real file through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file. Default: 512 MiB.
    pub bytes: usize,
    /// Joints, end sites included. Nested joints count like others: no reader recurses. Default: 16384.
    pub joints: usize,
    /// Length of one joint's name, bytes. Default: 256.
    pub name_bytes: usize,
    /// Frames times joints, 16 bytes each in memory. Default: 128 Mi, which is 2 GiB. Whatever is set here, a file
    /// gets no more than [`Self::FREE_CELLS`] and one for each of its bytes.
    pub cells: usize,
}

impl Limits {
    /// Frames times joints that any file may have, however short its rows are: 1 Mi, which is 16 MiB in memory.
    pub const FREE_CELLS: usize = 1 << 20;

    /// Refuses a text that is longer than [`Self::bytes`].
    pub(crate) fn check_bytes(&self, bytes: &[u8]) -> Result<(), FormatError> {
        let limit = self.bytes;
        if bytes.len() <= limit {
            return Ok(());
        }
        let what = format!("the file has {} bytes", bytes.len());
        let hint = "cut it into shorter motions".into();
        Err(FormatError::Limit { what, limit, place: None, hint })
    }

    /// The number of cells that a file of `bytes` bytes may have.
    pub(crate) fn cells_for(&self, bytes: usize) -> usize {
        self.cells.min(Self::FREE_CELLS.saturating_add(bytes))
    }
}

/// What all clips of one file may ask for together, keys and frames times joints: four times what one of them may. Clips can share their
/// keys, so that a short file could name the same ones a thousand times.
#[derive(Debug)]
pub(crate) struct Together {
    taken: usize,
    limit: usize,
}

impl Together {
    /// Of clips of which each may have `one`.
    pub(crate) fn of(one: usize) -> Self {
        Self { taken: 0, limit: one.saturating_mul(4) }
    }

    /// Takes some for a clip.
    pub(crate) fn take(&mut self, more: usize) -> Result<(), FormatError> {
        self.taken = self.taken.saturating_add(more);
        if self.taken <= self.limit {
            return Ok(());
        }
        Err(FormatError::Limit {
            what: format!("the clips of the file have {} keys and rotations together, and more", self.taken),
            limit: self.limit,
            place: None,
            hint: "name one of its clips, or put them into several files".into(),
        })
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self { bytes: 512 << 20, joints: 16_384, name_bytes: 256, cells: 128 << 20 }
    }
}
