//! What can be said to `inkrig retarget`.

use super::{BakeArgs, ImportArgs, SidecarArgs};
use crate::numbers;
use crate::span::Span;
use clap::{Args, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig retarget walk.bvh --onto hero.glb -o hero-walk.glb
      the walk in a copy of your character's own file, mesh and materials as they are
  inkrig retarget dance.glb --clip Waltz --onto dancer.bvh -o waltz.bvh --sheet waltz.png
      one clip of several, on another skeleton, with a contact sheet
  inkrig retarget walk.bvh --onto hero.glb -o hero-walk.glb --report walk.json --strict
      the certificate as a file; nothing is written where a limit is not kept
  inkrig retarget walk.bvh --onto hero.glb -o hero-walk.glb --bake sparse
      few keys with curves, for editing
  inkrig retarget trot.glb --onto fox.glb -o fox-trot.glb --preview trot.html
      one animal on four legs as another moves, with a page that shows both
  inkrig retarget walk.bvh --onto robot.glb --suggest-map -o map.json
  inkrig retarget walk.bvh --onto robot.glb --map map.json -o robot-walk.glb
      which joint follows which, written to a file; and carried over as the file then says

The certificate says how exact the result is: how well limbs point where they did (limit: 5 degrees for 95 of 100
frames), how far standing feet slide (limit: 5 mm a frame), float (20 mm) or sink into the ground (20 mm), and more;
docs/retarget.md has all of it. Joints are known by the names of common programs, else by the skeleton's build.";

/// Arguments of `inkrig retarget`.
#[derive(Debug, Args)]
pub struct RetargetArgs {
    /// The motion: a file of any format that is read
    #[arg(value_name = "MOTION", value_hint = ValueHint::FilePath)]
    pub motion: PathBuf,
    /// The character that shall move so: a file of any format that is read, with or without a motion
    #[arg(long, value_name = "CHARACTER", value_hint = ValueHint::FilePath)]
    pub onto: PathBuf,
    /// The file to write: .bvh, .glb (for a character from a GLB a copy of it with the new clip), .fbx, .usda, .vrma;
    /// with --suggest-map a .json
    #[arg(long, short, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Size of the character over that of the one in the motion; else the ratio of their hips' heights
    #[arg(long, value_name = "RATIO", value_parser = numbers::scale, allow_negative_numbers = true)]
    pub scale: Option<f64>,
    /// Which joint follows which: a file that --suggest-map wrote and you have changed
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath, conflicts_with = "suggest_map")]
    pub map: Option<PathBuf>,
    /// Only write which joint would follow which, to be changed and given with --map
    #[arg(long, conflicts_with_all = ["strict", "report", "sheet", "preview"])]
    pub suggest_map: bool,
    /// Do not hold standing feet in place
    #[arg(long)]
    pub no_keep_feet: bool,
    /// Frames a second of the result, 0.1 to 1000; else the motion's own
    #[arg(long, value_name = "RATE", value_parser = numbers::fps, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// Use only a part of the motion: frames of the file or seconds
    #[arg(long, value_name = "FROM..TO")]
    pub range: Option<Span>,
    /// Write the result only if the certificate's limits are kept
    #[arg(long)]
    pub strict: bool,
    /// Write the certificate as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub report: Option<PathBuf>,
    /// Write a page that shows the result, with the motion beside it
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub preview: Option<PathBuf>,
    /// Write a contact sheet: poses of the motion, in the character's size, beside those of the result
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub sheet: Option<PathBuf>,
    /// Replace files that are there already
    #[arg(long, help_heading = "More results")]
    pub force: bool,
    #[command(flatten)]
    /// The record beside the result.
    pub sidecar: SidecarArgs,
    #[command(flatten)]
    /// Keys of the result.
    pub bake: BakeArgs,
    #[command(flatten)]
    /// How to read the motion.
    pub import: ImportArgs,
}
