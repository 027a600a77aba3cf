//! Where the readers of drawings get their weights.

use crate::error::CliError;
use crate::inputs;
use crate::shipped::{SKETCH, Shipped, WORD};
use inkrig_generate::readers::file::read;
use inkrig_generate::readers::sketch::SketchReader;
use inkrig_generate::readers::word::WordReader;
use inkrig_generate::weights::Tensors;
use inkrig_generate::{CheckpointError, GenerateError};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The reader of figures: of given weights, or of those that come inside the program.
///
/// # Errors
/// When the weights cannot be read or are of something else.
pub(crate) fn sketch(weights: Option<&Path>) -> Result<SketchReader, CliError> {
    let (path, tensors) = tensors(weights, SKETCH, "sketch")?;
    made(&path, SketchReader::new(&tensors))
}

/// The reader of words; as [`sketch`].
///
/// # Errors
/// As for [`sketch`].
pub(crate) fn word(weights: Option<&Path>) -> Result<WordReader, CliError> {
    let (path, tensors) = tensors(weights, WORD, "word")?;
    made(&path, WordReader::new(&tensors))
}

fn made<T>(path: &Path, reader: Result<T, GenerateError>) -> Result<T, CliError> {
    reader.map_err(|cause| CliError::Generate { path: path.to_path_buf(), cause: Box::new(cause) })
}

/// Those of a file, or those that come inside the program.
fn tensors(weights: Option<&Path>, shipped: Shipped, kind: &str) -> Result<(PathBuf, Tensors), CliError> {
    let path = weights.map_or_else(|| shipped.path(), Path::to_path_buf);
    let failed = |cause: CheckpointError| CliError::Model { path: path.clone(), cause: Box::new(cause) };
    let (_, tensors) = if weights.is_some() {
        read(inputs::open_large(&path)?, kind).map_err(failed)?
    } else {
        inputs::note(&path, shipped.bytes)?;
        read(Cursor::new(shipped.bytes), kind).map_err(failed)?
    };
    Ok((path, tensors))
}
