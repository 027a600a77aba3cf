//! The parts of a configuration.

use serde::{Deserialize, Serialize};

/// How words become vectors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextSettings {
    /// Whose vectors.
    pub encoder: TextEncoderKind,
    /// The sentence; `{word}` stands for the word.
    pub template: String,
    /// How much more the text counts than nothing does (w_c).
    pub weight: f32,
    /// Share of training clips that lose their text.
    pub dropped: f32,
}

/// Encoders of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TextEncoderKind {
    /// CLIP ViT-L/14.
    Clip,
    /// The sentence-T5-large encoder.
    SentenceT5,
    /// A table of verbs.
    Verbs,
}

/// Which steps, and how long clips are.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SamplingSettings {
    /// Kind of steps.
    pub method: SamplingMethod,
    /// How many.
    pub steps: usize,
    /// Frames that are decoded, 20 a second.
    pub frames: usize,
}

/// Kinds of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplingMethod {
    /// Many, without new noise.
    Ddim,
    /// Few, of a distilled model.
    Lcm,
}

/// How drawn trajectories are met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuidanceSettings {
    /// What is moved.
    pub variable: GuidanceVariable,
    /// What squared distances are divided by.
    pub mean: GuidanceMean,
    /// Strength of a step (tau_2).
    pub rate: f64,
    /// Directions in a round.
    pub iterations: usize,
    /// Evaluations after which a round takes no new direction.
    pub evaluations: usize,
    /// Rounds at steps in the noisier half.
    pub early_rounds: usize,
    /// Rounds at later steps.
    pub late_rounds: usize,
    /// Whether the noise is reckoned as of the step before.
    pub step_early: bool,
}

/// What guidance moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GuidanceVariable {
    /// The predicted noise.
    Noise,
    /// The noisy latent.
    Latent,
}

/// What squared distances are divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GuidanceMean {
    /// All numbers of the clip.
    AllEntries,
    /// What is asked for.
    Asked,
}

/// How clips become one animation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlendingSettings {
    /// Frames of a transition.
    pub transition: usize,
    /// Strength of a step (tau_3).
    pub rate: f64,
    /// Directions at each step.
    pub iterations: usize,
}

/// Losses, rates, and what is learned from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingSettings {
    /// Frames of the shortest clip.
    pub shortest: usize,
    /// Frames of the longest clip.
    pub longest: usize,
    /// Which frames of a joint are asked for.
    pub trajectory: TrajectoryChoice,
    /// Joints that may be asked for.
    pub joints: Vec<usize>,
    /// Which frame is the key pose.
    pub keypose: KeyposeChoice,
    /// Of the key pose's distance, in space.
    pub keypose_weight: f64,
    /// Of the trajectory's.
    pub trajectory_weight: f64,
    /// Of the distance of both domains' embeddings.
    pub match_weight: f64,
    /// Of their contrast.
    pub contrast_weight: f64,
    /// Of the trajectory's distance while domains are aligned.
    pub align_trajectory_weight: f64,
    /// Of the key pose's distance while domains are aligned.
    pub align_keypose_weight: f64,
    /// Of the contrast (tau_1).
    pub temperature: f64,
    /// Of AdamW.
    pub learning_rate: f64,
    /// Steps until the rate is reached.
    pub warm_up: usize,
    /// Whether the rate then falls along a cosine.
    pub cosine: bool,
    /// Clips in a step.
    pub batch: usize,
}

/// Which frames of a joint are asked for in training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrajectoryChoice {
    /// The first or the last frames.
    Contiguous,
    /// Any.
    Random,
}

/// Which frame is the key pose in training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KeyposeChoice {
    /// The one most like the text.
    Similar,
    /// The first at which anything is asked for.
    FirstAsked,
}

/// From where training looks. Degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSettings {
    /// From and to, downwards.
    pub pitch: [f32; 2],
    /// From and to, around.
    pub yaw: [f32; 2],
    /// From and to, of the picture.
    pub scale: [f32; 2],
    /// Downwards, when measured.
    pub evaluation_pitch: [f32; 2],
    /// Around, when measured.
    pub evaluation_yaw: [f32; 2],
}

/// What is done to drawn points in training. Metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerturbationSettings {
    /// Deviation of normal noise on points.
    pub noise: f32,
    /// Share of clips that get it.
    pub noise_share: f32,
    /// Most of uniform noise on points.
    pub jitter: f32,
    /// Share of clips that get it.
    pub jitter_share: f32,
    /// Most that the whole is shifted, in each direction.
    pub shift: f32,
    /// From and to, factors of spine, neck, arms and legs.
    pub proportions: [f32; 2],
    /// From and to, factor of the shoulders' width.
    pub shoulders: [f32; 2],
    /// Whether trajectories are perturbed as well as key poses.
    pub both_views: bool,
}

/// How it is measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvaluationSettings {
    /// Which joints are asked for when several are.
    pub cross: Cross,
}

/// Which joints are asked for when several are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cross {
    /// Each of the 63 combinations of six joints is as likely as another.
    Combinations,
    /// Each number of joints is as likely as another.
    Number,
}
