//! Everything in which the paper and the published code differ, as two named configurations.

mod settings;

pub use settings::{
    BlendingSettings, CameraSettings, Cross, EvaluationSettings, GuidanceMean, GuidanceSettings,
    GuidanceVariable, KeyposeChoice, PerturbationSettings, SamplingMethod, SamplingSettings, TextEncoderKind,
    TextSettings, TrainingSettings, TrajectoryChoice,
};

use crate::GenerateError;
use crate::blending::BlendOptions;
use crate::guidance::{GuidanceOptions, LbfgsOptions, Mean, Method, Variable};
use crate::networks::Sizes;
use crate::sampling::{SamplingOptions, Semantics, Steps};
use serde::{Deserialize, Serialize};

/// A whole setting up of the second engine: sizes, conditions, sampling, guidance, training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Configuration {
    /// Whose reading holds where one switch decides.
    pub semantics: Semantics,
    /// Of the networks.
    pub sizes: Sizes,
    /// How words become vectors.
    pub text: TextSettings,
    /// Which steps, and how long clips are.
    pub sampling: SamplingSettings,
    /// How drawn trajectories are met.
    pub guidance: GuidanceSettings,
    /// How clips become one animation.
    pub blending: BlendingSettings,
    /// Losses, rates, and what is learned from.
    pub training: TrainingSettings,
    /// From where training looks.
    pub camera: CameraSettings,
    /// What is done to drawn points in training.
    pub perturbation: PerturbationSettings,
    /// How it is measured.
    pub evaluation: EvaluationSettings,
}

impl Configuration {
    /// As the paper describes the system.
    ///
    /// # Errors
    /// Never, as long as the file inside the program is whole.
    pub fn paper() -> Result<Self, GenerateError> {
        Self::read(include_str!("paper.toml"))
    }

    /// As the published code and weights are.
    ///
    /// # Errors
    /// Never, as long as the file inside the program is whole.
    pub fn official() -> Result<Self, GenerateError> {
        Self::read(include_str!("official.toml"))
    }

    /// One from a text in TOML. Every setting has to be there.
    ///
    /// # Errors
    /// [`GenerateError::Configuration`] with the place, or [`GenerateError::Setting`].
    pub fn read(text: &str) -> Result<Self, GenerateError> {
        let configuration: Self = toml::from_str(text)
            .map_err(|error| GenerateError::Configuration { reason: error.to_string() })?;
        configuration.sizes.check()?;
        Ok(configuration)
    }

    /// How clips are sampled.
    pub fn sampling_options(&self) -> SamplingOptions {
        let guidance = &self.guidance;
        let options = LbfgsOptions {
            rate: guidance.rate,
            iterations: guidance.iterations,
            evaluations: guidance.evaluations,
            ..LbfgsOptions::default()
        };
        let method =
            Method::SecondOrder { options, early: guidance.early_rounds, late: guidance.late_rounds };
        SamplingOptions {
            steps: match self.sampling.method {
                SamplingMethod::Ddim => Steps::Ddim(self.sampling.steps),
                SamplingMethod::Lcm => Steps::Lcm(self.sampling.steps),
            },
            text_weight: self.text.weight,
            semantics: self.semantics,
            guidance: Some(GuidanceOptions {
                variable: match guidance.variable {
                    GuidanceVariable::Noise => Variable::Noise,
                    GuidanceVariable::Latent => Variable::Latent,
                },
                method,
                mean: match guidance.mean {
                    GuidanceMean::AllEntries => Mean::AllEntries,
                    GuidanceMean::Asked => Mean::Asked,
                },
                step_early: guidance.step_early,
            }),
            guide_every: 1,
            settle: None,
            from: None,
        }
    }
}

impl Configuration {
    /// How clips are blended. Guidance holds them with the same variable and mean as it holds trajectories.
    pub fn blend_options(&self) -> BlendOptions {
        let sampling = self.sampling_options();
        let options = LbfgsOptions {
            rate: self.blending.rate,
            iterations: self.blending.iterations,
            evaluations: 1000,
            ..LbfgsOptions::default()
        };
        let method = Method::SecondOrder { options, early: 1, late: 1 };
        let guidance =
            sampling.guidance.map(|guidance| GuidanceOptions { method, mean: Mean::Asked, ..guidance });
        let transition = self.blending.transition;
        BlendOptions { transition, text_weight: self.text.weight, guidance, ..BlendOptions::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_or_unknown_is_said_with_its_place() {
        let whole = include_str!("paper.toml");
        let error = Configuration::read(&whole.replace("iterations = 4 # 7", "")).unwrap_err().to_string();
        assert!(error.contains("iterations"), "{error}");
        let error = Configuration::read(&whole.replace("steps = 50", "stepps = 50")).unwrap_err().to_string();
        assert!(error.contains("stepps") && error.contains("line"), "{error}");
        assert!(Configuration::read(&whole.replace("vae_blocks = 9", "vae_blocks = 8")).is_err());
    }

    #[test]
    fn both_are_whole_and_differ_where_the_sources_do() {
        let (paper, official) = (Configuration::paper().unwrap(), Configuration::official().unwrap());
        assert_eq!((paper.sizes.control_blocks, official.sizes.control_blocks), (4, 9));
        assert_ne!(paper.sampling_options(), official.sampling_options());
        let again = toml::to_string(&official).unwrap();
        assert_eq!(Configuration::read(&again).unwrap(), official);
    }
}
