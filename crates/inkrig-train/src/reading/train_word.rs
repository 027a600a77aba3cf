//! Teaching the reader of words.

use super::WordSettings;
use super::run::{At, Lesson, OnStep, Task, teach};
use super::words::{WordScore, measure_words, word_examples};
use crate::TrainError;
use crate::figures::Chance;
use crate::lettering::{Case, Font, read_fonts, write_word};
use inkrig_generate::readers::file::Header;
use inkrig_generate::readers::ink::Ink;
use inkrig_generate::readers::network::{Network, Value, Work};
use inkrig_generate::readers::word::{CtcLoss, WordReader, letters, plan};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::VERBS;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A line of `log.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WordRow {
    /// Steps that were taken.
    pub step: u64,
    /// Mean loss since the last line.
    pub loss: f64,
    /// Rate of the last step.
    pub rate: f64,
    /// Share of verbs that are read rightly in held-out fonts.
    pub top_1: f64,
    /// Seconds of training, earlier runs included.
    pub seconds: f64,
}

/// Trains, or goes on with, the run in `folder`, as [`super::train_sketch`] does. Gives the log, what the held-out fonts come to, and
/// whether all steps were taken.
///
/// # Errors
/// When the fonts or the checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be written.
pub fn train_word(
    fonts: &Path,
    folder: &Path,
    settings: &WordSettings,
    threads: usize,
    progress: &mut OnStep<'_, WordRow>,
) -> Result<(Vec<WordRow>, bool), TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let (learned, held_out) = split_fonts(read_fonts(fonts)?, &settings.held_out)?;
    let (plan, letters) = plan();
    let examples = word_examples(&held_out, settings.pace.measured.div_ceil(VERBS.len()), 3);
    let lesson = WordLesson { fonts: learned, settings, letters, examples };
    let header = Header::new("word");
    let task =
        Task { folder, pace: &settings.pace, identity: settings.identity(), header, from: None, threads };
    teach(&lesson, plan, &task, progress)
}

/// Fonts to learn from, and those to measure on: the named ones, or every sixth.
///
/// # Errors
/// When a name is none of a font, or one of the two has none.
pub fn split_fonts(fonts: Vec<Font>, held_out: &[String]) -> Result<(Vec<Font>, Vec<Font>), TrainError> {
    if let Some(name) = held_out.iter().find(|name| fonts.iter().all(|font| font.name != **name)) {
        return Err(TrainError::Device(format!("there is no font {name} to hold out")));
    }
    let (mut learned, mut apart) = (Vec::new(), Vec::new());
    for (at, font) in fonts.into_iter().enumerate() {
        let out = if held_out.is_empty() { at % 6 == 5 } else { held_out.contains(&font.name) };
        if out { apart.push(font) } else { learned.push(font) }
    }
    if learned.is_empty() || apart.is_empty() {
        return Err(TrainError::Device(
            "there are too few fonts: some to learn from, some to hold out".into(),
        ));
    }
    Ok((learned, apart))
}

struct WordLesson<'a> {
    fonts: Vec<Font>,
    settings: &'a WordSettings,
    letters: Value,
    examples: Vec<(usize, Ink)>,
}

impl Lesson for WordLesson<'_> {
    type Row = WordRow;

    fn example(&self, network: &Network, noise: &mut Noise, work: &mut Work, gradient: &mut [f32]) -> f64 {
        let word = if noise.happens(self.settings.known) { known(noise) } else { made_up(noise) };
        let case = noise.pick(&[(Case::Small, 5.0), (Case::First, 1.5), (Case::Large, 2.5)]);
        let font = &self.fonts[noise.below(self.fonts.len())];
        let ink = write_word(&word, case.unwrap_or(Case::Small), font, noise);
        network.forward(&ink.pixels, work);
        let letters = letters(&word);
        let mut loss = CtcLoss::default();
        loss.of(work.value(self.letters), &letters);
        if !loss.loss.is_finite() {
            return 0.0;
        }
        // Long words count as much as short ones.
        let share = 1.0 / letters.len().max(1) as f32;
        loss.gradient.iter_mut().for_each(|part| *part *= share);
        network.backward(work, &[(self.letters, &loss.gradient)], gradient);
        loss.loss * f64::from(share)
    }

    fn measure(&self, network: &Network, at: At) -> (f64, WordRow) {
        let reader = WordReader::of(network.clone(), self.letters);
        let WordScore { top_1, .. } = measure_words(&reader, &self.examples);
        let At { step, loss, rate, seconds } = at;
        (1.0 - top_1, WordRow { step, loss, rate, top_1, seconds })
    }

    fn step_of(row: &WordRow) -> u64 {
        row.step
    }
}

/// A verb or another word for one, half of them as they are often written.
fn known(noise: &mut Noise) -> String {
    let verb = VERBS[noise.below(VERBS.len())];
    let word = if noise.happens(0.6) || verb.words.is_empty() {
        verb.name
    } else {
        verb.words[noise.below(verb.words.len())]
    };
    let ending = noise.pick(&[("", 8.0), ("s", 1.0), ("ing", 1.0)]).unwrap_or("");
    let single = !word.contains(' ') && word.len() < 10;
    if single { format!("{word}{ending}") } else { word.to_string() }
}

/// Letters like those of a word.
fn made_up(noise: &mut Noise) -> String {
    let mut word: Vec<char> = known(noise).chars().collect();
    for _ in 0..1 + noise.below(4) {
        let letter = char::from(b'a' + noise.below(26) as u8);
        let at = noise.below(word.len().max(1));
        match noise.below(4) {
            0 if word.len() > 2 => {
                word.remove(at);
            }
            1 if word.len() < 12 => word.insert(at, letter),
            2 if word.len() > 2 => {
                let other = noise.below(word.len());
                word.swap(at, other);
            }
            _ => word[at] = letter,
        }
    }
    let word: String = word.into_iter().collect();
    let word = word.trim();
    if word.is_empty() { "go".into() } else { word.to_string() }
}
