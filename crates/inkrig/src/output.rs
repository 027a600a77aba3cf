//! Files are written whole or not at all, and never over another without leave.

use std::io::Write;
use std::path::{Path, PathBuf};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// Something of that name is there.
    #[error("{0} is there already: give another name, or --force to replace it")]
    Exists(PathBuf),
    /// The folder is not there.
    #[error("there is no folder {0}: make it first")]
    NoFolder(PathBuf),
    /// The system said no.
    #[error("{path} could not be written: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Where results go.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Whether files that are there already may be replaced.
    pub force: bool,
}

impl Output {
    /// Says early, before long work, whether a file could be written.
    ///
    /// # Errors
    /// When it is there already, or its folder is not.
    pub fn check(self, path: &Path) -> Result<(), OutputError> {
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(OutputError::NoFolder(folder.to_path_buf()));
        }
        if path.is_dir() || (!self.force && path.symlink_metadata().is_ok()) {
            return Err(OutputError::Exists(path.to_path_buf()));
        }
        Ok(())
    }

    /// Writes a file beside its final place and moves it there: a crash or a full disk leaves the old file as it was.
    ///
    /// # Errors
    /// As for [`Self::check`], or when the system refuses.
    pub fn write(self, path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
        self.check(path)?;
        let io = |source| OutputError::Io { path: path.to_path_buf(), source };
        let mut file = tempfile::Builder::new()
            .prefix(".inkrig-")
            .suffix(".tmp")
            .tempfile_in(folder_of(path))
            .map_err(io)?;
        file.write_all(bytes).map_err(io)?;
        file.as_file().sync_all().map_err(io)?;
        allow_others_to_read(file.as_file()).map_err(io)?;
        if self.force {
            file.persist(path).map_err(|error| io(error.error))?;
        } else {
            // Does not replace a file that came up while we worked.
            file.persist_noclobber(path).map_err(|error| match error.error.kind() {
                std::io::ErrorKind::AlreadyExists => OutputError::Exists(path.to_path_buf()),
                _ => io(error.error),
            })?;
        }
        Ok(())
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Temporary files are private; results are ordinary files.
#[cfg(unix)]
fn allow_others_to_read(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn allow_others_to_read(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_replaced_without_leave_and_nothing_partial_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bvh");
        let careful = Output { force: false };
        careful.write(&path, b"one").unwrap();
        assert!(matches!(careful.write(&path, b"two"), Err(OutputError::Exists(_))));
        assert_eq!(std::fs::read(&path).unwrap(), b"one");
        Output { force: true }.write(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
        let nowhere = folder.path().join("no/such/file");
        assert!(matches!(careful.write(&nowhere, b""), Err(OutputError::NoFolder(_))));
        assert!(matches!(Output { force: true }.write(folder.path(), b""), Err(OutputError::Exists(_))));
    }
}
