//! Estimator and correction on batches, forwards and back to their weights.

use super::block::WeightGradients;
use super::dropout::Dropout;
use super::estimate::{Correction, CorrectionTape, Estimate, Estimator, MISSED, WAVES};
use super::trunk::TrunkTape;
use crate::GenerateError;
use crate::numeric::elementwise::add;

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
    /// From the gradient of corrected clean latents to those of the weights, added to theirs, of what was corrected, and of the estimate (added). `back` goes from
    /// the gradient of the misses to that of what was corrected.
    ///
    /// # Errors
    /// Those of `back`.
    pub(crate) fn correct_back(
        &self,
        grad: &[f32],
        timesteps: &[usize],
        (tape, of): (&CorrectionTape, &mut Estimate),
        to: &mut WeightGradients<'_>,
        back: impl FnOnce(&[f32]) -> Result<Vec<f32>, GenerateError>,
    ) -> Result<Vec<f32>, GenerateError> {
        let moved = self.shared(grad, timesteps);
        self.latent.weight_gradient(&tape.hidden, &moved, to.row, to.work);
        let mut hidden = vec![0.0; tape.hidden.len()];
        self.latent.backward(&moved, &mut hidden, false);
        let input = self.trunk.backward(hidden, &tape.trunk, to);
        let (inputs, width) = (input.len() / timesteps.len().max(1), self.width);
        // Of what was corrected: directly, through the blocks, and through what it misses.
        let through = input.chunks_exact(inputs).flat_map(|row| &row[width..2 * width]);
        let mut before: Vec<f32> = grad.iter().zip(through).map(|(grad, through)| grad + through).collect();
        let misses: Vec<f32> =
            input.chunks_exact(inputs).flat_map(|row| &row[inputs - MISSED..]).copied().collect();
        add(&mut before, &back(&misses)?);
        let known = inputs - 3 * width - WAVES - MISSED;
        of.latents.resize(grad.len(), 0.0);
        of.hidden.resize(timesteps.len() * known, 0.0);
        let rows = of.latents.chunks_exact_mut(width).zip(of.hidden.chunks_exact_mut(known));
        for ((latents, hidden), input) in rows.zip(input.chunks_exact(inputs)) {
            add(latents, &input[2 * width..3 * width]);
            add(hidden, &input[3 * width..3 * width + known]);
        }
        Ok(before)
    }

    /// From the gradient of weighed latents to those of the weights and of the estimate, added to theirs.
    pub(crate) fn weigh_back(
        &self,
        grad: &[f32],
        timesteps: &[usize],
        (tape, of): (&CorrectionTape, &mut Estimate),
        to: &mut WeightGradients<'_>,
    ) {
        let numbers = grad.iter().zip(&tape.apart).zip(&tape.shares);
        let gate: Vec<f32> =
            numbers.map(|((grad, apart), share)| grad * apart * share * (1.0 - share)).collect();
        self.gate.weight_gradient(&tape.weighed, &gate, to.row, to.work);
        let mut known = vec![0.0; tape.weighed.len()];
        self.gate.backward(&gate, &mut known, false);
        let each = known.len() / timesteps.len().max(1);
        of.latents.resize(grad.len(), 0.0);
        of.hidden.resize(timesteps.len() * (each - WAVES), 0.0);
        for (hidden, known) in of.hidden.chunks_exact_mut(each - WAVES).zip(known.chunks_exact(each)) {
            add(hidden, &known[..each - WAVES]);
        }
        let direct = self.shared(grad, timesteps);
        let direct = direct.iter().zip(&tape.shares);
        of.latents.iter_mut().zip(direct).for_each(|(of, (grad, share))| *of += grad * share);
    }

    /// A gradient times what corrections count at each timestep.
    fn shared(&self, grad: &[f32], timesteps: &[usize]) -> Vec<f32> {
        let rows = grad.chunks_exact(self.width).zip(timesteps);
        rows.flat_map(|(row, &step)| row.iter().map(move |grad| self.share(step) * grad)).collect()
    }
}
