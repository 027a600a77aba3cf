//! Motions that are moved to where joints were put in space: a clip before it is joined, so that what comes after it follows; and its
//! part of the whole, so that it is there in the end.

use crate::error::{Problem, StoryboardError};
use crate::exact::{Asked, Constraint, Goal, MeetOptions, Source, as_it_is, meet_all, misses};
use crate::generate::Generated;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{FRAME_RATE, Joints, NAMES, keep_footing, skeleton, to_clip};
use inkrig_motion::{Clip, MotionError, Skeleton};
use std::ops::Range;
use std::sync::Arc;

/// What is put farther from where a motion is than this is a mistake, metres.
const FAR: f32 = 2.0;
/// Times that a clip is moved at most: its bones are not quite those of the body that it is moved on.
const TIMES: usize = 3;
/// A drawn way gives way to a place in space over so many frames on each side.
const BEND: usize = 8;
/// Frames around a clip that may be moved where its ends are not locked, and frames beyond these that movements are smooth against.
const AROUND: usize = 10;
const BEYOND: usize = 4;

/// The motion of a clip (`number`, from 1) with its edits; as it is where there are none.
pub(crate) fn edited(number: usize, clip: &Generated, body: &Joints) -> Result<Vec<Joints>, StoryboardError> {
    let mut motion = clip.motion.clone();
    let space = &clip.plan.space;
    for &(frame, joint, at) in &space.edits {
        let Some(before) = motion.get(frame).map(|pose| pose[joint]) else { continue };
        let off = at.distance(before);
        if off > FAR {
            let problem = format!(
                "the edit of {} at frame {frame} is {off:.1} m from where it is in the motion, which is [{:.2}, {:.2}, {:.2}]",
                NAMES.get(joint).copied().unwrap_or_default(),
                before.x,
                before.y,
                before.z
            );
            let todo = "Put it nearer; a trajectory leads a motion elsewhere";
            return Err(Problem::new(problem, todo).of_frame(number));
        }
    }
    let pose = motion.get(clip.plan.key_frame()).copied();
    for (at, own) in space.constraints.iter().enumerate() {
        let Some((off, frame)) = pose.and_then(|pose| own.measured(&pose).miss(&motion, &[])) else {
            continue;
        };
        if off > FAR {
            let problem = format!("constraint {} is {off:.1} m from the motion at frame {frame}", at + 1);
            let todo = "Put it nearer: places count from where the clip begins, in metres";
            return Err(Problem::new(problem, todo).of_frame(number));
        }
    }
    if space.edits.is_empty() {
        return Ok(motion);
    }
    let standing = keep_footing(&motion, &clip.contacts, FRAME_RATE, &[])?.standing;
    let goals = placed_edits((clip, 0, (Quat::IDENTITY, Vec3::ZERO)));
    let last = motion.len().saturating_sub(1);
    let frozen: Vec<bool> =
        (0..motion.len()).map(|frame| space.lock_ends && (frame == 0 || frame == last)).collect();
    let rig = Arc::new(skeleton(body, &motion)?);
    let options = MeetOptions::default();
    for _ in 0..TIMES {
        let own = to_clip(&motion, &rig, FRAME_RATE)?;
        let before = as_it_is(&own);
        if misses(&before, &goals)[1] < options.tolerance {
            break;
        }
        let asked = Asked { goals: &goals, frozen: &frozen, ..Asked::default() };
        let after = meet_all(&own, &asked, &standing, &options).motion;
        for ((pose, after), before) in motion.iter_mut().zip(&after).zip(&before) {
            *pose = std::array::from_fn(|joint| pose[joint] + (after[joint] - before[joint]));
        }
    }
    Ok(motion)
}

/// The edits of a clip in the motion that it was turned and shifted into, at this frame.
pub(crate) fn placed_edits((clip, start, placement): (&Generated, usize, (Quat, Vec3))) -> Vec<Goal> {
    let plan = &clip.plan;
    let edits = plan.space.edits.iter();
    edits
        .map(|(frame, joint, at)| Goal::in_space(start + frame, *joint, *at, &plan.camera, placement))
        .collect()
}

/// Bends what is drawn of joints that were put in space, and adds these.
pub(crate) fn bend(goals: &mut Vec<Goal>, edits: &[Goal]) {
    for edit in edits {
        let own = |goal: &&Goal| goal.joint == edit.joint && goal.frame == edit.frame;
        // A place in space is one on any picture.
        let place = edit.nearest(Vec3::ZERO);
        let Some(off) = goals.iter().find(own).map(|goal| goal.miss(place).truncate()) else { continue };
        let others = edits.iter().filter(|other| other.joint == edit.joint && other.frame != edit.frame);
        // Other places in space stay.
        let reach = |side: fn(usize, usize) -> bool| {
            let others = others.clone().filter(|other| side(other.frame, edit.frame));
            others.map(|other| other.frame.abs_diff(edit.frame)).min().unwrap_or(BEND).min(BEND)
        };
        let (before, after) = (reach(|a, b| a < b), reach(|a, b| a > b));
        let bends =
            |goal: &&mut Goal| goal.joint == edit.joint && matches!(goal.source, Source::Way | Source::Path);
        for goal in goals.iter_mut().filter(bends) {
            let wide = if goal.frame < edit.frame { before } else { after };
            let share = (goal.frame.abs_diff(edit.frame) as f32 / wide as f32).min(1.0);
            goal.at += off * 0.5 * (1.0 + (std::f32::consts::PI * share).cos());
        }
    }
    goals.retain(|goal| !edits.iter().any(|edit| (edit.frame, edit.joint) == (goal.frame, goal.joint)));
    goals.extend(edits);
}

/// A motion whose frames that belong to an edited clip are moved until edits are met; others stay. `frames`: those of the clip.
pub(crate) fn settled(
    motion: &[Joints],
    rig: &Arc<Skeleton>,
    (frames, locked): (Range<usize>, bool),
    (goals, constraints): (&[Goal], &[Constraint]),
    standing: &[[bool; 2]],
    options: &MeetOptions,
) -> Result<Vec<Joints>, MotionError> {
    let moving = if locked {
        frames.start + 1..frames.end.saturating_sub(1)
    } else {
        frames.start.saturating_sub(AROUND)..(frames.end + AROUND).min(motion.len())
    };
    let seen = moving.start.saturating_sub(BEYOND)..(moving.end + BEYOND).min(motion.len());
    let stands = standing.get(seen.clone()).unwrap_or_default();
    let Some(part) = motion.get(seen.clone()).filter(|part| !part.is_empty()) else {
        return Ok(motion.to_vec());
    };
    let clip: Clip = to_clip(part, rig, FRAME_RATE)?;
    let goals: Vec<Goal> = goals
        .iter()
        .filter(|goal| moving.contains(&goal.frame))
        .map(|goal| Goal { frame: goal.frame - seen.start, ..*goal })
        .collect();
    let within = |frame: usize| frame.clamp(seen.start, seen.end) - seen.start;
    let constraints: Vec<Constraint> = constraints
        .iter()
        .map(|own| Constraint { frames: within(own.frames.start)..within(own.frames.end), ..own.clone() })
        .collect();
    let frozen: Vec<bool> = seen.clone().map(|frame| !moving.contains(&frame)).collect();
    let asked = Asked { goals: &goals, constraints: &constraints, frozen: &frozen };
    let met = meet_all(&clip, &asked, stands, options);
    let mut motion = motion.to_vec();
    for (frame, pose) in seen.zip(met.motion).filter(|(frame, _)| moving.contains(frame)) {
        if let Some(own) = motion.get_mut(frame) {
            *own = pose;
        }
    }
    Ok(motion)
}
