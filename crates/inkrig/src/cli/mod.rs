//! The command line, as people see it.

mod align;
mod bake;
mod bench;
mod convert;
mod data;
mod evaluate;
mod evaluate_readers;
mod generate;
mod model;
mod redo;
mod retarget;
mod root;
mod sidecar;
mod sketch;
mod storyboard;
mod studio;
mod suggest;
mod train;

pub use align::{AlignArgs, ControlArgs, Norms, PresetArg, RotationArg, SolverArg, VelocityArg};
pub use bake::{BakeArgs, BakeMode, Hold, Tolerance};
pub use bench::{BenchAlignArgs, BenchArgs, BenchCommand};
pub use convert::{ConvertArgs, ToArg};
pub use data::{CorpusArgs, DataArgs, DataCommand};
pub use evaluate::{
    EvaluateArgs, EvaluateBlendingArgs, EvaluateCommand, EvaluateOnArgs, EvaluateStoryboardArgs, JointsArg,
    SplitArg,
};
pub use evaluate_readers::{EvaluateSketchArgs, EvaluateWordArgs};
pub use generate::{GenerateArgs, GroundArg, GuidanceArg, StartArg, StepsArg};
pub use model::{ModelArgs, ModelCommand, ModelImportArgs, ModelInspectArgs, ModelPackArgs, TextArg};
pub use redo::RedoArgs;
pub use retarget::RetargetArgs;
pub use root::{RootArgs, RootMode};
pub use sidecar::SidecarArgs;
pub use sketch::{SketchArgs, SketchCommand, SketchReadArgs, SketchWordArgs};
pub use storyboard::{BlendArg, EngineArg, ExactArg, StoryboardArgs};
pub use studio::StudioArgs;
pub use suggest::SuggestArgs;
pub use train::{PaceArgs, RunArgs, TrainArgs, TrainStage};

use crate::numbers;
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use std::path::PathBuf;

/// Turns drawings and examples into 3D character animation. Offline, on a CPU.
#[derive(Debug, Parser)]
#[command(name = "inkrig", version, propagate_version = true, arg_required_else_help = true)]
#[command(
    after_help = "Examples:\n  inkrig demo                                         see it work, with nothing else needed\n  inkrig align dance.bvh --curve spiral.svg -o new.bvh    a drawn curve moves your clip\n  inkrig inspect dance.bvh                            what is in a file"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print one JSON object instead of text.
    #[arg(long, global = true)]
    pub json: bool,
    /// Say nothing but errors.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a finished example to a folder and say what to open
    #[command(after_help = "Examples:\n  inkrig demo\n  inkrig demo my-folder")]
    Demo(DemoArgs),
    /// Re-arrange a clip so that it follows a curve, a wave, labels, a sound or another motion
    #[command(after_help = align::EXAMPLES)]
    Align(Box<AlignArgs>),
    /// Measure quality and speed, beside simpler methods
    Bench(BenchArgs),
    /// Write motion files in other formats, one or many
    #[command(after_help = convert::EXAMPLES)]
    Convert(Box<ConvertArgs>),
    /// Make a motion of a word, a key pose and trajectories, with a model file
    #[command(after_help = generate::EXAMPLES)]
    Generate(Box<GenerateArgs>),
    /// Make model files of published weights, and say what is in one
    Model(ModelArgs),
    /// Put a motion on another character, and say how exact it is
    #[command(after_help = retarget::EXAMPLES)]
    Retarget(Box<RetargetArgs>),
    /// Make a corpus to train on out of folders of motion files
    Data(DataArgs),
    /// Measure a model on clips that it never saw, or a reader of drawings
    Evaluate(EvaluateArgs),
    /// Say what is in a motion file: skeleton, frames, unit, problems
    #[command(after_help = "Examples:\n  inkrig inspect walk.bvh\n  inkrig inspect walk.bvh --json")]
    Inspect(InspectArgs),
    /// Make a result again from the record beside it, byte for byte, or check it
    #[command(after_help = redo::EXAMPLES)]
    Redo(RedoArgs),
    /// Make one animation of drawn frames: figures, ways of joints, words
    #[command(after_help = storyboard::EXAMPLES)]
    Storyboard(Box<StoryboardArgs>),
    /// Draw in the browser while the character moves
    #[command(after_help = studio::EXAMPLES)]
    Studio(StudioArgs),
    /// Suggest poses of a clip for keyframes, and map it to draw on
    #[command(after_help = suggest::EXAMPLES)]
    Suggest(SuggestArgs),
    /// Find the joints of a drawn figure, or read a word
    Sketch(SketchArgs),
    /// Train the networks of the second engine and the readers of drawings
    Train(TrainArgs),
    /// Print a completion script for your shell
    #[command(
        after_help = "Example:\n  inkrig completions bash > ~/.local/share/bash-completion/completions/inkrig"
    )]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

/// Arguments of `inkrig demo`.
#[derive(Debug, Args)]
pub struct DemoArgs {
    /// The folder to write to; made if it is not there
    #[arg(default_value = "inkrig-demo", value_hint = ValueHint::DirPath)]
    pub folder: PathBuf,
    /// Replace files of the same names even where they are not the demo's own
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `inkrig inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The motion file
    #[arg(value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    #[command(flatten)]
    /// How to read it.
    pub import: ImportArgs,
}

/// How to read a motion file.
#[derive(Debug, Clone, Default, Args)]
pub struct ImportArgs {
    /// Metres in one unit of the file (0.01 for centimetres); guessed if not given
    #[arg(long, value_name = "METRES", value_parser = numbers::unit, allow_negative_numbers = true, help_heading = "Reading")]
    pub unit: Option<f64>,
    /// The axis that points up in the file
    #[arg(long, value_name = "AXIS", help_heading = "Reading")]
    pub up: Option<Up>,
    /// Frames a second of the file, where it says nothing usable or the wrong thing
    #[arg(long, value_name = "RATE", value_parser = numbers::source_fps, allow_negative_numbers = true, help_heading = "Reading")]
    pub source_fps: Option<f64>,
    /// The skeleton file, for AMC (.asf) and DeepMimic motions; else the one that lies beside the motion
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Reading")]
    pub skeleton: Option<PathBuf>,
    /// Which clip of a file that has several, by name or number [default: the first]
    #[arg(long, value_name = "CLIP", help_heading = "Reading")]
    pub clip: Option<String>,
}

/// Axes that can point up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// y up: most files.
    Y,
    /// z up: some capture systems and exporters.
    Z,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
