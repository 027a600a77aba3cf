//! What lies in a folder and in those within it.

use crate::TrainError;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Folders within folders, at most.
const DEEPEST: usize = 16;

/// A file, or something else that cannot be read, with the reason.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Found {
    pub path: PathBuf,
    pub problem: Option<&'static str>,
    /// Whether it is a folder, which is listed only with a problem.
    pub is_folder: bool,
}

/// All files, by path. Links are followed, to every folder once, so that none leads around in circles.
pub(super) fn walk(folder: &Path) -> Result<Vec<Found>, TrainError> {
    let mut walk = Walk { seen: HashSet::new(), found: Vec::new() };
    walk.folder(folder, 0)?;
    walk.found.sort();
    Ok(walk.found)
}

struct Walk {
    seen: HashSet<PathBuf>,
    found: Vec<Found>,
}

impl Walk {
    fn folder(&mut self, folder: &Path, depth: usize) -> Result<(), TrainError> {
        let failed = |cause| TrainError::File { path: folder.to_path_buf(), cause };
        if !self.seen.insert(std::fs::canonicalize(folder).map_err(failed)?) {
            self.push(folder.to_path_buf(), Some("it is a link to a folder that is read already"), true);
            return Ok(());
        }
        let mut entries = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            entries.push((entry.file_type().map_err(failed)?.is_symlink(), entry.path()));
        }
        // Links come last: what is in a folder itself is found under its own name.
        entries.sort();
        for (_, path) in entries {
            match std::fs::metadata(&path) {
                Ok(kind) if kind.is_dir() && depth < DEEPEST => self.folder(&path, depth + 1)?,
                Ok(kind) if kind.is_dir() => {
                    self.push(path, Some("it lies more than 16 folders deep"), true);
                }
                Ok(kind) if kind.is_file() => self.push(path, None, false),
                Ok(_) => self.push(path, Some("it is no file"), false),
                Err(_) => self.push(path, Some("it is a link that leads nowhere"), false),
            }
        }
        Ok(())
    }

    fn push(&mut self, path: PathBuf, problem: Option<&'static str>, is_folder: bool) {
        self.found.push(Found { path, problem, is_folder });
    }
}
