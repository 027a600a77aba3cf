//! Storyboards: drawn frames that become one animation. What makes it is given by the program, so that the studio knows no
//! model; here is what both say to each other.

mod boards;

pub(crate) use boards::{BoardMade, Boards, KeptBoard};

use inkrig_sketch::storyboard::Storyboard;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::ops::ControlFlow;
use utoipa::ToSchema;

/// Makes animations of storyboards.
pub trait Storyboarder: Send + Sync + Debug {
    /// Words that it knows, to be suggested.
    fn words(&self) -> Vec<String>;

    /// Makes one animation. It looks at `watch` between frames, at least; that says whether to go on, and on how many threads.
    ///
    /// # Errors
    /// [`NotMade`].
    fn make(
        &self,
        board: &Storyboard,
        asked: BoardAsked,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<(), usize>,
    ) -> Result<MadeBoard, NotMade>;
}

/// What is made of a storyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub struct BoardAsked {
    /// How drawn lines and poses are met; `soft` without.
    #[serde(default)]
    #[param(inline)]
    pub exact: BoardExact,
    /// Number of the only frame that is made, from 1. It is shown with the others where these need not be made again, else alone.
    pub frame: Option<usize>,
}

/// How drawn lines and poses are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum BoardExact {
    /// Only the word counts.
    Off,
    /// The motion is drawn to them.
    #[default]
    Soft,
    /// It is moved until it meets them.
    Pin,
}

/// How far an animation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardProgress {
    /// Steps that are done: reading, each frame, joining.
    pub done: usize,
    /// All steps.
    pub total: usize,
    /// Number of the frame that is made, from 1; 0 while all are read or joined.
    pub frame: usize,
    /// Number of frames.
    pub frames: usize,
}

/// Why there is no animation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotMade {
    /// It was stopped.
    Stopped,
    /// It cannot be made: what is wrong, and what to do.
    Failed(String),
}

/// An animation.
#[derive(Debug, Clone, PartialEq)]
pub struct MadeBoard {
    /// As a BVH file.
    pub bvh: Vec<u8>,
    /// What is told of each frame that is in it.
    pub frames: Vec<MadeFrame>,
    /// How each of them becomes the next.
    pub transitions: Vec<MadeTransition>,
    /// What the user should know of the whole.
    pub notes: Vec<String>,
}

/// What came of a frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MadeFrame {
    /// Which frame of the storyboard it was, from 1.
    pub number: usize,
    /// Its word, as it was understood.
    pub word: String,
    /// Where in the animation it begins, frames; none where the animation is without it.
    pub begins: Option<usize>,
    /// How long it is, frames.
    pub frames: usize,
    /// How its own space, in which it begins above the origin and faces +z, was turned about the vertical, radians, and then
    /// shifted, metres.
    pub turn: f32,
    /// See `turn`.
    #[schema(value_type = (f32, f32, f32))]
    pub shift: [f32; 3],
    /// Which of its own frames has the drawn pose.
    pub key_frame: Option<usize>,
    /// The drawn pose in the animation's space; empty where none was drawn.
    pub pose: Vec<PosedJoint>,
    /// Joints that were read, on the frame's canvas.
    pub joints: Vec<ReadJoint>,
    /// Whose ways the trajectories are, in their order.
    pub ways: Vec<MadeWay>,
    /// Mean distance of the animation from what was drawn, metres.
    pub mean_miss: f32,
    /// The largest distance, metres.
    pub worst_miss: f32,
    /// Motions that were made of it, the best first.
    pub takes: Vec<MadeTake>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// A motion that can be taken for a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MadeTake {
    /// Mean distance from what was drawn, before frames were joined, metres; none where nothing was drawn.
    pub mean_miss: Option<f32>,
    /// Some of its poses as the frame's camera sees them, metres, y up: trunk, left leg, right leg, left arm, right arm, each a
    /// line of joints.
    #[schema(value_type = Vec<Vec<Vec<(f32, f32)>>>)]
    pub poses: Vec<[Vec<[f32; 2]>; 5]>,
}

/// Frames of an animation that lead from one frame of the storyboard to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MadeTransition {
    /// The first.
    pub begins: usize,
    /// How many.
    pub frames: usize,
}

/// A joint of a pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PosedJoint {
    /// Its name.
    pub name: String,
    /// Where it is, metres.
    #[schema(value_type = (f32, f32, f32))]
    pub at: [f32; 3],
}

/// A joint that was read from a drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadJoint {
    /// Its name, such as `right_foot`.
    pub name: String,
    /// To the right, canvas units.
    pub x: f64,
    /// Up, canvas units.
    pub y: f64,
    /// 0 to 1.
    pub confidence: f32,
    /// Whether the user said where it is.
    pub pinned: bool,
}

/// What a trajectory was taken for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MadeWay {
    /// Whose way it is.
    pub joint: String,
    /// `start` or `end`: where on the line the figure is.
    pub figure: String,
    /// First of the frame's own frames.
    pub first: usize,
    /// How many.
    pub frames: usize,
    /// The line in the animation's space, a place a frame.
    #[schema(value_type = Vec<(f32, f32, f32)>)]
    pub points: Vec<[f32; 3]>,
}
