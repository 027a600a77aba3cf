//! Storyboards answered from clips that the user has, of one skeleton, which may be anybody's: the clip that is nearest to what a
//! frame asks for is found, arranged anew to follow the drawn way, and joined to the next.
//!
//! People (skeletons in which [`Humanoid::find`] finds a body) become motions of the model's 22 joints, and are joined and pinned as sampled
//! ones are. All others keep their own skeleton: see [`creature`].

mod creature;
mod person;
mod words;

pub use creature::{Creature, CreatureFrame, CreaturePart, CreatureWay, creature, read_creature};

use crate::error::StoryboardError;
use crate::generate::Generated;
use inkrig_motion::rig::Humanoid;
use inkrig_motion::{Clip, lead_in, time};

/// Clips of fewer frames are no motion.
const LEAST_FRAMES: usize = 4;
/// Frames of all clips together that are searched: an hour and a half at 60 a second.
const MOST_FRAMES: usize = 324_000;

/// What is said of a frame that chooses one of several motions, where clips are found.
pub const NO_TAKE: &str = "its `take` counts for nothing: one motion is found among the examples. Only sampled ones are chosen from";

/// What skeletons are told apart by: each joint's name and parent.
type Form = Vec<(String, Option<usize>)>;

/// A clip that frames may be answered with.
#[derive(Debug, Clone)]
pub struct Example {
    /// What people call it.
    pub name: String,
    /// What is known of what happens in it: words of its name, its folder, an index.
    pub said: String,
    /// The motion.
    pub clip: Clip,
}

/// What was found for a frame. Lower scores are nearer.
#[derive(Debug, Clone, PartialEq)]
pub struct Retrieved {
    /// Name of the example.
    pub example: String,
    /// The part of it, seconds.
    pub seconds: [f64; 2],
    /// 0 where the word is the example's own, 1 where nothing of it is.
    pub word: f32,
    /// How far its way is from the drawn one: metres in the mean for people, for others the share of the drawn way that no turn
    /// and no scale explains, 0 to 1. `None` where no way is drawn.
    pub path: Option<f32>,
    /// How far its pose is from the drawn one at the key frame, metres in the mean; `None` where none is drawn or the skeleton is no person's.
    pub pose: Option<f32>,
    /// Whether it was arranged anew by alignment with the drawn way, and not taken as it was.
    pub aligned: bool,
}

/// A frame's clip that came of an example.
#[derive(Debug, Clone)]
pub struct Answer {
    /// As if it had been sampled.
    pub clip: Generated,
    /// Where it is from.
    pub retrieved: Retrieved,
}

/// Clips of one skeleton.
#[derive(Debug, Clone)]
pub struct Library {
    examples: Vec<Example>,
    person: Option<Humanoid>,
}

impl Library {
    /// Clips without the rest poses at their beginnings; those that are too short to be a motion are left out.
    ///
    /// # Errors
    /// [`StoryboardError::Examples`] when there is none, they are of several skeletons, or there are too many frames.
    pub fn new(examples: Vec<Example>) -> Result<Self, StoryboardError> {
        let wrong = |problem: String, todo: &str| StoryboardError::Examples { problem, todo: todo.into() };
        let mut kept = Vec::new();
        for example in examples {
            let first = lead_in::rest_pose_frames(&example.clip);
            let frames = example.clip.frames();
            if frames.saturating_sub(first) >= LEAST_FRAMES {
                let clip = time::trim(&example.clip, first..frames)?;
                kept.push(Example { clip, ..example });
            }
        }
        let form = |clip: &Clip| -> Form {
            clip.skeleton().joints().iter().map(|joint| (joint.name.clone(), joint.parent)).collect()
        };
        let mut groups: Vec<(Form, Vec<String>)> = Vec::new();
        for example in &kept {
            let own = form(&example.clip);
            match groups.iter_mut().find(|(form, _)| *form == own) {
                Some((_, names)) => names.push(example.name.clone()),
                None => groups.push((own, vec![example.name.clone()])),
            }
        }
        groups.sort_by_key(|(_, names)| std::cmp::Reverse(names.len()));
        if let [(_, usual), (_, odd), ..] = &groups[..] {
            let others: usize = groups.iter().skip(1).map(|(_, names)| names.len()).sum();
            let mut named: Vec<&str> =
                groups.iter().skip(1).flat_map(|(_, names)| names).map(String::as_str).collect();
            named.truncate(8);
            let more = if others > named.len() { " and others" } else { "" };
            let first = odd.first().map_or("", String::as_str);
            return Err(wrong(
                format!(
                    "the examples are of {} skeletons: {} clips, among them {}, have one, {}{more} have another than that",
                    groups.len(),
                    usual.len(),
                    usual.first().map_or("", String::as_str),
                    named.join(", ")
                ),
                &format!("Keep clips of one skeleton in the folder; move {first} elsewhere"),
            ));
        }
        let Some(first) = kept.first() else {
            return Err(wrong(
                "there is no clip among the examples".into(),
                "Put motion files into the folder",
            ));
        };
        // They are searched at up to sixty frames a second, however few they have.
        let searched = |clip: &Clip| clip.frames().max((clip.duration() * 60.0) as usize);
        let frames: usize = kept.iter().map(|example| searched(&example.clip)).fold(0, usize::saturating_add);
        if frames > MOST_FRAMES {
            return Err(wrong(
                format!("the examples have {frames} frames; at most {MOST_FRAMES} are searched"),
                "Take some away",
            ));
        }
        let person = Humanoid::find(first.clip.skeleton()).ok();
        Ok(Self { examples: kept, person })
    }

    /// Whether they are a person's.
    pub fn of_person(&self) -> bool {
        self.person.is_some()
    }

    /// The clips.
    pub fn examples(&self) -> &[Example] {
        &self.examples
    }
}
