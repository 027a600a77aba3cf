//! What makes animations of the studio's storyboards: as `inkrig storyboard` does, with the model read once.

use super::generate::{HUMANOID, Model, named_model};
use super::storyboard::{Next, Part, Settings, frames, make, parts};
use crate::cli::{BlendArg, ExactArg};
use crate::error::CliError;
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_generate::text::{TextEncoder, VERBS};
use inkrig_sketch::storyboard::Storyboard;
use inkrig_storyboard::StoryboardError;
use inkrig_studio::storyboard::{
    BoardExact, BoardProgress, MadeBoard, MadeFrame, MadeWay, NotMade, ReadJoint, Storyboarder,
};
use std::fmt;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// The model, once it was needed.
#[derive(Default)]
pub(super) struct Boards {
    model: Mutex<Option<Loaded>>,
}

struct Loaded {
    model: Model,
    encoder: Box<dyn TextEncoder>,
}

impl fmt::Debug for Boards {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("Boards")
    }
}

impl Storyboarder for Boards {
    fn words(&self) -> Vec<String> {
        VERBS.iter().map(|verb| verb.name.to_owned()).collect()
    }

    fn make(
        &self,
        board: &Storyboard,
        exact: BoardExact,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<()>,
    ) -> Result<MadeBoard, NotMade> {
        self.made(board, exact, watch).map_err(|error| match error {
            CliError::Storyboard { cause, .. } => match *cause {
                StoryboardError::Stopped => NotMade::Stopped,
                // On the page there is no file that is to be named.
                cause => NotMade::Failed(cause.to_string()),
            },
            other => NotMade::Failed(other.to_string()),
        })
    }
}

impl Boards {
    fn made(
        &self,
        board: &Storyboard,
        exact: BoardExact,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<()>,
    ) -> Result<MadeBoard, CliError> {
        let path = Path::new("storyboard.json");
        let count = board.frames.len();
        let mut tell = |done, frame| watch(BoardProgress { done, total: count + 2, frame, frames: count });
        let stopped =
            || CliError::Storyboard { path: path.into(), cause: Box::new(StoryboardError::Stopped) };
        let mut slot = self.model.lock().unwrap_or_else(PoisonError::into_inner);
        if tell(0, 0).is_break() {
            return Err(stopped());
        }
        let Loaded { model, encoder } = match &mut *slot {
            Some(loaded) => loaded,
            none => none.insert(Loaded::open()?),
        };
        let understood = frames(board, model, path)?;
        let settings = Settings {
            exact: match exact {
                BoardExact::Off => ExactArg::Off,
                BoardExact::Soft => ExactArg::Soft,
                BoardExact::Pin => ExactArg::Pin,
            },
            blend: BlendArg::Smooth,
            steps: None,
            text_weight: None,
            candidates: 4,
            guide_every: 5,
            seed: 0,
        };
        let watch = &mut |next: Next| match next {
            Next::Frame(number) => tell(number, number),
            Next::Whole => tell(count + 1, 0),
        };
        let made = make(&understood, model, encoder.as_ref(), &settings, path, watch)?;
        let export = ExportOptions {
            name: Some(board.title.clone()),
            humanoid: HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec(),
            ..ExportOptions::default()
        };
        let bvh = write_motion(&made.animation.clip, Format::Bvh, &export)?.bytes;
        let mut notes = Vec::new();
        let parts = parts(&understood, &made, settings.exact, &mut notes);
        let frames = parts.into_iter().zip(&understood).map(|(part, frame)| told(part, frame.notes.clone()));
        Ok(MadeBoard { bvh, frames: frames.collect(), notes })
    }
}

impl Loaded {
    fn open() -> Result<Self, CliError> {
        let mut model = match named_model(None) {
            Some(path) => Model::open(&path)?,
            None => Model::shipped(None)?,
        };
        let encoder = model.read(None)?;
        Ok(Self { model, encoder })
    }
}

/// A frame's record as the page gets it.
fn told(part: Part, notes: Vec<String>) -> MadeFrame {
    let [mean_miss, worst_miss] = part.result;
    let joints = part.joints.into_iter().map(|joint| ReadJoint {
        name: joint.name.to_owned(),
        x: joint.x,
        y: joint.y,
        confidence: joint.confidence,
        pinned: joint.pinned,
    });
    let ways = part.trajectories.into_iter().map(|way| MadeWay {
        joint: way.joint.to_owned(),
        figure: way.figure.to_owned(),
        first: way.first,
        frames: way.frames,
    });
    MadeFrame {
        begins: part.begins,
        frames: part.frames,
        key_frame: part.key_frame,
        joints: joints.collect(),
        ways: ways.collect(),
        mean_miss,
        worst_miss,
        notes,
    }
}
