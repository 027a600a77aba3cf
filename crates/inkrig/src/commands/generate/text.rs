//! What makes vectors of words for a model.

use super::about;
use crate::error::CliError;
use crate::inputs;
use inkrig_generate::checkpoint::{CheckpointError, ModelHeader, Safetensors, TensorSource};
use inkrig_generate::configuration::{Configuration, TextEncoderKind};
use inkrig_generate::text::{ClipEncoder, T5Encoder, TextEncoder, VerbTable};
use inkrig_generate::weights::Tensors;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The most of a configuration or a tokenizer that is read, bytes.
const MOST_TEXT: u64 = 64 << 20;

/// The table in the model, or the text model in a folder.
///
/// # Errors
/// When the model needs a folder that is not given, has no use for one, or the folder has not what it needs.
pub(in crate::commands) fn encoder(
    header: &ModelHeader,
    weights: &Tensors,
    folder: Option<&Path>,
    model: &Path,
) -> Result<Box<dyn TextEncoder>, CliError> {
    let width = header.sizes.text_width;
    let needed = || CliError::NoTextModel {
        path: model.into(),
        what: if header.text == TextEncoderKind::Clip { "CLIP ViT-L/14" } else { "Sentence-T5 large" },
    };
    if header.text == TextEncoderKind::Verbs {
        if folder.is_some() {
            return Err(CliError::NoEffect { flag: "--text-model", with: "a model that has its own verbs" });
        }
        let table = VerbTable::new(weights, width).map_err(|cause| about(model, cause))?;
        return Ok(Box::new(table));
    }
    let folder = folder.ok_or_else(needed)?;
    let (config, tokenizer) = (small(&folder.join("config.json"))?, small(&folder.join("tokenizer.json"))?);
    let mut main = open(&folder.join("model.safetensors"))?;
    let wrong = |cause: CheckpointError| CliError::Model { path: folder.into(), cause: Box::new(cause) };
    let encoder: Box<dyn TextEncoder> = if header.text == TextEncoderKind::Clip {
        Box::new(ClipEncoder::load(&config, &tokenizer, &mut [&mut main]).map_err(wrong)?)
    } else {
        // The layer behind the encoder lies in a folder of its own, as it is published, or in the same file.
        let dense = folder.join("2_Dense").join("model.safetensors");
        let mut dense = if dense.exists() { Some(open(&dense)?) } else { None };
        let mut files: Vec<&mut dyn TensorSource> = vec![&mut main];
        files.extend(dense.iter_mut().map(|file| file as &mut dyn TensorSource));
        Box::new(T5Encoder::load(&config, &tokenizer, &mut files, width).map_err(wrong)?)
    };
    Ok(encoder)
}

/// What the encoder is told: a sentence, where the model was trained with sentences.
pub(super) fn description(header: &ModelHeader, configuration: &Configuration, word: &str) -> String {
    match header.text {
        TextEncoderKind::Verbs => word.to_string(),
        _ => configuration.text.template.replace("{word}", word.trim()),
    }
}

fn small(path: &Path) -> Result<String, CliError> {
    let read = |cause| CliError::Read { path: path.into(), cause };
    let mut text = String::new();
    inputs::open_large(path)?.take(MOST_TEXT).read_to_string(&mut text).map_err(read)?;
    Ok(text)
}

fn open(path: &Path) -> Result<Safetensors<File>, CliError> {
    Safetensors::open(inputs::open_large(path)?)
        .map_err(|cause| CliError::Model { path: path.into(), cause: Box::new(cause) })
}
