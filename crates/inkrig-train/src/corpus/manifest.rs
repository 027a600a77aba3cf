//! All clips of a corpus, and where their numbers are.

use super::config::Split;
use super::part::Part;
use crate::TrainError;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A clip of the corpus: one line of `manifest.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The part with its numbers, within the corpus folder.
    pub part: String,
    /// Its place in that part.
    pub index: usize,
    /// The source's name.
    pub source: String,
    /// The file within the source's folder.
    pub file: String,
    /// The clip's name, where the file names its clips.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub clip: Option<String>,
    /// Who moves.
    pub subject: String,
    /// What it is used for.
    pub split: Split,
    /// The licence's class.
    pub licence: String,
    /// Rows of features at 20 a second.
    pub frames: usize,
    /// What is done, as it was found.
    pub text: String,
    /// The same of the mirror image.
    pub mirrored_text: String,
    /// Verbs of the lexicon in it, in order.
    pub actions: Vec<String>,
    /// Rows worth a key pose.
    pub key_poses: Vec<usize>,
}

/// A clip that was left out: one line of `rejected.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RejectedEntry {
    /// The source's name.
    pub source: String,
    /// The file within the source's folder.
    pub file: String,
    /// The clip's name, where the file names its clips.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub clip: Option<String>,
    /// The reason, to count by.
    pub kind: String,
    /// The reason, to read.
    pub why: String,
}

/// A corpus that was built.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    folder: PathBuf,
    entries: Vec<Entry>,
}

impl Manifest {
    /// Reads the manifest of a corpus folder.
    ///
    /// # Errors
    /// When it is not there, or a line is none of a manifest.
    pub fn read(folder: &Path) -> Result<Self, TrainError> {
        let path = folder.join("manifest.jsonl");
        let text = super::config::read_text(&path)?;
        let entries = text
            .lines()
            .enumerate()
            .map(|(line, text)| {
                serde_json::from_str(text).map_err(|error| TrainError::Content {
                    path: path.clone(),
                    what: format!("line {}: {error}", line + 1),
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { folder: folder.to_path_buf(), entries })
    }

    /// All clips.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The parts of a split with the entries in each, one part after the other.
    pub fn parts(&self, split: Split) -> impl Iterator<Item = (PathBuf, &[Entry])> {
        self.entries
            .chunk_by(|a, b| a.part == b.part)
            .filter(move |entries| entries.first().is_some_and(|entry| entry.split == split))
            .filter_map(|entries| Some((self.folder.join(&entries.first()?.part), entries)))
    }

    /// Reads the part that some entries are in.
    ///
    /// # Errors
    /// As for [`Part::read`], or when an entry is not in its part.
    pub fn read_part(path: &Path, entries: &[Entry]) -> Result<Part, TrainError> {
        let part = Part::read(path)?;
        let fits = |entry: &Entry| {
            part.clips.get(entry.index).is_some_and(|clip| clip.prepared.features.frames() == entry.frames)
        };
        if entries.iter().all(fits) {
            return Ok(part);
        }
        let what = "is not what the manifest says: build the corpus again".to_string();
        Err(TrainError::Content { path: path.to_path_buf(), what })
    }
}
