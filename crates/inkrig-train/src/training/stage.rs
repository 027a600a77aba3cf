//! What is particular about a stage of training; [`super::run`] does what all have in common.

use super::course::Course;
use crate::TrainError;
use inkrig_generate::weights::Tensors;
use std::path::Path;

/// A stage. Nothing in it changes along the way.
pub(super) trait Stage: Sync {
    /// What one thread works with: buffers, and networks that are not trained.
    type Replica: Send;
    /// What a replica needs to know of its part of a step.
    type Work: Send;

    /// Names of the loss' parts, as they stand in the log.
    const PARTS: &'static [&'static str];

    fn course(&self) -> Course;

    /// What the run was told, as JSON.
    fn settings(&self) -> String;

    /// Whether a run was told the same. Settings that came after it began have their usual values there.
    fn is_same(&self, settings: &str) -> bool;

    fn replica(&self) -> Result<Self::Replica, TrainError>;

    /// The work of a step for so many replicas. What is drawn at random belongs to seed and step alone.
    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work>;

    /// The loss and its parts, in the order of [`Self::PARTS`], and the gradient, which replaces what is in the buffer: in the order of
    /// [`Tensors::row`].
    fn gradient(
        &self,
        replica: &mut Self::Replica,
        weights: Weights<'_>,
        work: Self::Work,
        step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError>;

    /// Measures weights on held-out clips; the first number is the one that shall be small.
    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError>;

    /// Writes weights, with all else that a model file needs.
    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError>;
}

/// All weights that are trained, in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights<'a> {
    pub now: &'a [f32],
    /// Their mean along the way; the weights themselves where none is kept.
    pub average: &'a [f32],
}

/// Networks say no in their own words.
#[allow(clippy::needless_pass_by_value, reason = "it maps errors")]
pub(super) fn network(error: inkrig_generate::GenerateError) -> TrainError {
    TrainError::Device(error.to_string())
}

/// The seed of what a step draws.
pub(super) fn seed_of(seed: u64, step: u64) -> u64 {
    seed.wrapping_mul(0x1_0000_0001).wrapping_add(step + 1)
}
