//! The files of a project. Names are made here or checked here, so that none leads out of the folder.

use crate::StudioError;
use crate::storyboard::KeptBoard;
use inkrig_formats::read_in_folder;
use inkrig_sketch::storyboard::{Storyboard, write_storyboard};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Most bytes of a JSON file of ours.
const MOST_JSON: usize = 64 << 20;
/// What a project's folder may hold.
const KNOWN: [&str; 9] = [
    "project.json",
    "project.lock",
    "history",
    "clips",
    "sounds",
    "stroke.jsonl",
    ".gitignore",
    STORYBOARD,
    MADE,
];
/// The storyboard, as `inkrig storyboard` reads it too.
const STORYBOARD: &str = "storyboard.json";
/// What was read of it and made of it.
const MADE: &str = "storyboard-made.json";

/// A project's folder, locked for this process.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    _lock: File,
}

impl Folder {
    /// Opens the folder, or makes it.
    ///
    /// # Errors
    /// When it cannot be made, holds something else and no project, or is open in another process.
    pub(super) fn open(path: &Path) -> Result<Self, StudioError> {
        let failed = |what: String| StudioError::Folder { path: path.to_path_buf(), what };
        fs::create_dir_all(path).map_err(|cause| failed(format!("the folder cannot be made: {cause}")))?;
        let path = path.canonicalize().map_err(|cause| failed(cause.to_string()))?;
        if !path.join("project.json").exists()
            && let Some(other) = stranger(&path)
        {
            return Err(failed(format!(
                "the folder holds `{other}`, which is of no project: give an empty or a new folder"
            )));
        }
        let lock = File::create(path.join("project.lock")).map_err(|cause| failed(cause.to_string()))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(failed(
                    "it is open already: close the other studio, or give another --project".into(),
                ));
            }
            // Some file systems know no locks.
            Err(TryLockError::Error(_)) => {}
        }
        for name in ["history", "clips", "sounds"] {
            fs::create_dir_all(path.join(name)).map_err(|cause| failed(cause.to_string()))?;
        }
        Ok(Self { path, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A file of ours: a name, or a folder of ours and a name.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Reads a file of ours; `None` where there is none.
    pub(super) fn read_json<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, StudioError> {
        let failed = |what: String| StudioError::Folder { path: self.file(name), what };
        let bytes = match read_in_folder(&self.path, name, MOST_JSON) {
            Ok(bytes) => bytes,
            Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(failed(cause.to_string())),
        };
        serde_json::from_slice(&bytes)
            .map(Some)
            .map_err(|cause| failed(format!("it cannot be understood: {cause}")))
    }

    /// Writes a file of ours whole or not at all.
    pub(super) fn write_json<T: Serialize>(&self, name: &str, value: &T) -> Result<(), StudioError> {
        let bytes = serde_json::to_vec(value).map_err(|cause| StudioError::Internal(cause.to_string()))?;
        self.write(name, &bytes)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudioError> {
        let path = self.file(name);
        let failed = |cause| StudioError::File { path: path.clone(), cause };
        let parent = path.parent().unwrap_or(&self.path);
        let mut file = tempfile::NamedTempFile::new_in(parent).map_err(failed)?;
        file.write_all(bytes).map_err(failed)?;
        file.persist(&path).map_err(|error| failed(error.error))?;
        Ok(())
    }

    pub(super) fn remove(&self, name: &str) {
        let _ = fs::remove_file(self.file(name));
    }

    /// Keeps an upload in `clips` or `sounds`; returns the name of its file, which begins with the id.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&self, kind: Kind, id: &str, name: &str, bytes: &[u8]) -> Result<String, StudioError> {
        let file = format!("{id}-{}", plain(name));
        self.write(&format!("{}/{file}", kind.folder()), bytes)?;
        Ok(file)
    }

    /// Reads a file of `clips` or `sounds`. The name may come from a `project.json` that others wrote.
    ///
    /// # Errors
    /// When it is no plain name, leads elsewhere, is too large, or is not there.
    pub fn kept(&self, kind: Kind, file: &str, most: usize) -> Result<Vec<u8>, StudioError> {
        let folder = self.file(kind.folder());
        let path = folder.join(plain(file));
        if file.is_empty() || plain(file) != file {
            let what = "a project names its files by letters, digits, -, _ and . only".to_string();
            return Err(StudioError::Folder { path, what });
        }
        read_in_folder(&folder, file, most).map_err(|cause| StudioError::File { path, cause })
    }
}

impl Folder {
    /// Keeps the storyboard, whole or not at all.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep_board(&self, board: &Storyboard) -> Result<(), StudioError> {
        self.write(STORYBOARD, write_storyboard(board)?.as_bytes())
    }

    /// Keeps what was made of the storyboard.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn keep_made(&self, made: &KeptBoard) -> Result<(), StudioError> {
        self.write_json(MADE, made)
    }

    /// What was made of the storyboard; `None` where there is nothing, or nothing that this program understands: it can be made
    /// again.
    pub(crate) fn made(&self) -> Option<KeptBoard> {
        self.read_json(MADE).ok().flatten()
    }

    /// The bytes of the storyboard; `None` where there is none.
    ///
    /// # Errors
    /// When it cannot be read, or is too large.
    pub fn board(&self) -> Result<Option<Vec<u8>>, StudioError> {
        match read_in_folder(&self.path, STORYBOARD, MOST_JSON) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(StudioError::File { path: self.file(STORYBOARD), cause }),
        }
    }
}

/// Kinds of files that are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Motions and characters.
    Clip,
    /// Sounds.
    Sound,
}

impl Kind {
    fn folder(self) -> &'static str {
        match self {
            Self::Clip => "clips",
            Self::Sound => "sounds",
        }
    }
}

/// A name as that of a file on any system: the ending is kept, no part of it leads anywhere.
fn plain(name: &str) -> String {
    let base = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let kept: String = base
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() || "-_.".contains(letter) { letter } else { '_' })
        .collect();
    let skip = kept.len().saturating_sub(80);
    let kept = kept[skip..].trim_start_matches('.').to_string();
    if kept.is_empty() { "file".into() } else { kept }
}

/// Something in a folder that no project has.
fn stranger(path: &Path) -> Option<String> {
    let names =
        fs::read_dir(path).ok()?.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.into_iter().find(|name| !KNOWN.contains(&name.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere() {
        assert_eq!(plain("walk.bvh"), "walk.bvh");
        assert_eq!(plain("../../etc/passwd"), "passwd");
        assert_eq!(plain("C:\\Users\\me\\Tanz (1).fbx"), "Tanz__1_.fbx");
        assert_eq!(plain("..\u{202e}"), "_");
        assert_eq!(plain(".."), "file");
        assert!(plain(&format!("{}.glb", "x".repeat(500))).ends_with("x.glb"));
    }

    #[test]
    fn files_of_others_are_not_read() {
        let outside = tempfile::tempdir().unwrap();
        fs::write(outside.path().join("secret.bvh"), "secret").unwrap();
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        let file = folder.keep(Kind::Clip, "c1", "../walk.bvh", b"HIERARCHY").unwrap();
        assert_eq!(folder.kept(Kind::Clip, &file, 100).unwrap(), b"HIERARCHY");
        for bad in ["../project.lock", "..", "/etc/hostname", "", "a/../../project.lock"] {
            assert!(folder.kept(Kind::Clip, bad, 1 << 20).is_err(), "{bad}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(
                outside.path().join("secret.bvh"),
                place.path().join("clips/link.bvh"),
            )
            .unwrap();
            let error = folder.kept(Kind::Clip, "link.bvh", 100).unwrap_err().to_string();
            assert!(error.contains("outside"), "{error}");
        }
    }
}
