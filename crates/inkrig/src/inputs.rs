//! Which files a run has read: the very bytes, so that nothing that took part is forgotten in a record.

use crate::error::CliError;
use crate::provenance::licence::{LicenceNote, of_bytes};
use crate::provenance::sha256;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct InputFile {
    /// As it was given, or where it was found.
    pub(crate) path: String,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
    /// What is said about its use, and where.
    #[serde(default)]
    pub(crate) licences: Vec<LicenceNote>,
}

#[derive(Debug)]
struct Journal {
    read: Vec<InputFile>,
    /// When a run is repeated: nothing but these.
    only: Option<Vec<InputFile>>,
}

static JOURNAL: Mutex<Journal> = Mutex::new(Journal { read: Vec::new(), only: None });

/// Begins anew. With `only` any other file is refused, and any other content.
pub(crate) fn begin(only: Option<Vec<InputFile>>) {
    *lock() = Journal { read: Vec::new(), only };
}

/// How many files were read so far.
pub(crate) fn count() -> usize {
    lock().read.len()
}

/// Forgets what was read after the first `count` files: another result of the same run begins.
pub(crate) fn forget_after(count: usize) {
    lock().read.truncate(count);
}

/// The files that were read, in order, each once.
pub(crate) fn read() -> Vec<InputFile> {
    lock().read.clone()
}

/// Notes a file that was read. Every reader calls this before it looks at the bytes.
///
/// # Errors
/// When a run is repeated that has not read this file, or not with this content.
pub(crate) fn note(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    let name = path.to_string_lossy().into_owned();
    let mut journal = lock();
    if journal.only.is_none() && journal.read.iter().any(|input| input.path == name) {
        return Ok(());
    }
    let sha256 = sha256(bytes);
    if let Some(only) = &journal.only {
        let known = only.iter().any(|input| input.path == name && input.sha256 == sha256);
        if !known {
            return Err(CliError::OtherInput { path: path.to_path_buf() });
        }
    }
    if !journal.read.iter().any(|input| input.path == name) {
        let licences = of_bytes(path, bytes);
        journal.read.push(InputFile { path: name, bytes: bytes.len() as u64, sha256, licences });
    }
    Ok(())
}

/// The list is whole even where a thread that held it has panicked.
fn lock() -> MutexGuard<'static, Journal> {
    JOURNAL.lock().unwrap_or_else(PoisonError::into_inner)
}
