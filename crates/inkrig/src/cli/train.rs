//! What can be said to `inkrig train`.

use crate::numbers;
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig train vae --corpus corpus -o runs/vae
      the autoencoder, with the settings of the small network
  inkrig train vae --corpus corpus -o runs/vae --config vae.toml --minutes 150
      other settings; stops after 150 minutes, and the same command goes on from there
  inkrig train sketch --corpus corpus -o runs/sketch
      the reader of drawn figures, which sees its poses drawn in many styles
  inkrig train word --fonts fonts -o runs/word
      the reader of words, out of fonts (.ttf, .otf, single lines as .svg)

Stop at any moment: nothing but the steps since the last checkpoint is lost.";

pub(super) const DENOISER_EXAMPLES: &str = "\
Examples:
  inkrig train denoiser --vae runs/vae/best.safetensors --corpus corpus -o runs/denoiser
      then: inkrig generate --model runs/denoiser/best.safetensors --word walk -o walk.bvh";

pub(super) const CONTROL_EXAMPLES: &str = "\
Examples:
  inkrig train control --model runs/denoiser/best.safetensors --corpus corpus -o runs/control
      then: inkrig generate --model runs/control/best.safetensors --word kick --trajectory3d foot.json -o kick.bvh";

pub(super) const ALIGN_EXAMPLES: &str = "\
Examples:
  inkrig train align --model runs/control/best.safetensors --corpus corpus -o runs/align";

pub(super) const DISTILL_EXAMPLES: &str = "\
Examples:
  inkrig train distill --model runs/align/best.safetensors --corpus corpus -o runs/distill
      a whole model with control: inkrig generate --model runs/distill/best.safetensors --word kick --steps 2 -o kick.bvh";

pub(super) const CURVES_EXAMPLES: &str = "\
Examples:
  inkrig train curves runs/vae -o curves.html";

/// Arguments of `inkrig train`.
#[derive(Debug, Args)]
pub struct TrainArgs {
    /// The stage.
    #[command(subcommand)]
    pub stage: TrainStage,
}

/// Stages of training.
#[derive(Debug, Subcommand)]
pub enum TrainStage {
    /// The reader of drawn figures
    #[command(after_help = EXAMPLES)]
    Sketch {
        /// The corpus, made by inkrig data build
        #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
        corpus: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        pace: PaceArgs,
    },
    /// The reader of words
    #[command(after_help = EXAMPLES)]
    Word {
        /// A folder of fonts
        #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
        fonts: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        pace: PaceArgs,
    },
    /// The autoencoder, which everything else stands on
    #[command(after_help = EXAMPLES)]
    Vae {
        #[command(flatten)]
        /// Where and how long.
        run: RunArgs,
    },
    /// The denoiser and the vectors of verbs, on latents of a finished autoencoder
    #[command(after_help = DENOISER_EXAMPLES)]
    Denoiser {
        /// The autoencoder: a model file that inkrig train vae wrote
        #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
        vae: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        run: RunArgs,
    },
    /// Control by trajectories and key poses in space, on a finished denoiser
    #[command(after_help = CONTROL_EXAMPLES)]
    Control {
        /// The denoiser: a model file that inkrig train denoiser wrote
        #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
        model: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        run: RunArgs,
    },
    /// Encoders of drawn trajectories and key poses, on finished control
    #[command(after_help = ALIGN_EXAMPLES)]
    Align {
        /// The control: a model file that inkrig train control wrote
        #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
        model: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        run: RunArgs,
    },
    /// The denoiser once more, for one to four steps
    #[command(after_help = DISTILL_EXAMPLES)]
    Distill {
        /// A model file of any stage after the denoiser
        #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
        model: PathBuf,
        #[command(flatten)]
        /// Where and how long.
        run: RunArgs,
    },
    /// The log of a run as a page with pictures
    #[command(after_help = CURVES_EXAMPLES)]
    Curves {
        /// The folder of the run
        #[arg(value_name = "RUN", value_hint = ValueHint::DirPath)]
        run: PathBuf,
        /// The page to write
        #[arg(long, short, value_name = "FILE.html", value_hint = ValueHint::FilePath)]
        out: PathBuf,
        /// Replace a file that is there already
        #[arg(long)]
        force: bool,
    },
}

/// Where and how long to train.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The corpus, made by inkrig data build
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub corpus: PathBuf,
    /// The folder of the run: checkpoint, log, weights. One that is there already is gone on with
    #[arg(long, short, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Settings that differ from the usual ones
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,
    /// Weights to begin with, of an earlier run whose checkpoint is gone; its rate rises anew
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub from: Option<PathBuf>,
    /// Stop after so many minutes, to go on later
    #[arg(long, value_name = "MINUTES", value_parser = numbers::minutes, allow_negative_numbers = true)]
    pub minutes: Option<f64>,
    /// Copies of the network that work side by side, one a thread [default: one a core]
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
    pub replicas: Option<usize>,
}

/// Where and how long to train a reader.
#[derive(Debug, Args)]
pub struct PaceArgs {
    /// The folder of the run: checkpoint, log, weights. One that is there already is gone on with
    #[arg(long, short, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Settings that differ from the usual ones
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,
    /// Stop after so many minutes, to go on later
    #[arg(long, value_name = "MINUTES", value_parser = numbers::minutes, allow_negative_numbers = true)]
    pub minutes: Option<f64>,
    /// Threads to work with; the result does not depend on it [default: all cores, at most 16]
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
}
