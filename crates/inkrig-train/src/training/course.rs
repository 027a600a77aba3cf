//! What all stages are told alike: how many steps, how long, measured and kept when.

use crate::TrainError;
use crate::corpus::{parse_toml, read_text, toml_error};
use inkrig_generate::weights::Tensors;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What moves weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Optimiser {
    /// AdamW for all.
    #[default]
    AdamW,
    /// Muon for the matrices inside blocks, AdamW for the rest.
    Muon,
}

/// The course of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Course {
    /// Steps of the whole run, over which the rate falls.
    pub steps: u64,
    /// Samples of a step.
    pub batch: usize,
    /// The highest rate.
    pub rate: f64,
    /// Steps until it is reached.
    pub warm_up: u64,
    /// What moves weights.
    pub optimiser: Optimiser,
    /// Decay of AdamW's two means.
    pub betas: (f64, f64),
    /// Decay of weights.
    pub weight_decay: f64,
    /// Longest gradient.
    pub clip: f64,
    /// What is measured and written is a mean of the weights along the way, of which a step keeps this share; 0: the weights themselves.
    pub average: f64,
    /// Whether factors are multiplied in half precision where the processor is faster at it; sums and weights are single.
    pub half_precision: bool,
    /// Steps from one measurement to the next.
    pub measure_every: u64,
    /// Steps from one checkpoint to the next.
    pub save_every: u64,
    /// Measurements without a better one after which the run ends; 0: never.
    pub patience: u64,
    /// Another seed draws other samples.
    pub seed: u64,
}

impl Default for Course {
    fn default() -> Self {
        Self {
            steps: 20_000,
            batch: 64,
            rate: 1e-3,
            warm_up: 200,
            optimiser: Optimiser::AdamW,
            betas: (0.9, 0.99),
            weight_decay: 0.0,
            clip: 1.0,
            average: 0.0,
            half_precision: true,
            measure_every: 250,
            save_every: 100,
            patience: 0,
            seed: 0,
        }
    }
}

/// A rule that a setting breaks: its name and what it should be.
type Rule = (&'static str, bool, String);

/// Says which is broken, if one is.
pub(super) fn broken(rules: impl IntoIterator<Item = Rule>) -> Result<(), String> {
    match rules.into_iter().find(|(_, fits, _)| !fits) {
        Some((name, _, range)) => Err(format!("{name} is out of range: give {range}")),
        None => Ok(()),
    }
}

/// Whether a number is a share of a whole.
pub(super) fn is_share(value: f64) -> bool {
    (0.0..=1.0).contains(&value)
}

impl Course {
    /// Weights of which learners make networks.
    pub(super) fn for_learning(&self, mut weights: Tensors) -> Tensors {
        if self.half_precision {
            weights.prefer_half_precision();
        }
        weights
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let share = is_share;
        broken([
            ("steps", self.steps > 0, "1 or more".to_string()),
            ("batch", (1..=4096).contains(&self.batch), "1 to 4096".into()),
            ("rate", self.rate > 0.0 && self.rate <= 1.0, "above 0, at most 1".into()),
            (
                "betas",
                share(self.betas.0) && share(self.betas.1) && self.betas.0.max(self.betas.1) < 1.0,
                "from 0 to below 1".into(),
            ),
            ("weight_decay", share(self.weight_decay), "0 to 1".into()),
            ("clip", self.clip > 0.0, "above 0".into()),
            ("average", (0.0..1.0).contains(&self.average), "from 0 to below 1".into()),
            ("measure_every", self.measure_every > 0, "1 or more".into()),
            ("save_every", self.save_every > 0, "1 or more".into()),
        ])
    }
}

/// Settings of a stage that stand in one TOML file with those of its course.
pub(super) trait Settings: Default + Serialize + DeserializeOwned {
    /// # Errors
    /// The first that is out of its range.
    fn check(&self) -> Result<(), String>;
}

/// Reads settings; what the file does not say is as by default.
pub(super) fn read_settings<S: Settings>(path: &Path) -> Result<S, TrainError> {
    let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
    parse_settings::<S>(&read_text(path)?).map_err(content)
}

/// Files are flat, and settings have their course in a part of its own.
pub(super) fn parse_settings<S: Settings>(text: &str) -> Result<S, String> {
    let said: toml::Table = parse_toml(text)?;
    let mut table = toml::Table::try_from(S::default()).map_err(|error| error.to_string())?;
    for (name, value) in said {
        let course = table.get_mut("course").and_then(toml::Value::as_table_mut);
        match course.and_then(|course| course.get_mut(&name)) {
            Some(own) => *own = value,
            None => _ = table.insert(name, value),
        }
    }
    let settings: S = table.try_into().map_err(|error| toml_error("", &error))?;
    settings.check()?;
    Ok(settings)
}
