//! Labels as files: one a frame in CSV, frames or segments in JSON.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::{LabelLength, Labels, LabelsBuilder, Refusal};
use crate::read::csv::{Stop, each_row};
use crate::table::{field_count, located, text_of};
use crate::{Format, SketchError};

const WHAT: &str = "labels";

/// Reads labels from the bytes of a file.
///
/// CSV has one label for each frame. A first row with a field `label` or `labels` is a header, and that column is read;
/// without one there is a single column. Empty lines are left out; `#` begins a comment line. JSON is an array, alone or under the key `labels`, of
/// names, one for each frame, and of segments `{"name": "walk", "frames": 30}` or `{"name": "walk", "seconds": 1.5}`.
///
/// # Errors
/// Any [`SketchError`] that says what the file holds and where; the errors of [`Labels::new`]. SVG is refused with
/// [`SketchError::NotFromSvg`].
pub fn read_labels(bytes: &[u8], format: Format) -> Result<Labels, SketchError> {
    if format == Format::Svg {
        return Err(SketchError::NotFromSvg { what: "a row of labels" });
    }
    let text = text_of(bytes, WHAT)?;
    if format == Format::Json { from_json(text) } else { from_csv(text) }
}

fn from_csv(text: &str) -> Result<Labels, SketchError> {
    let mut builder = LabelsBuilder::default();
    let mut column = None;
    each_row(text, &SketchError::TooManySegments, |row| {
        let at = match column {
            Some(at) => at,
            None => {
                let header = row.iter().position(is_header);
                column = Some(header.unwrap_or(0));
                match header {
                    Some(_) => return Ok(()),
                    None if field_count(row) > 1 => {
                        let problem =
                            "a row is one label; name the column `label` in a header if there are more";
                        return Err(Stop::At(2, problem.into()));
                    }
                    None => 0,
                }
            }
        };
        builder.push_frame(row.get(at).unwrap_or_default()).map_err(|refusal| match refusal {
            Refusal::Full(error) => Stop::Whole(error),
            Refusal::Name(expected) | Refusal::Length(expected) => {
                Stop::At(at + 1, format!("{expected} is expected"))
            }
        })
    })?;
    builder.finish()
}

fn is_header(field: &str) -> bool {
    field.eq_ignore_ascii_case("label") || field.eq_ignore_ascii_case("labels")
}

fn from_json(text: &str) -> Result<Labels, SketchError> {
    if text.trim().is_empty() {
        return Err(SketchError::NoLabels);
    }
    let mut reader = Reader::default();
    let mut json = serde_json::Deserializer::from_str(text);
    let read = json.deserialize_any(Document(&mut reader)).and_then(|()| json.end());
    match (read, reader.full) {
        (Ok(()), _) => reader.builder.finish(),
        (Err(_), Some(error)) => Err(error),
        (Err(error), None) => Err(located(&error, text, "label", reader.items)),
    }
}

#[derive(Default)]
struct Reader {
    builder: LabelsBuilder,
    items: usize,
    /// What made the file too large.
    full: Option<SketchError>,
}

impl Reader {
    /// Without a length the label is that of one frame.
    fn push<E: Error>(&mut self, name: &str, length: Option<LabelLength>) -> Result<(), E> {
        let pushed = match length {
            Some(length) => self.builder.push(name, length),
            None => self.builder.push_frame(name),
        };
        pushed.map_err(|refusal| match refusal {
            Refusal::Full(error) => {
                self.full = Some(error);
                E::custom("too many labels")
            }
            Refusal::Name(expected) | Refusal::Length(expected) => {
                E::custom(format!("{expected} is expected"))
            }
        })?;
        self.items += 1;
        Ok(())
    }
}

/// The whole file: labels, or an object that holds them.
struct Document<'a>(&'a mut Reader);

impl<'de> Visitor<'de> for Document<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .write_str("[\"walk\", ...], [{\"name\": \"walk\", \"frames\": 30}, ...] or {\"labels\": [...]}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<(), A::Error> {
        Items(self.0).visit_seq(seq)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut found = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "labels" if found => return Err(A::Error::custom("a second \"labels\"")),
                "labels" => {
                    found = true;
                    map.next_value_seed(Items(self.0))?;
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        if found { Ok(()) } else { Err(A::Error::custom("the object has no \"labels\"")) }
    }
}

/// An array of labels.
struct Items<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Items<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Items<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array of labels")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while seq.next_element_seed(Item(&mut *self.0))?.is_some() {}
        Ok(())
    }
}

/// One frame's name, or a segment.
struct Item<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Item<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Item<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a name, or {\"name\": .., \"frames\": ..}, or {\"name\": .., \"seconds\": ..}")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<(), E> {
        self.0.push(name, None)
    }

    /// Numbers are names too: motion by numbers.
    fn visit_u64<E: Error>(self, name: u64) -> Result<(), E> {
        self.0.push(&name.to_string(), None)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let (mut name, mut length) = (None::<String>, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "name" | "label" => name = Some(map.next_value()?),
                "frames" | "seconds" if length.is_some() => {
                    return Err(A::Error::custom("a segment has one length: frames or seconds"));
                }
                "frames" => length = Some(LabelLength::Frames(map.next_value()?)),
                "seconds" => length = Some(LabelLength::Seconds(map.next_value()?)),
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        let Some(name) = name else { return Err(A::Error::custom("the segment has no \"name\"")) };
        if length.is_none() {
            return Err(A::Error::custom("the segment has neither \"frames\" nor \"seconds\""));
        }
        self.0.push(&name, length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        for (text, format) in [
            ("A\nA\nB b\nA\n", Format::Csv),
            ("Label\r\nA\r\nA\r\nB b\r\nA", Format::Csv),
            ("frame,label\n0,A\n1,A\n2,B b\n3,A\n", Format::Csv),
            ("# note\n\"A\"\n\"A\"\n\"B b\"\n\"A\"\n", Format::Csv),
            ("[\"A\", \"A\", \"B b\", \"A\"]", Format::Json),
            (
                "{\"by\": [1], \"labels\": [\"A\", \"A\", \"B b\", {\"frames\": 1, \"name\": \"A\"}]}",
                Format::Json,
            ),
        ] {
            let labels = read_labels(text.as_bytes(), format).unwrap();
            assert_eq!(labels.to_string(), "A:2 \"B b\":1 A:1", "{text}");
        }
        let numbers = read_labels(b"[3, 3, 12]", Format::Json).unwrap();
        assert_eq!(numbers.to_string(), "3:2 12:1");
        let seconds =
            read_labels(b"[{\"name\":\"a\",\"seconds\":2},{\"label\":\"b\",\"seconds\":0.5}]", Format::Json);
        assert_eq!(seconds.unwrap().to_string(), "a:2s b:0.5s");
    }
}
