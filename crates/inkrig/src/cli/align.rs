//! What can be said to `inkrig align`.

use super::{BakeArgs, ImportArgs, RootArgs, SidecarArgs};
use crate::numbers;
use crate::span::{Length, Span};
use clap::{Args, ValueEnum, ValueHint};
use inkrig_align::Norm;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  inkrig align dance.bvh --curve spiral.svg -o new.bvh
      ten seconds of dance that grows and shrinks with the drawing
  inkrig align dance.bvh --range 0s..20s --curve pen.csv --preset natural -o new.bvh --preview new.html
      only the first twenty seconds, nearer to the clip's own poses, with a page to look at
  inkrig align horse.bvh --curve eight.json --length 12s -o new.bvh --sheet new.png --report new.json
      twelve seconds, with a contact sheet and the numbers
  inkrig align walk.bvh run.bvh --like horse.bvh --loop -o new.bvh
      two clips of one skeleton move as a horse does, in a loop

  inkrig align wolf.glb#Walk wolf.glb#Gallop --laps 6 --like hero.glb#Run -o new.glb
      loops of a game character, six rounds of each, move as another file's clip does

  inkrig align walk.bvh --wave 'sine(0.5Hz..2Hz) for 10s' -o new.bvh
      a movement that comes and goes, faster and faster
  inkrig align person.bvh --labels 'A:3s B:2s A:3s' --key '4s=frame:320' -o new.bvh
      two kinds of movement in turn; four seconds in, the pose of frame 320 of the clip
  inkrig align walk.bvh --curve pen.csv --path way.svg --root bone -o new.bvh
      along a path that is drawn as seen from above, with a root bone for a game engine
  inkrig align dance.bvh --curve pen.csv --fix 2s..4s --fix-from first.bvh -o second.bvh
      the third and fourth second of an earlier result stay as they are, the rest is made anew
  inkrig align hero.glb --curve pen.csv --key 2s=frame:120 --bake sparse -o new.glb
      few keys with curves for editing; the exact pose is one of them

Curves: JSON ([[x,y],...] or [[x,y,t],...]), CSV (x,y or x,y,t; n rows without t are n frames of 30 a second), SVG (its paths).
A CSV of more columns is a curve of as many dimensions; a header such as x,y,z or x,y,t says which.";

/// Arguments of `inkrig align`.
#[derive(Debug, Args)]
pub struct AlignArgs {
    /// The clip to arrange: a motion file with any skeleton, or several of one skeleton; of a file that holds several
    /// clips, one (wolf.glb#Gallop) or all that fit ('wolf.glb#Idle*')
    #[arg(value_name = "CLIP", required = true, value_hint = ValueHint::FilePath)]
    pub clips: Vec<PathBuf>,
    #[command(flatten)]
    /// What to follow.
    pub control: ControlArgs,
    /// The file to write: .bvh, .glb (a clip of a GLB goes back into a copy of it), .fbx, .usda, .vrma
    #[arg(long, short, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// A pose at a time, exactly (0.5s=frame:120), or softly at a time, place or label, also a pose of another clip
    /// (0.5s~frame:120, 0.3,-1~frame:120*0.5, label:walk~other.bvh:120, frame:45~frame:120, sound:1.5s~frame:120)
    #[arg(long = "key", value_name = "KEY", help_heading = "Keyframes", allow_hyphen_values = true)]
    pub keys: Vec<String>,
    /// A pose to keep away from, also one of another clip (frame:120, or with distance and weight other.bvh:120~1*0.5)
    #[arg(long = "avoid", value_name = "POSE", help_heading = "Keyframes")]
    pub avoids: Vec<String>,
    /// A pose that must not appear at all (frame:120, other.bvh:120, or with a radius frame:120~0.5)
    #[arg(long = "never", value_name = "POSE", help_heading = "Keyframes")]
    pub nevers: Vec<String>,
    /// Keep this part of an earlier result as it is, to the byte, and make the rest anew around it; may be repeated
    #[arg(long = "fix", value_name = "FROM..TO", help_heading = "Keyframes", requires = "fix_from")]
    pub fixes: Vec<Span>,
    /// The earlier result that --fix keeps parts of
    #[arg(long, value_name = "FILE.bvh", value_hint = ValueHint::FilePath, help_heading = "Keyframes", requires = "fixes")]
    pub fix_from: Option<PathBuf>,
    /// All kinds of keyframes from a JSON file
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath, help_heading = "Keyframes")]
    pub key_file: Option<PathBuf>,
    /// The curve is drawn over the clip's map (see inkrig suggest --map): where it is, the map's pose there is meant
    #[arg(long, requires = "curve", help_heading = "Keyframes")]
    pub on_map: bool,
    /// Make a loop: the end goes over into the beginning
    #[arg(long = "loop")]
    pub cyclic: bool,
    /// Use only a part of the clip (of every clip): frames of the file or seconds
    #[arg(long, value_name = "FROM..TO")]
    pub range: Option<Span>,
    /// Play clips that are loops so many times: walks and idles of game characters are a second or two
    #[arg(long, value_name = "TIMES", default_value_t = 1, value_parser = numbers::times, allow_negative_numbers = true)]
    pub laps: usize,
    /// Length of the result (of each time with --repeat): frames of 30 a second, at most 100000, or seconds; else the curve's own
    #[arg(long, value_name = "300|10s", value_parser = numbers::length, allow_negative_numbers = true)]
    pub length: Option<Length>,
    /// Follow it so many times, one after the other: for a bar of music, or a figure that is drawn once
    #[arg(long, value_name = "TIMES", default_value_t = 1, value_parser = numbers::times, allow_negative_numbers = true)]
    pub repeat: usize,
    /// Ignore the speed of drawing: move along the curve evenly
    #[arg(long)]
    pub uniform: bool,
    /// Follow the drawing closely, or stay near to the clip's own poses
    #[arg(long, value_enum, default_value_t = PresetArg::Follow)]
    pub preset: PresetArg,
    /// Frames a second of the result, 0.1 to 1000; else the clip's own
    #[arg(long, value_name = "RATE", value_parser = numbers::fps, allow_negative_numbers = true)]
    pub fps: Option<f64>,

    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub report: Option<PathBuf>,
    /// Write a page to look at: the curve beside the moving character
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub preview: Option<PathBuf>,
    /// Write a contact sheet of poses
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath, help_heading = "More results")]
    pub sheet: Option<PathBuf>,
    /// Replace files that are there already
    #[arg(long, help_heading = "More results")]
    pub force: bool,

    /// Weight of the drawing's structure against nearness to the clip, 0 to 1 [default: 0.9, natural: 0.7]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub alpha: Option<f64>,
    /// Weight of using the whole clip evenly [default: 0.05, labels 0.2, sound 0.02]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub lambda: Option<f64>,
    /// How many poses may be mixed into one; smaller is sharper [default: 0.005, labels 0.0025, sound 0.01]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub epsilon: Option<f64>,
    /// Length of the pieces that are matched, seconds [default: 0.367]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub patch: Option<f64>,
    /// Number of levels from coarse to fine [default: 6]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub levels: Option<usize>,
    /// How many times shorter the coarsest level is [default: 4]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub ratio: Option<f64>,
    /// Solver gradients of every round [default: 4]
    #[arg(long, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub iterations: Option<usize>,
    /// Smoothing of the curve or the sound, frames of 30 a second; 0 for none [default: 2, for a sound 2.7, for a curve of
    /// more than two dimensions 0]
    #[arg(long, value_name = "FRAMES", value_parser = numbers::smooth, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub smooth: Option<f64>,
    /// Another seed finds another of the equally good solutions
    #[arg(long, default_value_t = 0, value_parser = numbers::seed, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub seed: u64,
    /// The mirrored solution: what the control has alike on two sides changes places
    #[arg(long, help_heading = "Other solutions")]
    pub mirror: bool,
    /// Write up to so many solutions that differ and fit about as well (2 to 4), as OUT-2.bvh and so on
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = numbers::solutions, allow_negative_numbers = true, help_heading = "Other solutions")]
    pub solutions: usize,
    /// By what distances are scaled: mean, max, quantile or learned; of one side as source=mean,control=learned
    /// [default: mean; for --like quantile; for --sound source=mean,control=quantile]
    #[arg(long, value_name = "NORM", value_parser = norms, help_heading = "Fine tuning")]
    pub norm: Option<Norms>,
    /// Compare and carry travel along world axes, or relative to where the character is headed
    #[arg(long, value_enum, help_heading = "Fine tuning")]
    pub velocity: Option<VelocityArg>,
    /// Compare rotations relative to the parent joint, or to the root
    #[arg(long, value_enum, help_heading = "Fine tuning")]
    pub rotations: Option<RotationArg>,
    /// How the matching is solved; by size unless said [default: auto]
    #[arg(long, value_enum, help_heading = "Fine tuning")]
    pub solver: Option<SolverArg>,
    /// Threads to work with; the result does not depend on it [default: all cores, at most 16]
    #[arg(long, value_parser = numbers::threads, allow_negative_numbers = true, help_heading = "Fine tuning")]
    pub threads: Option<usize>,

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
    /// How to read the clip.
    pub import: ImportArgs,
}

/// What a motion can follow: one of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub struct ControlArgs {
    /// Follow a drawn curve: JSON, CSV or SVG
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "What to follow")]
    pub curve: Option<PathBuf>,
    /// Follow a wave: an expression, a CSV or JSON file of values, or a WAV as a curve (of music its outline)
    #[arg(long, value_name = "WAVE|FILE", help_heading = "What to follow", allow_hyphen_values = true)]
    pub wave: Option<String>,
    /// Follow labels: which movement each is, is found by itself
    #[arg(long, value_name = "A:30 B:45|FILE", help_heading = "What to follow")]
    pub labels: Option<String>,
    /// Follow music or speech: WAV, FLAC, OGG or MP3
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "What to follow")]
    pub sound: Option<PathBuf>,
    /// Follow another motion, of any skeleton
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "What to follow")]
    pub like: Option<PathBuf>,
}

impl ControlArgs {
    /// The file that is followed.
    pub fn file(&self) -> Option<PathBuf> {
        let text = self.wave.as_deref().or(self.labels.as_deref());
        let path = self.curve.as_ref().or(self.sound.as_ref()).or(self.like.as_ref());
        path.cloned().or_else(|| text.and_then(crate::commands::control::file_in))
    }

    /// The wave or labels themselves, where they were given as text.
    pub fn text(&self) -> Option<&str> {
        let text = self.wave.as_deref().or(self.labels.as_deref())?;
        crate::commands::control::file_in(text).is_none().then_some(text)
    }
}

/// By what distances within the clip and within the control are scaled, where it was said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Norms {
    /// Within the clip.
    pub source: Option<Norm>,
    /// Within the control.
    pub control: Option<Norm>,
}

/// Reads `mean`, for both sides, or `source=mean,control=learned`, for one or both by name.
fn norms(text: &str) -> Result<Norms, String> {
    let norm = |name: &str| match name {
        "mean" => Ok(Norm::Mean),
        "max" => Ok(Norm::Max),
        "quantile" => Ok(Norm::Quantile),
        "learned" => Ok(Norm::Learned),
        _ => Err("give mean, max, quantile or learned, or source=mean,control=learned".to_string()),
    };
    if !text.contains('=') {
        let both = Some(norm(text)?);
        return Ok(Norms { source: both, control: both });
    }
    let mut norms = Norms::default();
    for part in text.split(',') {
        let (side, name) = match part.trim().split_once('=') {
            Some(("source", name)) => (&mut norms.source, name),
            Some(("control", name)) => (&mut norms.control, name),
            _ => return Err(format!("'{part}' is neither source=NORM nor control=NORM")),
        };
        if side.replace(norm(name)?).is_some() {
            return Err(format!("'{part}' says a side twice"));
        }
    }
    if norms.source == Some(Norm::Learned) {
        return Err("only the control's distances can be learned: they are fitted to the clip's".to_string());
    }
    Ok(norms)
}

/// Ways to solve the matching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverArg {
    /// By size: one of the others.
    Auto,
    /// Exact, for up to 4,000 frames; a thousand take a second or two.
    Dense,
    /// Nearly the same and faster, for up to 4,000 frames.
    #[value(name = "lowrank")]
    LowRank,
    /// For up to 100,000 frames.
    Sparse,
}

/// Presets of align.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PresetArg {
    /// Structure first.
    Follow,
    /// The clip's own poses first.
    Natural,
}

/// Frames in which travel is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VelocityArg {
    /// World axes.
    World,
    /// Where the character is headed.
    Heading,
}

/// Spaces in which rotations are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RotationArg {
    /// The parent joint's.
    Local,
    /// The root's.
    Root,
}
