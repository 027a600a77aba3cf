//! Our own model files.

use super::header::ModelHeader;
use super::number::to_half;
use super::safetensors::Safetensors;
use super::source::{Listed, TensorSource};
use super::{CheckpointError, NumberKind};
use crate::weights::{Tensor, Tensors};
use serde_json::json;
use sha2::{Digest, Sha256};
use std::io::{Read, Seek, SeekFrom, Write};

/// The name of our header in a file's metadata.
const KEY: &str = "inkrig.model";
/// Hexadecimal digits of a checksum.
const DIGITS: usize = 64;

/// A model file whose header has been read.
#[derive(Debug)]
pub struct ModelFile<R> {
    file: Safetensors<R>,
    header: ModelHeader,
}

impl<R: Read + Seek> ModelFile<R> {
    /// Reads the header; no tensor yet.
    ///
    /// # Errors
    /// [`CheckpointError`] when it is no safetensors file, is damaged, or has no header of ours.
    pub fn open(file: R) -> Result<Self, CheckpointError> {
        let file = Safetensors::open(file)?;
        let no_header = || {
            if file.metadata().contains_key(crate::readers::file::KEY) {
                return CheckpointError::Unsupported {
                    what: "these are weights of a reader of drawings".into(),
                    todo: "give a model that makes motions",
                };
            }
            CheckpointError::Unsupported {
                what: "this safetensors file is no model of ours: it says nothing of itself".into(),
                todo: "make one of it by inkrig model import",
            }
        };
        let header = file.metadata().get(KEY).ok_or_else(no_header)?;
        let header: ModelHeader = serde_json::from_str(header)
            .map_err(|error| CheckpointError::Header { what: error.to_string() })?;
        header.check()?;
        Ok(Self { file, header })
    }

    /// Whether a safetensors file has a header of ours, be it a good one or not.
    pub fn is_of(file: &Safetensors<R>) -> bool {
        file.metadata().contains_key(KEY)
    }

    /// What it says of itself.
    pub fn header(&self) -> &ModelHeader {
        &self.header
    }

    /// Whether it can be used by itself; else it has only the weights in which it differs from another model.
    pub fn is_whole(&self) -> bool {
        self.header.laid_over.is_none() && self.listed().iter().any(|tensor| tensor.name.starts_with("vae."))
    }

    /// What it consists of.
    pub fn listed(&self) -> &[Listed] {
        self.file.listed()
    }

    /// All weights, in single precision.
    ///
    /// # Errors
    /// [`CheckpointError`] when a tensor is damaged, or all of them are not what the checksum was made of.
    pub fn tensors(&mut self) -> Result<Tensors, CheckpointError> {
        let mut hash = Sha256::new();
        let mut tensors = Tensors::new();
        for at in 0..self.file.listed().len() {
            let name = self.file.listed()[at].name.clone();
            tensors.insert(name, self.file.read_with(at, |piece| hash.update(piece))?);
        }
        if hex(&hash.finalize()) != self.header.sha256 {
            return Err(CheckpointError::damaged("the checksum of the weights is not the one in the header"));
        }
        Ok(tensors)
    }
}

/// Writes a model file: the tensors of `listed`, which `next` gives by their places, in that order, and in their kinds (single or
/// half precision). Gives back the header with its checksum, which stands in the file.
///
/// # Errors
/// [`CheckpointError`] when the header does not fit, a tensor has another shape than it was listed with, or the file cannot be
/// written. What was written then is no whole file.
pub fn write_model<W: Write + Seek>(
    mut out: W,
    header: &ModelHeader,
    listed: &[Listed],
    mut next: impl FnMut(usize) -> Result<Tensor, CheckpointError>,
) -> Result<ModelHeader, CheckpointError> {
    header.check()?;
    let mut header = ModelHeader { sha256: "0".repeat(DIGITS), ..header.clone() };
    let before = head(&header, listed)?;
    let start = out.stream_position()?;
    out.write_all(&before)?;
    let mut hash = Sha256::new();
    let mut bytes = Vec::new();
    for (at, listed) in listed.iter().enumerate() {
        let tensor = next(at)?;
        if tensor.shape() != listed.shape {
            let what = format!("its shape is {:?}, not {:?}", tensor.shape(), listed.shape);
            return Err(CheckpointError::tensor(&listed.name, what));
        }
        bytes.clear();
        encode(listed, tensor.data(), &mut bytes)?;
        hash.update(&bytes);
        out.write_all(&bytes)?;
    }
    header.sha256 = hex(&hash.finalize());
    let after = head(&header, listed)?;
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(start))?;
    out.write_all(&after)?;
    out.seek(SeekFrom::Start(end))?;
    out.flush()?;
    Ok(header)
}

/// The part of the file before the tensors: it is as long with any checksum.
fn head(header: &ModelHeader, listed: &[Listed]) -> Result<Vec<u8>, CheckpointError> {
    let in_json = |error: serde_json::Error| CheckpointError::Header { what: error.to_string() };
    let mut table = serde_json::Map::new();
    let own = serde_json::to_string(header).map_err(in_json)?;
    table.insert("__metadata__".into(), json!({ "format": "pt", KEY: own }));
    let mut at = 0_u64;
    for tensor in listed {
        let dtype = if tensor.kind == NumberKind::F16 { "F16" } else { "F32" };
        let end = at + tensor.numbers() as u64 * tensor.kind.size() as u64;
        table.insert(
            tensor.name.clone(),
            json!({ "dtype": dtype, "shape": tensor.shape, "data_offsets": [at, end] }),
        );
        at = end;
    }
    let mut text = serde_json::to_vec(&table).map_err(in_json)?;
    text.resize(text.len().next_multiple_of(8), b' ');
    Ok([&(text.len() as u64).to_le_bytes()[..], &text].concat())
}

fn encode(listed: &Listed, numbers: &[f32], out: &mut Vec<u8>) -> Result<(), CheckpointError> {
    match listed.kind {
        NumberKind::F32 => out.extend(numbers.iter().flat_map(|number| number.to_le_bytes())),
        NumberKind::F16 => {
            let largest = numbers.iter().fold(0.0_f32, |largest, number| largest.max(number.abs()));
            if largest >= 65_520.0 {
                let what =
                    format!("{largest} is more than half precision can say: write it in single precision");
                return Err(CheckpointError::tensor(&listed.name, what));
            }
            out.extend(numbers.iter().flat_map(|&number| to_half(number).to_le_bytes()));
        }
        _ => {
            return Err(CheckpointError::tensor(&listed.name, "is written in single or half precision only"));
        }
    }
    Ok(())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
