//! What can be said to `inkrig sketch`.

use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig sketch read figure.png -o joints.json --picture seen.png
      where the joints of a drawn figure are, how sure that is, and a picture to check it by
  inkrig sketch word word.png
      which action a word in somebody's hand names";

/// Arguments of `inkrig sketch`.
#[derive(Debug, Args)]
pub struct SketchArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: SketchCommand,
}

/// What is done with a drawing.
#[derive(Debug, Subcommand)]
pub enum SketchCommand {
    /// Find the joints of a drawn figure
    #[command(after_help = EXAMPLES)]
    Read(SketchReadArgs),
    /// Read an action's word
    Word(SketchWordArgs),
}

/// Arguments of `inkrig sketch read`.
#[derive(Debug, Args)]
pub struct SketchReadArgs {
    /// The drawing: one figure on light paper as PNG or JPEG (.jpg), or its lines as SVG, JSON or CSV
    #[arg(value_name = "DRAWING", value_hint = ValueHint::FilePath)]
    pub drawing: PathBuf,
    /// Write the joints here
    #[arg(long, short, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Write the drawing with the joints over it
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub picture: Option<PathBuf>,
    /// Weights that `inkrig train sketch` wrote [default: those that come with the program]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub weights: Option<PathBuf>,
    /// Do without weights: follow the lines
    #[arg(long, conflicts_with = "weights")]
    pub lines: bool,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `inkrig sketch word`.
#[derive(Debug, Args)]
pub struct SketchWordArgs {
    /// The word: PNG or JPEG (.jpg), or its lines as SVG, JSON or CSV
    #[arg(value_name = "DRAWING", value_hint = ValueHint::FilePath)]
    pub drawing: PathBuf,
    /// Weights that `inkrig train word` wrote [default: those that come with the program]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub weights: Option<PathBuf>,
}
