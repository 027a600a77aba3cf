//! What can be said to `inkrig storyboard`.

use super::{SidecarArgs, StepsArg};
use crate::numbers;
use clap::{Args, ValueEnum, ValueHint};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = r#"Examples:
  inkrig storyboard kick.json -o kick.bvh
      a motion of the drawn frames
  inkrig storyboard kick.json --sheet kick.png -o kick.glb
      with a picture of what was drawn, what was read, and what was made
  inkrig storyboard kick.json --exact pin --seed 3 --report kick-report.json -o kick.glb
      on the lines that were drawn, another motion than with seed 0, and all that is known of it
  inkrig storyboard kick.json --preview kick.html -o kick.glb
      with a page that plays the motion beside the drawings
  inkrig storyboard kick.json --onto hero.glb -o hero-kick.glb
      on your own character, with a certificate of how exact it is there
  inkrig storyboard kick.json --lock-ends --report kick-report.json -o kick.glb
      after joints were moved in space ("edits" in the file): only that frame's motion changes, between its ends

  inkrig storyboard trot.json --engine example --examples wolf/ -o trot.glb
      from clips of your own, of any skeleton: a drawn way and a word are enough
  inkrig storyboard kick.json --engine both --examples kicks/ --report kick-report.json -o kick.glb
      the model begins with your clips; the report has it beside the model alone and the clips alone
  inkrig storyboard kick.json --video kick.webm -o kick.glb
      with a video of the motion beside the drawing; kick.gif for a GIF

docs/storyboard.md says how storyboards are drawn and written."#;

/// Arguments of `inkrig storyboard`.
#[derive(Debug, Args)]
pub struct StoryboardArgs {
    /// The storyboard: .json, .svg with layers or colours, or a page as .png or .jpg
    #[arg(value_name = "BOARD", value_hint = ValueHint::FilePath)]
    pub board: PathBuf,
    /// The file to write: .bvh, .glb, .fbx, .usda, .vrma
    #[arg(long, short, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// A character's file, which the animation is put on; where the best motions are beyond a limit of the certificate there, others are tried
    #[arg(long, value_name = "CHARACTER", value_hint = ValueHint::FilePath)]
    pub onto: Option<PathBuf>,
    /// What frames are made by: learned (the model), example (clips of --examples), both (the model, which begins with the clips; the report compares all three)
    #[arg(long, default_value = "learned")]
    pub engine: EngineArg,
    /// A folder of motion files of one skeleton, people or animals; words.csv or index.csv in it may say what is in a file
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub examples: Option<PathBuf>,
    /// How drawn lines and poses are met: off (only the word counts), soft (the motion is drawn to them while it is made),
    /// pin (and then moved until it meets them)
    #[arg(long, default_value = "soft")]
    pub exact: ExactArg,
    /// Which of the motions: the same seed gives the same
    #[arg(long, default_value_t = 0, value_parser = numbers::seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// How many motions are made of a frame, of which the best is taken; with --onto one that lands on the character [default: 4]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=64))]
    pub candidates: Option<u16>,
    /// How a frame goes over into the next: smooth (cubics), or model (made by the model, slower)
    #[arg(long, default_value = "smooth")]
    pub blend: BlendArg,
    /// Keep the first and the last pose of frames with edits, so that nothing after them moves
    #[arg(long)]
    pub lock_ends: bool,
    /// Write a motion for each frame too, beside OUT: OUT-1, OUT-2 ...
    #[arg(long)]
    pub clips: bool,
    /// The model file [default: the one that INKRIG_MODEL names, else the one that comes with inkrig]
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub model: Option<PathBuf>,
    /// Steps from noise to motion: ddim (50), or 1, 2 or 4 of a model that was distilled for few
    #[arg(long)]
    pub steps: Option<StepsArg>,
    /// How much more the word counts than no word does [default: the model's own]
    #[arg(long, value_name = "WEIGHT", value_parser = numbers::text_weight, allow_negative_numbers = true)]
    pub text_weight: Option<f64>,
    /// The motion is drawn to the lines at every so many steps, the last among them [default: 5]
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub guide_every: Option<u16>,
    /// For models that take T5's or CLIP's text: a folder with its config.json, tokenizer.json and model.safetensors
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub text_model: Option<PathBuf>,
    /// Write a picture: every frame's drawing with the joints that were read, and poses of its motion
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Write a page that plays the motion beside its drawings, with drawn ways and poses in space; it needs no server
    #[arg(long, value_name = "PAGE.html", value_hint = ValueHint::FilePath)]
    pub preview: Option<PathBuf>,
    /// Write a moving picture, .webm or .gif: the motion beside its drawings, 20 pictures a second, two minutes at most
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub video: Option<PathBuf>,
    /// Write what was understood and how exactly it is met, as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    /// The record beside the result.
    pub sidecar: SidecarArgs,
}

/// What frames are made by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EngineArg {
    /// The model.
    Learned,
    /// The user's clips.
    Example,
    /// The model, begun with the clips.
    Both,
}

/// How drawings are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExactArg {
    /// By the word only.
    Off,
    /// Drawn to them.
    Soft,
    /// Met.
    Pin,
}

/// How clips go over into each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BlendArg {
    /// Cubics.
    Smooth,
    /// By the model.
    Model,
}
