//! Files that come into the project: motions with their companions, sounds, drawings, and what was made of a storyboard.

use super::{Applied, Studio, lock};
use crate::StudioError;
use crate::document::{Beside, ClipEntry, ClipRole, Command, Document, SoundEntry, Source, Up};
use crate::engine::drawings;
use crate::engine::media;
use crate::project::Kind;
use inkrig_formats::{Import, Severity};
use serde::Deserialize;
use std::collections::{HashMap, VecDeque};
use std::path::Path;
use std::sync::Arc;
use utoipa::ToSchema;

/// Companion files that wait for the file that they belong to.
const MOST_UPLOADS: usize = 8;

#[derive(Debug, Default)]
pub(super) struct Uploads {
    next: u64,
    kept: VecDeque<(String, String, Vec<u8>)>,
}

/// How an upload is read.
#[derive(Debug, Clone, Default, Deserialize, ToSchema, utoipa::IntoParams)]
#[serde(rename_all = "camelCase", default)]
#[into_params(parameter_in = Query)]
pub struct UploadOptions {
    /// The file's name; its ending says what it is.
    pub name: String,
    /// Which clip of a file that has several, by name or number from 1.
    pub take: Option<String>,
    /// Metres in one unit of the file.
    pub unit: Option<f64>,
    /// The axis that points up in the file.
    pub up: Option<Up>,
    /// Frames a second of the file.
    pub source_fps: Option<f64>,
    /// Ids of companion files, with commas between.
    pub beside: Option<String>,
}

impl Studio {
    /// Keeps a companion file until the file comes that it belongs to.
    pub fn keep_upload(&self, name: &str, bytes: Vec<u8>) -> String {
        let mut uploads = lock(&self.uploads);
        uploads.next += 1;
        let id = format!("u{}", uploads.next);
        uploads.kept.push_back((id.clone(), name.to_string(), bytes));
        while uploads.kept.len() > MOST_UPLOADS {
            uploads.kept.pop_front();
        }
        id
    }

    /// Adds a motion; the first one is arranged. Returns it as it was read.
    ///
    /// # Errors
    /// When the file is not understood.
    pub fn add_clip(
        &self,
        bytes: &[u8],
        options: &UploadOptions,
    ) -> Result<(ClipEntry, Arc<Import>, Applied), StudioError> {
        self.add_clip_as("Add", bytes, options, |document, id| {
            if document.source.clips.is_empty() {
                document.source.clips.push(id);
            }
        })
    }

    /// Adds what was made of a storyboard, and shows it as it is: it alone is arranged, and follows nothing. Returns its id.
    ///
    /// The clip takes the place of the one that was made `before`, so that trying things out does not fill the list. That one
    /// stays where something else depends on it: a drawing that it is arranged for, clips that it is arranged with, a key with a pose
    /// of it. Undo brings it back: files of clips are never deleted.
    pub(crate) fn add_made(&self, title: &str, bvh: &[u8], before: &str) -> Result<String, StudioError> {
        let title = if title.trim().is_empty() { "Storyboard" } else { title.trim() };
        let options = UploadOptions { name: format!("{title}.bvh"), ..UploadOptions::default() };
        let (entry, ..) = self.add_clip_as("Make", bvh, &options, |document, id| {
            replace(document, before, &id);
            document.source = Source { clips: vec![id], ..Source::default() };
            document.control = None;
        })?;
        Ok(entry.id)
    }

    fn add_clip_as(
        &self,
        verb: &str,
        bytes: &[u8],
        options: &UploadOptions,
        then: impl FnOnce(&mut Document, String),
    ) -> Result<(ClipEntry, Arc<Import>, Applied), StudioError> {
        let mut beside = HashMap::new();
        for id in options.beside.iter().flat_map(|ids| ids.split(',')).filter(|id| !id.is_empty()) {
            let uploads = lock(&self.uploads);
            let kept = uploads.kept.iter().find(|kept| kept.0 == id);
            let (_, name, bytes) = kept.ok_or_else(|| StudioError::unknown("upload", id))?;
            beside.insert(name.rsplit(['/', '\\']).next().unwrap_or(name).to_string(), bytes.clone());
        }
        let stem = Path::new(&options.name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let name = match &options.take {
            Some(take) if take.parse::<usize>().is_err() => take.clone(),
            _ => stem.unwrap_or_default(),
        };
        let mut entry = ClipEntry {
            id: String::new(),
            name: name.chars().take(200).collect(),
            file: options.name.clone(),
            take: options.take.clone(),
            role: ClipRole::Motion,
            unit: options.unit,
            up: options.up,
            source_fps: options.source_fps,
            beside: Vec::new(),
        };
        let import = Arc::new(media::read(&entry, bytes, &beside)?);
        let mut project = self.project();
        let folder = project.folder().clone();
        entry.id = project.new_id('c')?;
        entry.file = folder.keep(Kind::Clip, &entry.id, &options.name, bytes)?;
        for (name, bytes) in beside {
            let file = folder.keep(Kind::Clip, &entry.id, &name, &bytes)?;
            entry.beside.push(Beside { name, file });
        }
        entry.beside.sort_by(|a, b| a.name.cmp(&b.name));
        self.media.put(&entry, import.clone());
        let label = format!("{verb} {}", entry.name);
        project.change(&label, None, |document| {
            document.clips.push(entry.clone());
            then(document, entry.id.clone());
            Ok(())
        })?;
        let applied = self.tell(project, true);
        Ok((entry, import, applied))
    }

    /// Adds a sound.
    ///
    /// # Errors
    /// When the file is not understood.
    pub fn add_sound(&self, name: &str, bytes: &[u8]) -> Result<(SoundEntry, Applied), StudioError> {
        // Before anything is kept.
        inkrig_sound::decode(bytes, &media::extension(name))?;
        let mut project = self.project();
        let id = project.new_id('s')?;
        let file = project.folder().keep(Kind::Sound, &id, name, bytes)?;
        let stem = Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let entry = SoundEntry { id, name: stem.unwrap_or_default().chars().take(200).collect(), file };
        let label = format!("Add {}", entry.name);
        let kept = entry.clone();
        project.change(&label, None, |document| {
            document.sounds.push(kept);
            Ok(())
        })?;
        let applied = self.tell(project, true);
        Ok((entry, applied))
    }

    /// Of a project in which nothing was ever done: begins with a sample, as if it had always been there.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn begin_with(&self, sample: &str) -> Result<(), StudioError> {
        let sample = inkrig_samples::find(sample).ok_or_else(|| StudioError::unknown("sample", sample))?;
        let history = self.project().history();
        if history.undo.is_empty()
            && history.redo.is_empty()
            && self.project().document() == &Document::default()
        {
            let options = UploadOptions { name: sample.file_name.into(), ..UploadOptions::default() };
            self.add_clip(sample.bytes, &options)?;
            self.project().forget_history()?;
        }
        Ok(())
    }

    /// Adds a motion, a sound, or a drawing, which is followed then. Returns what is odd in it.
    ///
    /// # Errors
    /// When its name says no known kind, or it is not understood.
    pub fn add_file(&self, name: &str, bytes: &[u8]) -> Result<Vec<String>, StudioError> {
        match media::extension(name).as_str() {
            "svg" | "csv" => {
                let (control, note) = drawings::read(bytes, name, drawings::As::Curve)?;
                let control = Some(control);
                self.commands(&format!("Follow {name}"), None, vec![Command::SetControl { control }])?;
                Ok(note.into_iter().collect())
            }
            "wav" | "mp3" | "ogg" | "flac" => self.add_sound(name, bytes).map(|_| Vec::new()),
            _ => {
                let options = UploadOptions { name: name.into(), ..UploadOptions::default() };
                let (_, import, _) = self.add_clip(bytes, &options)?;
                let warnings = import.findings.iter().filter(|finding| finding.severity == Severity::Warning);
                Ok(warnings.map(|finding| finding.message.clone()).collect())
            }
        }
    }
}

/// Puts the clip `fresh` in the place of the clip `old`, if that is there and nothing depends on it.
fn replace(document: &mut Document, old: &str, fresh: &str) {
    let arranged = &document.source.clips;
    let solved = arranged.iter().any(|id| id == old) && (document.control.is_some() || arranged.len() > 1);
    let keyed = document.keys.iter().any(|key| {
        key.pose.as_ref().is_some_and(|pose| pose.clip == old)
            || key.fixed.as_ref().is_some_and(|fixed| fixed.clip == old)
    });
    let place = |id: &str| document.clips.iter().position(|clip| clip.id == id);
    if let (false, false, Some(at), Some(from)) = (solved, keyed, place(old), place(fresh))
        && at != from
    {
        let clip = document.clips.remove(from);
        document.clips[at] = clip;
    }
}

#[cfg(test)]
mod tests {
    use super::replace;
    use crate::document::Document;
    use serde_json::{Value, json};

    /// Clips of a document in which `fresh` has come last and is to replace `old`.
    fn clips(more: &Value) -> Vec<String> {
        let clip = |id: &str| json!({"id": id, "name": id, "file": "a.bvh"});
        let clips: Vec<Value> = ["other", "old", "third", "fresh"].into_iter().map(clip).collect();
        let mut document = json!({"clips": clips});
        for (key, value) in more.as_object().unwrap() {
            document[key] = value.clone();
        }
        let mut document: Document = serde_json::from_value(document).unwrap();
        replace(&mut document, "old", "fresh");
        document.clips.into_iter().map(|clip| clip.id).collect()
    }

    #[test]
    fn a_clip_is_replaced_where_nothing_depends_on_it() {
        let (replaced, beside) = (["other", "fresh", "third"], ["other", "old", "third", "fresh"]);
        let key = |of: Value| {
            let mut key = json!({"id": "k", "kind": "fixed"});
            key.as_object_mut().unwrap().extend(of.as_object().unwrap().clone());
            json!({"keys": [key]})
        };
        let pose = |clip: &str| key(json!({"kind": "soft", "pose": {"clip": clip, "frame": 3}}));
        let fixed = |clip: &str| key(json!({"fixed": {"clip": clip, "from": 0.0, "to": 1.0}}));
        let source = |clips: &[&str]| json!({"source": {"clips": clips, "range": null, "laps": 1}});
        for (more, expected) in [
            (json!({}), &replaced[..]),
            // It alone is arranged, and nothing is followed: the new one is shown in its place.
            (source(&["old"]), &replaced),
            (source(&["other", "third"]), &replaced),
            (source(&["old", "third"]), &beside),
            (pose("old"), &beside),
            (pose("third"), &replaced),
            (fixed("old"), &beside),
            (fixed("other"), &replaced),
        ] {
            assert_eq!(clips(&more), expected, "{more}");
        }
    }
}
