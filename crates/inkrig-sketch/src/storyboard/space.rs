//! What a frame says of the motion in space, once there is one: joints that were moved by hand, and what is to hold between joints
//! and the world around.
//!
//! Places are metres in the clip's own space: it begins above the origin, y is up, and the figure faces +z.

use super::Frame;
use crate::SketchError;
use crate::limits::{MAX_STORYBOARD_CONSTRAINTS, MAX_STORYBOARD_EDITS, MAX_STORYBOARD_METRES};
use serde::{Deserialize, Serialize};

/// Frames of a second of a clip.
const FRAME_RATE: f64 = 20.0;

/// A joint that was moved by hand after the motion was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// Name of the joint, such as `right_wrist`.
    pub joint: String,
    /// Frame of the clip, from 0, 20 a second.
    pub frame: usize,
    /// Where it is, metres.
    pub at: [f64; 3],
}

/// What holds while a motion goes on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Constraint {
    /// Two joints stay apart: hands on a bar, or on a club.
    Distance {
        /// Names of the two.
        joints: [String; 2],
        /// How far; without it as far as they are in the drawn pose, or in the first frame.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        metres: Option<f64>,
        /// First and last frame of the clip; without it, all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frames: Option<[usize; 2]>,
    },
    /// A joint is on a plane: a hand on the floor, or on a wall.
    Plane {
        /// Name of the joint.
        joint: String,
        /// Of a level plane, metres over the floor.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        height: Option<f64>,
        /// Of any plane: what it looks to, of any length.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        normal: Option<[f64; 3]>,
        /// Of any plane: a place on it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        through: Option<[f64; 3]>,
        /// Of a level plane: the stroke of the scene, from 0, that is drawn at its height, as far away as the figure.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scene: Option<usize>,
        /// See [`Constraint::Distance`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frames: Option<[usize; 2]>,
    },
    /// A joint is on the surface of a box, and the body is not in it: a foot on a table.
    Box {
        /// Name of the joint.
        joint: String,
        /// A corner.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from: Option<[f64; 3]>,
        /// The corner across.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<[f64; 3]>,
        /// Or the stroke of the scene, from 0, that goes around its face, as far away as the figure.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scene: Option<usize>,
        /// With that, how deep it is, metres; without it, half a metre.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        thickness: Option<f64>,
        /// See [`Constraint::Distance`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frames: Option<[usize; 2]>,
    },
    /// The centre of mass is over the feet that stand.
    Balance {
        /// See [`Constraint::Distance`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frames: Option<[usize; 2]>,
    },
}

impl Constraint {
    /// Its name in the file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Distance { .. } => "distance",
            Self::Plane { .. } => "plane",
            Self::Box { .. } => "box",
            Self::Balance { .. } => "balance",
        }
    }

    /// First and last frame of the clip in which it holds.
    pub fn frames(&self) -> Option<[usize; 2]> {
        match self {
            Self::Distance { frames, .. }
            | Self::Plane { frames, .. }
            | Self::Box { frames, .. }
            | Self::Balance { frames } => *frames,
        }
    }

    /// Names of the joints that it is about.
    pub fn joints(&self) -> &[String] {
        match self {
            Self::Distance { joints, .. } => joints,
            Self::Plane { joint, .. } | Self::Box { joint, .. } => std::slice::from_ref(joint),
            Self::Balance { .. } => &[],
        }
    }

    /// The stroke of the scene that it is set from.
    pub fn scene(&self) -> Option<usize> {
        match self {
            Self::Plane { scene, .. } | Self::Box { scene, .. } => *scene,
            Self::Distance { .. } | Self::Balance { .. } => None,
        }
    }

    /// What is wrong with it in itself, and what to do.
    fn problem(&self) -> Option<String> {
        match self {
            Self::Distance { joints: [a, b], .. } if a == b => {
                Some(format!("both of its joints are {a}. Name two"))
            }
            Self::Distance { metres: Some(metres), .. } if !(0.0..=3.0).contains(metres) => {
                Some(format!("{metres} m is not a distance that a person's joints can have, 0 to 3"))
            }
            Self::Plane { height, normal, through, scene, .. } => match (height, normal, through, scene) {
                (Some(height), None, None, None) if is_place(*height) => None,
                (Some(height), None, None, None) => Some(format!("{height} is no height in metres")),
                (None, None, None, Some(_)) => None,
                (None, Some(normal), Some(through), None) => {
                    let long = normal.iter().map(|number| number * number).sum::<f64>().sqrt();
                    if !(1e-6..=1e6).contains(&long) {
                        return Some(format!(
                            "the normal {normal:?} says no direction. Give one such as [0, 1, 0]"
                        ));
                    }
                    no_place(through)
                }
                _ => Some(
                    "it needs \"height\", or \"normal\" and \"through\", or \"scene\": one of these".into(),
                ),
            },
            Self::Box { from: Some(from), to: Some(to), scene: None, thickness: None, .. } => {
                no_place(from).or_else(|| no_place(to)).or_else(|| {
                    let flat = from.iter().zip(to).any(|(a, b)| (a - b).abs() < 1e-3);
                    flat.then(|| {
                        format!("the box from {from:?} to {to:?} is flat. Use a plane, or make it thicker")
                    })
                })
            }
            Self::Box { from: None, to: None, scene: Some(_), thickness, .. } => {
                let thick = thickness.filter(|thick| !(1e-3..=MAX_STORYBOARD_METRES).contains(thick));
                thick.map(|thick| format!("{thick} m is no thickness"))
            }
            Self::Box { .. } => Some("it needs \"from\" and \"to\", or \"scene\": one of these".into()),
            _ => None,
        }
    }
}

impl Frame {
    /// Whether edits and constraints can be used, see [`super::Storyboard::check`].
    pub(super) fn check_space(&self, number: usize) -> Result<(), SketchError> {
        let wrong = |place: String, problem: String| {
            Err(SketchError::Storyboard { place: format!("frame {number}, {place}"), problem })
        };
        for (count, most, what) in [
            (self.edits.len(), MAX_STORYBOARD_EDITS, "edits"),
            (self.constraints.len(), MAX_STORYBOARD_CONSTRAINTS, "constraints"),
        ] {
            if count > most {
                return wrong(what.into(), format!("there are {count}; at most {most} are read"));
            }
        }
        let length = self.seconds.map(|seconds| (seconds * FRAME_RATE).round() as usize);
        let outside = |frame: usize| length.filter(|length| frame >= (*length).max(2));
        for (at, edit) in self.edits.iter().enumerate() {
            super::check::text(&format!("frame {number}, edit"), &edit.joint)?;
            let place = format!("edit of {} at frame {}", edit.joint, edit.frame);
            if let Some(problem) = no_place(&edit.at) {
                return wrong(place, problem);
            }
            if let Some(length) = outside(edit.frame) {
                return wrong(place, format!("the clip has frames 0 to {}", length - 1));
            }
            let same = |other: &&Edit| other.frame == edit.frame && other.joint == edit.joint;
            if let Some(other) = self.edits.iter().take(at).find(same)
                && other.at != edit.at
            {
                let problem = format!("it is at {:?} and at {:?}. Leave one of them out", other.at, edit.at);
                return wrong(place, problem);
            }
        }
        for (at, constraint) in self.constraints.iter().enumerate() {
            let place = format!("constraint {} ({})", at + 1, constraint.kind());
            for joint in constraint.joints() {
                super::check::text(&format!("frame {number}, {place}"), joint)?;
            }
            if let Some(problem) = constraint.problem() {
                return wrong(place, problem);
            }
            if let Some(scene) = constraint.scene().filter(|scene| *scene >= self.scene.len()) {
                let count = self.scene.len();
                return wrong(
                    place,
                    format!("the scene has no stroke {scene}: there are {count}, counted from 0"),
                );
            }
            if let Some([from, to]) = constraint.frames() {
                if from > to {
                    return wrong(place, format!("it begins at frame {from}, behind its last, {to}"));
                }
                if let Some(length) = outside(to) {
                    return wrong(
                        place,
                        format!("it ends at frame {to}; the clip has frames 0 to {}", length - 1),
                    );
                }
            }
        }
        Ok(())
    }
}

fn is_place(number: f64) -> bool {
    number.abs() <= MAX_STORYBOARD_METRES
}

fn no_place(place: &[f64; 3]) -> Option<String> {
    let number = place.iter().find(|number| !is_place(**number))?;
    Some(format!(
        "{number} is no place: at most {MAX_STORYBOARD_METRES} m from where the clip begins are read"
    ))
}
