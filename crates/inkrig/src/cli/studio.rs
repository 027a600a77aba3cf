//! What can be said to `inkrig studio`.

use crate::numbers;
use clap::{Args, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "Examples:
  inkrig studio --open                         draw in the browser, on the project in ./inkrig-studio
  inkrig studio dance.bvh song.mp3             begin with your own files
  inkrig studio --project walk-cycle           another project: a folder of plain files
  inkrig studio --lan                          draw on a tablet: scan the code that is printed";

/// Arguments of `inkrig studio`.
#[derive(Debug, Args)]
pub struct StudioArgs {
    /// Motions, characters, sounds and drawings to begin with
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,
    /// The folder of the project; made if it is not there, gone on with if it is
    #[arg(long, value_name = "FOLDER", default_value = "inkrig-studio", value_hint = ValueHint::DirPath)]
    pub project: PathBuf,
    /// The port to listen on; 0 for any that is free
    #[arg(long, default_value_t = 4747)]
    pub port: u16,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// Let other devices of the local network draw, each with a token that is good once
    #[arg(long)]
    pub lan: bool,
    /// A name under which those devices find this machine, if its address is not to be printed
    #[arg(long = "name", value_name = "NAME", requires = "lan")]
    pub names: Vec<String>,
    /// Threads to solve with; the result does not depend on it
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Serve the page from this folder, for work on it
    #[arg(long, value_name = "FOLDER", hide = true)]
    pub page: Option<PathBuf>,
}
