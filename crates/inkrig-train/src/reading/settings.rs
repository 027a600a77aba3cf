//! How readers are taught.

use crate::TrainError;
use crate::corpus::{parse_toml, read_text};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How a network is taught, whatever it reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pace {
    /// Steps in all. May be changed while a run goes on: it then ends sooner or later.
    pub steps: u64,
    /// Pictures of a step.
    pub batch: usize,
    /// The highest rate.
    pub rate: f64,
    /// Steps until it is reached.
    pub warm_up: u64,
    /// Share of a weight that a step at rate 1 takes away.
    pub weight_decay: f64,
    /// The longest gradient.
    pub clip: f64,
    /// Steps between measurements.
    pub measure_every: u64,
    /// Pictures of each kind that are measured on.
    pub measured: usize,
    /// Steps between checkpoints.
    pub save_every: u64,
    /// What all chance comes from.
    pub seed: u64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            steps: 6000,
            batch: 32,
            rate: 2e-3,
            warm_up: 200,
            weight_decay: 0.02,
            clip: 1.0,
            measure_every: 250,
            measured: 300,
            save_every: 100,
            seed: 1,
        }
    }
}

/// Settings of `inkrig train sketch`, as its TOML file says them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SketchSettings {
    /// How it is taught.
    pub pace: Pace,
    /// Share of poses whose limbs are bent further at random.
    pub bent: f64,
    /// Share of figures that are seen from any side, not from the front half.
    pub turned: f64,
    /// Share of figures of stranger proportions and habits than those of learned styles that are measured on.
    pub varied: f64,
    /// Share of characters with bodies and clothes among the figures.
    pub characters: f64,
    /// Weights to begin with, as far as their tensors fit; all others begin at random, but what new blocks add begins at zero.
    pub from: Option<PathBuf>,
}

impl Default for SketchSettings {
    fn default() -> Self {
        Self { pace: Pace::default(), bent: 0.3, turned: 0.15, varied: 0.5, characters: 0.15, from: None }
    }
}

/// Settings of `inkrig train word`, as its TOML file says them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WordSettings {
    /// How it is taught.
    pub pace: Pace,
    /// Names of fonts that are measured on and not learned from. Default: every sixth.
    pub held_out: Vec<String>,
    /// Share of words that are of the lexicon; the others are made up, so that letters are learned and not words.
    pub known: f64,
}

impl Default for WordSettings {
    fn default() -> Self {
        Self { pace: Pace::default(), held_out: Vec::new(), known: 0.6 }
    }
}

impl Pace {
    fn check(&self) -> Result<(), String> {
        if self.steps == 0
            || !(1..=4096).contains(&self.batch)
            || self.measure_every == 0
            || self.save_every == 0
            || !(1..=100_000).contains(&self.measured)
        {
            return Err(
                "steps, batch (up to 4096), measure_every, measured (up to 100000) and save_every must be at least 1"
                    .into(),
            );
        }
        let positive = self.rate > 0.0 && self.rate <= 1.0 && self.clip > 0.0;
        if !positive || !(0.0..=1.0).contains(&self.weight_decay) {
            return Err("rate must be above 0 and at most 1, clip above 0, weight_decay from 0 to 1".into());
        }
        Ok(())
    }

    /// Any number of steps belongs to the same run.
    fn without_steps(&self) -> Self {
        Self { steps: 0, ..self.clone() }
    }
}

impl SketchSettings {
    /// Reads a TOML file; what it does not say is as usual.
    ///
    /// # Errors
    /// When it cannot be read, or says what there is not.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        parse(path)
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let Self { bent, turned, varied, characters, .. } = *self;
        let all = [("bent", bent), ("turned", turned), ("varied", varied), ("characters", characters)];
        shares(all).and(self.pace.check())
    }

    pub(super) fn identity(&self) -> String {
        serde_json::to_string(&Self { pace: self.pace.without_steps(), ..self.clone() }).unwrap_or_default()
    }
}

impl WordSettings {
    /// Reads a TOML file; what it does not say is as usual.
    ///
    /// # Errors
    /// When it cannot be read, or says what there is not.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        parse(path)
    }

    pub(super) fn check(&self) -> Result<(), String> {
        shares([("known", self.known)]).and(self.pace.check())
    }

    pub(super) fn identity(&self) -> String {
        serde_json::to_string(&Self { pace: self.pace.without_steps(), ..self.clone() }).unwrap_or_default()
    }
}

fn parse<T: DeserializeOwned>(path: &Path) -> Result<T, TrainError> {
    let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
    parse_toml(&read_text(path)?).map_err(content)
}

fn shares<const N: usize>(shares: [(&str, f64); N]) -> Result<(), String> {
    match shares.into_iter().find(|(_, share)| !(0.0..=1.0).contains(share)) {
        Some((name, share)) => Err(format!("{name} is {share}; from 0 to 1 is possible")),
        None => Ok(()),
    }
}
