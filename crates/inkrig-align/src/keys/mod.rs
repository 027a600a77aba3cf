//! Keyframes: wishes that tie a place of the control to a moment of a motion, or forbid a moment (MAMM Sec. 3.3).

mod fixed;
mod hard;
mod level;
mod met;
mod moment;
mod resolve;
mod sparse;

pub(crate) use level::{LevelKeys, LevelTables};
pub use met::{KeyRow, pose_errors};
pub use resolve::Keys;
pub(crate) use resolve::{Context, Timing};
pub(crate) use sparse::Moved;

use inkrig_motion::Clip;
use std::ops::Range;
use std::sync::Arc;

/// One wish. Times are seconds since the beginning of the control, and so of the result.
#[derive(Debug, Clone, PartialEq)]
pub enum Key {
    /// Where the control is at (or near) `place`, the motion shall be at (or near) `pose`; what is far from the one
    /// shall be far from the other (Sec. 3.3.1).
    Soft {
        /// A place of the control's domain.
        place: Place,
        /// A moment of the motion's domain.
        pose: Pose,
        /// How much it counts, 0..=100; about 0.3 to 1 (Sec. 3.3.1).
        weight: f64,
    },
    /// The motion shall keep away from a pose: the nearer a moment of the source is to it, the dearer it becomes.
    Avoid {
        /// The pose.
        pose: Pose,
        /// From here on a moment costs nothing; in mean distances of the clip's moments, 0..=10.
        distance: f64,
        /// How much it counts, 0..=100.
        weight: f64,
    },
    /// At that time the pose is exactly that of a frame of the source (Sec. 3.3.2).
    Hard {
        /// Seconds since the beginning of the control. The frame of the result that is nearest takes the pose.
        seconds: f64,
        /// Frame of the source as it was given, at its own rate, takes counted through.
        frame: usize,
    },
    /// Nothing like that pose may appear: the moments of the source that are like it get no weight at all.
    Never {
        /// The pose.
        pose: Pose,
        /// Moments nearer than this are left out too; in mean distances of the clip's moments, 0..=10.
        radius: f64,
    },
    /// A part of an earlier result that stays as it is, at the same time; all else is made anew around it.
    Fixed {
        /// The earlier result, of the source's skeleton, at any rate.
        earlier: Arc<Clip>,
        /// Its frames that stay.
        frames: Range<usize>,
    },
}

/// A place of the control's domain.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Where the control is at that time, seconds since its beginning.
    Time(f64),
    /// Where the control is at that row of its own table ([`Control::features`](crate::Control)), from 0. A time t of
    /// a sound is row 22050 / 512 t.
    Row(usize),
    /// A point of the canvas, a value, a row of labels: as many numbers as the control has, in its own units. It need
    /// not lie on the control.
    Value(Vec<f64>),
    /// A label.
    Label(String),
}

/// A moment of a motion of the source's skeleton.
#[derive(Debug, Clone, PartialEq)]
pub enum Pose {
    /// Frame of the source as it was given, at its own rate, takes counted through.
    Frame(usize),
    /// Frame of another clip.
    Of {
        /// What the clip is called in messages and in the report.
        name: String,
        /// The clip, at any rate.
        clip: Arc<Clip>,
        /// Its frame.
        frame: usize,
    },
}

impl From<usize> for Pose {
    fn from(frame: usize) -> Self {
        Self::Frame(frame)
    }
}

impl std::fmt::Display for Pose {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Frame(frame) => write!(f, "frame {frame}"),
            Self::Of { name, frame, .. } => write!(f, "frame {frame} of {name}"),
        }
    }
}
