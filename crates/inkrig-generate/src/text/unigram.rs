//! T5's tokenizer: the pieces of a word that are together the likeliest (Kudo 2018).

use crate::checkpoint::CheckpointError;
use serde::Deserialize;
use std::collections::HashMap;

/// Stands for a space, at the beginning of a word.
const SPACE: char = '\u{2581}';
/// How much less likely than the least likely piece an unknown letter is.
const UNKNOWN: f64 = 10.0;
/// Letters of a description that are read.
const MOST_LETTERS: usize = 4096;

/// The pieces with the logarithms of their probabilities.
#[derive(Debug, Clone)]
pub(super) struct Unigram {
    pieces: HashMap<String, (u32, f64)>,
    longest: usize,
    unknown: (u32, f64),
    end: u32,
    strips: bool,
}

#[derive(Deserialize)]
struct File {
    model: Model,
    #[serde(default)]
    normalizer: serde_json::Value,
}

#[derive(Deserialize)]
struct Model {
    vocab: Vec<(String, f64)>,
    unk_id: Option<u32>,
}

impl Unigram {
    /// From the text of `tokenizer.json`. Of its rules for letters only those for spaces are kept: letters beyond ASCII that it would
    /// replace count as unknown.
    pub(super) fn read(json: &str) -> Result<Self, CheckpointError> {
        let wrong = |what: String| CheckpointError::Header { what: format!("tokenizer.json: {what}") };
        let file: File = serde_json::from_str(json).map_err(|error| wrong(error.to_string()))?;
        let end = file.model.vocab.iter().position(|(piece, _)| piece == "</s>");
        let end = end.ok_or_else(|| wrong("it has no </s>, so it is not that of T5".into()))?;
        let least = file.model.vocab.iter().map(|(_, score)| *score).fold(0.0, f64::min);
        let longest = file.model.vocab.iter().map(|(piece, _)| piece.chars().count()).max().unwrap_or(0);
        let strips = file.normalizer.to_string().contains("\"Strip\"");
        let unknown = (file.model.unk_id.unwrap_or(2), least - UNKNOWN);
        let pieces =
            file.model.vocab.into_iter().enumerate().map(|(id, (piece, score))| (piece, (id as u32, score)));
        // A hostile file shall not make every step of the search long.
        Ok(Self { pieces: pieces.collect(), longest: longest.min(64), unknown, end: end as u32, strips })
    }

    /// The tokens of a description and the end's, at most so many.
    pub(super) fn tokens(&self, text: &str, most: usize) -> Vec<u32> {
        let mut spaced = String::new();
        for letter in text.chars().take(MOST_LETTERS) {
            let letter = if letter.is_whitespace() { SPACE } else { letter };
            if letter != SPACE || !spaced.ends_with(SPACE) {
                spaced.push(letter);
            }
        }
        if self.strips {
            spaced = spaced.trim_matches(SPACE).to_owned();
        }
        if !spaced.is_empty() && !spaced.starts_with(SPACE) {
            spaced.insert(0, SPACE);
        }
        let mut tokens = Vec::new();
        for word in spaced.split(SPACE).skip(1) {
            let mut letters = vec![SPACE];
            letters.extend(word.chars());
            self.split(&letters, &mut tokens);
        }
        tokens.truncate(most.saturating_sub(1));
        tokens.push(self.end);
        tokens
    }

    /// The likeliest pieces of one word (Viterbi's search).
    fn split(&self, letters: &[char], tokens: &mut Vec<u32>) {
        // For every place the best way to it: its score, the last piece and where that begins.
        let mut best: Vec<Option<(f64, u32, usize)>> = vec![None; letters.len() + 1];
        best[0] = Some((0.0, 0, 0));
        for start in 0..letters.len() {
            let Some((so_far, ..)) = best[start] else { continue };
            let mut offer = |end: usize, id: u32, score: f64| {
                if best[end].is_none_or(|(before, ..)| so_far + score > before) {
                    best[end] = Some((so_far + score, id, start));
                }
            };
            let mut piece = String::new();
            let mut single = false;
            for (end, letter) in letters.iter().enumerate().skip(start).take(self.longest) {
                piece.push(*letter);
                if let Some(&(id, score)) = self.pieces.get(&piece) {
                    single |= end == start;
                    offer(end + 1, id, score);
                }
            }
            if !single {
                offer(start + 1, self.unknown.0, self.unknown.1);
            }
        }
        let mut found = Vec::new();
        let mut at = letters.len();
        while let Some((_, id, start)) = best[at].filter(|_| at > 0) {
            // Unknown letters in a row are one token.
            if id != self.unknown.0 || found.last() != Some(&id) {
                found.push(id);
            }
            at = start;
        }
        tokens.extend(found.into_iter().rev());
    }
}
