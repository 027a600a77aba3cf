//! CLIP's tokenizer: pairs of letters that are often together are joined, the most frequent first (Sennrich et al. 2016).

use crate::checkpoint::CheckpointError;
use serde::Deserialize;
use std::collections::HashMap;

/// Letters of a description that are read.
const MOST_LETTERS: usize = 4096;
/// Stands at the end of a word.
const END_OF_WORD: &str = "</w>";

/// The pieces, and which two are joined before which.
#[derive(Debug, Clone)]
pub(super) struct BytePairs {
    pieces: HashMap<String, u32>,
    ranks: HashMap<(String, String), usize>,
    start: u32,
    end: u32,
}

#[derive(Deserialize)]
struct File {
    model: Model,
}

#[derive(Deserialize)]
struct Model {
    vocab: HashMap<String, u32>,
    merges: Vec<Pair>,
}

/// Older files have both in one text.
#[derive(Deserialize)]
#[serde(untagged)]
enum Pair {
    Two(String, String),
    One(String),
}

impl BytePairs {
    /// From the text of `tokenizer.json`.
    pub(super) fn read(json: &str) -> Result<Self, CheckpointError> {
        let wrong = |what: String| CheckpointError::Header { what: format!("tokenizer.json: {what}") };
        let File { model } = serde_json::from_str(json).map_err(|error| wrong(error.to_string()))?;
        let special = |name: &str| {
            let missing = || wrong(format!("it has no {name}, so it is not that of CLIP"));
            model.vocab.get(name).copied().ok_or_else(missing)
        };
        let (start, end) = (special("<|startoftext|>")?, special("<|endoftext|>")?);
        let pair = |pair: Pair| match pair {
            Pair::Two(first, second) => Some((first, second)),
            Pair::One(both) => {
                both.split_once(' ').map(|(first, second)| (first.to_owned(), second.to_owned()))
            }
        };
        let ranks =
            model.merges.into_iter().filter_map(pair).enumerate().map(|(rank, pair)| (pair, rank)).collect();
        Ok(Self { pieces: model.vocab, ranks, start, end })
    }

    /// The start's token, those of a description, and the end's, at most so many.
    pub(super) fn tokens(&self, text: &str, most: usize) -> Vec<u32> {
        let text: String = text.chars().take(MOST_LETTERS).flat_map(char::to_lowercase).collect();
        let mut tokens = vec![self.start];
        for word in words(&text) {
            self.split(word, &mut tokens);
        }
        tokens.truncate(most.saturating_sub(1));
        tokens.push(self.end);
        tokens
    }

    fn split(&self, word: &str, tokens: &mut Vec<u32>) {
        let mut parts: Vec<String> = word.bytes().map(|byte| letter(byte).to_string()).collect();
        if let Some(last) = parts.last_mut() {
            last.push_str(END_OF_WORD);
        }
        loop {
            let rank = |pair: &[String]| match pair {
                [first, second] => self.ranks.get(&(first.clone(), second.clone())).copied(),
                _ => None,
            };
            let best = parts.windows(2).enumerate().filter_map(|(at, pair)| Some((rank(pair)?, at))).min();
            let Some((_, at)) = best else { break };
            let second = parts.remove(at + 1);
            parts[at].push_str(&second);
        }
        tokens.extend(parts.iter().map(|part| self.pieces.get(part).copied().unwrap_or(self.end)));
    }
}

/// Words by CLIP's pattern: short endings after an apostrophe, letters in a row, single digits, other signs in a row.
fn words(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let ending =
            ["'s", "'t", "'re", "'ve", "'m", "'ll", "'d"].into_iter().find(|ending| rest.starts_with(ending));
        let other = |letter: char| !letter.is_whitespace() && !letter.is_alphabetic() && !letter.is_numeric();
        let length = |same: &dyn Fn(char) -> bool| rest.find(|letter| !same(letter)).unwrap_or(rest.len());
        let length = match ending {
            Some(ending) => ending.len(),
            None if first.is_alphabetic() => length(&char::is_alphabetic),
            None if other(first) => length(&other),
            None => first.len_utf8(),
        };
        let (word, after) = rest.split_at(length);
        if !first.is_whitespace() {
            found.push(word);
        }
        rest = after;
    }
    found
}

/// The letter that stands for a byte: itself where it can be printed, else one from 256 on.
fn letter(byte: u8) -> char {
    let prints = |byte: u8| matches!(byte, b'!'..=b'~' | 0xa1..=0xac | 0xae..=0xff);
    if prints(byte) {
        return char::from(byte);
    }
    let before = (0..byte).filter(|byte| !prints(*byte)).count() as u32;
    char::from_u32(256 + before).unwrap_or_default()
}
