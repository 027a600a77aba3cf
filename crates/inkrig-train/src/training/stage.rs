//! What is particular about a stage of training; [`super::run`] does what all have in common.

use super::course::Course;
use crate::TrainError;
use burn::module::Module;
use burn::tensor::Tensor;
use inkrig_generate::weights::Tensors;
use std::path::Path;

/// A stage. Nothing in it changes along the way.
pub(super) trait Stage: Sync {
    /// What is trained: all of its weights are.
    type Network: Module + Sync;
    /// What stands beside it and is not trained. Every replica has its own.
    type Beside: Send + Sync;
    /// What a replica needs to know of its part of a step.
    type Work: Send;

    /// Names of the loss' parts, as they stand in the log.
    const PARTS: &'static [&'static str];

    fn course(&self) -> Course;

    /// What the run was told, as JSON.
    fn settings(&self) -> String;

    fn beside(&self) -> Result<Self::Beside, TrainError>;

    /// The work of a step for so many replicas. What is drawn at random belongs to seed and step alone.
    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work>;

    fn loss(
        &self,
        network: &Self::Network,
        beside: &Self::Beside,
        work: Self::Work,
        step: u64,
    ) -> Result<Loss, TrainError>;

    /// After a step: takes over the mean of the weights, for stages whose loss needs it.
    fn follow(&self, _beside: &mut Self::Beside, _average: &[f32]) -> Result<(), TrainError> {
        Ok(())
    }

    /// The weights of a network by their published names.
    fn tensors(&self, network: &Self::Network) -> Result<Tensors, TrainError>;

    /// Measures weights on held-out clips; the first number is the one that shall be small.
    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError>;

    /// Writes weights, with all else that a model file needs.
    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError>;
}

/// A loss that can be gone back from, and its parts.
pub(super) struct Loss {
    /// What is made small.
    pub total: Tensor<1>,
    /// In the order of [`Stage::PARTS`].
    pub parts: Vec<Tensor<1>>,
}

/// Networks say no in their own words.
pub(super) fn network(error: inkrig_generate::GenerateError) -> TrainError {
    TrainError::Device(error.to_string())
}

/// The seed of what a step draws.
pub(super) fn seed_of(seed: u64, step: u64) -> u64 {
    seed.wrapping_mul(0x1_0000_0001).wrapping_add(step + 1)
}
