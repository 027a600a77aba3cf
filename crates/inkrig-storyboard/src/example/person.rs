//! People: windows of clips on the model's body, compared with what is drawn as sampled motions are.

use super::{Answer, Library, Retrieved, words};
use crate::error::StoryboardError;
use crate::exact::joints_of;
use crate::generate::{Generated, cost, error, placed};
use crate::path::facing;
use crate::plan::Plan;
use inkrig_align::{Control, ControlKind, Options, Preset, align};
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{
    Blocks, FRAME_RATE, Joints, WIDTH, features, from_clip, ground, keep_footing, skeleton, to_clip, uniform,
};
use inkrig_motion::{Features, Takes};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Windows are longer or shorter than asked for by these factors, and played quicker or slower.
const PACES: [f64; 3] = [1.0, 0.8, 1.25];
/// A clip of another word counts as so many metres.
const OTHER_WORD: f32 = 0.4;
/// Playing at another pace counts as so many metres for a factor of e.
const OTHER_PACE: f32 = 0.05;
/// Windows that are looked at closely.
const FINALISTS: usize = 4;
/// Windows begin at every so many frames.
const STRIDE: usize = 3;
/// Around the best window, alignment is given so many times its length.
const AROUND: usize = 2;

/// A clip on the model's body, 20 frames a second, the floor at height 0.
pub(super) struct Person {
    name: String,
    said: String,
    motion: Vec<Joints>,
}

struct Window<'a> {
    of: &'a Person,
    first: usize,
    length: usize,
    motion: Vec<Joints>,
    word: f32,
    score: f32,
}

impl Library {
    /// All clips on the model's body (`body`: the bone that ends at each joint, metres); none where they are no person's.
    fn people(&self, body: &Joints) -> Vec<Person> {
        let Some(person) = &self.person else { return Vec::new() };
        self.examples
            .par_iter()
            .map(|example| Person {
                name: example.name.clone(),
                said: example.said.clone(),
                motion: ground(&uniform(&from_clip(&example.clip, person), body)),
            })
            .filter(|person| person.motion.len() > 1)
            .collect()
    }

    /// Answers each plan with a clip, those of a storyboard in its order: a plan may take over the path of an earlier one's clip.
    /// `drawn`: whether the drawing counts, not only the word.
    ///
    /// # Errors
    /// When the clips are no person's, or numbers are not finite.
    pub fn answers(
        &self,
        plans: &[Plan],
        body: &Joints,
        drawn: bool,
    ) -> Result<Vec<Answer>, StoryboardError> {
        let people = self.people(body);
        if people.is_empty() {
            return Err(StoryboardError::Examples {
                problem: "the examples are no person's, so a figure cannot be answered with them".into(),
                todo: "Draw a way without a figure, or give clips of a person".into(),
            });
        }
        let mut answers: Vec<Answer> = Vec::new();
        for (at, plan) in plans.iter().enumerate() {
            let leads = plan.path_of(at + 1).and_then(|frame| answers.get(frame.checked_sub(1)?));
            let plan = leads.map_or_else(|| plan.clone(), |leads| plan.along(&leads.clip.motion));
            answers.push(answer(&people, &plan, body, drawn)?);
        }
        Ok(answers)
    }
}

fn answer(people: &[Person], plan: &Plan, body: &Joints, drawn: bool) -> Result<Answer, StoryboardError> {
    let found = windows(people, plan, drawn);
    let mut best: Option<(f64, Answer)> = None;
    let mut take = |window: &Window<'_>, motion: &[Joints], aligned: bool| -> Result<(), StoryboardError> {
        let clip = generated(plan, motion)?;
        let nearness = if drawn { 0.0 } else { clip.error };
        let all = cost(&clip) - f64::from(nearness) + f64::from(OTHER_WORD * window.word);
        if best.as_ref().is_none_or(|(least, _)| all < *least) {
            let retrieved = retrieved(window, &clip, aligned);
            best = Some((all, Answer { clip, retrieved }));
        }
        Ok(())
    };
    for window in &found {
        take(window, &window.motion, false)?;
    }
    if let Some(window) = found.first().filter(|_| drawn && (!plan.ways.is_empty() || plan.path.is_some()))
        && let Some(motion) = aligned(window, plan, body)?
    {
        take(window, &motion, true)?;
    }
    let none = || StoryboardError::Examples {
        problem: "no example is long enough".into(),
        todo: "Give clips of a second and more".into(),
    };
    best.map(|(_, answer)| answer).ok_or_else(none)
}

/// The windows that are nearest to what is asked for, no two of one place.
fn windows<'a>(people: &'a [Person], plan: &Plan, drawn: bool) -> Vec<Window<'a>> {
    let mut all: Vec<Window<'a>> = people
        .par_iter()
        .flat_map_iter(|person| {
            let word = words::distance(&plan.word, &person.said);
            PACES.into_iter().flat_map(move |pace| {
                let length = ((plan.frames as f64 * pace).round() as usize).clamp(2, person.motion.len());
                let pace = length as f32 / plan.frames as f32;
                let firsts = (0..=person.motion.len() - length).step_by(STRIDE);
                firsts.map(move |first| {
                    let motion = begun(&at_pace(&person.motion[first..first + length], plan.frames));
                    let moved = placed(plan, &motion);
                    let near = if drawn { error(&moved, &motion)[0] } else { 0.0 };
                    let score = near + OTHER_WORD * word + OTHER_PACE * pace.ln().abs();
                    // The motion itself is made again for the few that are kept: all of them would be gigabytes.
                    Window { of: person, first, length, motion: Vec::new(), word, score }
                })
            })
        })
        .collect();
    all.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut kept: Vec<Window<'a>> = Vec::new();
    for window in all {
        let same = |other: &Window<'_>| {
            std::ptr::eq(other.of, window.of) && other.first.abs_diff(window.first) < window.length / 3
        };
        if kept.len() < FINALISTS && !kept.iter().any(same) {
            let part = &window.of.motion[window.first..window.first + window.length];
            let motion = begun(&at_pace(part, plan.frames));
            kept.push(Window { motion, ..window });
        }
    }
    kept
}

/// So many frames, spread over the same motion.
fn at_pace(motion: &[Joints], frames: usize) -> Vec<Joints> {
    let last = motion.len() - 1;
    (0..frames)
        .map(|frame| {
            let place = last as f32 * frame as f32 / (frames.max(2) - 1) as f32;
            let (low, high) = ((place.floor() as usize).min(last), (place.ceil() as usize).min(last));
            std::array::from_fn(|joint| motion[low][joint].lerp(motion[high][joint], place - low as f32))
        })
        .collect()
}

/// The same motion begun above the origin, facing +z, as high as it is.
fn begun(motion: &[Joints]) -> Vec<Joints> {
    let Some(first) = motion.first() else { return Vec::new() };
    let back = Quat::from_rotation_y(-facing(first));
    let from = Vec3::new(first[0].x, 0.0, first[0].z);
    motion.iter().map(|pose| pose.map(|place| back * (place - from))).collect()
}

/// Arranges the surroundings of a window so that they follow the drawn ways; nothing where that cannot be done.
fn aligned(window: &Window<'_>, plan: &Plan, body: &Joints) -> Result<Option<Vec<Joints>>, StoryboardError> {
    let own = &window.of.motion;
    let from = window.first.saturating_sub(AROUND * window.length);
    let until = (window.first + (AROUND + 1) * window.length).min(own.len());
    let part = &own[from..until];
    let clip = to_clip(part, &Arc::new(skeleton(body, part)?), FRAME_RATE)?;
    let mut rows = Vec::new();
    for frame in 0..plan.frames {
        for (_, first, places) in &plan.ways {
            // Before and behind its way a joint rests at its ends.
            let at = frame.saturating_sub(*first).min(places.len().saturating_sub(1));
            rows.extend(places.get(at).map_or([0.0; 2], Vec2::to_array));
        }
        rows.extend(plan.path.iter().flat_map(|path| path.get(frame).map_or([0.0; 2], |at| [at.x, at.z])));
    }
    let control = Control {
        features: Features::new(rows, 2 * (plan.ways.len() + usize::from(plan.path.is_some())))?,
        rate: FRAME_RATE,
        cyclic: false,
        domain: None,
        kind: ControlKind::Curve,
        heard: None,
    };
    let takes = Takes::join(&[clip])?;
    // What is too short or too still to be compared is taken as it is.
    let Ok(done) =
        align(&takes, &control, &Options::preset(Preset::Natural), &mut |_| ControlFlow::Continue(()))
    else {
        return Ok(None);
    };
    let motion = joints_of(&done.clip);
    Ok((motion.len() > 1).then(|| begun(&at_pace(&motion, plan.frames))))
}

/// As if it had been sampled.
fn generated(plan: &Plan, motion: &[Joints]) -> Result<Generated, StoryboardError> {
    let table = features(motion)?;
    let mut contacts: Vec<[f32; 4]> = table
        .as_slice()
        .chunks_exact(WIDTH)
        .filter_map(|row| row[Blocks::CONTACTS].try_into().ok())
        .collect();
    contacts.resize(motion.len(), contacts.last().copied().unwrap_or([0.5; 4]));
    let moved = placed(plan, motion);
    let [error, worst] = error(&moved, motion);
    let motion = keep_footing(motion, &contacts, FRAME_RATE, &[])?.frames;
    let plan = placed(&moved, &motion);
    Ok(Generated { motion, contacts, plan, error, worst, candidate: 0, evaluations: 0 })
}

fn retrieved(window: &Window<'_>, clip: &Generated, aligned: bool) -> Retrieved {
    let plan = &clip.plan;
    let of = |part: Plan| {
        let asked = !part.asks().is_empty() || part.path.is_some();
        asked.then(|| error(&part, &clip.motion)[0])
    };
    Retrieved {
        example: window.of.name.clone(),
        seconds: [window.first, window.first + window.length].map(|frame| frame as f64 / FRAME_RATE),
        word: window.word,
        path: of(Plan { keypose: None, ..plan.clone() }),
        pose: of(Plan { ways: Vec::new(), path: None, ..plan.clone() }),
        aligned,
    }
}
