//! What can be said to `inkrig convert`.

use super::{BakeArgs, ImportArgs, RootArgs, SidecarArgs};
use crate::numbers;
use crate::span::{Length, Span};
use clap::{Args, ValueEnum, ValueHint};
use inkrig_formats::Format;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig convert walk.bvh walk.glb
      one file, in the format that its new name says
  inkrig convert dance.glb dance.bvh --clip Waltz --fps 30
      one clip of several, at another rate
  inkrig convert 'mocap/*.amc' out --to glb
      many files to a folder; what cannot be read is said, the others are converted
  inkrig convert run.bvh cycle.bvh --loop 24 --root in-place
      a loop of exactly 24 frames, on the spot
  inkrig convert walk.bvh walk.glb --bake sparse --tolerance 1mm,0.5deg
      few keys with curves, for editing
  inkrig convert walk.bvh walk-on-twos.bvh --bake stepped --on 2s
      every pose held for two frames of 24 a second";

/// Arguments of `inkrig convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The files to convert; a pattern such as '*.bvh' means all files whose names fit
    #[arg(value_name = "IN", required = true, value_hint = ValueHint::FilePath)]
    pub inputs: Vec<PathBuf>,
    /// The file to write (.bvh, .glb, .fbx, .usda, .vrma); with --to the folder, which is made if it is not there
    #[arg(value_name = "OUT", required = true, value_hint = ValueHint::AnyPath)]
    pub out: PathBuf,
    /// Write each file to the folder OUT, in this format
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub to: Option<ToArg>,
    /// Frames a second of the result, 0.1 to 1000; else the file's own
    #[arg(long, value_name = "RATE", value_parser = numbers::fps, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// Use only a part of the clip: frames of the file or seconds
    #[arg(long, value_name = "FROM..TO")]
    pub range: Option<Span>,
    /// Make a loop of exactly so many frames of the result (or seconds) out of a clip that nearly repeats
    #[arg(long = "loop", value_name = "24|1s", value_parser = numbers::length, allow_negative_numbers = true)]
    pub cyclic: Option<Length>,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    /// The record beside the result.
    pub sidecar: SidecarArgs,
    #[command(flatten)]
    /// Keys of the result.
    pub bake: BakeArgs,
    #[command(flatten)]
    /// Where the result goes over the ground.
    pub root: RootArgs,
    #[command(flatten)]
    /// How to read the files.
    pub import: ImportArgs,
}

/// Formats that a file of any format can become.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ToArg {
    /// Biovision hierarchy
    Bvh,
    /// glTF 2.0 in one file: skeleton, motion and a body of capsules, or the clip put into a copy of the GLB it is from
    Glb,
    /// Autodesk's exchange format, binary: skeleton, motion and a body of capsules
    Fbx,
    /// USD as text
    Usda,
}

impl ToArg {
    /// The format.
    pub fn format(self) -> Format {
        match self {
            Self::Bvh => Format::Bvh,
            Self::Glb => Format::Glb,
            Self::Fbx => Format::Fbx,
            Self::Usda => Format::Usda,
        }
    }
}
