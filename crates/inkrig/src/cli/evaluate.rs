//! What can be said to `inkrig evaluate`.

use super::StepsArg;
use super::evaluate_readers::{self, EvaluateSketchArgs, EvaluateWordArgs};
use crate::numbers;
use clap::{Args, Subcommand, ValueEnum, ValueHint};
use inkrig_train::corpus::Split;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig evaluate reconstruction --corpus corpus
      what the autoencoder loses of clips that it never saw, by subject
  inkrig evaluate control --corpus corpus
      how exactly key poses and trajectories are met, in space and as a camera sees them, with and without guidance
  inkrig evaluate control --corpus corpus --steps 2 --windows 40 --json > control.json
      the same of the model for few steps and of fewer clips, as JSON
  inkrig evaluate control --corpus corpus --model mine.safetensors
      of a model of your own
  inkrig evaluate storyboard --corpus corpus
      rough drawings of held-out clips as storyboards: what comes of them, with --exact off, soft and pin
  inkrig evaluate blending --corpus corpus
      how smooth transitions between held-out clips are, and how much guidance each takes";

/// Arguments of `inkrig evaluate`.
#[derive(Debug, Args)]
pub struct EvaluateArgs {
    /// What is measured.
    #[command(subcommand)]
    pub command: EvaluateCommand,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub enum EvaluateCommand {
    /// How well the joints of drawn figures are found
    #[command(after_help = evaluate_readers::EXAMPLES)]
    Sketch(EvaluateSketchArgs),
    /// How well words are read
    #[command(after_help = evaluate_readers::EXAMPLES)]
    Word(EvaluateWordArgs),
    /// How near motions of rough storyboards come to the clips that these were drawn of
    #[command(after_help = EXAMPLES)]
    Storyboard(EvaluateStoryboardArgs),
    /// How smooth transitions between clips are, by how much guidance they were given
    #[command(after_help = EXAMPLES)]
    Blending(EvaluateBlendingArgs),
    /// How well clips survive the autoencoder, subject by subject
    #[command(after_help = EXAMPLES)]
    Reconstruction {
        #[command(flatten)]
        /// Of what.
        on: EvaluateOnArgs,
    },
    /// How exactly key poses and trajectories are met
    #[command(after_help = EXAMPLES)]
    Control {
        #[command(flatten)]
        /// Of what.
        on: EvaluateOnArgs,
        /// Which joints are controlled: one after the other of six, or a set of them drawn for each clip
        #[arg(long, default_value = "both")]
        joints: JointsArg,
        /// Steps from noise to motion: ddim (50), or 1, 2 or 4 of a model that was distilled for few [default: ddim or 2]
        #[arg(long)]
        steps: Option<StepsArg>,
        /// Guidance at every so many steps
        #[arg(long, default_value_t = 1)]
        guide_every: usize,
        /// How much more the text counts than nothing does
        #[arg(long, value_name = "WEIGHT", value_parser = numbers::text_weight, allow_negative_numbers = true)]
        text_weight: Option<f64>,
        /// Of noise, cameras and joints
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
}

/// Arguments of `inkrig evaluate blending`.
#[derive(Debug, Args)]
pub struct EvaluateBlendingArgs {
    /// The corpus, made by inkrig data build
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub corpus: PathBuf,
    /// The model file [default: the one that INKRIG_MODEL names, else the one that comes with inkrig]
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub model: Option<PathBuf>,
    /// Whose clips are put end to end
    #[arg(long, default_value = "test")]
    pub split: SplitArg,
    /// How many pairs, spread over all clips
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub pairs: u16,
}

/// Arguments of `inkrig evaluate storyboard`.
#[derive(Debug, Args)]
pub struct EvaluateStoryboardArgs {
    /// The corpus, made by inkrig data build
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub corpus: PathBuf,
    /// The model file [default: the one that INKRIG_MODEL names, else the one that comes with inkrig]
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub model: Option<PathBuf>,
    /// Whose clips are drawn
    #[arg(long, default_value = "test")]
    pub split: SplitArg,
    /// How many clips, spread over all
    #[arg(long, default_value_t = 30, value_parser = numbers::windows, allow_negative_numbers = true)]
    pub windows: usize,
    /// Steps from noise to motion: ddim (50), or 1, 2 or 4 of a model that was distilled for few
    #[arg(long)]
    pub steps: Option<StepsArg>,
    /// How many motions are made of a drawing, of which the best is taken
    #[arg(long, value_name = "NUMBER", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub candidates: u16,
    /// The motion is drawn to the lines at every so many steps, the last among them
    #[arg(long, value_name = "STEPS", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub guide_every: u16,
    /// Of drawings and noise
    #[arg(long, default_value_t = 0, value_parser = numbers::seed, allow_negative_numbers = true)]
    pub seed: u64,
}

/// The model, and the clips that it is measured on.
#[derive(Debug, Args)]
pub struct EvaluateOnArgs {
    /// The corpus, made by inkrig data build
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub corpus: PathBuf,
    /// The model file [default: the one that INKRIG_MODEL names, else the one that comes with inkrig]
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub model: Option<PathBuf>,
    /// Whose clips: those of test, or those that training looked at (val), or learned (train)
    #[arg(long, default_value = "test")]
    pub split: SplitArg,
    /// Frames of a clip, 20 a second
    #[arg(long, default_value_t = 40)]
    pub frames: usize,
    /// At most so many clips, spread over all [default: all for reconstruction, 100 for control]
    #[arg(long, value_parser = numbers::windows, allow_negative_numbers = true)]
    pub windows: Option<usize>,
}

/// Parts of a corpus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SplitArg {
    /// Learned from.
    Train,
    /// Looked at while learning.
    Val,
    /// Only measured on.
    Test,
}

impl From<SplitArg> for Split {
    fn from(split: SplitArg) -> Self {
        match split {
            SplitArg::Train => Self::Train,
            SplitArg::Val => Self::Val,
            SplitArg::Test => Self::Test,
        }
    }
}

/// Which joints are controlled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum JointsArg {
    /// One after the other of pelvis, feet, head and wrists.
    One,
    /// A set of them.
    Several,
    /// Both, one table.
    Both,
}
