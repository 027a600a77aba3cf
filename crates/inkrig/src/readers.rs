//! Where the readers of drawings get their weights.

use crate::error::CliError;
use crate::inputs;
use inkrig_generate::readers::file::read;
use inkrig_generate::readers::sketch::SketchReader;
use inkrig_generate::readers::word::WordReader;
use inkrig_generate::weights::Tensors;
use inkrig_generate::{CheckpointError, GenerateError};
use std::path::{Path, PathBuf};

/// The reader of figures: of given weights, or of those that lie beside the program. `None` where there are none.
///
/// # Errors
/// When the weights cannot be read or are of something else.
pub(crate) fn sketch(weights: Option<&Path>) -> Result<Option<SketchReader>, CliError> {
    tensors(weights, "sketch")?.map(|(path, tensors)| made(&path, SketchReader::new(&tensors))).transpose()
}

/// The reader of words; as [`sketch`].
///
/// # Errors
/// As for [`sketch`].
pub(crate) fn word(weights: Option<&Path>) -> Result<Option<WordReader>, CliError> {
    tensors(weights, "word")?.map(|(path, tensors)| made(&path, WordReader::new(&tensors))).transpose()
}

fn made<T>(path: &Path, reader: Result<T, GenerateError>) -> Result<T, CliError> {
    reader.map_err(|cause| CliError::Generate { path: path.to_path_buf(), cause: Box::new(cause) })
}

fn tensors(weights: Option<&Path>, kind: &str) -> Result<Option<(PathBuf, Tensors)>, CliError> {
    let Some(path) = weights.map(Path::to_path_buf).or_else(|| beside(kind)) else { return Ok(None) };
    let failed = |cause: CheckpointError| CliError::Model { path: path.clone(), cause: Box::new(cause) };
    let file = inputs::open_large(&path)?;
    let (_, tensors) = read(file, kind).map_err(failed)?;
    Ok(Some((path, tensors)))
}

/// `models/KIND-reader.safetensors` beside the program, or in the folder of one above it.
fn beside(kind: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let name = format!("models/{kind}-reader.safetensors");
    program.ancestors().skip(1).take(4).map(|folder| folder.join(&name)).find(|path| path.is_file())
}
