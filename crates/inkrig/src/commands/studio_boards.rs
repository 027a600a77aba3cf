//! What makes animations of the studio's storyboards: as `inkrig storyboard` does, with the model read once, and with clips that
//! were made before.

use super::generate::{HUMANOID, Model, named_model};
use super::storyboard::{
    Asked, Made, Next, Part, Reader, Settings, Takes, Workshop, all, frames, parts, pose, poses, ways,
};
use crate::cli::{BlendArg, ExactArg};
use crate::error::CliError;
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_generate::text::{TextEncoder, VERBS};
use inkrig_motion::humanml::{Joints, NAMES};
use inkrig_sketch::storyboard::Storyboard;
use inkrig_storyboard::{Generated, StoryboardError, Understood};
use inkrig_studio::storyboard::{
    BoardAsked, BoardExact, BoardProgress, MadeBoard, MadeFrame, MadeTake, MadeTransition, MadeWay, NotMade,
    PosedJoint, ReadJoint, Storyboarder,
};
use std::fmt;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Poses of a take that are shown.
const SHOWN: usize = 4;
/// Joints of the lines of a shown pose: trunk, left leg, right leg, left arm, right arm.
const LINES: [&[usize]; 5] =
    [&[0, 3, 6, 9, 12, 15], &[0, 1, 4, 7, 10], &[0, 2, 5, 8, 11], &[12, 16, 18, 20], &[12, 17, 19, 21]];

/// The model, once it was needed, and what it has made.
#[derive(Default)]
pub(super) struct Boards {
    model: Mutex<Option<Loaded>>,
    takes: Mutex<Takes>,
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
        asked: BoardAsked,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<(), usize>,
    ) -> Result<MadeBoard, NotMade> {
        self.made(board, asked, watch).map_err(|error| match error {
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
        BoardAsked { exact, frame: only }: BoardAsked,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<(), usize>,
    ) -> Result<MadeBoard, CliError> {
        let path = Path::new("storyboard.json");
        let count = only.map_or(board.frames.len(), |_| 1);
        let whole = board.frames.len();
        let mut tell = |done, frame| watch(BoardProgress { done, total: count + 2, frame, frames: whole });
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
        let workshop = Workshop { model, encoder: encoder.as_ref(), settings: &settings, path };
        let mut takes = self.takes.lock().unwrap_or_else(PoisonError::into_inner);
        let understood = match only {
            Some(number) => one(board, number, &workshop, &takes)?,
            None => frames(board, model, path)?.into_iter().map(Some).collect(),
        };
        let asked: Vec<Asked<'_>> = all(board, understood.iter().map(Option::as_ref));
        let mut before = 0;
        let watch = &mut |next: Next| match next {
            // Of one frame, the others are here already.
            Next::Frame(number) if only.is_none_or(|only| only == number) => {
                before += 1;
                tell(before, number)
            }
            Next::Frame(_) => tell(before.max(1), 0),
            Next::Whole => tell(count + 1, 0),
        };
        let made = workshop.make(&asked, &mut takes, watch)?;
        drop(takes);
        let export = ExportOptions {
            name: Some(board.title.clone()),
            humanoid: HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec(),
            ..ExportOptions::default()
        };
        let bvh = write_motion(&made.animation.clip, Format::Bvh, &export)?.bytes;
        let mut notes = Vec::new();
        let parts = parts(&asked, &made, settings.exact, &mut notes);
        let rows = parts.into_iter().zip(&asked).enumerate();
        let motion = poses(&made.animation.clip);
        let frames = rows.map(|(row, (part, asked))| told(row, part, asked, &made, &motion)).collect();
        let transitions = made.animation.joined.transitions.iter();
        let transitions = transitions
            .map(|one| MadeTransition { begins: one.frames.start, frames: one.frames.len() })
            .collect();
        Ok(MadeBoard { bvh, frames, transitions, notes })
    }
}

/// Reads one frame, and the others where all of them can be read and were made before; these are left out otherwise.
fn one(
    board: &Storyboard,
    number: usize,
    workshop: &Workshop<'_>,
    takes: &Takes,
) -> Result<Vec<Option<Understood>>, CliError> {
    let reader = Reader::open(board, workshop.model, workshop.path)?;
    let mut read = Vec::new();
    let mut alone = false;
    for (number_of, frame) in (1..).zip(&board.frames) {
        if number_of == number {
            read.push(Some(reader.read(number, frame)?));
            continue;
        }
        let other = (!alone).then(|| reader.read(number_of, frame).ok()).flatten();
        let kept = match &other {
            Some(other) => takes.has(&workshop.order(&Asked { number: number_of, frame, read: other })?),
            None => false,
        };
        alone |= !kept;
        read.push(other);
    }
    if alone {
        (1..).zip(&mut read).filter(|(of, _)| *of != number).for_each(|(_, other)| *other = None);
    }
    Ok(read)
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

/// What the page gets of the animation's frame `row`.
fn told(row: usize, part: Part, asked: &Asked<'_>, made: &Made, motion: &[Joints]) -> MadeFrame {
    let [mean_miss, worst_miss] = part.result;
    let joints = part.joints.into_iter().map(|joint| ReadJoint {
        name: joint.name.to_owned(),
        x: joint.x,
        y: joint.y,
        confidence: joint.confidence,
        pinned: joint.pinned,
    });
    let mut lines = ways(row, made, motion).into_iter();
    let ways = part.trajectories.into_iter().map(|way| MadeWay {
        joint: way.joint.to_owned(),
        figure: way.figure.to_owned(),
        first: way.first,
        frames: way.frames,
        points: lines.next().map_or_else(Vec::new, |line| line.points),
    });
    let posed = pose(row, made, motion).into_iter().flatten().zip(NAMES);
    let takes = made.ranked.get(row).map_or(&[][..], |clips| clips);
    MadeFrame {
        number: asked.number,
        word: part.word,
        begins: Some(part.begins),
        frames: part.frames,
        turn: part.space.turn_radians,
        shift: part.space.shift,
        key_frame: part.key_frame,
        pose: posed.map(|(at, name)| PosedJoint { name: name.to_owned(), at: at.to_array() }).collect(),
        joints: joints.collect(),
        ways: ways.collect(),
        mean_miss,
        worst_miss,
        takes: takes.iter().map(shown).collect(),
        notes: asked.read.notes.clone(),
    }
}

/// A clip in a few poses.
fn shown(clip: &Generated) -> MadeTake {
    let last = clip.motion.len().saturating_sub(1);
    let pose = |at: usize| {
        let seen = |joint: &usize| {
            let place = clip.motion.get(at).and_then(|pose| pose.get(*joint)).copied().unwrap_or_default();
            // A picture of a few millimetres is fine enough.
            clip.plan.camera.project(place).to_array().map(|value| (value * 200.0).round() / 200.0)
        };
        LINES.map(|line| line.iter().map(seen).collect())
    };
    let asked = !clip.plan.asks().is_empty();
    MadeTake {
        mean_miss: asked.then_some(clip.error),
        poses: (0..SHOWN).map(|at| pose(at * last / (SHOWN - 1))).collect(),
    }
}
