//! What can be said to `inkrig redo`.

use clap::{Args, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig redo new.bvh.inkrig.json --list
      what was done, what would be read and written; nothing is done
  inkrig redo new.bvh.inkrig.json --check
      make new.bvh again and compare; nothing is written
  inkrig redo new.bvh.inkrig.json -o again.bvh
      make it again under another name

Paths of inputs are those of the first run: go to the folder that it was started in. Inputs that have changed, another
build of inkrig or another instruction level are refused, for the bytes would not be the same; see --anyway.";

/// Arguments of `inkrig redo`.
#[derive(Debug, Args)]
pub struct RedoArgs {
    /// The record beside a result
    #[arg(value_name = "OUT.inkrig.json", value_hint = ValueHint::FilePath)]
    pub sidecar: PathBuf,
    /// The file to write; else the one that the record lies beside
    #[arg(long, short, value_name = "NEW", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Say what would be read and written, and do nothing
    #[arg(long, conflicts_with_all = ["out", "check", "force", "anyway"])]
    pub list: bool,
    /// Make it and compare, but write nothing
    #[arg(long, conflicts_with_all = ["out", "force"])]
    pub check: bool,
    /// Go on with inputs that have changed, another build or another instruction level
    #[arg(long)]
    pub anyway: bool,
    /// Replace a file that is there already
    #[arg(long)]
    pub force: bool,
    /// Threads to work with; the result does not depend on it
    #[arg(long, value_parser = crate::numbers::threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
}
