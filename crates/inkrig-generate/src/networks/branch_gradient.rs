//! Denoiser, ControlNet and adapter on batches, forwards and back to their weights and to what they were given.

use super::block::{Layout, WeightGradients};
use super::branch::Branch;
use super::dropout::Dropout;
use super::embedding::timestep_waves;
use super::stack::{Residuals, SideGradients, StackTape};
use crate::numeric::elementwise::{add, relu};
use crate::numeric::fit;
use crate::schedule::STEPS;

/// Samples of a batch, one after the other. Each has a timestep of its own.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// Samples x latent tokens x width.
    pub latents: &'a [f32],
    /// One for each sample, from 0 to 999.
    pub timesteps: &'a [usize],
    /// Samples x text width.
    pub texts: &'a [f32],
    /// The waves of each sample's guidance weight, samples x guidance width, for networks that are distilled.
    pub guidance: Option<&'a [f32]>,
}

/// The waves of all timesteps, worked out once.
#[derive(Debug, Clone)]
pub struct WaveTable {
    width: usize,
    rows: Vec<f32>,
}

impl WaveTable {
    /// For networks with text vectors of this width.
    pub fn new(width: usize) -> Self {
        Self { width, rows: (0..STEPS).flat_map(|step| timestep_waves(step, width)).collect() }
    }

    fn of(&self, timestep: usize) -> &[f32] {
        &self.rows[timestep.min(STEPS - 1) * self.width..][..self.width]
    }
}

/// What the way back needs of a batch, and buffers.
#[derive(Debug)]
pub(crate) struct BranchTape {
    stack: StackTape,
    lengths: Vec<usize>,
    /// What went into the layers of text and time.
    texts: Vec<f32>,
    waves: Vec<f32>,
    hidden: Vec<f32>,
    active: Vec<f32>,
}

impl BranchTape {
    /// For weights that are learned.
    pub(crate) fn for_learning() -> Self {
        Self::of(StackTape::for_learning())
    }

    /// For weights that stay, where only what goes in has gradients.
    pub(crate) fn for_inputs() -> Self {
        Self::of(StackTape::default())
    }

    fn of(stack: StackTape) -> Self {
        let (lengths, texts, waves, hidden, active) = Default::default();
        Self { stack, lengths, texts, waves, hidden, active }
    }

    /// What the next forward pass drops.
    pub(crate) fn set_dropout(&mut self, dropout: Option<Dropout>) {
        self.stack.set_dropout(dropout);
    }
}

/// Gradients of what a branch was given.
#[derive(Debug, Default)]
pub(crate) struct InputGradients {
    /// Samples x latent tokens x width.
    pub(crate) latents: Vec<f32>,
    /// Samples x text width.
    pub(crate) texts: Vec<f32>,
}

impl Branch {
    /// What comes out of the last block, samples x (latent tokens + 2) x width; what comes out of each goes into `outputs`. Numbers
    /// that do not fit each other are the caller's mistake.
    pub(crate) fn forward_batch(
        &self,
        samples: &Samples<'_>,
        waves: &WaveTable,
        corrections: Option<&Residuals>,
        outputs: Option<&mut Residuals>,
        tape: &mut BranchTape,
    ) -> Vec<f32> {
        let width = self.sizes.width;
        let latent = self.sizes.latent_tokens * width;
        let count = samples.timesteps.len();
        tape.texts.clear();
        tape.texts.extend_from_slice(samples.texts);
        relu(&mut tape.texts);
        let texts = self.text.apply(&tape.texts);
        tape.waves.clear();
        samples.timesteps.iter().for_each(|&step| tape.waves.extend_from_slice(waves.of(step)));
        if let (Some(projection), Some(guidance)) = (&self.time.guidance, samples.guidance) {
            add(&mut tape.waves, &projection.apply(guidance));
        }
        self.time.first.forward(&tape.waves, fit(&mut tape.hidden, count * width));
        tape.active.clear();
        tape.active.extend(tape.hidden.iter().map(|x| x * sigmoid(*x)));
        let times = self.time.second.apply(&tape.active);
        let tokens = latent + 2 * width;
        let mut x = Vec::with_capacity(count * tokens);
        let rows = samples.latents.chunks_exact(latent).zip(times.chunks_exact(width));
        for ((latent, time), text) in rows.zip(texts.chunks_exact(width)) {
            let first = x.len();
            x.extend_from_slice(latent);
            x.extend_from_slice(time);
            x.extend_from_slice(text);
            add(&mut x[first..], &self.positions[..tokens]);
        }
        tape.lengths.clear();
        tape.lengths.resize(count, tokens / width);
        let layout = Layout { lengths: &tape.lengths, memory: None };
        self.stack.forward(&mut x, layout, corrections, outputs, &mut tape.stack);
        x
    }

    /// From the gradient of what [`Self::forward_batch`] gave, which is used up, to what weights and inputs get of it.
    pub(crate) fn backward_batch(
        &self,
        grad: &mut [f32],
        samples: &Samples<'_>,
        tape: &mut BranchTape,
        side: SideGradients<'_>,
        mut weights: Option<&mut WeightGradients<'_>>,
        inputs: &mut InputGradients,
    ) {
        let width = self.sizes.width;
        let latent = self.sizes.latent_tokens * width;
        let tokens = latent + 2 * width;
        let layout = Layout { lengths: &tape.lengths, memory: None };
        self.stack.backward_beside(grad, layout, &mut tape.stack, weights.as_deref_mut(), side);
        let (mut times, mut texts) = (Vec::new(), Vec::new());
        inputs.latents.clear();
        for row in grad.chunks_exact(tokens) {
            inputs.latents.extend_from_slice(&row[..latent]);
            times.extend_from_slice(&row[latent..latent + width]);
            texts.extend_from_slice(&row[latent + width..]);
            if let Some(to) = weights.as_deref_mut() {
                add(&mut to.row[self.place..][..tokens], row);
            }
        }
        inputs.texts.clear();
        inputs.texts.resize(tape.texts.len(), 0.0);
        self.text.backward(&texts, &mut inputs.texts, false);
        let given = inputs.texts.iter_mut().zip(&tape.texts);
        given.filter(|(_, text)| **text <= 0.0).for_each(|(grad, _)| *grad = 0.0);
        let Some(to) = weights else { return };
        self.text.weight_gradient(&tape.texts, &texts, to.row, to.work);
        self.time.second.weight_gradient(&tape.active, &times, to.row, to.work);
        let mut hidden = vec![0.0; times.len()];
        self.time.second.backward(&times, &mut hidden, false);
        for (grad, x) in hidden.iter_mut().zip(&tape.hidden) {
            let share = sigmoid(*x);
            *grad *= share * (1.0 + x * (1.0 - share));
        }
        self.time.first.weight_gradient(&tape.waves, &hidden, to.row, to.work);
        if let (Some(projection), Some(guidance)) = (&self.time.guidance, samples.guidance) {
            let mut waves = vec![0.0; tape.waves.len()];
            self.time.first.backward(&hidden, &mut waves, false);
            projection.matrix_gradient(guidance, &waves, to.row, to.work);
        }
    }
}

fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}
