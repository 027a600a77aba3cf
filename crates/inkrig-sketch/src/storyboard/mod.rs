//! A storyboard: frames that say by strokes and a word what a figure does, one after the other. docs/storyboard.md
//! describes the file.

mod check;
mod colours;
mod file;
mod path;
mod rows;
mod space;
mod svg;

pub use colours::{Kind, kind_of_colour};
pub use file::{read_storyboard, write_storyboard};
pub use path::FramePath;
pub use space::{Constraint, Edit};
pub use svg::read_storyboard_svg;

use serde::{Deserialize, Serialize};

/// The form of the file that this program writes.
pub const STORYBOARD_VERSION: u32 = 1;

/// Frames of drawing, in the order of the story.
///
/// Whatever [`read_storyboard`] gives holds to [`Storyboard::check`]: every number is finite and in its range, and there
/// is not more of anything than [`crate::limits`] says.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Storyboard {
    /// What it is called.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// The frames.
    pub frames: Vec<Frame>,
}

/// One frame: a drawing on a canvas of its own. x points to the right, y up; the unit is any.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Frame {
    /// What is done, as typed: `kick`, `walk and wave`.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub word: String,
    /// The word as it was written by hand. A typed one wins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lettering: Vec<Stroke>,
    /// The way over the ground that it takes over from what was made of another frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<FramePath>,
    /// The figure.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<Stroke>,
    /// The ways of joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trajectories: Vec<Trajectory>,
    /// Dashes beside a trajectory that make it faster: never read as trajectories.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub speed_lines: Vec<Stroke>,
    /// What stands around: kept, never read as body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scene: Vec<Stroke>,
    /// Where joints are, said by the user. They win over what is read from the body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// Joints that were moved in space, after the motion was made.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<Edit>,
    /// Whether the clip's first and last pose stay as they were without edits, so that no other clip moves.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub lock_ends: bool,
    /// What holds between joints and the world around.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<Constraint>,
    /// Which sides of the figure are the other way round than they are read.
    #[serde(skip_serializing_if = "Sides::is_read")]
    pub sides: Sides,
    /// The camera that the frame is drawn through.
    pub camera: FrameCamera,
    /// How long it lasts; without it as long as the trajectories ask for, or two seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Which of its motions is taken, 0 is the best: several are made of a frame, and ranked.
    #[serde(skip_serializing_if = "is_best")]
    pub take: u32,
    /// The number that its motions are sampled with; without it its place in the story, from 1. A frame that keeps its number
    /// keeps its motions, wherever it is moved to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Whatever there is to say.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub notes: String,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_best(take: &u32) -> bool {
    *take == 0
}

/// A line of a pen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stroke {
    /// x and y, canvas units.
    pub points: Vec<[f64; 2]>,
    /// The pen's time at each point, seconds; never goes back.
    pub seconds: Option<Vec<f64>>,
    /// The pen's pressure at each point, 0 to 1. There is none without time.
    pub pressure: Option<Vec<f64>>,
}

/// The way of a joint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trajectory {
    /// The line.
    pub points: Stroke,
    /// Whose way it is, such as `right_foot`; without it, the joint that is nearest to one of its ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Whether the figure is drawn where the way begins or where it ends; without it, the end that is nearer to the joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub figure: Option<End>,
}

/// An end of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// The first point.
    Start,
    /// The last point.
    End,
}

/// A joint's place, said by the user.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Name of the joint, such as `right_wrist`.
    pub joint: String,
    /// Where it is, canvas units.
    pub at: [f64; 2],
}

/// Left and right of a figure, which a drawing often does not tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sides {
    /// Of shoulders, elbows and hands.
    pub arms: SideChoice,
    /// Of hips, knees and feet.
    pub legs: SideChoice,
}

/// Whether left and right are as they are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SideChoice {
    /// As the reader of figures says.
    #[default]
    Read,
    /// The other way round.
    Swapped,
}

impl Sides {
    fn is_read(&self) -> bool {
        *self == Self::default()
    }
}

/// The camera of a frame: orthographic, turned about the vertical, then tilted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrameCamera {
    /// How far it looks down, degrees, -90 to 90.
    pub pitch_degrees: f64,
    /// How far the figure is turned to the right of the picture, degrees, -180 to 180; at 0 it faces the viewer.
    pub yaw_degrees: f64,
}

impl Default for FrameCamera {
    /// The three-quarter view that storyboards are drawn in.
    fn default() -> Self {
        Self { pitch_degrees: 20.0, yaw_degrees: 30.0 }
    }
}

impl Stroke {
    /// Points without time.
    pub fn new(points: Vec<[f64; 2]>) -> Self {
        Self { points, seconds: None, pressure: None }
    }
}

impl Frame {
    /// Puts a stroke where its kind belongs.
    pub fn add(&mut self, kind: Kind, stroke: Stroke) {
        match kind {
            Kind::Body => self.body.push(stroke),
            Kind::Trajectory => {
                self.trajectories.push(Trajectory { points: stroke, ..Trajectory::default() });
            }
            Kind::Speed => self.speed_lines.push(stroke),
            Kind::Scene => self.scene.push(stroke),
            Kind::Lettering => self.lettering.push(stroke),
        }
    }

    /// All strokes but those of the scene.
    pub fn strokes(&self) -> impl Iterator<Item = &Stroke> {
        let ways = self.trajectories.iter().map(|way| &way.points);
        self.body.iter().chain(ways).chain(&self.speed_lines).chain(&self.lettering)
    }
}
