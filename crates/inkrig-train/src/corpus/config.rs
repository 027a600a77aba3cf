//! What a corpus is made of.

use super::toml_text::parse_toml;
use crate::TrainError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The most bytes of a configuration or an index.
pub(super) const MOST_BYTES: u64 = 64 << 20;

/// A corpus, as its TOML file says it. Paths are relative to that file's folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// A motion file whose first frame gives the body that all clips get. Default: the first usable file.
    #[serde(default)]
    pub body: Option<PathBuf>,
    /// Fewer frames at 20 a second are no clip. Default: 21, which is 20 rows of features.
    #[serde(default = "least_frames")]
    pub least_frames: usize,
    /// The folders.
    #[serde(rename = "source")]
    pub sources: Vec<Source>,
}

/// A folder of motion files of one origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Its short name.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// What is in it.
    #[serde(default)]
    pub format: SourceFormat,
    /// Frames a second of tables of joints that do not say.
    #[serde(default)]
    pub frame_rate: Option<f64>,
    /// The axis that points up in tables of joints.
    #[serde(default)]
    pub up: Up,
    /// What its licence allows, as one word that results can be sorted by: `free`, `attribution`, `non-commercial`.
    pub licence: String,
    /// The sentence that its licence or its makers ask for.
    #[serde(default)]
    pub credit: String,
    /// A CSV with a column `file` and any of `subject` or `actor`, `split`, `fps`, `description`, `label` or `text`. A file is the end of
    /// a path, or its name alone where no other file of the source is named so.
    #[serde(default)]
    pub index: Option<PathBuf>,
    /// Take only files whose path within the folder holds one of these. Default: all.
    #[serde(default)]
    pub include: Vec<String>,
    /// Leave out files whose path within the folder holds one of these.
    #[serde(default)]
    pub exclude: Vec<String>,
    /// Where the words for a clip stand.
    #[serde(default)]
    pub text: TextFrom,
    /// Words for all clips that the index has none for.
    #[serde(default)]
    pub words: Option<String>,
    /// Where clips go that neither the index nor `subjects` places.
    #[serde(default)]
    pub split: Split,
    /// Splits by subject.
    #[serde(default)]
    pub subjects: BTreeMap<String, Split>,
    /// The skeleton of files that have none beside them.
    #[serde(default)]
    pub skeleton: Option<PathBuf>,
}

/// What is in a folder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SourceFormat {
    /// Motion files of all kinds that the program reads.
    #[default]
    Motion,
    /// NumPy's tables of joints (.npz, .npy): frames x 22 or more x 3, metres, in the order of SMPL.
    Joints,
    /// HumanML3D: `new_joint_vecs` or `new_joints`, `texts`, and the lists `train.txt`, `val.txt` and `test.txt`.
    HumanMl3d,
}

/// An axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// As in HumanML3D.
    #[default]
    Y,
    /// As in AMASS.
    Z,
}

/// What a clip is used for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// Learned from.
    #[default]
    Train,
    /// Looked at while learning, to stop in time.
    Val,
    /// Only measured on.
    Test,
}

impl Split {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Train, Self::Val, Self::Test];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }
}

/// Where the words for a clip stand.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TextFrom {
    /// In the index, else in the clip's name where the file names its clips, else in the file's name.
    #[default]
    Best,
    /// In the file's name.
    FileName,
    /// In the name of the folder.
    Folder,
    /// Nowhere.
    Nothing,
}

impl Config {
    /// Reads a TOML file; its paths become relative to where the program runs.
    ///
    /// # Errors
    /// When it cannot be read, is too large, or is no configuration.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        let text = read_text(path)?;
        let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let mut config: Self = parse_toml(&text).map_err(content)?;
        config.check().map_err(content)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let place = |path: &mut PathBuf| *path = folder.join(&*path);
        config.body.iter_mut().for_each(place);
        for source in &mut config.sources {
            place(&mut source.folder);
            source.index.iter_mut().chain(&mut source.skeleton).for_each(place);
        }
        Ok(config)
    }

    fn check(&self) -> Result<(), String> {
        if self.sources.is_empty() {
            return Err("there is no [[source]]: name at least one folder".into());
        }
        if self.least_frames < 3 {
            return Err(format!("least_frames is {}: give 3 or more", self.least_frames));
        }
        for (index, source) in self.sources.iter().enumerate() {
            let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
            if source.name.is_empty() || !source.name.chars().all(plain) {
                return Err(format!(
                    "the source name `{}` becomes a folder: give letters, digits, - and _ only",
                    source.name
                ));
            }
            if self.sources.iter().take(index).any(|other| other.name == source.name) {
                return Err(format!("two sources are called `{}`", source.name));
            }
            if source.format != SourceFormat::Joints && (source.frame_rate.is_some() || source.up != Up::Y) {
                let name = &source.name;
                return Err(format!("`{name}`: frame_rate and up are for format = \"joints\" alone"));
            }
            if let Some(rate) = source.frame_rate.filter(|rate| !super::table::RATES.contains(rate)) {
                return Err(format!("frame_rate of `{}` is {rate}: give 1 to 1000", source.name));
            }
            if source.licence.trim().is_empty() {
                return Err(format!("say the licence of `{}`, for example \"free\"", source.name));
            }
        }
        Ok(())
    }
}

/// A text file, if it is no larger than a configuration may be.
pub(crate) fn read_text(path: &Path) -> Result<String, TrainError> {
    use std::io::Read as _;
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let mut text = String::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(failed)?;
    if text.len() as u64 > MOST_BYTES {
        let what = format!("is larger than {} MB", MOST_BYTES >> 20);
        return Err(TrainError::Content { path: path.to_path_buf(), what });
    }
    Ok(text)
}

fn least_frames() -> usize {
    21
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_says_what_is_wrong_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("corpus.toml");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Config::read(&path)
        };
        let good = "[[source]]\nname = 'a'\nfolder = 'x'\nlicence = 'free'\n[source.subjects]\n07 = 'test'\n";
        let config = read(good).unwrap();
        assert_eq!(config.sources[0].folder, folder.path().join("x"), "beside the configuration");
        assert_eq!((config.least_frames, config.sources[0].subjects["07"]), (21, Split::Test));
        let says = |text: &str| read(text).unwrap_err().to_string();
        assert!(says("").contains("source"));
        assert!(says(&good.replace("'a'", "'../a'")).contains("letters, digits"));
        assert!(says(&good.replace("'free'", "' '")).contains("licence"));
        assert!(says(&format!("{good}{good}")).contains("two sources"));
        assert!(says(&good.replace("folder", "fodler")).contains("fodler"));
        assert!(says(&good.replace("'test'", "'tset'")).contains("tset"));
        let with = |more: &str| good.replace("licence", &format!("{more}\nlicence"));
        let tables = read(&with("format = 'joints'\nup = 'z'\nframe_rate = 120")).unwrap().sources.remove(0);
        assert_eq!((tables.format, tables.up, tables.frame_rate), (SourceFormat::Joints, Up::Z, Some(120.0)));
        assert!(read(&with("format = 'humanml3d'")).is_ok());
        assert!(says(&with("format = 'npz'")).contains("joints"), "{}", says(&with("format = 'npz'")));
        assert!(says(&with("format = 'humanml3d'\nup = 'z'")).contains("for format = \"joints\" alone"));
        assert!(says(&with("format = 'joints'\nframe_rate = 0")).contains("give 1 to 1000"));
        assert!(says(&format!("least_frames = 1\n{good}")).contains("3 or more"));
    }
}
