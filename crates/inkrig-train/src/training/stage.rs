//! What is particular about a stage of training; [`super::run`] does what all have in common.

use super::course::Course;
use crate::TrainError;
use inkrig_generate::weights::Tensors;
use serde::de::DeserializeOwned;
use serde_json::Value;
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

/// The settings that a checkpoint was made with, as JSON. `gone`: settings that there are no more, where they said this, and nothing
/// else; `added`: what was so before it could be said.
pub(super) fn told<S: DeserializeOwned>(
    settings: &str,
    gone: &[(&str, f64)],
    added: &[(&str, f64)],
) -> Option<S> {
    let mut said = serde_json::from_str::<Value>(settings).ok()?;
    let table = said.as_object_mut()?;
    for (name, value) in gone {
        if table.get(*name) == Some(&Value::from(*value)) {
            table.remove(*name);
        }
    }
    for (name, value) in added {
        table.entry(*name).or_insert(Value::from(*value));
    }
    serde_json::from_value(said).ok()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::training::{DenoiserSettings, VaeSettings};

    #[test]
    fn checkpoints_from_before_a_setting_had_what_was_so_then() {
        let old = |settings: Value, more: &[(&str, f64)]| -> String {
            let mut settings = settings;
            let table = settings.as_object_mut().unwrap();
            for name in ["retimed", "mirrored"] {
                table.remove(name).unwrap();
            }
            table.extend(more.iter().map(|(name, value)| ((*name).to_string(), Value::from(*value))));
            settings.to_string()
        };
        let usual = VaeSettings::default();
        let before = old(serde_json::to_value(&usual).unwrap(), &[("dropout", 0.0)]);
        let read = told::<VaeSettings>(&before, &[("dropout", 0.0)], &[("retimed", 0.0)]).unwrap();
        assert_eq!(read, VaeSettings { retimed: 0.0, ..usual.clone() });
        assert_ne!(read, usual, "it goes on without copies or not at all");
        let dropped = old(serde_json::to_value(&usual).unwrap(), &[("dropout", 0.1)]);
        assert!(told::<VaeSettings>(&dropped, &[("dropout", 0.0)], &[("retimed", 0.0)]).is_none());

        let usual = DenoiserSettings::default();
        let before = old(serde_json::to_value(&usual).unwrap(), &[]);
        let read = told::<DenoiserSettings>(&before, &[], &[("retimed", 0.0)]).unwrap();
        assert_eq!(read, DenoiserSettings { retimed: 0.0, ..usual });
    }
}
