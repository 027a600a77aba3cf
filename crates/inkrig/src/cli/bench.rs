//! What can be said to `inkrig bench`.

use super::ImportArgs;
use crate::bench::Parameter;
use crate::numbers;
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  inkrig bench align
      every case of our own samples, as a table
  inkrig bench align my-clips --markdown table.md
      the BVH files of a folder too, the table in a file
  inkrig bench align --case labels --case chirp
      only cases with one of these words in their names
  inkrig bench align --sweep alpha,lambda --out sweep
      what two parameters do, as a page with pictures";

/// Arguments of `inkrig bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// What to measure.
    #[command(subcommand)]
    pub what: BenchCommand,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Align beside a stretched clip, random pieces, the nearest patch and a single stage
    #[command(after_help = EXAMPLES)]
    Align(Box<BenchAlignArgs>),
}

/// Arguments of `inkrig bench align`.
#[derive(Debug, Args)]
pub struct BenchAlignArgs {
    /// A folder of BVH files: each is tried with a drawing, a wave, labels and a sound
    #[arg(value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Only cases whose names contain this; may be given again
    #[arg(long = "case", value_name = "WORD")]
    pub cases: Vec<String>,
    /// Run everything that often and keep the least time
    #[arg(long, value_name = "TIMES", default_value_t = 3, value_parser = numbers::repeats)]
    pub repeat: usize,
    /// Threads to work with; figures of quality do not depend on it [default: all cores, at most 16]
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Another seed: other scouts, other random pieces
    #[arg(long, default_value_t = 0, value_parser = numbers::seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Try these parameters at several values instead: alpha, lambda, epsilon, levels
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "out")]
    pub sweep: Vec<Parameter>,
    /// A folder for the table as Markdown and JSON, or for the sweep's page and pictures; made if it is not there
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Write the table as Markdown
    #[arg(long, value_name = "FILE.md", value_hint = ValueHint::FilePath)]
    pub markdown: Option<PathBuf>,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    /// How to read the clips of the folder.
    pub import: ImportArgs,
}
