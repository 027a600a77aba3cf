//! What can be said to `inkrig generate`.

use super::SidecarArgs;
use crate::numbers;
use crate::span::Length;
use clap::{Args, ValueEnum, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = r#"Examples:
  inkrig generate --word jump -o jump.bvh
      two seconds of a jump; another --seed is another jump
  inkrig generate --word kick --seed 3 --sheet kick.png -o kick.glb
      with a picture of its poses
  inkrig generate --word kick --keypose3d pose.json --trajectory3d foot.json -o kick.glb
      with the pose of one frame, and the way of a joint
  inkrig generate --model mine.safetensors --word "walk and jump" --seed 7 -o jump.bvh
      with another model than the one inside the program

pose.json is a list of 22 points [x, y, z], or {"frame": 12, "joints": [22 points]}.
foot.json is {"joint": "right_foot", "points": [[0.1, 0.05, 0], ...]}, a point a frame from the first on, or with
"frames": [0, 5, 10] only at those; or a list of such, for several joints. Metres, y up; 20 frames a second; the motion
begins above the origin and faces +z. Joints, by name or number from 0: pelvis, left_hip, right_hip, spine1, left_knee,
right_knee, spine2, left_ankle, right_ankle, spine3, left_foot, right_foot, neck, left_collar, right_collar, head,
left_shoulder, right_shoulder, left_elbow, right_elbow, left_wrist, right_wrist.

inkrig model import makes model files of published weights."#;

/// Arguments of `inkrig generate`.
#[derive(Debug, Args)]
pub struct GenerateArgs {
    /// The model file [default: the one that INKRIG_MODEL names, else the one that comes with inkrig]
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub model: Option<PathBuf>,
    /// What is done: kick, or "walk and turn"
    #[arg(long, value_name = "TEXT")]
    pub word: String,
    /// A pose that one frame shall have: 22 points in space
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub keypose3d: Option<PathBuf>,
    /// Where joints shall pass: points in space
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub trajectory3d: Option<PathBuf>,
    /// The file to write: .bvh, .glb, .fbx, .usda, .vrma
    #[arg(long, short, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Which of the motions: the same seed gives the same
    #[arg(long, default_value_t = 0, value_parser = numbers::seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Steps from noise to motion: ddim (50), or 1, 2 or 4 of a model that was distilled for few, as the one that comes with inkrig also is [default: ddim, or 2 of a distilled one]
    #[arg(long)]
    pub steps: Option<StepsArg>,
    /// What denoising begins with: a motion of the word's verb that the model has learned from, made so noisy that most of it is lost, or noise alone
    /// [default: example, where the model has some, fifty steps are taken, and nothing is asked for but the word]
    #[arg(long, value_enum)]
    pub start: Option<StartArg>,
    /// How much more the word counts than no word does: more is clearer and less varied, far more is no motion [default: the
    /// model's own]
    #[arg(long, value_name = "WEIGHT", value_parser = numbers::text_weight, allow_negative_numbers = true)]
    pub text_weight: Option<f64>,
    /// How long: frames of 20 a second (40), or seconds (2s); the model inside the program makes 2 to 252 frames
    #[arg(long, visible_alias = "frames", value_name = "LENGTH", default_value = "40", value_parser = numbers::clip_length, allow_negative_numbers = true)]
    pub length: Length,
    /// Whether the motion is drawn to the trajectory at every step [default: soft]
    #[arg(long)]
    pub guidance: Option<GuidanceArg>,
    /// Whether feet are put on the floor and kept where they stand, or left as the model makes them
    #[arg(long, value_enum, default_value_t = GroundArg::On)]
    pub ground: GroundArg,
    /// For models that take T5's or CLIP's text: a folder with its config.json, tokenizer.json and model.safetensors
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub text_model: Option<PathBuf>,
    /// Write a contact sheet of poses
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Write what was made of what, and how well conditions are met, as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    /// The record beside the result.
    pub sidecar: SidecarArgs,
}

/// Steps from noise to motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StepsArg {
    /// One of a distilled model.
    #[value(name = "1")]
    One,
    /// Two of a distilled model.
    #[value(name = "2")]
    Two,
    /// Four of a distilled model.
    #[value(name = "4")]
    Four,
    /// Fifty, of a model that was not distilled.
    Ddim,
}

/// What denoising begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StartArg {
    /// A motion of the same verb.
    Example,
    /// Nothing but noise.
    Noise,
}

/// How trajectories are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GuidanceArg {
    /// By what the networks have learned only.
    Off,
    /// Drawn to them at every step.
    Soft,
}

/// What happens to feet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GroundArg {
    /// On the floor, and still while they stand.
    On,
    /// As they come.
    Off,
}
