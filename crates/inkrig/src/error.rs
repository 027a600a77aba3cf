//! What the program says when it cannot go on.
//!
//! Messages hold what caused them, made printable. The causes are no `source`s, or they would be printed twice.

use crate::output::OutputError;
use crate::printable;
use crate::sheet::SheetError;
use inkrig_align::AlignError;
use inkrig_formats::FormatError;
use inkrig_generate::{CheckpointError, GenerateError};
use inkrig_motion::MotionError;
use inkrig_motion::retarget::RetargetError;
use inkrig_sketch::SketchError;
use inkrig_sound::SoundError;
use inkrig_storyboard::StoryboardError;
use inkrig_studio::StudioError;
use inkrig_train::TrainError;
use miette::Diagnostic;
use std::path::PathBuf;

/// An error with the file that it is about.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CliError {
    /// A file could not be opened or read.
    #[error("{} could not be read: {cause}", printable::path(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A file is larger than anything that is read.
    #[error("{} is larger than {most} bytes, the most that is read", printable::path(path))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        most: usize,
    },
    /// The name does not say what is inside.
    #[error("{}: what kind of file this is cannot be told from its name", printable::path(path))]
    #[diagnostic(help("{known}"))]
    Kind {
        /// The file.
        path: PathBuf,
        /// The endings that are known.
        known: &'static str,
    },
    /// A motion file that cannot be understood.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Format {
        /// The file.
        path: PathBuf,
        /// Where and what.
        cause: Box<FormatError>,
    },
    /// A clip that cannot be used as asked.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Clip {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: MotionError,
    },
    /// A range that holds no frame of a clip.
    #[error(
        "{}: --range {range} holds nothing of it; the clip ends at {} s, which is frame {frames}",
        printable::path(path),
        printable::fixed(*seconds, 2)
    )]
    Range {
        /// The file.
        path: PathBuf,
        /// What was asked for.
        range: crate::span::Span,
        /// The clip's length, seconds.
        seconds: f64,
        /// The clip's length, frames.
        frames: usize,
    },
    /// The studio cannot be opened.
    #[error("{}", printable::text(cause))]
    Studio {
        /// Why.
        cause: Box<StudioError>,
    },
    /// A corpus that cannot be built.
    #[error("{}", printable::text(.0))]
    Train(Box<TrainError>),
    /// A corpus that has no clip of a verb.
    #[error(
        "{}: no clip of its training split says by a verb what is done, so it has no motions to begin with: give words to its clips (`words`, `text` or `index` in its configuration), or leave --examples out",
        printable::path(path)
    )]
    NoVerbs {
        /// The corpus.
        path: PathBuf,
    },
    /// A drawing that cannot be understood.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Curve {
        /// The file.
        path: PathBuf,
        /// Where and what.
        cause: Box<SketchError>,
    },
    /// A picture of a drawing that cannot be read, or shows not what is looked for.
    #[error("{}: {}", printable::path(path), printable::text(what))]
    Picture {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        what: String,
    },
    /// A sound that cannot be understood.
    #[error("{}: {cause}", printable::path(path))]
    Sound {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: Box<SoundError>,
    },
    /// A wave or labels on the command line that cannot be understood.
    #[error("{flag}: {cause}")]
    Text {
        /// The flag.
        flag: &'static str,
        /// Where and what.
        cause: Box<SketchError>,
    },
    /// An option that nothing would come of.
    #[error("{flag} does nothing with {with}: leave it out")]
    NoEffect {
        /// The flag.
        flag: &'static str,
        /// What else was asked for.
        with: &'static str,
    },
    /// An engine that needs clips, and has none.
    #[error("--engine example and both need clips: name their folder with --examples FOLDER")]
    NoExamples,
    /// A keyframe on the command line that cannot be understood.
    #[error("the keyframe `{}` cannot be used", printable::text(text))]
    #[diagnostic(help("{known}"))]
    Key {
        /// What was given.
        text: String,
        /// How keyframes are written.
        known: &'static str,
    },
    /// A file of keyframes that cannot be understood.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    #[diagnostic(help(
        r#"a list such as [{{"time": 0.5, "frame": 120}}, {{"at": [0.3, -1], "frame": 60, "weight": 0.5}}, {{"never": 300}}]; docs/keys.md has all kinds"#
    ))]
    KeyFile {
        /// The file.
        path: PathBuf,
        /// Where and what.
        cause: String,
    },
    /// A path's shape that cannot be understood.
    #[error("--path {}: not a number of degrees from -36000 to 36000", printable::text(text))]
    #[diagnostic(help("a file, straight, arc:90 (to the left, arc:-90 to the right), or bend:90"))]
    Shape {
        /// What was given.
        text: String,
    },
    /// A part of an earlier result that cannot stay as it is.
    #[error("{} cannot be kept: {}", printable::path(path), printable::text(cause))]
    Fix {
        /// The earlier result.
        path: PathBuf,
        /// Why, and what to do.
        cause: String,
    },
    /// An argument on keys that goes with another way to make them.
    #[error("{flag} goes with --bake {mode}")]
    #[diagnostic(help("--bake sparse --tolerance 1mm,0.5deg, or --bake stepped --on 2s"))]
    Bake {
        /// The flag.
        flag: &'static str,
        /// What it goes with.
        mode: &'static str,
    },
    /// A key at a time that the result does not have.
    #[error(
        "--keep-key {time} is not in the result, which has {frames} frames ({} s), counted from 0",
        printable::fixed(*seconds, 2)
    )]
    KeepKey {
        /// What was asked for.
        time: crate::span::Length,
        /// Frames of the result.
        frames: usize,
        /// Its length, seconds.
        seconds: f64,
    },
    /// A record beside a result that is not what inkrig writes.
    #[error("{} is no record of a result: {}", printable::path(path), printable::text(what))]
    Sidecar {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A run cannot be repeated as it was.
    #[error("{}: {}", printable::path(path), printable::text(what))]
    #[diagnostic(help("{help}"))]
    Redo {
        /// The record or the input.
        path: PathBuf,
        /// What is different.
        what: String,
        /// What to do.
        help: &'static str,
    },
    /// A repeated run wants a file that the first has not read.
    #[error(
        "{} is not among the inputs of the record, or has changed since it was checked",
        printable::path(path)
    )]
    OtherInput {
        /// The file.
        path: PathBuf,
    },
    /// Two results would go to one file, or a result over an input.
    #[error("{} is named twice: every input and result needs a name of its own", printable::path(.0))]
    SameFile(PathBuf),
    /// Several inputs, and no folder for them.
    #[error("{} cannot hold several files", printable::path(.0))]
    #[diagnostic(help("name a folder, and a format by --to bvh, glb, fbx or usda"))]
    OneFolder(PathBuf),
    /// No file has such a name.
    #[error("no file is called {}", printable::path(.0))]
    NothingFits(PathBuf),
    /// Some of many files were not converted.
    #[error("{failed} of {total} files were not converted")]
    #[diagnostic(help("{list}"))]
    NotConverted {
        /// How many were not.
        failed: usize,
        /// Of how many.
        total: usize,
        /// Why, one line each.
        list: String,
    },
    /// A file of weights that cannot be read, or not be made a model file of.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: Box<CheckpointError>,
    },
    /// A model that takes text from another one.
    #[error(
        "{}: this model takes its text from {what}: give --text-model with a folder that has it",
        printable::path(path)
    )]
    #[diagnostic(help(
        "config.json, tokenizer.json and model.safetensors as they are published; for Sentence-T5 also 2_Dense/model.safetensors"
    ))]
    NoTextModel {
        /// The model.
        path: PathBuf,
        /// What it takes text from.
        what: &'static str,
    },
    /// A word that is none.
    #[error("--word says nothing: name what is done, such as kick, or \"walk and turn\"")]
    NoWord,
    /// A result whose name ends in another kind of file than it is.
    #[error("{}: {what} is written as .{ending}: give it a name that ends so", printable::path(path))]
    Ending {
        /// The file.
        path: PathBuf,
        /// What is written to it.
        what: &'static str,
        /// How its name ends.
        ending: &'static str,
    },
    /// Few keys with curves between them, for a format that has none.
    #[error(
        "{}: .{format} files hold a pose a frame, not few keys with curves between them",
        printable::path(path)
    )]
    #[diagnostic(help("write a .glb or .fbx, or one key a frame (--bake dense)"))]
    BakeFormat {
        /// The file or the folder.
        path: PathBuf,
        /// The ending of the format.
        format: &'static str,
    },
    /// A wave or labels that look like the name of a file that is not read as such.
    #[error("{flag} {}: this looks like a file, of a kind that is not read here", printable::text(text))]
    #[diagnostic(help("{known}"))]
    LooksLikeFile {
        /// The flag.
        flag: &'static str,
        /// What was given.
        text: String,
        /// What is read instead.
        known: &'static str,
    },
    /// No motion of the verb to begin with.
    #[error(
        "{}: this model has no example of \"{}\" to begin with",
        printable::path(path),
        printable::text(word)
    )]
    #[diagnostic(help("leave --start example out; an action word such as walk or jump may have one"))]
    NoExample {
        /// The model.
        path: PathBuf,
        /// What was asked for.
        word: String,
    },
    /// Conditions for a model without networks for them.
    #[error(
        "{}: this model follows words only: it has no networks for --keypose3d and --trajectory3d",
        printable::path(path)
    )]
    NoControl {
        /// The model.
        path: PathBuf,
    },
    /// Steps that a model was not made for.
    #[error(
        "{}: {}", printable::path(path),
        if *distilled {
            "this model was distilled for few steps: give --steps 1, 2 or 4"
        } else {
            "this model was not distilled for few steps: give --steps ddim, or leave it out"
        }
    )]
    StepsOfModel {
        /// The model.
        path: PathBuf,
        /// Whether it was made for few.
        distilled: bool,
    },
    /// A length that a model cannot make.
    #[error(
        "{flag} is {} of 20 a second, but {} makes 2 to {most}",
        printable::counted(*frames, "frame"),
        printable::path(path)
    )]
    LengthOfModel {
        /// By what it was asked for.
        flag: &'static str,
        /// The model.
        path: PathBuf,
        /// What was asked for.
        frames: usize,
        /// The longest that it makes.
        most: usize,
    },
    /// A model that nothing can be made with, or not what was asked for.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Generate {
        /// The model.
        path: PathBuf,
        /// Why.
        cause: Box<GenerateError>,
    },
    /// A storyboard that cannot be made a motion.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Storyboard {
        /// The file.
        path: PathBuf,
        /// Which frame, why, and what to do.
        cause: Box<StoryboardError>,
    },
    /// A key pose or a trajectory that cannot be used.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    #[diagnostic(help("inkrig generate --help says how such files are written"))]
    Condition {
        /// The file.
        path: PathBuf,
        /// Where and what.
        cause: String,
    },
    /// A motion cannot be put on another character.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    Retarget {
        /// The file of the one of the two that stands in the way.
        path: PathBuf,
        /// Why.
        cause: Box<RetargetError>,
    },
    /// A map of joints that cannot be used.
    #[error("{}: {}", printable::path(path), printable::text(cause))]
    #[diagnostic(help(
        "inkrig retarget MOTION --onto CHARACTER --suggest-map -o map.json writes one to begin with"
    ))]
    Map {
        /// The file.
        path: PathBuf,
        /// Where and what.
        cause: String,
    },
    /// A result that does not keep its limits was not wanted.
    #[error("{} was not written: {broken}", printable::path(path))]
    #[diagnostic(help("without --strict it is written, with this as a warning"))]
    Strict {
        /// The file.
        path: PathBuf,
        /// What is not kept.
        broken: String,
    },
    /// No case of the benchmark has such a name.
    #[error("no case of the benchmark is called {}", printable::text(asked))]
    #[diagnostic(help("the cases are: {}", printable::text(known)))]
    NoCase {
        /// The words that were given.
        asked: String,
        /// The names that there are.
        known: String,
    },
    /// The engine could not align.
    #[error("{}", printable::text(.0))]
    Align(Box<AlignError>),
    /// A clip could not be joined or resampled.
    #[error("{}", printable::text(.0))]
    Motion(MotionError),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The contact sheet could not be made.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// A moving picture could not be made.
    #[error("the moving picture could not be made: {}", printable::text(cause))]
    Video {
        /// What the encoder says.
        cause: String,
    },
    /// A result could not be put in its file format.
    #[error("the result could not be written: {}", printable::text(.0))]
    Export(Box<FormatError>),
    /// Text could not be turned into JSON.
    #[error("the report could not be written as JSON: {cause}")]
    Json {
        /// What is wrong.
        cause: serde_json::Error,
    },
    /// Standard output could not be written.
    #[error("standard output could not be written: {cause}")]
    Print {
        /// What the system said.
        cause: std::io::Error,
    },
}

impl From<FormatError> for CliError {
    /// An error of writing; errors of reading carry their file's path.
    fn from(error: FormatError) -> Self {
        Self::Export(Box::new(error))
    }
}

impl From<AlignError> for CliError {
    fn from(error: AlignError) -> Self {
        Self::Align(Box::new(error))
    }
}

impl From<MotionError> for CliError {
    fn from(error: MotionError) -> Self {
        Self::Motion(error)
    }
}

impl From<serde_json::Error> for CliError {
    fn from(cause: serde_json::Error) -> Self {
        Self::Json { cause }
    }
}

impl CliError {
    /// The process's exit code: 130 when the user stopped it (as shells expect), else 1. Wrong usage is 2, by clap.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Align(error) if matches!(**error, AlignError::Cancelled) => 130,
            Self::Train(error) if matches!(**error, TrainError::Stopped) => 130,
            _ => 1,
        }
    }
}
