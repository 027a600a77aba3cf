//! What can be said to `inkrig data`.

use crate::numbers;
use clap::{Args, Subcommand, ValueHint};
use inkrig_train::corpus::Shard;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig data build corpus.toml -o corpus
      read the folders that corpus.toml names; the same command goes on after it was stopped
  inkrig data build corpus.toml -o corpus --shard 3/8
      the third of eight shares, for as many machines
  inkrig data merge corpus.toml -o corpus
      after all shares: the lists, the statistics and the page

corpus.toml, paths relative to it:
  [[source]]
  name = \"mine\"
  folder = \"captures\"            # BVH, AMC, GLB, ... of any people, folders within folders
  licence = \"free\"               # a word to sort by; whoever uses the weights will ask
  index = \"captures.csv\"         # optional: file, subject, split, description
  include = [\"walk/\", \".bvh\"]   # optional: only files whose path within the folder holds one of these texts; exclude leaves files out
  subjects = { ann = \"test\" }    # who is only measured on; a subject is called as the index says, else as the first folder

  [[source]]
  name = \"amass\"
  folder = \"amass-joints\"
  licence = \"non-commercial\"
  format = \"joints\"              # .npz with a table joints, Jtr or positions, or .npy: frames x 22 or more x 3, metres
  up = \"z\"                       # or \"y\", which is usual
  frame_rate = 120               # of tables that do not say

  [[source]]
  name = \"humanml\"
  folder = \"HumanML3D\"           # new_joint_vecs or new_joints, texts, train.txt, val.txt, test.txt
  licence = \"non-commercial\"
  format = \"humanml3d\"";

/// Arguments of `inkrig data`.
#[derive(Debug, Args)]
pub struct DataArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: DataCommand,
}

/// What is done with a corpus.
#[derive(Debug, Subcommand)]
pub enum DataCommand {
    /// Turn folders of motion files into a corpus to train on
    #[command(after_help = EXAMPLES)]
    Build {
        #[command(flatten)]
        /// Which.
        corpus: CorpusArgs,
        /// Only this share of the files, for several machines: 3/8 is the third of eight
        #[arg(long, value_name = "I/N", value_parser = shard)]
        shard: Option<Shard>,
        /// Threads to work with; the result does not depend on it [default: all cores]
        #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
        threads: Option<usize>,
    },
    /// Make the lists, statistics and page of a corpus whose shares are all built
    Merge {
        #[command(flatten)]
        /// Which.
        corpus: CorpusArgs,
    },
}

/// A corpus.
#[derive(Debug, Args)]
pub struct CorpusArgs {
    /// The TOML file that says what is in it
    #[arg(value_name = "CONFIG.toml", value_hint = ValueHint::FilePath)]
    pub config: PathBuf,
    /// Its folder: a new or empty one, or one that holds it already (the same sources)
    #[arg(long, short, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
}

/// Reads `3/8`.
fn shard(text: &str) -> Result<Shard, String> {
    let parts =
        text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
    match parts {
        Some((index, count)) if (1..=count).contains(&index) => Ok(Shard { index, count }),
        _ => Err("give a number from 1 to the count of shares, such as 3/8".into()),
    }
}
