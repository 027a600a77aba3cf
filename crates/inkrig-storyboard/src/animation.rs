//! From clips to one animation: joined, its feet on the floor, and moved until it is where it was drawn.

use crate::error::StoryboardError;
use crate::exact::{Goal, MeetOptions, Met, joints_of, meet, proportion};
use crate::generate::Generated;
use crate::sequence::{Blender, Joined, sequence};
use inkrig_motion::Clip;
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::{FRAME_RATE, Joints, keep_footing, skeleton, to_clip};
use std::sync::Arc;

/// How drawings are met.
#[derive(Debug, Clone, PartialEq)]
pub enum Exact {
    /// Only the word counts.
    Off,
    /// The motion is brought nearer to them where that takes little.
    Soft,
    /// The motion is moved until it meets them.
    Pin(MeetOptions),
}

/// An animation and how it came to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// On the body that was given.
    pub clip: Clip,
    /// The clips end to end.
    pub joined: Joined,
    /// What each clip asks of the whole.
    pub goals: Vec<Vec<Goal>>,
    /// Whether the left and the right foot stand, for each frame.
    pub standing: Vec<[bool; 2]>,
    /// How goals were met after sampling.
    pub met: Option<Met>,
    /// How far joints of each drawn pose were moved at most to be those of a person, metres.
    pub proportioned: Vec<f32>,
}

/// Makes one animation of clips. `body`: the bone that ends at each joint, metres.
///
/// # Errors
/// When the model cannot make a transition, or numbers are not finite.
pub fn animation(
    clips: &[Generated],
    blender: Option<Blender<'_>>,
    body: &Joints,
    exact: &Exact,
) -> Result<Animation, StoryboardError> {
    let joined = sequence(clips, blender)?;
    let rig = Arc::new(skeleton(body, &joined.motion)?);
    let motion = joints_of(&to_clip(&joined.motion, &rig, FRAME_RATE)?);
    let footing = keep_footing(&motion, &contacts(clips, &joined), FRAME_RATE, &[])?;
    let mut clip = to_clip(&footing.frames, &rig, FRAME_RATE)?;
    let mut goals = goals(clips, &joined);
    let (mut met, mut proportioned) = (None, Vec::new());
    goals.iter_mut().for_each(|goals| follow(goals, &footing.frames));
    let options = match exact {
        Exact::Off => None,
        Exact::Soft => Some(MeetOptions::soft()),
        Exact::Pin(options) => Some(options.clone()),
    };
    if let Some(options) = options {
        proportioned.extend(goals.iter_mut().map(|goals| proportion(&clip, goals)));
        let done = meet(&clip, &goals.concat(), &footing.standing, &options);
        clip = to_clip(&done.motion, &rig, FRAME_RATE)?;
        met = Some(done);
    }
    Ok(Animation { clip, joined, goals, standing: footing.standing, met, proportioned })
}

/// What every clip asks of the whole.
fn goals(clips: &[Generated], joined: &Joined) -> Vec<Vec<Goal>> {
    let each = clips.iter().zip(&joined.starts).zip(&joined.placements);
    each.map(|((clip, start), placement)| {
        let plan = &clip.plan;
        let wanted = plan.wanted().into_iter();
        wanted
            .map(|(frame, joint, at, source)| {
                Goal::placed(start + frame, joint, at, &plan.camera, *placement, source)
            })
            .collect()
    })
    .collect()
}

/// The model's opinion of which feet stand; of what lies between clips it has none.
fn contacts(clips: &[Generated], joined: &Joined) -> Vec<[f32; 4]> {
    let mut contacts = vec![[0.5; 4]; joined.motion.len()];
    for (clip, start) in clips.iter().zip(&joined.starts) {
        contacts.iter_mut().skip(*start).zip(&clip.contacts).for_each(|(all, own)| *all = *own);
    }
    contacts
}

/// Moves a picture to where its motion has gone: a drawing says nothing of where on the picture its origin is.
fn follow(goals: &mut [Goal], motion: &[Joints]) {
    let misses = goals.iter().filter_map(|goal| Some(goal.miss(motion.get(goal.frame)?[goal.joint])));
    let (sum, count) =
        misses.fold((Vec2::ZERO, 0.0_f32), |(sum, count), miss| (sum + miss.truncate(), count + 1.0));
    goals.iter_mut().for_each(|goal| goal.at += sum / count.max(1.0));
}
