//! What can be said to `inkrig suggest`.

use super::ImportArgs;
use crate::guide::CANDIDATES;
use crate::numbers;
use crate::span::Span;
use clap::{Args, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig suggest dance.bvh --sheet poses.png
      eight poses worth a keyframe, and a picture of them
  inkrig suggest dance.bvh --map map.svg
      a map of the clip; draw a line over it in any drawing program, save it as line.svg, then
  inkrig align dance.bvh --curve line.svg --on-map -o new.bvh
      the dance passes the poses that the line passes";

/// Arguments of `inkrig suggest`.
#[derive(Debug, Args)]
pub struct SuggestArgs {
    /// The clip; or several of one skeleton
    #[arg(value_name = "CLIP", required = true, value_hint = ValueHint::FilePath)]
    pub clips: Vec<PathBuf>,
    /// How many poses
    #[arg(long, default_value_t = CANDIDATES, value_parser = numbers::poses, allow_negative_numbers = true)]
    pub count: usize,
    /// Write the map: every frame's place as JSON, or a picture to draw on as SVG
    #[arg(long, value_name = "FILE.json|FILE.svg", value_hint = ValueHint::FilePath)]
    pub map: Option<PathBuf>,
    /// Write a picture of the poses
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Use only a part of the clip (of every clip): frames of the file or seconds
    #[arg(long, value_name = "FROM..TO")]
    pub range: Option<Span>,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
    /// Threads to work with; the result does not depend on it [default: all cores, at most 16]
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    #[command(flatten)]
    /// How to read the clip.
    pub import: ImportArgs,
}
