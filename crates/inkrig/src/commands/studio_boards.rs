//! What makes animations of the studio's storyboards: as `inkrig storyboard` does, with the model read once, and with clips that
//! were made before.

use super::generate::{HUMANOID, Model, named_model};
use super::storyboard::{
    Asked, CANDIDATES, GUIDE_EVERY, Made, Next, Part, Reader, Settings, Takes, Workshop, all, frames,
    lasting, parts, pose, poses, ways,
};
use crate::cli::{BlendArg, ExactArg};
use crate::error::CliError;
use inkrig_formats::{ExportOptions, Format, HumanBone, write_motion};
use inkrig_generate::text::{TextEncoder, VERBS};
use inkrig_motion::humanml::{Joints, NAMES};
use inkrig_sketch::storyboard::{Frame, Storyboard};
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
            candidates: CANDIDATES,
            guide_every: GUIDE_EVERY,
            seed: 0,
        };
        let workshop = Workshop { model, encoder: encoder.as_ref(), settings: &settings, path };
        let mut takes = self.takes.lock().unwrap_or_else(PoisonError::into_inner);
        let (understood, alone) = match only {
            Some(number) => one(board, number, &workshop, &mut takes)?,
            None => (frames(board, model, path)?.into_iter().map(Some).collect(), false),
        };
        let mut asked: Vec<Asked<'_>> = all(board, understood.iter().map(Option::as_ref));
        if alone {
            asked.iter_mut().for_each(|asked| asked.joined = Some(asked.number) == only);
        }
        let mut before = 0;
        let watch = &mut |next: Next| match next {
            // Of one frame, the others are here already.
            Next::Frame(number) if only.is_none_or(|only| only == number) => {
                before += 1;
                tell(before, number)
            }
            Next::Frame(_) => tell(before.max(1), 0),
            Next::Whole | Next::Character => tell(count + 1, 0),
        };
        let made = workshop.make(&asked, &mut takes, watch)?;
        drop(takes);
        asked.retain(|asked| asked.joined);
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

/// Reads one frame, and the others where all of them can be read and were made before. Else says that it is alone, and has only those
/// whose paths it takes over.
fn one(
    board: &Storyboard,
    number: usize,
    workshop: &Workshop<'_>,
    takes: &mut Takes,
) -> Result<(Vec<Option<Understood>>, bool), CliError> {
    let reader = Reader::open(board, workshop.model, workshop.path)?;
    let own = reader.read(number, board.frames.get(number - 1).unwrap_or(&Frame::default()))?;
    let (mut read, mut before): (Vec<Option<Understood>>, Vec<(usize, Generated)>) = Default::default();
    // Those that are made anew: the frame, and what goes along its path.
    let mut anew = vec![number];
    let mut alone = false;
    for (of, frame) in (1..).zip(&board.frames) {
        if of == number {
            read.push(Some(own.clone()));
            continue;
        }
        let other = (!alone).then(|| reader.read(of, frame).ok()).flatten();
        let leads = other.as_ref().and_then(|other| other.plan.path_of(of));
        if leads.is_some_and(|leads| anew.contains(&leads)) {
            anew.push(of);
        } else if let Some(read) = &other {
            let asked = Asked { number: of, frame, read, joined: true };
            match workshop.kept(&asked, &before, takes)? {
                Some(clip) => before.push((of, clip)),
                None => alone = true,
            }
        } else {
            alone = true;
        }
        read.push(other);
    }
    if alone {
        let mut wanted = own.plan.path_of(number);
        read = vec![None; board.frames.len()];
        while let Some((of, frame)) = wanted.and_then(|of| Some((of, board.frames.get(of.checked_sub(1)?)?)))
        {
            let other = reader.read(of, frame)?;
            wanted = other.plan.path_of(of);
            read.get_mut(of - 1).into_iter().for_each(|read| *read = Some(other.clone()));
        }
        read.get_mut(number - 1).into_iter().for_each(|read| *read = Some(own.clone()));
    } else {
        lasting(read.iter().flatten(), workshop.path)?;
    }
    Ok((read, alone))
}

impl Loaded {
    fn open() -> Result<Self, CliError> {
        let mut model = Model::asked(named_model(None).as_deref(), None)?;
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
    let asked = !clip.plan.asks().is_empty() || clip.plan.path.is_some();
    MadeTake {
        mean_miss: asked.then_some(clip.error),
        poses: (0..SHOWN).map(|at| pose(at * last / (SHOWN - 1))).collect(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn made(boards: &Boards, words: [&str; 3], frame: Option<usize>) -> MadeBoard {
        let [a, b, c] = words;
        let text = format!(
            r#"{{"inkrig_storyboard": 1, "frames": [{{"word": "{a}"}}, {{"word": "{b}", "path": "continue"}}, {{"word": "{c}"}}]}}"#
        );
        let board = inkrig_sketch::storyboard::read_storyboard(text.as_bytes()).unwrap();
        let asked = BoardAsked { exact: BoardExact::Soft, frame };
        boards.make(&board, asked, &mut |_| ControlFlow::Continue(0)).unwrap()
    }

    fn takes(made: &MadeBoard, number: usize) -> &[MadeTake] {
        &made.frames.iter().find(|frame| frame.number == number).unwrap().takes
    }

    #[test]
    fn a_frame_that_is_made_again_takes_along_what_goes_on_its_path() {
        let boards = Boards::default();
        // Alone, but for the one that leads, which is made and not shown.
        let alone = made(&boards, ["walk", "wave", "kick"], Some(2));
        assert_eq!(alone.frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [2]);
        let whole = made(&boards, ["walk", "wave", "kick"], None);
        assert_eq!(takes(&whole, 2), takes(&alone, 2));
        let other = made(&boards, ["run", "wave", "kick"], Some(1));
        assert_eq!(other.frames.len(), 3, "all others are there");
        assert_ne!(takes(&other, 1), takes(&whole, 1));
        assert_ne!(takes(&other, 2), takes(&whole, 2), "its path is another");
        assert_eq!(takes(&other, 3), takes(&whole, 3));
        assert_eq!(other, made(&boards, ["run", "wave", "kick"], None));
    }
}
