//! Readers' weights as files: safetensors in half precision, with a header of what they are.

use crate::checkpoint::{CheckpointError, NumberKind, Safetensors, TensorSource};
use crate::weights::Tensors;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::io::{Read, Seek};

/// The name of our header in a file's metadata.
pub(crate) const KEY: &str = "inkrig.reader";

/// What a reader's file says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Of this header's form; 1.
    pub version: u32,
    /// What it reads: `sketch` or `word`.
    pub reads: String,
    /// What it was trained on, and how.
    #[serde(default)]
    pub card: String,
}

impl Header {
    /// Of a kind of reader.
    pub fn new(reads: &str) -> Self {
        Self { version: 1, reads: reads.into(), card: String::new() }
    }
}

/// What a safetensors file says of itself, if it is a reader's.
pub fn header<R: Read + Seek>(file: &Safetensors<R>) -> Option<Header> {
    serde_json::from_str(file.metadata().get(KEY)?).ok()
}

/// A file of half precision numbers.
///
/// # Errors
/// When a number is larger than half precision can say.
pub fn to_bytes(header: &Header, tensors: &Tensors) -> Result<Vec<u8>, CheckpointError> {
    let in_json = |error: serde_json::Error| CheckpointError::Header { what: error.to_string() };
    let mut table = serde_json::Map::new();
    let own = serde_json::to_string(header).map_err(in_json)?;
    table.insert("__metadata__".into(), json!({ "format": "pt", KEY: own }));
    let mut data = Vec::with_capacity(2 * tensors.numbers());
    for (name, tensor) in tensors.iter() {
        let start = data.len();
        for &number in tensor.data() {
            if number.abs() >= 65_520.0 || number.is_nan() {
                let what = format!("{number} is no number of half precision");
                return Err(CheckpointError::tensor(name, what));
            }
            data.extend(NumberKind::half(number).to_le_bytes());
        }
        let described =
            json!({ "dtype": "F16", "shape": tensor.shape(), "data_offsets": [start, data.len()] });
        table.insert(name.into(), described);
    }
    let mut text = serde_json::to_vec(&table).map_err(in_json)?;
    text.resize(text.len().next_multiple_of(8), b' ');
    Ok([&(text.len() as u64).to_le_bytes()[..], &text, &data].concat())
}

/// Reads the weights of a kind of reader.
///
/// # Errors
/// When it is no such file, or damaged.
pub fn read<R: Read + Seek>(file: R, reads: &str) -> Result<(Header, Tensors), CheckpointError> {
    let mut file = Safetensors::open(file)?;
    let header =
        header(&file).filter(|header| header.version == 1 && header.reads == reads).ok_or_else(|| {
            CheckpointError::Unsupported {
                what: format!("this file holds no weights of a reader of kind `{reads}`"),
                todo: "give one that `inkrig train` wrote, or none for the one that comes with the program",
            }
        })?;
    let names: Vec<String> = file.listed().iter().map(|listed| listed.name.clone()).collect();
    let mut tensors = Tensors::new();
    for (at, name) in names.into_iter().enumerate() {
        tensors.insert(name, file.read(at)?);
    }
    Ok((header, tensors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weights::Tensor;
    use std::io::Cursor;

    #[test]
    fn weights_come_back_and_other_files_are_refused() {
        let tensors: Tensors =
            [("a.weight".to_string(), Tensor::new(vec![2, 2], vec![1.0, -0.5, 3.25, 1e-3]).unwrap())]
                .into_iter()
                .collect();
        let header = Header { card: "made of nothing".into(), ..Header::new("sketch") };
        let bytes = to_bytes(&header, &tensors).unwrap();
        let (found, back) = read(Cursor::new(&bytes), "sketch").unwrap();
        assert_eq!(found, header);
        let numbers = back.get("a.weight").unwrap().data();
        assert_eq!(&numbers[..3], [1.0, -0.5, 3.25]);
        assert!((numbers[3] - 1e-3).abs() < 1e-6);
        assert!(read(Cursor::new(&bytes), "word").is_err());
        assert!(read(Cursor::new(&bytes[..bytes.len() - 1]), "sketch").is_err());
        let large = [("a".to_string(), Tensor::new(vec![1], vec![1e6]).unwrap())].into_iter().collect();
        assert!(to_bytes(&header, &large).is_err());
    }
}
