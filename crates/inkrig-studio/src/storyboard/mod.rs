//! Storyboards: drawn frames that become one animation. What makes it is given by the program, so that the studio knows no
//! model; here is what both say to each other.

mod boards;

pub(crate) use boards::{BoardMade, Boards};

use inkrig_sketch::storyboard::Storyboard;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::ops::ControlFlow;
use utoipa::ToSchema;

/// Makes animations of storyboards.
pub trait Storyboarder: Send + Sync + Debug {
    /// Words that it knows, to be suggested.
    fn words(&self) -> Vec<String>;

    /// Makes one animation of all frames. It looks at `watch` between frames, at least, and stops when that says so.
    ///
    /// # Errors
    /// [`NotMade`].
    fn make(
        &self,
        board: &Storyboard,
        exact: BoardExact,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<()>,
    ) -> Result<MadeBoard, NotMade>;
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
    /// What is told of each frame.
    pub frames: Vec<MadeFrame>,
    /// What the user should know of the whole.
    pub notes: Vec<String>,
}

/// What came of a frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MadeFrame {
    /// Where in the animation it begins, frames.
    pub begins: usize,
    /// How long it is, frames.
    pub frames: usize,
    /// Which of its own frames has the drawn pose.
    pub key_frame: Option<usize>,
    /// Joints that were read, on the frame's canvas.
    pub joints: Vec<ReadJoint>,
    /// Whose ways the trajectories are, in their order.
    pub ways: Vec<MadeWay>,
    /// Mean distance of the animation from what was drawn, metres.
    pub mean_miss: f32,
    /// The largest distance, metres.
    pub worst_miss: f32,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// A joint that was read from a drawing.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct MadeWay {
    /// Whose way it is.
    pub joint: String,
    /// `start` or `end`: where on the line the figure is.
    pub figure: String,
    /// First of the frame's own frames.
    pub first: usize,
    /// How many.
    pub frames: usize,
}
