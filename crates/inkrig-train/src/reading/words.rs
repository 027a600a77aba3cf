//! How well words are read.

use crate::figures::Chance;
use crate::lettering::{Case, Font, write_word};
use inkrig_generate::readers::ink::Ink;
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::word::WordReader;
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::VERBS;
use serde::{Deserialize, Serialize};

/// Words that are none of the lexicon, and short as its words are.
const OTHERS: [&str; 16] = [
    "table", "window", "seven", "garden", "paper", "orange", "music", "river", "chapter", "blue", "monday",
    "engine", "quiet", "forest", "budget", "pixel",
];

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WordScore {
    /// Words.
    pub words: usize,
    /// Share of verbs that come first, 0 to 1.
    pub top_1: f64,
    /// Share of those among the first three.
    pub top_3: f64,
    /// Share of words outside the lexicon that are said to be so.
    pub unknown_told: f64,
    /// Share of verbs that are taken for a word outside.
    pub known_refused: f64,
}

/// Every verb, and every word that is none, so many times, each in one of the fonts. The number is the verb's; that of others is larger.
pub fn word_examples(fonts: &[Font], rounds: usize, seed: u64) -> Vec<(usize, Ink)> {
    let words = || VERBS.iter().map(|verb| verb.name).chain(OTHERS);
    let mut examples = Vec::new();
    for round in 0..rounds {
        for (number, word) in words().enumerate() {
            let at = (round * (VERBS.len() + OTHERS.len()) + number) as u64;
            let mut noise = Noise::new(seed.wrapping_mul(0x9FB2_1C65_1E98_DF25).wrapping_add(at));
            noise.uniform();
            let case = noise.pick(&[(Case::Small, 5.0), (Case::First, 1.5), (Case::Large, 2.5)]);
            let Some(font) = fonts.get(noise.below(fonts.len())) else { continue };
            examples.push((number, write_word(word, case.unwrap_or(Case::Small), font, &mut noise)));
        }
    }
    examples
}

/// Measures a reader.
pub fn measure_words(reader: &WordReader, examples: &[(usize, Ink)]) -> WordScore {
    let mut work = Work::default();
    let (mut known, mut first, mut three, mut refused, mut told) = (0, 0, 0, 0, 0);
    for (number, ink) in examples {
        let reading = reader.read(ink, &mut work);
        let best = reading.verbs.first().map_or(0.0, |verb| verb.2);
        let outside = reading.unknown > best;
        let Some(verb) = VERBS.get(*number) else {
            told += usize::from(outside);
            continue;
        };
        known += 1;
        let place = reading.verbs.iter().position(|(name, _, _)| *name == verb.name);
        first += usize::from(place == Some(0));
        three += usize::from(place.is_some_and(|place| place < 3));
        refused += usize::from(outside);
    }
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    WordScore {
        words: examples.len(),
        top_1: share(first, known),
        top_3: share(three, known),
        unknown_told: share(told, examples.len() - known),
        known_refused: share(refused, known),
    }
}
