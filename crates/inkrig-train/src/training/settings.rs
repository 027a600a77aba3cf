//! What a run of training is told.

use super::course::{Course, Optimiser, broken, is_share};
use super::motions::Selection;
use crate::TrainError;
use crate::corpus::{parse_toml, read_text};
use inkrig_generate::networks::Sizes;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How the autoencoder is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VaeSettings {
    /// `full`, `small` or `tiny`.
    pub sizes: String,
    /// Latent tokens, 1 to 8; the sizes' own if not said.
    pub latent_tokens: Option<usize>,
    /// Cosines of the linear path beside the blocks, 0 for none; the sizes' own if not said.
    pub cosines: Option<usize>,
    /// Deviation of the noise that a component of the linear path begins with: metres, the root of the sum of squares over joints.
    pub path_noise: f64,
    /// Steps of the whole run, over which the rate falls.
    pub steps: u64,
    /// Windows of a step.
    pub batch: usize,
    /// The highest rate.
    pub rate: f64,
    /// Steps until it is reached.
    pub warm_up: u64,
    /// `adamw`, or `muon` for the matrices inside blocks.
    pub optimiser: Optimiser,
    /// Decay of AdamW's two means.
    pub betas: (f64, f64),
    /// Decay of weights.
    pub weight_decay: f64,
    /// Longest gradient.
    pub clip: f64,
    /// Weight of the divergence from a normal distribution.
    pub divergence: f64,
    /// Weight of the joints' places, metres.
    pub places: f64,
    /// Noise on the latents begins with this share and is whole after `noise_until` of the run.
    pub noise_from: f64,
    /// See `noise_from`.
    pub noise_until: f64,
    /// Frames of most windows.
    pub frames: usize,
    /// Share of steps whose windows have another length, from `shortest` to `longest`.
    pub other_lengths: f64,
    /// See `other_lengths`.
    pub shortest: usize,
    /// See `other_lengths`.
    pub longest: usize,
    /// 0: every second of motion as often; 1: every action.
    pub balance: f64,
    /// Whether mirror images are learned from, too.
    pub mirrored: bool,
    /// Share of clips of which a copy is learned from that is faster or slower, up to 1.3 times.
    pub retimed: f64,
    /// Whether factors are multiplied in half precision where the processor is faster at it; sums and weights are single.
    pub half_precision: bool,
    /// Steps from one measurement to the next.
    pub measure_every: u64,
    /// Steps from one checkpoint to the next.
    pub save_every: u64,
    /// Measurements without a better one after which the run ends; 0: never.
    pub patience: u64,
    /// Another seed draws other windows.
    pub seed: u64,
}

impl Default for VaeSettings {
    fn default() -> Self {
        Self {
            sizes: "small".into(),
            latent_tokens: None,
            cosines: None,
            path_noise: 0.01,
            steps: 20_000,
            batch: 64,
            rate: 1e-3,
            warm_up: 200,
            optimiser: Optimiser::Muon,
            betas: (0.9, 0.99),
            weight_decay: 0.0,
            clip: 1.0,
            divergence: 1e-5,
            places: 30.0,
            noise_from: 0.1,
            noise_until: 0.5,
            frames: 40,
            other_lengths: 0.3,
            shortest: 20,
            longest: 120,
            balance: 0.3,
            mirrored: true,
            retimed: 1.0,
            half_precision: true,
            measure_every: 250,
            save_every: 100,
            patience: 0,
            seed: 0,
        }
    }
}

impl VaeSettings {
    /// Reads a TOML file; what it does not say is as by default.
    ///
    /// # Errors
    /// When it cannot be read, or a value is out of its range.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let settings: Self = parse_toml(&read_text(path)?).map_err(content)?;
        settings.network().map_err(content)?;
        Ok(settings)
    }

    /// The sizes that are meant, checked along with all else.
    pub(super) fn network(&self) -> Result<Sizes, String> {
        let named = match self.sizes.as_str() {
            "full" => Sizes::full(),
            "small" => Sizes::small(),
            "tiny" => Sizes::tiny(),
            other => return Err(format!("sizes = \"{other}\": give full, small or tiny")),
        };
        let latent_tokens = self.latent_tokens.unwrap_or(named.latent_tokens);
        let sizes = Sizes { latent_tokens, cosines: self.cosines.unwrap_or(named.cosines), ..named };
        sizes.check().map_err(|error| error.to_string())?;
        let most = sizes.most_frames();
        self.course().check()?;
        broken([
            ("divergence", self.divergence >= 0.0 && self.divergence.is_finite(), "0 or more".to_string()),
            ("places", self.places >= 0.0 && self.places.is_finite(), "0 or more".into()),
            ("noise_from", is_share(self.noise_from), "0 to 1".into()),
            ("noise_until", is_share(self.noise_until), "0 to 1".into()),
            ("frames", (2..=most).contains(&self.frames), format!("2 to {most}")),
            ("other_lengths", is_share(self.other_lengths), "0 to 1".into()),
            ("shortest", (2..=self.longest).contains(&self.shortest), "2 to longest".into()),
            ("longest", self.longest <= most, format!("at most {most}")),
            ("balance", is_share(self.balance), "0 to 1".into()),
            ("retimed", is_share(self.retimed), "0 to 1".into()),
            ("path_noise", self.path_noise > 0.0 && self.path_noise <= 1.0, "above 0, at most 1".into()),
            (
                "weight_decay",
                self.weight_decay == 0.0 || sizes.cosines == 0,
                "0, or cosines = 0: a linear path is to stay as it is".into(),
            ),
        ])?;
        Ok(sizes)
    }

    /// What is taken of the split that is learned from.
    pub(super) fn selection(&self) -> Selection {
        let Self { balance, mirrored, retimed, seed, .. } = *self;
        Selection { balance, mirrored, retimed, seed }
    }

    /// What all stages are told. The settings of this one are flat, as they stand in its checkpoints.
    pub(super) fn course(&self) -> Course {
        Course {
            steps: self.steps,
            batch: self.batch,
            rate: self.rate,
            warm_up: self.warm_up,
            optimiser: self.optimiser,
            betas: self.betas,
            weight_decay: self.weight_decay,
            clip: self.clip,
            average: 0.0,
            half_precision: self.half_precision,
            measure_every: self.measure_every,
            save_every: self.save_every,
            patience: self.patience,
            seed: self.seed,
        }
    }

    /// The share of its noise that a latent gets at a step.
    pub(super) fn noise_at(&self, step: u64) -> f64 {
        let whole = self.noise_until * self.steps as f64;
        let share = if whole > 0.0 { (step as f64 / whole).min(1.0) } else { 1.0 };
        self.noise_from + (1.0 - self.noise_from) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_out_of_range_are_named() {
        let says = |text: &str| toml::from_str::<VaeSettings>(text).unwrap().network().unwrap_err();
        assert!(VaeSettings::default().network().is_ok());
        assert!(says("sizes = 'huge'").contains("full, small or tiny"));
        assert!(says("latent_tokens = 9").contains("latent_tokens"));
        assert!(says("frames = 1000").starts_with("frames"));
        assert!(says("rate = nan").starts_with("rate"));
        assert!(says("shortest = 130").starts_with("shortest"));
        assert!(toml::from_str::<VaeSettings>("stesp = 3").is_err());
        let settings = VaeSettings { steps: 100, ..VaeSettings::default() };
        assert_eq!((settings.noise_at(0), settings.noise_at(50), settings.noise_at(90)), (0.1, 1.0, 1.0));
    }
}
