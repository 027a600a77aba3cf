//! What is said of a frame's motion in space: where its clip is, what became of edits and constraints.

use crate::cli::ExactArg;
use crate::printable::fixed;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Joints, NAMES};
use inkrig_storyboard::{Animation, Kept, Rule, Source, Space};
use serde::Serialize;

/// What is off by more than this is told, metres.
const TOLD: f32 = 0.01;

/// Part of a frame's record; the names are stable. Lengths are metres.
#[derive(Debug, Default, Serialize)]
pub(in crate::commands) struct SpaceRecord {
    /// From the clip's own space, which begins above the origin and faces +z, to the animation's: first a turn about the vertical.
    pub(in crate::commands) turn_radians: f32,
    /// And then a shift.
    pub(in crate::commands) shift: [f32; 3],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    edits: Vec<EditRecord>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    lock_ends: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    constraints: Vec<ConstraintRecord>,
}

#[derive(Debug, Serialize)]
struct EditRecord {
    joint: &'static str,
    /// Of the clip.
    frame: usize,
    at: [f32; 3],
    miss: f32,
}

#[derive(Debug, Serialize)]
struct ConstraintRecord {
    kind: &'static str,
    joints: Vec<&'static str>,
    /// Of a distance, as it was given or measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    metres: Option<f32>,
    /// Of the clip.
    first: usize,
    frames: usize,
    /// The largest.
    miss: f32,
    /// Where that is, of the clip.
    frame: usize,
}

impl SpaceRecord {
    /// Of the clip at this place of an animation, whose joints are these.
    pub(super) fn of(at: usize, animation: &Animation, motion: &[Joints], space: &Space) -> Self {
        let start = animation.joined.starts.get(at).copied().unwrap_or(0);
        let (turn, shift) = animation.placements.get(at).copied().unwrap_or_default();
        let ahead = turn * Vec3::Z;
        let name = |joint: usize| NAMES.get(joint).copied().unwrap_or_default();
        let goals = animation.goals.get(at).into_iter().flatten();
        let edits = goals.filter(|goal| goal.source == Source::Edit).zip(&space.edits);
        let edits = edits.map(|(goal, (frame, joint, at))| EditRecord {
            joint: name(*joint),
            frame: *frame,
            at: at.to_array(),
            miss: motion.get(goal.frame).map_or(0.0, |pose| goal.miss(pose[goal.joint]).length()),
        });
        let constraints = animation.constraints.get(at).into_iter().flatten();
        let constraints = constraints.map(|Kept { constraint, miss, frame }| ConstraintRecord {
            kind: kind(&constraint.rule),
            joints: joints(&constraint.rule).into_iter().map(name).collect(),
            metres: if let Rule::Distance(_, metres) = constraint.rule { metres } else { None },
            first: constraint.frames.start.saturating_sub(start),
            frames: constraint.frames.len(),
            miss: *miss,
            frame: frame.saturating_sub(start),
        });
        Self {
            turn_radians: ahead.x.atan2(ahead.z),
            shift: shift.to_array(),
            edits: edits.collect(),
            lock_ends: space.lock_ends,
            constraints: constraints.collect(),
        }
    }

    /// Lines below a frame's own.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        if let Some(most) = self.edits.iter().map(|edit| edit.miss).max_by(f32::total_cmp) {
            let (count, most) = (self.edits.len(), centimetres(most));
            let ends = if self.lock_ends { ", ends kept" } else { "" };
            text += &format!("\n    {count} in space, {most} cm off at most{ends}");
        }
        for (number, own) in self.constraints.iter().enumerate() {
            let of = if own.joints.is_empty() {
                String::new()
            } else {
                format!(" of {}", own.joints.join(" and "))
            };
            text += &format!(
                "\n    constraint {}, {}{of}: {} cm off at most",
                number + 1,
                own.kind,
                centimetres(own.miss)
            );
        }
        text
    }

    /// What is not as it was asked for, and what to do.
    pub(super) fn warnings(&self, exact: ExactArg) -> Vec<String> {
        let mut all = Vec::new();
        for edit in self.edits.iter().filter(|edit| edit.miss > TOLD) {
            all.push(format!(
                "the edit of {} at frame {} is missed by {} cm: a body cannot be there with all else that is asked for. Put it nearer, or move the pelvis, too",
                edit.joint,
                edit.frame,
                centimetres(edit.miss)
            ));
        }
        for (number, own) in self.constraints.iter().enumerate().filter(|(_, own)| own.miss > TOLD) {
            let todo = match (exact, own.kind) {
                (ExactArg::Off, _) => "Constraints are kept with --exact pin",
                (ExactArg::Soft, _) => "--exact pin keeps it",
                (ExactArg::Pin, "balance") => {
                    "The feet stand where the drawing does not let the body be: leave balance to other frames, or draw the body over its feet"
                }
                (ExactArg::Pin, "box") => {
                    "Move the box to where the motion comes by, or ask for fewer frames"
                }
                (ExactArg::Pin, "plane") => {
                    "The joint cannot come there with all else that is asked for: move the plane, or ask for fewer frames"
                }
                (ExactArg::Pin, _) => {
                    "Lines, pins and other constraints hold the joints elsewhere: change one of them, or ask for fewer frames"
                }
            };
            all.push(format!(
                "constraint {} ({}) is missed by up to {} cm, at frame {}. {todo}",
                number + 1,
                own.kind,
                centimetres(own.miss),
                own.frame
            ));
        }
        all
    }
}

fn centimetres(metres: f32) -> String {
    fixed(100.0 * f64::from(metres), 1)
}

fn kind(rule: &Rule) -> &'static str {
    match rule {
        Rule::Distance(..) => "distance",
        Rule::Plane(..) => "plane",
        Rule::Box(..) => "box",
        Rule::Balance => "balance",
    }
}

fn joints(rule: &Rule) -> Vec<usize> {
    match rule {
        Rule::Distance(joints, _) => joints.to_vec(),
        Rule::Plane(joint, ..) | Rule::Box(joint, _) => vec![*joint],
        Rule::Balance => Vec::new(),
    }
}
