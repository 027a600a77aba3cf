//! The denoiser and the table of verbs, for training.

use super::branch::{Branch, NoisyBatch};
use super::layers::{Side, Source};
use super::named::{parameter, to_tensors};
use crate::GenerateError;
use crate::networks::Sizes;
use crate::text::VerbTable;
use crate::weights::Tensors;
use burn::module::{Module, Param};
use burn::tensor::{Device, Int, Tensor, TensorData};

/// The network that predicts the noise in a latent, equal to [`crate::networks::Denoiser`] when nothing is dropped out.
#[derive(Module, Debug)]
pub struct TrainableDenoiser {
    branch: Branch,
}

impl TrainableDenoiser {
    /// Takes the weights that are named `denoiser.denoiser.*`; `dropout` from 0 to below 1 is the share of numbers that is dropped
    /// within [`dropping`](super::dropping).
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        let source = Source::new(sizes, weights, dropout, device)?;
        Ok(Self { branch: Branch::new(source, "denoiser.denoiser", sizes.denoiser_blocks, true)? })
    }

    /// The noise in each latent, samples x latent tokens x width; `corrections` are those of ControlNet or adapter, one for each
    /// of the first blocks.
    pub fn noise(&self, batch: &NoisyBatch, corrections: Option<&[Tensor<3>]>) -> Tensor<3> {
        let side = Side { residuals: corrections, outputs: None };
        self.branch.forward(batch, side).narrow(1, 0, batch.latents.dims()[1])
    }

    /// All weights by their published names.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self) -> Result<Tensors, GenerateError> {
        to_tensors(self, "denoiser.denoiser")
    }
}

/// Vectors of the verbs and of no text, as [`VerbTable`] has them.
#[derive(Module, Debug)]
pub struct TrainableVerbs {
    verbs: Param<Tensor<2>>,
    nothing: Param<Tensor<1>>,
}

impl TrainableVerbs {
    /// Takes [`VerbTable::VERBS`] and [`VerbTable::NOTHING`], vectors of `width` numbers.
    ///
    /// # Errors
    /// When one is missing or of another shape.
    pub fn new(weights: &Tensors, width: usize, device: &Device) -> Result<Self, GenerateError> {
        let missing = || GenerateError::MissingTensor { name: VerbTable::VERBS.into() };
        let rows = weights.get(VerbTable::VERBS).ok_or_else(missing)?.shape().first().copied().unwrap_or(0);
        Ok(Self {
            verbs: parameter(weights, VerbTable::VERBS, [rows, width], device)?,
            nothing: parameter(weights, VerbTable::NOTHING, [width], device)?,
        })
    }

    /// Vectors of some verbs, by their places in the list, or of no text: samples x width.
    pub fn texts(&self, verbs: &[Option<usize>]) -> Tensor<2> {
        let table = Tensor::cat(vec![self.verbs.val(), self.nothing.val().unsqueeze::<2>()], 0);
        let nothing = table.dims()[0] - 1;
        let places = verbs.iter().map(|verb| verb.map_or(nothing, |verb| verb.min(nothing)) as i64);
        let places = TensorData::new(places.collect::<Vec<_>>(), [verbs.len()]);
        let places = Tensor::<1, Int>::from_data(places, &table.device());
        table.select(0, places)
    }

    /// Both tensors by their names.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self) -> Result<Tensors, GenerateError> {
        to_tensors(self, "text")
    }
}
