//! The files of the demo: it may be run again over its own, but never over somebody else's of the same name.

use crate::error::CliError;
use crate::output::{Output, OutputError};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Stands in the folder and lists what the demo wrote.
const MARKER: &str = ".inkrig-demo";
/// A marker is much smaller; what is larger is none of ours.
const MOST_BYTES: u64 = 1 << 20;

/// A folder of the demo.
pub(super) struct DemoFiles<'a> {
    folder: &'a Path,
    force: bool,
    written: Written,
}

/// SHA-256 of everything that the demo wrote, by file name. A name has more than one while it is being replaced.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Written {
    files: BTreeMap<String, BTreeSet<String>>,
}

impl<'a> DemoFiles<'a> {
    /// Makes the folder, if needed, and reads what an earlier demo left there.
    ///
    /// # Errors
    /// When the folder cannot be made, or a marker is there that is none of ours.
    pub(super) fn open(folder: &'a Path, force: bool) -> Result<Self, CliError> {
        std::fs::create_dir_all(folder)
            .map_err(|cause| OutputError::Io { path: folder.to_path_buf(), cause })?;
        let marker = folder.join(MARKER);
        let written = match read(&marker) {
            Some(bytes) => serde_json::from_slice(&bytes).ok(),
            None if marker.symlink_metadata().is_err() => Some(Written::default()),
            None => None,
        };
        match written {
            Some(written) => Ok(Self { folder, force, written }),
            None if force => Ok(Self { folder, force, written: Written::default() }),
            None => Err(OutputError::Exists(marker).into()),
        }
    }

    /// The path of a file of the demo.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Says whether a file may be written: nothing is there, or what is there is ours. `sample` is what the file is
    /// known to hold, if that is known before.
    ///
    /// # Errors
    /// When it is somebody else's, or cannot be written at all.
    pub(super) fn check(&self, name: &str, sample: Option<&[u8]>) -> Result<(), CliError> {
        let path = self.path(name);
        Ok(Output { force: self.force || self.is_ours(name, &path, sample) }.check(&path)?)
    }

    /// Writes a file of the demo and notes that it is ours.
    ///
    /// # Errors
    /// As for [`Self::check`].
    pub(super) fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        let path = self.path(name);
        let output = Output { force: self.force || self.is_ours(name, &path, Some(bytes)) };
        output.check(&path)?;
        // Noted first: were we stopped in between, the file would count as somebody else's.
        self.written.files.entry(name.to_string()).or_default().insert(hash(bytes));
        self.save()?;
        output.write(&path, bytes)?;
        self.written.files.insert(name.to_string(), BTreeSet::from([hash(bytes)]));
        Ok(())
    }

    /// Notes what is there now, and nothing of before.
    ///
    /// # Errors
    /// When the marker cannot be written.
    pub(super) fn save(&self) -> Result<(), CliError> {
        let text = serde_json::to_string_pretty(&self.written)?;
        // It was read as ours, or there was none, or `--force` was given.
        Ok(Output { force: true }.write(&self.folder.join(MARKER), text.as_bytes())?)
    }

    fn is_ours(&self, name: &str, path: &Path, sample: Option<&[u8]>) -> bool {
        let Some(there) = read_any(path) else { return false };
        sample == Some(there.as_slice())
            || self.written.files.get(name).is_some_and(|hashes| hashes.contains(&hash(&there)))
    }
}

/// An ordinary file that is not too large for a marker.
fn read(path: &Path) -> Option<Vec<u8>> {
    path.metadata().ok().filter(|file| file.len() <= MOST_BYTES)?;
    read_any(path)
}

/// An ordinary file that is no larger than anything that the demo writes.
fn read_any(path: &Path) -> Option<Vec<u8>> {
    path.metadata().ok().filter(|file| file.is_file() && file.len() <= MOST_BYTES << 6)?;
    std::fs::read(path).ok()
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_own_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let open = |force| DemoFiles::open(folder.path(), force).unwrap();
        let mut files = open(false);
        files.write("a", b"one").unwrap();
        open(false).write("a", b"two").unwrap();
        std::fs::write(folder.path().join("b"), "two").unwrap();
        assert!(files.check("b", Some(b"two")).is_ok(), "the same bytes lose nothing");
        assert!(files.check("b", None).is_err() && files.write("b", b"three").is_err());
        std::fs::write(folder.path().join("a"), "changed").unwrap();
        assert!(open(false).write("a", b"three").is_err(), "changed by somebody, so it is theirs");
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"changed");
        open(true).write("a", b"three").unwrap();
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"three");
    }

    #[test]
    fn a_marker_of_somebody_else_is_safe() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(MARKER), "my notes").unwrap();
        assert!(DemoFiles::open(folder.path(), false).is_err());
        assert!(DemoFiles::open(folder.path(), true).is_ok());
    }
}
