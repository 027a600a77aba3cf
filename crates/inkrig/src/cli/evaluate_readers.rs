//! What can be said to `inkrig evaluate` of the readers of drawings.

use clap::{Args, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig evaluate sketch --corpus corpus
      how well joints are found in drawings of people who were not trained on, and in a style that was not
  inkrig evaluate sketch --corpus corpus --by-style --sheet styles.png
      which styles of drawing are read best
  inkrig evaluate sketch --drawings drawings --sheet seen.png
      the same on drawings whose joints somebody marked, with a picture of what was found
  inkrig evaluate word --fonts fonts
      how well words are read in fonts that were not trained on";

/// Arguments of `inkrig evaluate sketch`.
#[derive(Debug, Args)]
pub struct EvaluateSketchArgs {
    /// The corpus whose test split is drawn
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath, required_unless_present = "drawings")]
    pub corpus: Option<PathBuf>,
    /// A folder of drawings with marked joints: in folders of their own, texture.png with char_cfg.yaml
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub drawings: Option<PathBuf>,
    /// Drawings of each kind
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub count: u32,
    /// Each learned style by itself, too
    #[arg(long, requires = "corpus")]
    pub by_style: bool,
    /// Weights [default: those that come with the program]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub weights: Option<PathBuf>,
    /// Measure the reading by lines, without weights
    #[arg(long, conflicts_with = "weights")]
    pub lines: bool,
    /// The first drawings of every kind with the joints that were found, a row each, and below the first marked ones, as PNG
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Replace a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `inkrig evaluate word`.
#[derive(Debug, Args)]
pub struct EvaluateWordArgs {
    /// The fonts
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub fonts: PathBuf,
    /// The settings of the training, which name the fonts that were held out
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,
    /// How often every word is written
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// Weights [default: those that come with the program]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub weights: Option<PathBuf>,
}
