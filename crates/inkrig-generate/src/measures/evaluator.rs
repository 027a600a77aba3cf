//! The networks that put motions and texts into one space, where what belongs together is near (Guo et al. 2022).

use crate::GenerateError;
use crate::networks::Linear;
use crate::numeric::normal::{LayerNorm, Normalised};
use crate::weights::Tensors;
use inkrig_motion::humanml::{Blocks, WIDTH};

/// Numbers of an embedding, and of a step of a movement.
const EMBEDDING: usize = 512;
/// Numbers of the recurrent state of motions.
const STATE: usize = 1024;
/// Numbers of a word's vector (GloVe), and of its kind of word.
pub const WORDS: [usize; 2] = [300, 15];
/// What is left of a number below zero.
const LEAK: f32 = 0.2;
/// Taps of a convolution, which goes on by two frames at a time.
const TAPS: usize = 4;

/// The three networks.
#[derive(Debug, Clone)]
pub struct Evaluator {
    convolutions: [Linear; 2],
    movement: Linear,
    motion: Recurrent,
    kind: Linear,
    text: Recurrent,
}

impl Evaluator {
    /// Needs the 42 tensors `t2m_*` of the published state dictionary.
    ///
    /// # Errors
    /// [`GenerateError`] for a tensor that is missing or has another shape.
    pub fn new(weights: &Tensors) -> Result<Self, GenerateError> {
        let convolution = |name: &str, inputs: usize| {
            let name = format!("t2m_moveencoder.main.{name}");
            let weight = weights.expect(&format!("{name}.weight"), &[EMBEDDING, inputs, TAPS])?;
            let bias = weights.expect(&format!("{name}.bias"), &[EMBEDDING])?;
            Ok::<_, GenerateError>(Linear::of(weight, bias, inputs * TAPS))
        };
        Ok(Self {
            convolutions: [convolution("0", Blocks::CONTACTS.start)?, convolution("3", EMBEDDING)?],
            movement: Linear::new(weights, "t2m_moveencoder.out_net", EMBEDDING, EMBEDDING)?,
            motion: Recurrent::new(weights, "t2m_motionencoder", EMBEDDING, STATE)?,
            kind: Linear::new(weights, "t2m_textencoder.pos_emb", WORDS[0], WORDS[1])?,
            text: Recurrent::new(weights, "t2m_textencoder", WORDS[0], EMBEDDING)?,
        })
    }

    /// Where a motion lies: 512 numbers. `features` has frames x 263, normalised by the evaluator's own statistics; contacts are not
    /// looked at. Four frames make a step, and what is left over does not count.
    ///
    /// # Errors
    /// [`GenerateError::Rows`] for fewer than four frames, more than 10,000, or a broken row.
    pub fn motion(&self, features: &[f32]) -> Result<Vec<f32>, GenerateError> {
        Ok(self.motion_of_steps(&self.movement(features)?))
    }

    /// Where a motion lies whose steps are known: whole rows of 512 numbers. The published code makes steps of the padding too, and
    /// then leaves out what lies beyond the length.
    pub fn motion_of_steps(&self, steps: &[f32]) -> Vec<f32> {
        self.motion.run(steps)
    }

    /// The steps of a motion, 512 numbers each.
    ///
    /// # Errors
    /// As [`Self::motion`].
    pub fn movement(&self, features: &[f32]) -> Result<Vec<f32>, GenerateError> {
        const MOST: usize = 10_000;
        let (frames, rest) = (features.len() / WIDTH, features.len() % WIDTH);
        if rest != 0 || !(TAPS..=MOST).contains(&frames) {
            let (what, numbers) = ("features, of which four frames are the fewest", features.len());
            return Err(GenerateError::Rows { what, numbers, width: WIDTH, most: MOST });
        }
        let frames = frames / TAPS * TAPS;
        let mut rows: Vec<f32> = features
            .chunks_exact(WIDTH)
            .take(frames)
            .flat_map(|row| &row[..Blocks::CONTACTS.start])
            .copied()
            .collect();
        for (convolution, width) in self.convolutions.iter().zip([Blocks::CONTACTS.start, EMBEDDING]) {
            rows = convolution.apply(&windows(&rows, width));
            leak(&mut rows);
        }
        Ok(self.movement.apply(&rows))
    }

    /// Where a text lies: 512 numbers. `words` has 300 numbers a word, `kinds` 15 (one of them 1).
    ///
    /// # Errors
    /// [`GenerateError::Rows`] for no word, more than 1,000, or a broken row, [`GenerateError::Length`] when there are not as many
    /// kinds.
    pub fn text(&self, words: &[f32], kinds: &[f32]) -> Result<Vec<f32>, GenerateError> {
        const MOST: usize = 1_000;
        let [width, kind_width] = WORDS;
        let count = words.len() / width;
        if !words.len().is_multiple_of(width) || !(1..=MOST).contains(&count) {
            return Err(GenerateError::Rows { what: "words", numbers: words.len(), width, most: MOST });
        }
        if kinds.len() != count * kind_width {
            let (expected, got) = (count * kind_width, kinds.len());
            return Err(GenerateError::Length { what: "table of kinds of words", expected, got });
        }
        let mut rows = self.kind.apply(kinds);
        for (row, word) in rows.iter_mut().zip(words) {
            *row += word;
        }
        Ok(self.text.run(&rows))
    }
}

/// What a convolution sees at every second row: four rows from the one before it, zeros beyond the ends, channel by channel.
fn windows(rows: &[f32], width: usize) -> Vec<f32> {
    let rows: Vec<&[f32]> = rows.chunks_exact(width).collect();
    let steps = rows.len() / 2;
    let mut out = vec![0.0; steps * width * TAPS];
    for (step, out) in out.chunks_exact_mut(width * TAPS).enumerate() {
        for tap in 0..TAPS {
            let row = (2 * step + tap).checked_sub(1).and_then(|row| rows.get(row));
            for (channel, value) in row.into_iter().flat_map(|row| row.iter().enumerate()) {
                out[channel * TAPS + tap] = *value;
            }
        }
    }
    out
}

fn leak(rows: &mut [f32]) {
    for value in rows {
        *value = value.max(LEAK * *value);
    }
}

/// Reads a sequence forwards and backwards, and makes an embedding of both last states.
#[derive(Debug, Clone)]
struct Recurrent {
    input: Linear,
    ways: [Gated; 2],
    first: Linear,
    norm: LayerNorm,
    last: Linear,
}

impl Recurrent {
    fn new(weights: &Tensors, name: &str, width: usize, state: usize) -> Result<Self, GenerateError> {
        let starts = weights.expect(&format!("{name}.hidden"), &[2, 1, state])?;
        let (forwards, backwards) = starts.split_at(state);
        let way = |ending: &str, start: &[f32]| {
            let layer = |kind: &str| {
                let weight =
                    weights.expect(&format!("{name}.gru.weight_{kind}_l0{ending}"), &[3 * state, state])?;
                let bias = weights.expect(&format!("{name}.gru.bias_{kind}_l0{ending}"), &[3 * state])?;
                Ok::<_, GenerateError>(Linear::of(weight, bias, state))
            };
            Ok::<_, GenerateError>(Gated { input: layer("ih")?, state: layer("hh")?, start: start.to_vec() })
        };
        let output = |at: usize| format!("{name}.output_net.{at}");
        Ok(Self {
            input: Linear::new(weights, &format!("{name}.input_emb"), state, width)?,
            ways: [way("", forwards)?, way("_reverse", backwards)?],
            first: Linear::new(weights, &output(0), state, 2 * state)?,
            norm: LayerNorm::new(weights, &output(1), state)?,
            last: Linear::new(weights, &output(3), EMBEDDING, state)?,
        })
    }

    fn run(&self, rows: &[f32]) -> Vec<f32> {
        let rows = self.input.apply(rows);
        let [forwards, backwards] = &self.ways;
        let mut states = forwards.run(&rows, false);
        states.extend(backwards.run(&rows, true));
        let mut hidden = self.first.apply(&states);
        self.norm.forward(&mut hidden, &mut Normalised::default());
        leak(&mut hidden);
        self.last.apply(&hidden)
    }
}

/// Gated recurrent units (Cho et al. 2014), in PyTorch's order: reset, update, new.
#[derive(Debug, Clone)]
struct Gated {
    input: Linear,
    state: Linear,
    start: Vec<f32>,
}

impl Gated {
    /// The last state.
    fn run(&self, rows: &[f32], backwards: bool) -> Vec<f32> {
        let size = self.start.len();
        let inputs = self.input.apply(rows);
        let steps = inputs.chunks_exact(3 * size);
        let mut state = self.start.clone();
        let mut step = |input: &[f32]| {
            let own = self.state.apply(&state);
            for (at, value) in state.iter_mut().enumerate() {
                let gate = |gate: usize| sigmoid(input[gate * size + at] + own[gate * size + at]);
                let (reset, update) = (gate(0), gate(1));
                let new = (input[2 * size + at] + reset * own[2 * size + at]).tanh();
                *value = (1.0 - update) * new + update * *value;
            }
        };
        if backwards {
            steps.rev().for_each(&mut step);
        } else {
            steps.for_each(&mut step);
        }
        state
    }
}

fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}
