//! Words for actions, drawn by hand, by a network that reads letters from left to right.
//!
//! The network gives the likelihood of every letter at every place (connectionist temporal classification, Graves et al. 2006). A
//! word of the lexicon is scored by the likelihood of its letters, so that all verbs and their other words can be read, and what is
//! none of them can be told.

mod ctc;
mod letters;

pub use ctc::{CtcLoss, best_path, likelihood};
pub use letters::{ALPHABET, letters, text};

use super::ink::{Ink, Placement};
use super::network::{Network, Plan, Shape, Value, Work};
use crate::GenerateError;
use crate::text::VERBS;
use crate::weights::Tensors;

/// Rows of pixels that the network sees.
pub const HEIGHT: usize = 32;
/// Pixels of a row.
pub const WIDTH: usize = 192;
/// Places where a letter can be.
pub const STEPS: usize = 48;

/// How much likelier than chance a word outside the lexicon has to be before it is read as such; a logarithm.
const UNKNOWN: f64 = 3.0;

/// The network, and the table of letters' scores that it makes: [`STEPS`] x [`ALPHABET`].
pub fn plan() -> (Plan, Value) {
    let mut plan = Plan::new(Shape { height: HEIGHT, width: WIDTH, channels: 1 });
    let mut a = plan.patch("stem", 0, [8, 8], [4, 4], [2, 2], 48);
    for at in 0..2 {
        a = plan.block(&format!("fine.{at}"), a, 5, 96);
    }
    let mut b = plan.patch("down.0", a, [2, 1], [2, 1], [0, 0], 72);
    for at in 0..2 {
        b = plan.block(&format!("middle.{at}"), b, 5, 144);
    }
    let mut c = plan.patch("down.1", b, [4, 1], [4, 1], [0, 0], 128);
    for at in 0..3 {
        c = plan.block(&format!("line.{at}"), c, 7, 256);
    }
    let c = plan.norm("norm", c);
    let letters = plan.linear("letters", c, ALPHABET);
    (plan, letters)
}

/// Reads words.
#[derive(Debug, Clone)]
pub struct WordReader {
    network: Network,
    letters: Value,
    /// Words and phrases, with the verb that each is of.
    lexicon: Vec<(&'static str, &'static str, Vec<usize>)>,
}

/// A word as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct WordReading {
    /// Verbs of the lexicon, the likeliest first: name, word that was found for it, and how likely it is, 0 to 1, beside all others
    /// and a word outside the lexicon.
    pub verbs: Vec<(&'static str, &'static str, f64)>,
    /// The letters as they are, whatever the lexicon says.
    pub letters: String,
    /// How likely it is that the word is none of the lexicon, 0 to 1.
    pub unknown: f64,
}

impl WordReader {
    /// Takes the weights that [`plan`] names.
    ///
    /// # Errors
    /// When one is missing or has another shape.
    pub fn new(tensors: &Tensors) -> Result<Self, GenerateError> {
        let (plan, letters) = plan();
        Ok(Self::of(Network::from_tensors(plan, tensors)?, letters))
    }

    /// Takes a network of [`plan`] as it is.
    pub fn of(network: Network, letters: Value) -> Self {
        let words = VERBS.iter().flat_map(|verb| {
            std::iter::once(verb.name).chain(verb.words.iter().copied()).map(|word| (verb.name, word))
        });
        let lexicon = words.map(|(verb, word)| (verb, word, self::letters(word))).collect();
        Self { network, letters, lexicon }
    }

    /// Reads a line of [`HEIGHT`] x [`WIDTH`] pixels, as [`line()`] makes it.
    pub fn read(&self, line: &Ink, work: &mut Work) -> WordReading {
        self.network.forward(&line.pixels, work);
        let scores = ctc::logarithms(work.value(self.letters));
        let free = best_path(&scores);
        let own = likelihood(&scores, &free);
        let in_lexicon = self.lexicon.iter().any(|(_, _, word)| *word == free);
        // A word outside competes, at a handicap.
        let other = if in_lexicon { f64::NEG_INFINITY } else { own - UNKNOWN };
        let mut verbs: Vec<(&str, &str, f64)> = Vec::new();
        for (verb, word, spelled) in &self.lexicon {
            let score = likelihood(&scores, spelled);
            match verbs.iter_mut().find(|(known, _, _)| known == verb) {
                Some(known) if known.2 >= score => {}
                Some(known) => *known = (verb, word, score),
                None => verbs.push((verb, word, score)),
            }
        }
        let most = verbs.iter().map(|(_, _, score)| *score).fold(other, f64::max);
        let sum: f64 =
            verbs.iter().map(|(_, _, score)| (score - most).exp()).sum::<f64>() + (other - most).exp();
        verbs.iter_mut().for_each(|(_, _, score)| *score = (*score - most).exp() / sum);
        verbs.sort_by(|a, b| b.2.total_cmp(&a.2));
        WordReading { verbs, letters: text(&free), unknown: (other - most).exp() / sum }
    }
}

/// The ink of a page as a line of [`HEIGHT`] x [`WIDTH`] pixels. `None` where there is no ink.
pub fn line(page: &Ink) -> Option<Ink> {
    let crop = super::ink::crop(page, WIDTH, 0.0)?;
    let rows: Vec<bool> =
        crop.ink.pixels.chunks_exact(WIDTH).map(|row| row.iter().any(|pixel| *pixel > 0.2)).collect();
    let top = rows.iter().position(|row| *row)?;
    let tall = rows.iter().rposition(|row| *row)? + 1 - top;
    let placed = fit([WIDTH as f32, tall as f32]);
    let mut line = Ink::new(WIDTH, HEIGHT);
    let scale = 1.0 / placed.scale;
    for (at, pixel) in line.pixels.iter_mut().enumerate() {
        let (x, y) = ((at % WIDTH) as f32 - placed.origin[0], (at / WIDTH) as f32 - placed.origin[1]);
        *pixel = super::ink::mean(&crop.ink, [x * scale, y * scale + top as f32], scale);
    }
    Some(line)
}

/// Where ink of this size (pixels) goes on a line: as high as fits, at the left. The origin is its upper left corner.
pub fn fit(size: [f32; 2]) -> Placement {
    let (wide, high) = (WIDTH as f32 - 6.0, HEIGHT as f32 - 4.0);
    let scale = (wide / size[0].max(1.0)).min(high / size[1].max(1.0));
    Placement { scale, origin: [3.0, 0.5 * (HEIGHT as f32 - scale * size[1])] }
}
