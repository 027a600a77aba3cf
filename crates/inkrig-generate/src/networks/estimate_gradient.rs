//! Estimator and correction on batches, forwards and back to their weights.

use super::block::WeightGradients;
use super::dropout::Dropout;
use super::estimate::{Correction, CorrectionTape, Estimate, Estimator, WAVES};
use super::trunk::TrunkTape;

/// What an estimator needs for the way back.
#[derive(Debug, Clone, Default)]
pub(crate) struct EstimatorTape {
    trunk: TrunkTape,
}

impl EstimatorTape {
    /// What the next forward pass drops.
    pub(crate) fn set_dropout(&mut self, dropout: Option<Dropout>) {
        self.trunk.dropout = dropout;
    }
}

impl CorrectionTape {
    /// What the next forward pass drops.
    pub(crate) fn set_dropout(&mut self, dropout: Option<Dropout>) {
        self.trunk.dropout = dropout;
    }
}

impl Estimator {
    /// As [`Self::estimate`].
    pub(crate) fn forward_batch(&self, told: Vec<f32>, tape: &mut EstimatorTape) -> Estimate {
        let hidden = self.trunk.forward(told, &mut tape.trunk);
        Estimate { latents: self.latent.apply(&hidden), hidden }
    }

    /// From the gradient of an estimate to those of the weights, added to theirs.
    pub(crate) fn backward_batch(
        &self,
        estimate: &Estimate,
        grad: &Estimate,
        tape: &EstimatorTape,
        to: &mut WeightGradients<'_>,
    ) {
        self.latent.weight_gradient(&estimate.hidden, &grad.latents, to.row, to.work);
        let mut hidden = grad.hidden.clone();
        self.latent.backward(&grad.latents, &mut hidden, true);
        self.trunk.backward(hidden, &tape.trunk, to);
    }
}

impl Correction {
    /// What is to be taken from the velocities in `noisy` latents of which the denoiser sees `clean` ones.
    pub(crate) fn forward_batch(
        &self,
        noisy: &[f32],
        clean: &[f32],
        timesteps: &[usize],
        estimate: &Estimate,
        tape: &mut CorrectionTape,
    ) -> Vec<f32> {
        self.velocity(noisy, clean, timesteps, estimate, tape)
    }

    /// From the gradient of that velocity to those of the weights, added to theirs, and of the estimate.
    pub(crate) fn backward_batch(
        &self,
        grad: &[f32],
        tape: &CorrectionTape,
        to: &mut WeightGradients<'_>,
    ) -> Estimate {
        self.latent.weight_gradient(&tape.hidden, grad, to.row, to.work);
        let mut hidden = vec![0.0; tape.hidden.len()];
        self.latent.backward(grad, &mut hidden, false);
        let input = self.trunk.backward(hidden, &tape.trunk, to);
        let weighed = grad.iter().zip(&tape.apart).zip(&tape.shares);
        let gate: Vec<f32> =
            weighed.map(|((grad, apart), share)| grad * apart * share * (1.0 - share)).collect();
        self.gate.weight_gradient(&tape.weighed, &gate, to.row, to.work);
        let mut known = vec![0.0; tape.weighed.len()];
        self.gate.backward(&gate, &mut known, false);
        let samples = grad.len() / self.width.max(1);
        let (inputs, width) = (input.len() / samples.max(1), self.width);
        let each = known.len() / samples.max(1);
        let mut of = Estimate { latents: Vec::with_capacity(grad.len()), hidden: Vec::new() };
        for (input, known) in input.chunks_exact(inputs).zip(known.chunks_exact(each)) {
            of.latents.extend_from_slice(&input[2 * width..3 * width]);
            let both = input[3 * width..inputs - WAVES].iter().zip(known);
            of.hidden.extend(both.map(|(trunk, gate)| trunk + gate));
        }
        let direct = grad.iter().zip(&tape.shares);
        of.latents.iter_mut().zip(direct).for_each(|(of, (grad, share))| *of += grad * share);
        of
    }
}
