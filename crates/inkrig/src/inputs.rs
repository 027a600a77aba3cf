//! Which files a run has read: the very bytes, so that nothing that took part is forgotten in a record.

use crate::error::CliError;
use crate::provenance::licence::{LicenceNote, of_bytes};
use crate::provenance::{sha256, sha256_of};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Seek;
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
    let journal = lock();
    if journal.only.is_none() && journal.read.iter().any(|input| input.path == name) {
        return Ok(());
    }
    drop(journal);
    let (sha256, licences) = (sha256(bytes), of_bytes(path, bytes));
    keep(InputFile { path: name, bytes: bytes.len() as u64, sha256, licences })
}

/// Opens a file that is too large to be held, notes its hash, and stands at its beginning again.
///
/// # Errors
/// When it cannot be read; else as [`note`].
pub(crate) fn open_large(path: &Path) -> Result<File, CliError> {
    let read = |cause| CliError::Read { path: path.to_path_buf(), cause };
    let mut file = File::open(path).map_err(read)?;
    let (bytes, sha256) = sha256_of(&mut file).map_err(read)?;
    file.rewind().map_err(read)?;
    let path = path.to_string_lossy().into_owned();
    keep(InputFile { path, bytes, sha256, licences: Vec::new() })?;
    Ok(file)
}

/// Notes what a file that was read says of its use itself.
pub(crate) fn add_licence(path: &Path, note: &LicenceNote) {
    let name = path.to_string_lossy();
    lock().read.iter_mut().filter(|input| input.path == name).for_each(|input| {
        input.licences.push(note.clone());
    });
}

fn keep(file: InputFile) -> Result<(), CliError> {
    let mut journal = lock();
    if let Some(only) = &journal.only
        && !only.iter().any(|input| input.path == file.path && input.sha256 == file.sha256)
    {
        return Err(CliError::OtherInput { path: file.path.into() });
    }
    if !journal.read.iter().any(|input| input.path == file.path) {
        journal.read.push(file);
    }
    Ok(())
}

/// The list is whole even where a thread that held it has panicked.
fn lock() -> MutexGuard<'static, Journal> {
    JOURNAL.lock().unwrap_or_else(PoisonError::into_inner)
}
