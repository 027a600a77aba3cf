//! Files that are being written. Whoever ends the process removes them first.

use std::fs::File;
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// The temporary files that exist now. Held while one is made or moved, so that the list is never wrong.
static OPEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file beside its final place, which it gets by [`Self::keep`]; otherwise it is removed.
#[derive(Debug)]
pub(crate) struct Temporary {
    file: Option<NamedTempFile>,
    path: PathBuf,
}

impl Temporary {
    /// An empty file in a folder, with the permissions that any new file of this user has.
    pub(crate) fn in_folder(folder: &Path) -> Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".inkrig-").suffix(".tmp");
        ordinary_permissions(&mut builder);
        let mut open = lock();
        let file = builder.tempfile_in(folder)?;
        let path = file.path().to_path_buf();
        open.push(path.clone());
        Ok(Self { file: Some(file), path })
    }

    /// The file, to write it piece by piece; [`Self::finish`] has to follow.
    pub(crate) fn file(&mut self) -> Result<&mut File> {
        self.file.as_mut().map(NamedTempFile::as_file_mut).ok_or_else(|| Error::from(ErrorKind::NotFound))
    }

    /// Waits until what was written is on the disk.
    pub(crate) fn finish(&mut self) -> Result<()> {
        self.file()?.sync_all()
    }

    /// Writes all of the file and waits until it is on the disk.
    pub(crate) fn fill(&mut self, bytes: &[u8]) -> Result<()> {
        if let Some(file) = &mut self.file {
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
        }
        Ok(())
    }

    /// Moves the file to its place. Without `replace` it fails when something came up there while we worked.
    pub(crate) fn keep(mut self, place: &Path, replace: bool) -> Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let mut open = lock();
        open.retain(|path| *path != self.path);
        let kept = if replace { file.persist(place) } else { file.persist_noclobber(place) };
        // A file that could not be moved comes back with the error, and is removed here while the list is held.
        kept.map(drop).map_err(|refused| refused.error)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let mut open = lock();
            open.retain(|path| *path != self.path);
            drop(file);
        }
    }
}

/// Ends the process at once and leaves no temporary file behind. Called by the handler of Ctrl-C.
pub(crate) fn exit(code: i32) -> ! {
    // Held to the end: nothing is made or moved any more.
    let open = lock();
    for path in open.iter() {
        let _ = std::fs::remove_file(path);
    }
    std::process::exit(code)
}

/// The list is whole even where a thread that held it has panicked.
fn lock() -> MutexGuard<'static, Vec<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Temporary files are private; results are ordinary files, within the user's umask.
#[cfg(unix)]
fn ordinary_permissions(builder: &mut tempfile::Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn ordinary_permissions(_: &mut tempfile::Builder<'_, '_>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_kept_goes_and_what_is_open_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let count = || std::fs::read_dir(folder.path()).unwrap().count();
        let mine = || lock().iter().filter(|path| path.starts_with(folder.path())).count();
        let mut file = Temporary::in_folder(folder.path()).unwrap();
        file.fill(b"half").unwrap();
        assert_eq!((count(), mine()), (1, 1));
        drop(file);
        assert_eq!((count(), mine()), (0, 0));
        let place = folder.path().join("out");
        Temporary::in_folder(folder.path()).unwrap().keep(&place, false).unwrap();
        assert!(Temporary::in_folder(folder.path()).unwrap().keep(&place, false).is_err());
        assert_eq!((count(), mine()), (1, 0));
    }
}
