//! What can be said to `inkrig model`.

use crate::numbers;
use clap::{Args, Subcommand, ValueEnum, ValueHint};
use std::path::PathBuf;

/// Arguments of `inkrig model`.
#[derive(Debug, Args)]
pub struct ModelArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: ModelCommand,
}

/// What can be done with models.
#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// Make a model file of weights that PyTorch saved (Sketch2Anim, MotionLCM 1, MLD); nothing in such a file is run
    #[command(
        after_help = "Examples:\n  inkrig model import adapter.ckpt --stats HumanML3D -o sketch2anim.safetensors\n      with Mean.npy, Std.npy, Mean_raw.npy, Std_raw.npy and 000021.npy in that folder\n  inkrig model import adapter.ckpt --half -o half.safetensors"
    )]
    Import(ModelImportArgs),
    /// Make a model that was trained ready to be given away: half precision, a name, where it comes from
    #[command(
        after_help = "Examples:\n  inkrig model pack runs/align/best.safetensors --name mine --data \"my own clips\" --licence CC0 -o mine.safetensors\n  inkrig model pack runs/quick/best.safetensors -o mine-quick.safetensors\n      a whole model too, for inkrig generate --model mine-quick.safetensors --steps 2; licence and credit are those of the weights it began with\n  inkrig model pack runs/quick/best.safetensors --without models/clean.safetensors -o models/clean-quick.safetensors\n      only what differs, for whoever builds inkrig with these two files in it: --model takes whole models only"
    )]
    Pack(ModelPackArgs),
    /// Say what is in a model file, or in weights that PyTorch saved
    #[command(after_help = "Example:\n  inkrig model inspect adapter.ckpt")]
    Inspect(ModelInspectArgs),
}

/// Arguments of `inkrig model import`.
#[derive(Debug, Args)]
pub struct ModelImportArgs {
    /// The weights: .ckpt, .pt, .pth or .safetensors
    #[arg(value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The model file to write
    #[arg(long, short, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
    /// A folder with Mean.npy, Std.npy, Mean_raw.npy, Std_raw.npy, and 000021.npy or skeleton.npy; weights do not hold them
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub stats: Option<PathBuf>,
    /// Write half precision: half the size
    #[arg(long)]
    pub half: bool,
    /// Keep the networks that measure motions
    #[arg(long)]
    pub evaluator: bool,
    /// Where text vectors come from, if not from what the published model uses
    #[arg(long, value_name = "KIND")]
    pub text: Option<TextArg>,
    /// What to call the model [default: the file's name]
    #[arg(long, value_name = "TEXT")]
    pub name: Option<String>,
    /// What it was trained on
    #[arg(long, value_name = "TEXT", default_value = "not stated")]
    pub data: String,
    /// What may be done with it
    #[arg(long, value_name = "TEXT", default_value = "not stated: ask its authors")]
    pub licence: String,
    /// Replace a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `inkrig model pack`.
#[derive(Debug, Args)]
pub struct ModelPackArgs {
    /// The model file that training wrote
    #[arg(value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The model file to write
    #[arg(long, short, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
    /// Leave out the weights that this model has, too. Only to build inkrig with both inside: --model takes no such file
    #[arg(long, value_name = "FILE.safetensors", value_hint = ValueHint::FilePath)]
    pub without: Option<PathBuf>,
    /// What to call the model [default: the file's name]
    #[arg(long, value_name = "TEXT")]
    pub name: Option<String>,
    /// Give it a few motions of each verb, from this corpus, that denoising may begin with
    #[arg(long, value_name = "CORPUS", value_hint = ValueHint::DirPath)]
    pub examples: Option<PathBuf>,
    /// How much more its words shall count than no word does, if --text-weight of inkrig generate does not say
    #[arg(long, value_name = "WEIGHT", value_parser = numbers::text_weight, allow_negative_numbers = true)]
    pub text_weight: Option<f64>,
    /// What it was trained on [default: as the model file says]
    #[arg(long, value_name = "TEXT")]
    pub data: Option<String>,
    /// What may be done with it; credit that the model file asks for is added [default: as the model file says]
    #[arg(long, value_name = "TEXT")]
    pub licence: Option<String>,
    /// Leave out the credit that the model file asks for
    #[arg(long, requires = "licence")]
    pub no_credit: bool,
    /// Replace a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `inkrig model inspect`.
#[derive(Debug, Args)]
pub struct ModelInspectArgs {
    /// The file
    #[arg(value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
}

/// Where text vectors come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TextArg {
    /// A table of action verbs in the model.
    Verbs,
    /// Sentence-T5 large.
    SentenceT5,
    /// CLIP ViT-L/14.
    Clip,
}
