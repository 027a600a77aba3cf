//! What can be done to a document. A list of commands is one step that can be undone.

use super::{ClipRole, Control, Document, Key, Settings, Source, check};
use crate::StudioError;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "type", rename_all = "camelCase")]
pub enum Command {
    /// Calls the project something else.
    SetName {
        /// The name.
        name: String,
    },
    /// Arranges other clips.
    SetSource {
        /// Which.
        source: Source,
    },
    /// Follows something else, or nothing.
    SetControl {
        /// What.
        control: Option<Control>,
    },
    /// Other settings, all of them.
    SetSettings {
        /// What is left out has its default.
        settings: Settings,
    },
    /// The page's own.
    SetPage {
        /// An object.
        #[schema(value_type = Object)]
        page: serde_json::Value,
    },
    /// A new key, or another one of the same id.
    PutKey {
        /// The key.
        key: Key,
    },
    /// No longer this key.
    RemoveKey {
        /// Its id.
        id: String,
    },
    /// All keys.
    SetKeys {
        /// In order.
        keys: Vec<Key>,
    },
    /// Calls a clip something else.
    RenameClip {
        /// Its id.
        id: String,
        /// Its name.
        name: String,
    },
    /// No longer this clip, nor what refers to it.
    RemoveClip {
        /// Its id.
        id: String,
    },
    /// No longer this sound.
    RemoveSound {
        /// Its id.
        id: String,
    },
    /// An empty drawing: no control, no keys.
    Clear,
}

impl Document {
    /// Does what a command says.
    ///
    /// # Errors
    /// When it refers to what is not there, or the document becomes too large. The document may have changed then: apply to a
    /// copy.
    pub fn apply(&mut self, command: Command) -> Result<(), StudioError> {
        match command {
            Command::SetName { name } => self.name = name,
            Command::SetSource { source } => self.source = source,
            Command::SetControl { control } => self.control = control,
            Command::SetSettings { settings } => self.settings = settings,
            Command::SetPage { page } => self.page = page,
            Command::PutKey { key } => match self.keys.iter_mut().find(|other| other.id == key.id) {
                Some(slot) => *slot = key,
                None => self.keys.push(key),
            },
            Command::RemoveKey { id } => {
                let count = self.keys.len();
                self.keys.retain(|key| key.id != id);
                if self.keys.len() == count {
                    return Err(StudioError::unknown("key", &id));
                }
            }
            Command::SetKeys { keys } => self.keys = keys,
            Command::RenameClip { id, name } => {
                let clip = self.clips.iter_mut().find(|clip| clip.id == id);
                clip.ok_or_else(|| StudioError::unknown("clip", &id))?.name = name;
            }
            Command::RemoveClip { id } => self.remove_clip(&id)?,
            Command::RemoveSound { id } => {
                self.sound(&id).ok_or_else(|| StudioError::unknown("sound", &id))?;
                self.sounds.retain(|sound| sound.id != id);
                if matches!(&self.control, Some(Control::Sound { sound, .. }) if *sound == id) {
                    self.control = None;
                }
            }
            Command::Clear => {
                self.control = None;
                self.keys.clear();
                self.clips.retain(|clip| clip.role != ClipRole::Locked);
            }
        }
        check::document(self)
    }

    fn remove_clip(&mut self, id: &str) -> Result<(), StudioError> {
        self.clip(id).ok_or_else(|| StudioError::unknown("clip", id))?;
        self.clips.retain(|clip| clip.id != id);
        self.source.clips.retain(|clip| clip != id);
        self.keys.retain(|key| {
            key.pose.as_ref().is_none_or(|pose| pose.clip != id)
                && key.fixed.as_ref().is_none_or(|fixed| fixed.clip != id)
        });
        if matches!(&self.control, Some(Control::Motion { clip }) if clip == id) {
            self.control = None;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{ClipEntry, KeyKind, PoseRef};

    fn with_clip() -> Document {
        let clip = ClipEntry {
            id: "c1".into(),
            name: "walk".into(),
            file: "c1-walk.bvh".into(),
            ..Default::default()
        };
        let source = Source { clips: vec!["c1".into()], ..Source::default() };
        Document { clips: vec![clip], source, ..Document::default() }
    }

    fn key(id: &str) -> Key {
        let pose = Some(PoseRef { clip: "c1".into(), frame: 3 });
        Key {
            id: id.into(),
            enabled: true,
            kind: KeyKind::Never,
            place: None,
            pose,
            weight: None,
            distance: None,
            radius: None,
            fixed: None,
        }
    }

    #[test]
    fn a_clip_takes_along_what_refers_to_it() {
        let mut document = with_clip();
        document.apply(Command::PutKey { key: key("k1") }).unwrap();
        document.apply(Command::SetControl { control: Some(Control::Motion { clip: "c1".into() }) }).unwrap();
        document.apply(Command::RemoveClip { id: "c1".into() }).unwrap();
        assert_eq!(document, Document::default());
    }

    #[test]
    fn a_key_is_replaced_by_its_id() {
        let mut document = with_clip();
        document.apply(Command::PutKey { key: key("k1") }).unwrap();
        document.apply(Command::PutKey { key: Key { enabled: false, ..key("k1") } }).unwrap();
        assert_eq!(document.keys, [Key { enabled: false, ..key("k1") }]);
        assert!(document.apply(Command::RemoveKey { id: "k2".into() }).is_err());
    }

    #[test]
    fn what_is_not_there_cannot_be_arranged() {
        let mut document = with_clip();
        let source = Source { clips: vec!["c7".into()], ..Source::default() };
        let error = document.apply(Command::SetSource { source }).unwrap_err();
        assert!(error.to_string().contains("c7"), "{error}");
    }
}
