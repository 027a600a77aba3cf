//! What stands in the way of an animation, and what to do about it.

use inkrig_generate::GenerateError;
use inkrig_motion::MotionError;

/// Why a storyboard could not be made a motion.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoryboardError {
    /// A frame that cannot be understood.
    #[error("frame {frame}: {problem}. {todo}")]
    Frame {
        /// Counted from 1.
        frame: usize,
        /// What is wrong, and where.
        problem: String,
        /// What to do.
        todo: String,
    },
    /// Clips that cannot be used as examples.
    #[error("{problem}. {todo}")]
    Examples {
        /// What is wrong.
        problem: String,
        /// What to do.
        todo: String,
    },
    /// The model could not make it.
    #[error("frame {frame}: {cause}")]
    Generate {
        /// Counted from 1.
        frame: usize,
        /// Why.
        cause: Box<GenerateError>,
    },
    /// A motion came out that is none.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// It was stopped.
    #[error("stopped: nothing was written")]
    Stopped,
}

/// A problem of a frame, before its number is known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    pub(crate) what: String,
    pub(crate) todo: String,
}

impl Problem {
    pub(crate) fn new(what: impl Into<String>, todo: impl Into<String>) -> Self {
        Self { what: what.into(), todo: todo.into() }
    }

    pub(crate) fn of_frame(self, frame: usize) -> StoryboardError {
        StoryboardError::Frame { frame, problem: self.what, todo: self.todo }
    }
}
