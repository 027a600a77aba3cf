//! Files are written whole or not at all, and never over another without leave.

use crate::printable;
use crate::temporary::Temporary;
use std::fs::{File, FileType};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// Something of that name is there.
    #[error("{} is there already: give another name, or --force to replace it", printable::path(.0))]
    Exists(PathBuf),
    /// Something is there that no leave lets us replace: a folder, a device, a pipe.
    #[error(
        "{} is {what}, not an ordinary file, and is not replaced: give another name",
        printable::path(path)
    )]
    NotAFile {
        /// The name that was given.
        path: PathBuf,
        /// What is there.
        what: &'static str,
    },
    /// The folder is not there.
    #[error("there is no folder {}: make it first", printable::path(.0))]
    NoFolder(PathBuf),
    /// The system said no.
    #[error("{} could not be written: {cause}", printable::path(path))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said. Not a `source`: it stands in the text already.
        cause: std::io::Error,
    },
}

/// Where results go.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Whether files that are there already may be replaced.
    pub force: bool,
}

impl Output {
    /// Says early, before long work, whether a file could be written: a trial file is made beside it and removed.
    ///
    /// # Errors
    /// When it is there already, is no ordinary file, its folder is not there, or nothing may be written into it.
    pub fn check(self, path: &Path) -> Result<(), OutputError> {
        let place = self.place(path)?;
        Temporary::in_folder(folder_of(&place)).map_err(refused(path))?;
        Ok(())
    }

    /// Writes a file beside its final place and moves it there: a crash or a full disk leaves the old file as it was.
    /// Where the name is a link, the file that it leads to is replaced and the link stays.
    ///
    /// # Errors
    /// As for [`Self::check`], or when the system refuses.
    pub fn write(self, path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
        let place = self.place(path)?;
        let mut file = Temporary::in_folder(folder_of(&place)).map_err(refused(path))?;
        file.fill(bytes).map_err(refused(path))?;
        self.keep(file, &place, path)
    }

    /// The same for what is too large to be held: `write` writes it piece by piece.
    ///
    /// # Errors
    /// As for [`Self::write`], or what `write` says; the old file is as it was then.
    pub fn stream<T, E: From<OutputError>>(
        self,
        path: &Path,
        write: impl FnOnce(&mut File) -> Result<T, E>,
    ) -> Result<T, E> {
        let place = self.place(path)?;
        let mut file = Temporary::in_folder(folder_of(&place)).map_err(refused(path))?;
        let result = write(file.file().map_err(refused(path))?)?;
        file.finish().map_err(refused(path))?;
        self.keep(file, &place, path)?;
        Ok(result)
    }

    fn keep(self, file: Temporary, place: &Path, path: &Path) -> Result<(), OutputError> {
        file.keep(place, self.force).map_err(|cause| match cause.kind() {
            ErrorKind::AlreadyExists => OutputError::Exists(path.to_path_buf()),
            _ => refused(path)(cause),
        })
    }

    /// The place that a name leads to, if something may be put there.
    fn place(self, path: &Path) -> Result<PathBuf, OutputError> {
        let not_a_file = |what| Err(OutputError::NotAFile { path: path.to_path_buf(), what });
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(OutputError::NoFolder(folder.to_path_buf()));
        }
        let is_link = path.is_symlink();
        // `metadata` follows links, so that a link to a device is a device.
        match path.metadata() {
            Ok(there) if !there.is_file() => not_a_file(kind(there.file_type())),
            Ok(_) if !self.force => Err(OutputError::Exists(path.to_path_buf())),
            Ok(_) if is_link => path.canonicalize().map_err(refused(path)),
            Ok(_) => Ok(path.to_path_buf()),
            Err(_) if is_link => not_a_file("a link that leads to no file"),
            Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(path.to_path_buf()),
            Err(cause) => Err(refused(path)(cause)),
        }
    }
}

fn refused(path: &Path) -> impl Fn(std::io::Error) -> OutputError {
    move |cause| OutputError::Io { path: path.to_path_buf(), cause }
}

/// The folder that a file of that name is in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn kind(file_type: FileType) -> &'static str {
    if file_type.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if file_type.is_fifo() {
            return "a pipe";
        }
        if file_type.is_socket() {
            return "a socket";
        }
    }
    "a device"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_replaced_without_leave_and_nothing_partial_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bvh");
        let careful = Output { force: false };
        careful.check(&path).unwrap();
        careful.write(&path, b"one").unwrap();
        assert!(matches!(careful.write(&path, b"two"), Err(OutputError::Exists(_))));
        assert_eq!(std::fs::read(&path).unwrap(), b"one");
        Output { force: true }.write(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
        let nowhere = folder.path().join("no/such/file");
        assert!(matches!(careful.write(&nowhere, b""), Err(OutputError::NoFolder(_))));
        let forced = Output { force: true };
        assert!(matches!(forced.write(folder.path(), b""), Err(OutputError::NotAFile { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_their_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link, loose) =
            (folder.path().join("file"), folder.path().join("link"), folder.path().join("loose"));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink("file", &link).unwrap();
        std::os::unix::fs::symlink("nothing", &loose).unwrap();
        let forced = Output { force: true };
        assert!(matches!(Output { force: false }.write(&link, b"new"), Err(OutputError::Exists(_))));
        forced.write(&link, b"new").unwrap();
        assert!(link.is_symlink() && std::fs::read(&file).unwrap() == b"new");
        assert!(matches!(forced.write(&loose, b"new"), Err(OutputError::NotAFile { .. })));
        std::os::unix::fs::symlink("/dev/null", folder.path().join("null")).unwrap();
        for device in [folder.path().join("null"), PathBuf::from("/dev/null")] {
            assert!(matches!(forced.check(&device), Err(OutputError::NotAFile { what: "a device", .. })));
        }
    }
}
