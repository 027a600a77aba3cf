//! What became of one motion file.

use super::check::Rejected;
use super::clip::Prepared;
use crate::TrainError;
use inkrig_motion::Features;
use inkrig_motion::humanml::WIDTH;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::Read as _;
use std::path::Path;

/// The form of parts; another one makes all anew.
pub(super) const VERSION: u32 = 1;

/// The key under which a part's header has what is said of it.
const HEADER: &str = "inkrig-corpus";

/// More bytes no part has: four hours of motion.
const MOST_BYTES: u64 = 1 << 30;

/// A motion file's clips.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What it was made of: other input, another key.
    pub key: String,
    /// Clips that can be used.
    pub clips: Vec<PartClip>,
    /// Clips that cannot: name, kind of reason, reason.
    pub rejected: Vec<(Option<String>, String, String)>,
}

/// A clip of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartClip {
    /// Its name, where the file names its clips.
    pub name: Option<String>,
    /// Its numbers.
    pub prepared: Prepared,
}

#[derive(Serialize, Deserialize)]
struct Header {
    version: u32,
    key: String,
    clips: Vec<ClipHeader>,
    rejected: Vec<(Option<String>, String, String)>,
}

/// What a part says of a clip without its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ClipHeader {
    pub name: Option<String>,
    pub frames: usize,
    pub key_poses: Vec<usize>,
}

impl Part {
    /// The part of a file from what its clips became.
    pub(super) fn new(key: String, clips: Vec<(Option<String>, Result<Prepared, Rejected>)>) -> Self {
        let mut part = Self { key, clips: Vec::new(), rejected: Vec::new() };
        for (name, clip) in clips {
            match clip {
                Ok(prepared) => part.clips.push(PartClip { name, prepared }),
                Err(why) => part.rejected.push((name, why.kind().to_string(), why.to_string())),
            }
        }
        part
    }

    /// As safetensors: `0` and `0.mirrored`, frames x 263 each, and so on.
    pub(super) fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let clips = self.clips.iter().map(|clip| ClipHeader {
            name: clip.name.clone(),
            frames: clip.prepared.features.frames(),
            key_poses: clip.prepared.key_poses.clone(),
        });
        let header = Header {
            version: VERSION,
            key: self.key.clone(),
            clips: clips.collect(),
            rejected: self.rejected.clone(),
        };
        let header = serde_json::to_string(&header).map_err(|error| error.to_string())?;
        let rows: Vec<(String, usize, Vec<u8>)> = self
            .clips
            .iter()
            .enumerate()
            .flat_map(|(index, clip)| {
                [
                    (tensor(index, false), &clip.prepared.features),
                    (tensor(index, true), &clip.prepared.mirrored),
                ]
            })
            .map(|(name, table)| {
                let bytes = table.as_slice().iter().flat_map(|value| value.to_le_bytes()).collect();
                (name, table.frames(), bytes)
            })
            .collect();
        let views = rows
            .iter()
            .map(|(name, frames, bytes)| {
                Ok((name, TensorView::new(Dtype::F32, vec![*frames, WIDTH], bytes)?))
            })
            .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
            .map_err(|error| error.to_string())?;
        let metadata = HashMap::from([(HEADER.to_string(), header)]);
        safetensors::serialize(views, Some(metadata)).map_err(|error| error.to_string())
    }

    /// Reads a part.
    ///
    /// # Errors
    /// When it is not there, too large, or is no part of this version.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        let bytes = read_bytes(path)?;
        let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let header = parse_header(&bytes).map_err(content)?;
        let tensors = SafeTensors::deserialize(&bytes).map_err(|error| content(error.to_string()))?;
        let table = |index: usize, mirrored: bool, frames: usize| -> Result<Features, String> {
            let view = tensors.tensor(&tensor(index, mirrored)).map_err(|error| error.to_string())?;
            if view.dtype() != Dtype::F32 || view.shape() != [frames, WIDTH] {
                return Err(format!(
                    "a table is {:?} of {:?}, not {frames} x {WIDTH} of F32",
                    view.shape(),
                    view.dtype()
                ));
            }
            let (numbers, _) = view.data().as_chunks::<4>();
            Features::new(numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(), WIDTH)
                .map_err(|error| error.to_string())
        };
        let clips = header.clips.into_iter().enumerate().map(|(index, clip)| {
            let features = table(index, false, clip.frames)?;
            let mirrored = table(index, true, clip.frames)?;
            if clip.key_poses.iter().any(|&frame| frame >= clip.frames) {
                return Err("a key pose stands behind the end".to_string());
            }
            Ok(PartClip {
                name: clip.name,
                prepared: Prepared { features, mirrored, key_poses: clip.key_poses },
            })
        });
        let clips = clips.collect::<Result<_, String>>().map_err(content)?;
        Ok(Self { key: header.key, clips, rejected: header.rejected })
    }

    /// What a part was made of, without its numbers; `None` when there is no such part.
    pub(super) fn key_of(path: &Path) -> Option<String> {
        header_of(path).ok().map(|header| header.key)
    }

    /// What a part says of its clips, and those that were left out.
    #[allow(clippy::type_complexity, reason = "two lists, as they stand in the header")]
    pub(super) fn list(
        path: &Path,
    ) -> Result<(Vec<ClipHeader>, Vec<(Option<String>, String, String)>), TrainError> {
        let header = header_of(path)?;
        Ok((header.clips, header.rejected))
    }
}

/// The name of a clip's table.
pub(super) fn tensor(index: usize, mirrored: bool) -> String {
    if mirrored { format!("{index}.mirrored") } else { index.to_string() }
}

fn header_of(path: &Path) -> Result<Header, TrainError> {
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let mut length = [0; 8];
    file.read_exact(&mut length).map_err(failed)?;
    let mut bytes = length.to_vec();
    // What a header says of its length is believed up to the file's end.
    file.take(u64::from_le_bytes(length).min(MOST_BYTES)).read_to_end(&mut bytes).map_err(failed)?;
    parse_header(&bytes).map_err(|what| TrainError::Content { path: path.to_path_buf(), what })
}

fn parse_header(bytes: &[u8]) -> Result<Header, String> {
    #[derive(Deserialize)]
    struct Outer {
        #[serde(rename = "__metadata__")]
        metadata: HashMap<String, String>,
    }
    let (length, rest) = bytes.split_first_chunk::<8>().ok_or("is cut off")?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| "is cut off")?;
    let json = rest.get(..length).ok_or("is cut off")?;
    let outer: Outer = serde_json::from_slice(json).map_err(|_| "is no part of a corpus")?;
    let inner = outer.metadata.get(HEADER).ok_or("is no part of a corpus")?;
    let header: Header = serde_json::from_str(inner).map_err(|error| error.to_string())?;
    if header.version != VERSION {
        return Err(format!(
            "is of version {}, this program makes {VERSION}: build it again",
            header.version
        ));
    }
    Ok(header)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, TrainError> {
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(TrainError::Content { path: path.to_path_buf(), what: "is too large for a part".into() });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_read_as_it_was_written_and_what_is_broken_is_said() {
        let table =
            |from: f32| Features::new((0..3 * WIDTH).map(|i| from + i as f32).collect(), WIDTH).unwrap();
        let prepared = Prepared { features: table(0.0), mirrored: table(5.0), key_poses: vec![1] };
        let part =
            Part::new("k".into(), vec![(Some("Wave".into()), Ok(prepared)), (None, Err(Rejected::Still))]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part");
        let bytes = part.to_bytes().unwrap();
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(Part::read(&path).unwrap(), part);
        assert_eq!(Part::key_of(&path).as_deref(), Some("k"));
        assert_eq!(part.to_bytes().unwrap(), bytes, "the same bytes every time");
        let (clips, rejected) = Part::list(&path).unwrap();
        assert_eq!((clips[0].frames, rejected[0].1.as_str()), (3, "a single pose"));
        for length in [0, 7, 9, 100, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            assert!(Part::read(&path).is_err(), "{length}");
        }
        std::fs::write(&path, [0xff; 64]).unwrap();
        assert!(Part::read(&path).is_err() && Part::key_of(&path).is_none());
    }
}
