//! The denoiser on batches, forwards and back, whatever it is made of.

use super::block::WeightGradients;
use super::branch_gradient::{BranchTape, InputGradients, Samples, WaveTable};
use super::denoiser::{Denoiser, Form};
use super::dropout::Dropout;
use super::feeding::FeedingTape;
use super::stack::{Residuals, SideGradients};

/// What the way back needs of a batch, and buffers.
#[derive(Debug)]
pub(crate) struct DenoiserTape {
    branch: BranchTape,
    /// What came out of the blocks with attention.
    x: Vec<f32>,
    inputs: InputGradients,
    feeding: FeedingTape,
}

impl DenoiserTape {
    /// For weights that are learned.
    pub(crate) fn for_learning() -> Self {
        Self::of(BranchTape::for_learning())
    }

    /// For weights that stay, where only what goes in has gradients.
    pub(crate) fn for_inputs() -> Self {
        Self::of(BranchTape::for_inputs())
    }

    fn of(branch: BranchTape) -> Self {
        Self { branch, x: Vec::new(), inputs: InputGradients::default(), feeding: FeedingTape::default() }
    }

    /// What the next forward pass drops.
    pub(crate) fn set_dropout(&mut self, dropout: Option<Dropout>) {
        self.branch.set_dropout(dropout);
        self.feeding.trunk.dropout = dropout;
    }
}

impl Denoiser {
    /// The noise in the latents of a batch. `corrections` count for blocks with attention alone. Numbers that do not fit each other are the
    /// caller's mistake.
    pub(crate) fn forward_batch(
        &self,
        samples: &Samples<'_>,
        waves: &WaveTable,
        corrections: Option<&Residuals>,
        tape: &mut DenoiserTape,
    ) -> Vec<f32> {
        match &self.form {
            Form::Attending(own) => {
                tape.x = own.branch.forward_batch(samples, waves, corrections, None, &mut tape.branch);
                own.noise_of(&tape.x, samples.latents, samples.timesteps)
            }
            Form::Feeding(own) => own.forward(samples, &mut tape.feeding),
        }
    }

    /// From the gradient of the noise to those of the weights, added to theirs, and of the texts (samples x text width).
    pub(crate) fn backward_batch(
        &self,
        grad: Vec<f32>,
        samples: &Samples<'_>,
        tape: &mut DenoiserTape,
        to: &mut WeightGradients<'_>,
    ) -> Vec<f32> {
        match &self.form {
            Form::Attending(own) => {
                let mut x = own.noise_gradient(&tape.x, &grad, samples.timesteps, Some(to));
                let (branch, side) = (&mut tape.branch, SideGradients::default());
                own.branch.backward_batch(&mut x, samples, branch, side, Some(to), &mut tape.inputs);
                std::mem::take(&mut tape.inputs.texts)
            }
            Form::Feeding(own) => own.backward(grad, samples.timesteps, &tape.feeding, to),
        }
    }

    /// From the gradient of the noise to those of the corrections of blocks with attention; weights stay.
    pub(crate) fn corrections_gradient(
        &self,
        grad: &[f32],
        samples: &Samples<'_>,
        tape: &mut DenoiserTape,
        corrections: &mut Residuals,
    ) {
        if let Form::Attending(own) = &self.form {
            let mut x = own.noise_gradient(&tape.x, grad, samples.timesteps, None);
            let side = SideGradients { outputs: None, residuals: Some(corrections) };
            own.branch.backward_batch(&mut x, samples, &mut tape.branch, side, None, &mut tape.inputs);
        }
    }
}
