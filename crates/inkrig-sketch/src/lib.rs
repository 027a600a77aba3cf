//! What was drawn: two-dimensional curves, read from JSON, CSV and SVG, brought to frames and smoothed.
//!
//! The way of a drawing into the align engine is: bytes -> [`read_curve`] -> [`Curve`] -> [`resample`] -> [`smooth`].
//!
//! ```
//! use inkrig_sketch::{Ends, Format, Timing, read_curve, resample, smooth};
//!
//! let curve = read_curve(b"[[0, 0, 0.0], [3, 4, 0.5], [6, 0, 2.0]]", Format::Json)?;
//! let timing = Timing::automatic(&curve, 61); // pen time: the speed of drawing becomes timing
//! let frames = resample(&curve, 61, timing)?;
//! let control = smooth(&frames, 2.0, Ends::Open)?;
//! assert_eq!((timing, control.len()), (Timing::Pen, 61));
//! # Ok::<(), inkrig_sketch::SketchError>(())
//! ```
//!
//! Units: x and y are canvas units, whose scale and origin do not matter to the engine; y points up; time is in seconds.
//! Nothing here opens a file: callers hand over bytes, and no reader follows a path or an address out of them.

#![deny(clippy::indexing_slicing)]

mod builder;
mod curve;
mod error;
mod labels;
pub mod limits;
mod measure;
mod read;
mod resample;
pub mod shapes;
mod smooth;
pub mod storyboard;
mod table;
mod wave;
mod write;

pub use curve::{Curve, Origin};
pub use error::SketchError;
pub use labels::{LabelLength, Labels, MAX_LABELS, OneHot, read_labels};
pub use measure::Bounds;
pub use read::{Drawing, Format, read_curve, read_drawing};
pub use resample::{Timing, frame_count, resample};
pub use smooth::{Ends, smooth};
pub use table::{MAX_CONTROL_VALUES, MAX_TABLE_WIDTH, Table, read_table};
pub use wave::{MAX_RATE, MAX_WAVE_DEPTH, MAX_WAVE_PARTS, MAX_WAVE_TEXT, Wave, read_wave};
pub use write::{to_csv, to_json, to_svg};
