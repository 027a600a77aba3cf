//! How good a model is, on clips that it never saw.

mod control;
mod reconstruction;
mod windows;

pub use control::{ControlOptions, ControlRow, ControlTable, Protocol, bounds, control};
pub use reconstruction::{ReconstructionRow, reconstruction};
pub use windows::{EvaluationWindow, windows};
