//! All clips of a corpus, and where their numbers are.

use super::config::Split;
use super::part::Part;
use crate::TrainError;
use serde::{Deserialize, Serialize};
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

/// Bytes of a line: twice the longest captions there are, and key poses of an hour.
const MOST_LINE: u64 = 512 << 10;
/// Clips of a corpus: a hundred times those of HumanML3D.
const MOST_ENTRIES: usize = 3_000_000;

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
        let failed = |cause| TrainError::File { path: path.clone(), cause };
        let mut file = BufReader::new(std::fs::File::open(&path).map_err(failed)?);
        let mut entries = Vec::new();
        let mut line = Vec::new();
        loop {
            line.clear();
            let read = file.by_ref().take(MOST_LINE + 1).read_until(b'\n', &mut line).map_err(failed)?;
            if read == 0 {
                return Ok(Self { folder: folder.to_path_buf(), entries });
            }
            let content = |what: String| TrainError::Content {
                path: path.clone(),
                what: format!("line {}: {what}", entries.len() + 1),
            };
            if read as u64 > MOST_LINE {
                return Err(content(format!("is longer than {} kB", MOST_LINE >> 10)));
            }
            if entries.len() == MOST_ENTRIES {
                return Err(content("there are more clips than can be used".into()));
            }
            let entry = serde_json::from_slice(&line).map_err(|error| content(error.to_string()))?;
            entries.push(entry);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    #[test]
    fn a_manifest_of_any_length_is_read_line_by_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("manifest.jsonl");
        let line = |text: &str| {
            format!(
                "{{\"part\":\"p\",\"index\":0,\"source\":\"s\",\"file\":\"f\",\"subject\":\"a\",\"split\":\"train\",\"licence\":\"free\",\
                 \"frames\":3,\"text\":\"{text}\",\"mirrored_text\":\"\",\"actions\":[],\"key_poses\":[]}}\n"
            )
        };
        let long = line(&"word ".repeat(20_000));
        let mut file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
        (0..700).for_each(|_| file.write_all(long.as_bytes()).unwrap());
        file.into_inner().unwrap();
        assert!(std::fs::metadata(&path).unwrap().len() > 64 << 20, "more than other texts may have");
        assert_eq!(Manifest::read(folder.path()).unwrap().entries().len(), 700);
        let says = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Manifest::read(folder.path()).unwrap_err().to_string()
        };
        assert!(
            says(&format!("{}{}", line("a"), line(&"a".repeat(600_000))))
                .contains("line 2: is longer than 512 kB")
        );
        assert!(says(&format!("{}x", line("a"))).contains("line 2: expected value"));
    }
}
