//! Ink on paper, as numbers from 0 (paper) to 1 (ink).

mod crop;
mod draw;
mod page;

pub(super) use crop::mean;
pub use crop::{Crop, crop};
pub use draw::{Mark, Placement};

/// A picture of ink: rows from the top, 0 paper to 1 ink.
#[derive(Debug, Clone, PartialEq)]
pub struct Ink {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row.
    pub pixels: Vec<f32>,
}

impl Ink {
    /// Bare paper.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![0.0; width * height] }
    }
}
