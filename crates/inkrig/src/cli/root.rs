//! What can be said about travel over the ground, for every command that writes a motion.

use crate::numbers;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Where a motion goes, and which joint carries it there.
#[derive(Debug, Clone, Args)]
pub struct RootArgs {
    /// What carries the travel over the ground
    #[arg(long, value_enum, default_value_t = RootMode::Travel, help_heading = "Over the ground")]
    pub root: RootMode,
    /// Follow a ground path: a drawing seen from above (JSON, CSV, SVG), `straight`, or a curve to the left by
    /// degrees, `arc:90` (to the right `arc:-90`); `bend:90` bends the motion's own way
    #[arg(long, value_name = "FILE|straight|arc:90|bend:90", help_heading = "Over the ground")]
    pub path: Option<String>,
    /// Metres in one unit of the path's drawing, which then lies where its coordinates say; else the path is made as
    /// long as the motion travels and begins where it begins
    #[arg(long, value_name = "METRES", requires = "path", value_parser = numbers::unit, allow_negative_numbers = true, help_heading = "Over the ground")]
    pub path_scale: Option<f64>,
    /// Slower movements over the ground than about four times this are travel, quicker ones sway; 0: all is travel
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5, value_parser = numbers::sway, allow_negative_numbers = true, help_heading = "Over the ground")]
    pub sway: f64,
}

/// Ways to carry the travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RootMode {
    /// As it is
    Travel,
    /// None: the character stays where it begins, and keeps its sway, its height and its turning
    InPlace,
    /// A root bone on the ground carries travel and heading, the hips keep the rest
    Bone,
    /// The hips carry all; a root bone is folded into them
    Hips,
}

impl RootArgs {
    /// The file of the path, where there is one.
    pub fn file(&self) -> Option<PathBuf> {
        self.path.as_deref().filter(|path| !is_shape(path)).map(PathBuf::from)
    }
}

/// Whether a path is named by its shape.
pub(crate) fn is_shape(path: &str) -> bool {
    path == "straight" || path.starts_with("arc:") || path.starts_with("bend:")
}
