//! The file `OUT.inkrig.json`.

use super::arguments::is_option;
use crate::error::CliError;
use crate::inputs::InputFile;
use crate::output::Output;
use crate::printable;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// How a result was made; the names are stable. It holds no time and no name of a machine or person: the same run gives the
/// same record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sidecar {
    /// Version of this form. Stands first, so that a record is known by its first bytes.
    pub(crate) inkrig_sidecar: u32,
    pub(crate) program: String,
    /// Hash of the program's file.
    pub(crate) build: String,
    pub(crate) system: String,
    pub(crate) instruction_set: String,
    pub(crate) threads: String,
    pub(crate) command: String,
    /// `--name` or `--name=value`.
    pub(crate) options: Vec<String>,
    /// The files that stand without an option.
    pub(crate) files: Vec<String>,
    /// Not where a name is no text.
    pub(crate) can_be_redone: bool,
    /// Which of several solutions, from 1.
    pub(crate) solution: usize,
    pub(crate) output: OutputFile,
    /// Every file that was read, with the content that it had.
    pub(crate) inputs: Vec<InputFile>,
    /// Of all inputs, each once.
    pub(crate) licences: Vec<String>,
    pub(crate) seed: Option<u64>,
    pub(crate) evaluations: Option<Value>,
    /// As they were said, defaults included, and what the engine made of them. Nothing reads them back.
    pub(crate) parameters: Value,
}

/// The result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(expecting = "an object with the path, bytes and sha256 of the result")]
pub(crate) struct OutputFile {
    pub(crate) path: String,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
}

/// Commands that make a motion.
const COMMANDS: [&str; 5] = ["align", "convert", "generate", "retarget", "storyboard"];

/// Largest record that is read, bytes.
const MOST_BYTES: u64 = 4 << 20;
/// Most inputs, files and options.
const MOST_PARTS: usize = 10_000;
/// Longest text among them, bytes.
const MOST_TEXT: usize = 1 << 16;

impl Sidecar {
    /// Version of the form that is written and read.
    pub(crate) const VERSION: u32 = 1;
    /// Behind the name of the result.
    const ENDING: &str = ".inkrig.json";

    /// The place of a result's record.
    pub(crate) fn place(result: &Path) -> PathBuf {
        let mut name = result.as_os_str().to_os_string();
        name.push(Self::ENDING);
        PathBuf::from(name)
    }

    /// The result beside which a record lies.
    pub(crate) fn result_of(place: &Path) -> Option<PathBuf> {
        let name = place.file_name()?.to_str()?.strip_suffix(Self::ENDING)?;
        (!name.is_empty()).then(|| place.with_file_name(name))
    }

    /// Whether a file is a record, and may be replaced by another.
    pub(crate) fn is_one(path: &Path) -> bool {
        let mut first = [0; 20];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut first));
        path.is_file() && read.is_ok() && &first == b"{\n  \"inkrig_sidecar\""
    }

    /// Writes it.
    pub(crate) fn write(&self, place: &Path, force: bool) -> Result<(), CliError> {
        let mut text = serde_json::to_vec_pretty(self)?;
        text.push(b'\n');
        Ok(Output { force: force || Self::is_one(place) }.write(place, &text)?)
    }

    /// Reads one and checks everything that is used of it.
    ///
    /// # Errors
    /// When it cannot be read, is too large, or not what inkrig writes.
    pub(crate) fn read(path: &Path) -> Result<Self, CliError> {
        let unreadable = |cause| CliError::Read { path: path.to_path_buf(), cause };
        let mut bytes = Vec::new();
        File::open(path)
            .map_err(unreadable)?
            .take(MOST_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
        let wrong = |what: String| CliError::Sidecar { path: path.to_path_buf(), what };
        if bytes.len() as u64 > MOST_BYTES {
            return Err(wrong(format!("it is larger than {MOST_BYTES} bytes")));
        }
        let sidecar: Self =
            serde_json::from_slice(&bytes).map_err(|error| wrong(printable::json_error(&error)))?;
        sidecar.check().map_err(wrong)?;
        Ok(sidecar)
    }

    fn check(&self) -> Result<(), String> {
        if self.inkrig_sidecar != Self::VERSION {
            return Err(format!(
                "it has version {}, and this program knows {}",
                self.inkrig_sidecar,
                Self::VERSION
            ));
        }
        if !COMMANDS.contains(&self.command.as_str()) {
            return Err(format!("`{}` is no command that makes a motion", self.command));
        }
        let parts = [self.options.len(), self.files.len(), self.inputs.len(), self.licences.len()];
        if parts.iter().any(|&count| count > MOST_PARTS) {
            return Err(format!("it has more than {MOST_PARTS} inputs or options"));
        }
        let mut texts =
            self.options.iter().chain(&self.files).chain(self.inputs.iter().map(|input| &input.path));
        if texts.any(|text| text.len() > MOST_TEXT || text.contains('\0')) {
            return Err("a name or an option in it is too long, or holds a zero".into());
        }
        if let Some(option) = self.options.iter().find(|option| !is_option(&self.command, option)) {
            return Err(format!(
                "`{option}` is no option of `inkrig {}` that a record may hold",
                self.command
            ));
        }
        let hashes = self.inputs.iter().map(|input| &input.sha256).chain([&self.output.sha256]);
        let is_hash = |text: &String| {
            text.len() == 64 && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
        };
        if let Some(wrong) = hashes.into_iter().find(|hash| !is_hash(hash)) {
            return Err(format!("`{wrong}` is no hash of 64 digits"));
        }
        if !(1..=16).contains(&self.solution) {
            return Err(format!("there is no solution {}", self.solution));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_and_its_result_find_each_other() {
        let place = Sidecar::place(Path::new("out/new.bvh"));
        assert_eq!(place, Path::new("out/new.bvh.inkrig.json"));
        assert_eq!(Sidecar::result_of(&place).unwrap(), Path::new("out/new.bvh"));
        assert_eq!(Sidecar::result_of(Path::new(".inkrig.json")), None);
        assert_eq!(Sidecar::result_of(Path::new("new.json")), None);
    }
}
