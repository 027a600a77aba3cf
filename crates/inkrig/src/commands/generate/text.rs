//! What makes vectors of words for a model.

use super::about;
use crate::error::CliError;
use crate::{inputs, printable};
use inkrig_generate::checkpoint::{CheckpointError, ModelHeader, Safetensors, TensorSource};
use inkrig_generate::configuration::{Configuration, TextEncoderKind};
use inkrig_generate::text::{ClipEncoder, T5Encoder, TextEncoder, VERBS, VerbTable, actions_in};
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

/// Words that nobody expects to count.
const LITTLE: [&str; 22] = [
    "a", "an", "and", "are", "at", "he", "her", "his", "is", "it", "man", "of", "on", "person", "she",
    "somebody", "someone", "the", "their", "then", "to", "woman",
];

/// Which words counted, where some did not: a model of verbs knows nothing else.
pub(super) fn left_out(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split_whitespace().take(100).collect();
    let all = actions_in(&words.join(" "));
    let plain = |word: &str| word.trim_matches(|letter: char| !letter.is_alphanumeric()).to_lowercase();
    // A word of an action's own phrase, such as down of sit down, counts even where the action is known without it.
    let in_phrase = |word: &str| {
        let actions = all.iter().filter_map(|verb| VERBS.get(*verb));
        let mut phrases =
            actions.flat_map(|verb| std::iter::once(verb.name).chain(verb.words.iter().copied()));
        phrases.any(|phrase| phrase.split(' ').any(|own| own == plain(word)))
    };
    let counts = |at: usize| {
        let without: Vec<&str> =
            words.iter().enumerate().filter(|own| own.0 != at).map(|own| *own.1).collect();
        words.get(at).is_some_and(|word| !actions_in(word).is_empty() || in_phrase(word))
            || actions_in(&without.join(" ")) != all
    };
    let left: Vec<&str> = words.iter().enumerate().filter(|own| !counts(own.0)).map(|own| *own.1).collect();
    let left: Vec<&str> = left
        .into_iter()
        .filter(|word| !LITTLE.contains(&plain(word).as_str()) && !plain(word).is_empty())
        .collect();
    let names: Vec<&str> = all.iter().filter_map(|verb| Some(VERBS.get(*verb)?.name)).collect();
    (!left.is_empty() && !names.is_empty()).then(|| {
        format!(
            "what counted: {}; the model knows nothing of: {}",
            names.join(", "),
            printable::text(left.join(", "))
        )
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_do_not_count_are_named() {
        let backwards = left_out("walk backwards").unwrap();
        assert!(backwards.contains("counted: walk;") && backwards.ends_with("of: backwards"), "{backwards}");
        assert!(left_out("do not kick").unwrap().ends_with("of: do, not"));
        for good in ["walk", "walk and walk", "a person is walking, then jumps", "sit down", "sit ups", ""] {
            assert_eq!(left_out(good), None, "{good}");
        }
    }
}
