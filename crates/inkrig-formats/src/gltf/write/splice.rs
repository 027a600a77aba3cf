//! Changes to a document that leave every other letter of it as it is.

use super::super::{bounded::BoundedMap, damaged};
use crate::FormatError;
use serde_json::{Value, value::RawValue};

/// An object whose values are text.
pub(super) struct Object<'j>(Vec<(String, Text<'j>)>);

#[derive(Clone)]
enum Text<'j> {
    Old(&'j str),
    New(String),
}

impl Text<'_> {
    fn as_str(&self) -> &str {
        match self {
            Self::Old(text) => text,
            Self::New(text) => text,
        }
    }
}

impl<'j> Object<'j> {
    pub(super) fn parse(json: &'j str) -> Result<Self, FormatError> {
        let map: BoundedMap<&RawValue, 4096> =
            serde_json::from_str(json).map_err(|error| unreadable(&error))?;
        Ok(Self(map.0.into_iter().map(|(name, value)| (name, Text::Old(value.get()))).collect()))
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(other, _)| other == name).map(|(_, text)| text.as_str())
    }

    /// The elements of a list, none when it is not there.
    pub(super) fn list(&self, name: &str) -> Result<Vec<&str>, FormatError> {
        let list: Vec<&RawValue> = match self.get(name) {
            Some(text) => serde_json::from_str(text).map_err(|error| unreadable(&error))?,
            None => Vec::new(),
        };
        Ok(list.into_iter().map(RawValue::get).collect())
    }

    /// Puts a value in the place of what was there, or at the end.
    pub(super) fn set(&mut self, name: &str, value: String) {
        match self.0.iter_mut().find(|(other, _)| other == name) {
            Some((_, text)) => *text = Text::New(value),
            None => self.0.push((name.into(), Text::New(value))),
        }
    }

    pub(super) fn remove(&mut self, name: &str) {
        self.0.retain(|(other, _)| other != name);
    }

    /// Adds elements to the end of a list.
    pub(super) fn extend_list(&mut self, name: &str, more: &[Value]) -> Result<(), FormatError> {
        let more: Vec<String> = more.iter().map(Value::to_string).collect();
        let mut elements = self.list(name)?;
        elements.extend(more.iter().map(String::as_str));
        let text = list_text(&elements);
        self.set(name, text);
        Ok(())
    }

    pub(super) fn text(&self) -> String {
        let entry =
            |(name, text): &(String, Text<'_>)| format!("{}:{}", Value::from(name.as_str()), text.as_str());
        let entries: Vec<String> = self.0.iter().map(entry).collect();
        format!("{{{}}}", entries.join(","))
    }
}

pub(super) fn list_text(elements: &[&str]) -> String {
    format!("[{}]", elements.join(","))
}

fn unreadable(error: &serde_json::Error) -> FormatError {
    let hint = "the file is damaged; export it again";
    damaged("gltf-json", "the JSON", crate::finding::clean(&error.to_string(), 160), hint)
}
