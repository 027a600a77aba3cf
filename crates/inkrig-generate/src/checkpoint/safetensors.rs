//! Files of tensors with a JSON header: safetensors.

use super::bytes::Bytes;
use super::error::shown;
use super::source::{Listed, TensorSource, check_size, finished};
use super::{CheckpointError, NumberKind};
use crate::weights::Tensor;
use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::io::{Read, Seek};

/// Bytes of a header: a model's has about two hundred thousand.
const MOST_HEADER: u64 = 16 << 20;
/// Tensors of a file.
const MOST_TENSORS: usize = 65_536;
/// Axes of a tensor.
const MOST_AXES: usize = 8;

/// A safetensors file.
#[derive(Debug)]
pub struct Safetensors<R> {
    bytes: Bytes<R>,
    listed: Vec<Listed>,
    starts: Vec<u64>,
    metadata: BTreeMap<String, String>,
}

impl<R: Read + Seek> Safetensors<R> {
    /// Reads and checks the header. Tensors are listed in the order in which they lie in the file.
    ///
    /// # Errors
    /// [`CheckpointError`] when the header is larger than 16 MiB, no JSON, names anything twice, or describes other bytes than
    /// those that are there: they have to fill the file without gaps and without overlapping.
    pub fn open(file: R) -> Result<Self, CheckpointError> {
        let mut bytes = Bytes::new(file)?;
        let length = bytes.part(0, 8, "the length of the header")?;
        let length = length.as_chunks().0.first().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        if length > MOST_HEADER {
            // In any other file these eight bytes are no length, and no table follows.
            if bytes.length() > 8 && bytes.part(8, 1, "the header")? != b"{" {
                return Err(CheckpointError::Unsupported {
                    what: "this is no safetensors file".into(),
                    todo: "give one that inkrig train, inkrig model import or inkrig model pack wrote",
                });
            }
            return Err(CheckpointError::TooMuch {
                what: "bytes in the header".into(),
                got: length,
                most: MOST_HEADER,
            });
        }
        let header = bytes.part(8, length, "the header")?;
        let header: Header = serde_json::from_slice(&header).map_err(|error| in_header(&error))?;
        let data = 8 + length;
        let mut tensors = Vec::with_capacity(header.tensors.len());
        for (name, described) in header.tensors {
            let [start, end] = described.data_offsets;
            tensors.push((start, end, described.listed(name)?));
        }
        tensors.sort_by(|a, b| (a.0, a.1, &a.2.name).cmp(&(b.0, b.1, &b.2.name)));
        let (mut listed, mut starts, mut next) = (Vec::new(), Vec::new(), 0);
        for (start, end, tensor) in tensors {
            let length = end.checked_sub(start);
            let needed = (tensor.numbers() as u64).checked_mul(tensor.kind.size() as u64);
            if start != next || length.is_none() || length != needed {
                let what =
                    format!("bytes {start} to {end} do not follow the one before, or do not fill its shape");
                return Err(CheckpointError::tensor(&tensor.name, what));
            }
            next = end;
            starts.push(data + start);
            listed.push(tensor);
        }
        if data.checked_add(next) != Some(bytes.length()) {
            let (there, said) = (bytes.length() - data, next);
            return Err(CheckpointError::damaged(format!(
                "{said} bytes of tensors are promised, {there} are there"
            )));
        }
        Ok(Self { bytes, listed, starts, metadata: header.metadata })
    }

    /// Texts that the file carries beside its tensors.
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.metadata
    }

    /// One tensor; what it is made of is shown to `each`, in order.
    pub(super) fn read_with(
        &mut self,
        at: usize,
        mut each: impl FnMut(&[u8]),
    ) -> Result<Tensor, CheckpointError> {
        let (Some(listed), Some(&start)) = (self.listed.get(at), self.starts.get(at)) else {
            return Err(CheckpointError::damaged(format!("there is no tensor number {at}")));
        };
        check_size(listed)?;
        let mut data = Vec::with_capacity(listed.numbers());
        let length = (listed.numbers() * listed.kind.size()) as u64;
        self.bytes.pieces(start, length, "a tensor", |piece| {
            each(piece);
            listed.kind.decode(piece, &mut data);
        })?;
        finished(listed, data)
    }
}

impl<R: Read + Seek> TensorSource for Safetensors<R> {
    fn listed(&self) -> &[Listed] {
        &self.listed
    }

    fn read(&mut self, at: usize) -> Result<Tensor, CheckpointError> {
        self.read_with(at, |_| ())
    }
}

/// What the JSON says.
struct Header {
    metadata: BTreeMap<String, String>,
    tensors: BTreeMap<String, Described>,
}

#[derive(Deserialize)]
struct Described {
    dtype: String,
    shape: Vec<usize>,
    data_offsets: [u64; 2],
}

impl Described {
    fn listed(self, name: String) -> Result<Listed, CheckpointError> {
        let kind = NumberKind::of_safetensors(&self.dtype);
        let unknown = || {
            CheckpointError::tensor(
                &name,
                format!("its numbers are of the unknown kind {}", shown(&self.dtype)),
            )
        };
        let kind = kind.ok_or_else(unknown)?;
        let numbers = self.shape.iter().try_fold(1_usize, |numbers, &length| numbers.checked_mul(length));
        if self.shape.len() > MOST_AXES || numbers.is_none() {
            return Err(CheckpointError::tensor(&name, "its shape has too many axes, or too long ones"));
        }
        Ok(Listed { name, shape: self.shape, kind })
    }
}

impl<'de> Deserialize<'de> for Header {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(HeaderVisitor)
    }
}

struct HeaderVisitor;

impl<'de> Visitor<'de> for HeaderVisitor {
    type Value = Header;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a table of tensors")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Header, M::Error> {
        let (mut metadata, mut tensors) = (None, BTreeMap::new());
        while let Some(key) = map.next_key::<String>()? {
            if key == "__metadata__" {
                let before = metadata.replace(map.next_value::<Texts>()?);
                if before.is_some() {
                    return Err(M::Error::custom("__metadata__ is there twice"));
                }
                continue;
            }
            if tensors.len() >= MOST_TENSORS {
                return Err(M::Error::custom(format!("there are more than {MOST_TENSORS} tensors")));
            }
            let described = map.next_value::<Described>()?;
            if tensors.contains_key(&key) {
                return Err(M::Error::custom(format!("the tensor {} is there twice", shown(&key))));
            }
            tensors.insert(key, described);
        }
        Ok(Header { metadata: metadata.unwrap_or_default().0, tensors })
    }
}

/// Texts by name. `null` and other values are passed over.
#[derive(Default)]
struct Texts(BTreeMap<String, String>);

impl<'de> Deserialize<'de> for Texts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TextsVisitor;
        impl<'de> Visitor<'de> for TextsVisitor {
            type Value = Texts;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("texts by name")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Texts, M::Error> {
                let mut texts = BTreeMap::new();
                while let Some((key, value)) = map.next_entry::<String, TextOrNot>()? {
                    if let TextOrNot::Text(text) = value
                        && texts.insert(key.clone(), text).is_some()
                    {
                        return Err(M::Error::custom(format!("the text {} is there twice", shown(&key))));
                    }
                }
                Ok(Texts(texts))
            }
        }
        deserializer.deserialize_map(TextsVisitor)
    }
}

#[derive(Deserialize)]
#[serde(untagged)]
enum TextOrNot {
    Text(String),
    Not(IgnoredAny),
}

fn in_header(error: &serde_json::Error) -> CheckpointError {
    CheckpointError::Header { what: error.to_string() }
}
