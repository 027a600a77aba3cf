//! Clips and sounds of a project, read once.

use crate::StudioError;
use crate::document::{ClipEntry, SoundEntry, Up};
use crate::project::{Folder, Kind};
use inkrig_formats::{ClipChoice, FileSource, Format, Import, ImportOptions, UpAxis, read_motion};
use inkrig_sound::Sound;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Most bytes of an upload.
pub const MOST_UPLOAD: usize = 64 << 20;

const MOTIONS: &str =
    "motions are .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .amc (with its .asf), DeepMimic's .txt or .json";

/// What is loaded. Clips of a project never change, so they are read once.
#[derive(Debug, Default)]
pub struct Media {
    clips: Mutex<HashMap<String, (ClipEntry, Arc<Import>)>>,
    sounds: Mutex<HashMap<String, Arc<Sound>>>,
}

impl Media {
    /// A clip of the project.
    ///
    /// # Errors
    /// When its file is not there or is not understood.
    pub fn clip(&self, folder: &Folder, entry: &ClipEntry) -> Result<Arc<Import>, StudioError> {
        let known = lock(&self.clips).get(&entry.id).cloned();
        if let Some((of, import)) = known
            && (ClipEntry { name: entry.name.clone(), ..of }) == *entry
        {
            return Ok(import);
        }
        let bytes = folder.kept(Kind::Clip, &entry.file, MOST_UPLOAD)?;
        let mut beside = HashMap::new();
        for other in &entry.beside {
            beside.insert(other.name.clone(), folder.kept(Kind::Clip, &other.file, MOST_UPLOAD)?);
        }
        let import = Arc::new(read(entry, &bytes, &beside)?);
        self.put(entry, import.clone());
        Ok(import)
    }

    /// Remembers a clip that was read.
    pub fn put(&self, entry: &ClipEntry, import: Arc<Import>) {
        lock(&self.clips).insert(entry.id.clone(), (entry.clone(), import));
    }

    /// Forgets clips and sounds that the project has no longer; they are read again when a step is undone.
    pub fn keep(&self, document: &crate::document::Document) {
        lock(&self.clips).retain(|id, _| document.clip(id).is_some());
        lock(&self.sounds).retain(|id, _| document.sound(id).is_some());
    }

    /// A sound of the project.
    ///
    /// # Errors
    /// As for [`clip`](Self::clip).
    pub fn sound(&self, folder: &Folder, entry: &SoundEntry) -> Result<Arc<Sound>, StudioError> {
        if let Some(sound) = lock(&self.sounds).get(&entry.id) {
            return Ok(sound.clone());
        }
        let bytes = folder.kept(Kind::Sound, &entry.file, MOST_UPLOAD)?;
        let sound = Arc::new(inkrig_sound::decode(&bytes, &extension(&entry.file))?.sound);
        lock(&self.sounds).insert(entry.id.clone(), sound.clone());
        Ok(sound)
    }
}

/// Reads a clip of an upload. `beside` are the files that came with it, by their names.
///
/// # Errors
/// When the name says no known kind, or the file is not understood.
pub fn read(
    entry: &ClipEntry,
    bytes: &[u8],
    beside: &HashMap<String, Vec<u8>>,
) -> Result<Import, StudioError> {
    let format = format_of(&entry.file)?;
    let skeleton = match format {
        Format::Amc | Format::DeepMimic => beside.values().next().cloned(),
        _ => None,
    };
    let take = entry
        .take
        .as_ref()
        .map(|take| take.parse().map_or_else(|_| ClipChoice::Name(take.clone()), ClipChoice::Number));
    let options = ImportOptions {
        metres_per_unit: entry.unit,
        up: entry.up.map(|up| match up {
            Up::Y => UpAxis::Y,
            Up::Z => UpAxis::Z,
        }),
        frame_rate: entry.source_fps,
        skeleton,
        clip: take,
        ..ImportOptions::default()
    };
    let files: FileSource<'_> = &|name, most| match beside.get(name.rsplit('/').next().unwrap_or(name)) {
        Some(bytes) if bytes.len() <= most => Ok(bytes.clone()),
        Some(_) => Err(std::io::Error::other("it is too large")),
        None => Err(std::io::Error::new(
            std::io::ErrorKind::NotFound,
            "drop it on the page together with this file",
        )),
    };
    read_motion(bytes, format, &options, files)
        .map_err(|cause| StudioError::Clip { name: entry.name.clone(), cause: Box::new(cause) })
}

/// The format of a motion by its name.
///
/// # Errors
/// When the name says none.
pub fn format_of(name: &str) -> Result<Format, StudioError> {
    Format::from_extension(&extension(name))
        .ok_or_else(|| StudioError::Kind { name: name.chars().take(80).collect(), known: MOTIONS })
}

/// The ending of a name, in small letters, without its dot.
pub fn extension(name: &str) -> String {
    let ending = Path::new(name).extension().and_then(|ending| ending.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
