//! The pieces of a document that a step of the history keeps: only those that the step changed.

use super::{ClipEntry, Control, Document, Key, Settings, SoundEntry, Source};
use serde::{Deserialize, Serialize};

/// One piece of a document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "part", content = "value", rename_all = "camelCase")]
pub enum Part {
    /// [`Document::name`]
    Name(String),
    /// [`Document::clips`]
    Clips(Vec<ClipEntry>),
    /// [`Document::sounds`]
    Sounds(Vec<SoundEntry>),
    /// [`Document::source`]
    Source(Source),
    /// [`Document::control`]
    Control(Option<Control>),
    /// [`Document::keys`]
    Keys(Vec<Key>),
    /// [`Document::settings`]
    Settings(Settings),
    /// [`Document::page`]
    Page(serde_json::Value),
}

impl Document {
    /// The pieces of this document that are other than in `after`.
    pub fn changed_parts(&self, after: &Self) -> Vec<Part> {
        let mut parts = Vec::new();
        let mut add = |changed: bool, part: &dyn Fn() -> Part| {
            if changed {
                parts.push(part());
            }
        };
        add(self.name != after.name, &|| Part::Name(self.name.clone()));
        add(self.clips != after.clips, &|| Part::Clips(self.clips.clone()));
        add(self.sounds != after.sounds, &|| Part::Sounds(self.sounds.clone()));
        add(self.source != after.source, &|| Part::Source(self.source.clone()));
        add(self.control != after.control, &|| Part::Control(self.control.clone()));
        add(self.keys != after.keys, &|| Part::Keys(self.keys.clone()));
        add(self.settings != after.settings, &|| Part::Settings(self.settings.clone()));
        add(self.page != after.page, &|| Part::Page(self.page.clone()));
        parts
    }

    /// Puts a piece in; gives back the one that was there.
    pub fn put(&mut self, part: Part) -> Part {
        use std::mem::replace;
        match part {
            Part::Name(value) => Part::Name(replace(&mut self.name, value)),
            Part::Clips(value) => Part::Clips(replace(&mut self.clips, value)),
            Part::Sounds(value) => Part::Sounds(replace(&mut self.sounds, value)),
            Part::Source(value) => Part::Source(replace(&mut self.source, value)),
            Part::Control(value) => Part::Control(replace(&mut self.control, value)),
            Part::Keys(value) => Part::Keys(replace(&mut self.keys, value)),
            Part::Settings(value) => Part::Settings(replace(&mut self.settings, value)),
            Part::Page(value) => Part::Page(replace(&mut self.page, value)),
        }
    }
}

impl Part {
    /// Whether two are the same piece, of whatever value.
    pub fn same_piece(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_change_bring_the_document_back() {
        let before = Document::default();
        let control = Some(Control::Wave { expression: "sine(1Hz)".into() });
        let after =
            Document { name: "walk".into(), control, page: serde_json::json!({"a": 1}), ..before.clone() };
        let parts = before.changed_parts(&after);
        assert_eq!(parts.len(), 3);
        let mut document = after.clone();
        let back: Vec<Part> = parts.into_iter().map(|part| document.put(part)).collect();
        assert_eq!(document, before);
        back.into_iter().for_each(|part| {
            document.put(part);
        });
        assert_eq!(document, after);
    }
}
