//! From clips to one animation: joined, its feet on the floor, and moved until it is where it was drawn.

use crate::edited::{bend, edited, placed_edits, settled};
use crate::error::{Problem, StoryboardError};
use crate::exact::{
    Asked, Constraint, Goal, MeetOptions, Met, Proportioned, Rule, Source, joints_of, meet_all, misses,
    proportion,
};
use crate::generate::Generated;
use crate::path;
use crate::plan::Plan;
use crate::sequence::{Blender, Joined, sequence_of};
use inkrig_motion::Clip;
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{self, FRAME_RATE, Joints, keep_footing, skeleton, to_clip};
use std::sync::Arc;

/// What changes by less than this stays, metres.
const STAYS: f32 = 0.01;

/// A picture whose upward axis rises less than this is seen from above and says nothing of heights.
const LEVEL: f32 = 0.1;

/// A whole animation of more seconds is not made: all its frames are moved at once, which takes a gigabyte for ten minutes.
const MOST_SECONDS: f64 = 600.0;

/// Whether frames that last so many seconds, in their order, can become one animation.
///
/// # Errors
/// [`StoryboardError::Frame`] with the frame at which it is too long.
pub fn check_length(seconds: impl IntoIterator<Item = f64>) -> Result<(), StoryboardError> {
    let mut whole = 0.0;
    for (number, seconds) in (1..).zip(seconds) {
        whole += seconds;
        if whole > MOST_SECONDS {
            let minutes = MOST_SECONDS / 60.0;
            let problem = format!(
                "with it the animation is longer than {minutes} minutes, and no longer ones are made"
            );
            return Err(
                Problem::new(problem, "Make frames shorter, or two storyboards of it").of_frame(number)
            );
        }
    }
    Ok(())
}

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
    /// The motion of each clip in its own space, with its edits.
    pub clips: Vec<Vec<Joints>>,
    /// The clips end to end, before feet are put on the floor.
    pub joined: Joined,
    /// From each clip's own space to that of the animation, in the mean over its frames: a turn about the vertical, then a shift over
    /// the ground.
    pub placements: Vec<(Quat, Vec3)>,
    /// What each clip asks of the whole.
    pub goals: Vec<Vec<Goal>>,
    /// What holds in each clip, in the order of its plan.
    pub constraints: Vec<Vec<Kept>>,
    /// Whether the left and the right foot stand, for each frame.
    pub standing: Vec<[bool; 2]>,
    /// How goals were met after sampling.
    pub met: Option<Met>,
    /// How far what is drawn in each frame was moved to be what a body can do.
    pub proportioned: Vec<Proportioned>,
}

/// How far a constraint is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// What holds, in the frames of the whole.
    pub constraint: Constraint,
    /// The largest miss, metres.
    pub miss: f32,
    /// The frame of the whole where that is.
    pub frame: usize,
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
    let moved = clips.iter().enumerate().map(|(at, clip)| edited(at + 1, clip, body));
    let moved: Vec<Vec<Joints>> = moved.collect::<Result<_, _>>()?;
    // Where the ends stay, all goes on as if nothing were moved: that comes last, between the ends.
    let stays: Vec<bool> = clips.iter().zip(&moved).map(|(clip, moved)| ends_stay(clip, moved)).collect();
    let motions = clips.iter().zip(&moved).zip(&stays);
    let motions: Vec<&[Joints]> =
        motions.map(|((clip, moved), stays)| if *stays { clip.motion.as_slice() } else { moved }).collect();
    let joined = sequence_of(clips, &motions, blender)?;
    let rig = Arc::new(skeleton(body, &joined.motion)?);
    let motion = joints_of(&to_clip(&joined.motion, &rig, FRAME_RATE)?);
    let high: Vec<humanml::Kept> = clips
        .iter()
        .zip(joined.starts.iter().zip(&joined.placements))
        .flat_map(|(clip, (start, place))| rises(&clip.plan, goals_of((clip, *start, *place)), &motion))
        .collect();
    let footing = keep_footing(&motion, &contacts(clips, &joined), FRAME_RATE, &high)?;
    let standing = footing.standing;
    let mut clip = to_clip(&footing.frames, &rig, FRAME_RATE)?;
    let placements = placements(clips, &joined, &footing.moved);
    let placed = || {
        let places = joined.starts.iter().zip(&placements);
        clips.iter().zip(places).map(|(clip, (start, place))| (clip, *start, *place))
    };
    let mut goals: Vec<Vec<Goal>> = placed().map(goals_of).collect();
    goals.iter_mut().for_each(|goals| follow(goals, &footing.frames));
    let edits: Vec<Vec<Goal>> = placed().map(placed_edits).collect();
    let mut constraints: Vec<Vec<Constraint>> = placed().map(constraints_of).collect();
    go_on(&mut constraints, clips, &joined);
    let held = constraints.concat();
    let bend_of = |of: bool, goals: &mut [Vec<Goal>]| {
        let own = goals.iter_mut().zip(&edits).zip(&stays).filter(|(_, stays)| **stays == of);
        own.for_each(|((goals, edits), _)| bend(goals, edits));
    };
    bend_of(false, &mut goals);
    let (mut met, mut proportioned) = (None, Vec::new());
    let options = match exact {
        Exact::Off => None,
        Exact::Soft => Some(MeetOptions::soft()),
        Exact::Pin(options) => Some(options.clone()),
    };
    if let Some(options) = &options {
        proportioned.extend(goals.iter_mut().map(|goals| proportion(&clip, goals)));
        let drawn: Vec<Goal> =
            goals.concat().into_iter().filter(|goal| goal.source != Source::Edit).collect();
        let asked = Asked { goals: &drawn, constraints: &held, frozen: &[] };
        let done = meet_all(&clip, &asked, &standing, options);
        clip = to_clip(&done.motion, &rig, FRAME_RATE)?;
        met = Some(done);
    }
    bend_of(true, &mut goals);
    if edits.iter().any(|edits| !edits.is_empty()) {
        let options = options.unwrap_or(MeetOptions { weight: 0.0, ..MeetOptions::default() });
        let mut motion = joints_of(&clip);
        let all = goals.concat();
        for ((own, start, _), _) in placed().zip(&edits).filter(|(_, edits)| !edits.is_empty()) {
            let part = (start..start + own.motion.len(), own.plan.space.lock_ends);
            motion = settled(&motion, &rig, part, (&all, &held), &standing, &options)?;
        }
        clip = to_clip(&motion, &rig, FRAME_RATE)?;
        if let Some(met) = &mut met {
            met.after = misses(&motion, &all);
            met.motion = motion;
        }
    }
    let motion = joints_of(&clip);
    let kept = |constraint: Constraint| {
        let (miss, frame) = constraint.miss(&motion, &standing).unwrap_or((0.0, constraint.frames.start));
        Kept { constraint, miss, frame }
    };
    let constraints = constraints.into_iter().map(|own| own.into_iter().map(kept).collect()).collect();
    Ok(Animation { clip, clips: moved, joined, placements, goals, constraints, standing, met, proportioned })
}

/// Whether an edited clip begins and ends as it did, so that nothing else has to move.
fn ends_stay(clip: &Generated, moved: &[Joints]) -> bool {
    let near = |pair: (Option<&Joints>, Option<&Joints>)| match pair {
        (Some(a), Some(b)) => a.iter().zip(b).all(|(a, b)| a.distance(*b) < STAYS),
        _ => true,
    };
    let ends = (clip.motion.last(), moved.last());
    clip.plan.space.lock_ends || (near((clip.motion.first(), moved.first())) && near(ends))
}

/// Where clips are once feet are on the floor: a body that goes elsewhere with its feet takes all that follows along.
fn placements(clips: &[Generated], joined: &Joined, moved: &[Vec3]) -> Vec<(Quat, Vec3)> {
    let each = clips.iter().zip(&joined.starts).zip(&joined.placements);
    each.map(|((clip, start), (turn, shift))| {
        let own = moved.get(*start..start + clip.motion.len()).unwrap_or_default();
        let mean = own.iter().copied().sum::<Vec3>() / own.len().max(1) as f32;
        (*turn, *shift + Vec3::new(mean.x, 0.0, mean.z))
    })
    .collect()
}

/// A clip, where it begins, and how it is turned and shifted.
type Placed<'a> = (&'a Generated, usize, (Quat, Vec3));

/// How high the drawn way of a body has it: a floor is not to press down who jumps. Ways over the ground say nothing of it.
fn rises(plan: &Plan, mut goals: Vec<Goal>, motion: &[Joints]) -> Vec<humanml::Kept> {
    follow(&mut goals, motion);
    let ways = goals.iter().filter(|goal| goal.joint == 0 && goal.source == Source::Way);
    let ways = ways.filter(|_| plan.over_ground().is_empty());
    ways.filter_map(|goal| {
        let (up, pelvis) = (goal.axes[1].y, motion.get(goal.frame)?[0]);
        let rise = -goal.miss(pelvis).y / up;
        (up > LEVEL).then_some(humanml::Kept { frame: goal.frame, joint: 0, place: pelvis + Vec3::Y * rise })
    })
    .collect()
}

/// What a clip asks of the whole.
fn goals_of((clip, start, placement): Placed<'_>) -> Vec<Goal> {
    let plan = &clip.plan;
    let wanted = plan.wanted().into_iter();
    wanted
        .map(|(frame, joint, at, source)| {
            Goal::placed(start + frame, joint, at, &plan.camera, placement, source)
        })
        .chain(path::goals(plan, start, placement))
        .collect()
}

/// What holds in a clip.
fn constraints_of((clip, start, placement): Placed<'_>) -> Vec<Constraint> {
    let pose = clip.motion.get(clip.plan.key_frame()).or(clip.motion.first());
    let measured = |own: &Constraint| pose.map_or_else(|| own.clone(), |pose| own.measured(pose));
    clip.plan.space.constraints.iter().map(|own| measured(own).placed(start, placement)).collect()
}

/// What holds the same at the end of one clip and the beginning of the next goes on between them.
fn go_on(constraints: &mut [Vec<Constraint>], clips: &[Generated], joined: &Joined) {
    for (number, start) in joined.starts.iter().enumerate().skip(1) {
        let end = joined.starts[number - 1] + clips[number - 1].motion.len();
        let (before, next) = constraints.split_at_mut(number);
        let (Some(before), Some(next)) = (before.last_mut(), next.first()) else { continue };
        for own in before.iter_mut().filter(|own| own.frames.end == end) {
            let same = |other: &Constraint| match (&own.rule, &other.rule) {
                (Rule::Distance(joints, Some(a)), Rule::Distance(others, Some(b))) => {
                    joints == others && (a - b).abs() < STAYS
                }
                (a, b) => a == b,
            };
            if next.iter().any(|other| other.frames.start == *start && same(other)) {
                own.frames.end = *start;
            }
        }
    }
}

/// The model's opinion of which feet stand; of what lies between clips it has none.
fn contacts(clips: &[Generated], joined: &Joined) -> Vec<[f32; 4]> {
    let mut contacts = vec![[0.5; 4]; joined.motion.len()];
    for (clip, start) in clips.iter().zip(&joined.starts) {
        contacts.iter_mut().skip(*start).zip(&clip.contacts).for_each(|(all, own)| *all = *own);
    }
    contacts
}

/// Moves a path, and then a picture, to where its motion has gone: a drawing says nothing of where on the picture its origin is.
fn follow(goals: &mut [Goal], motion: &[Joints]) {
    let place = |goal: &Goal| motion.get(goal.frame).map(|pose| pose[goal.joint]);
    let is_path = |goal: &Goal| goal.source == Source::Path;
    let moved = |goals: &mut [Goal], path: bool, by: &dyn Fn(usize) -> Vec3| {
        let own = goals.iter().filter(|goal| is_path(goal) == path);
        let misses: Vec<Vec2> =
            own.filter_map(|goal| Some(goal.miss(place(goal)? + by(goal.frame)).truncate())).collect();
        let mean = misses.iter().copied().sum::<Vec2>() / misses.len().max(1) as f32;
        goals.iter_mut().filter(|goal| is_path(goal) == path).for_each(|goal| goal.at += mean);
    };
    moved(goals, true, &|_| Vec3::ZERO);
    // What is drawn goes with a body that will be on its path.
    let path: Vec<(usize, Vec3)> = goals
        .iter()
        .filter(|goal| is_path(goal))
        .filter_map(|goal| place(goal).map(|own| (goal.frame, goal.nearest(own) - own)))
        .collect();
    let first = path.first().map_or(0, |(frame, _)| *frame);
    moved(goals, false, &|frame| {
        frame.checked_sub(first).and_then(|at| path.get(at)).map_or(Vec3::ZERO, |(_, by)| *by)
    });
}
