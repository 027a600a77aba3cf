//! What can go wrong with a drawing: each message says what, where and what to do.

use crate::limits;

/// Why a curve could not be read, resampled, smoothed or made.
///
/// Lines and columns count from 1. Points count from 0, over all strokes, as in the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SketchError {
    /// The file is larger than [`limits::MAX_BYTES`].
    #[error(
        "the drawing has {bytes} bytes; at most {} are read. Draw it simpler, or split it",
        limits::MAX_BYTES
    )]
    TooLarge {
        /// Size of the file, in bytes.
        bytes: usize,
    },
    /// There are more points than [`limits::MAX_POINTS`].
    #[error(
        "the drawing has more than {} points. Simplify the path, or split the drawing",
        limits::MAX_POINTS
    )]
    TooManyPoints,
    /// The bytes are not text.
    #[error("line {line}: this is not UTF-8 text. Save the drawing as UTF-8")]
    NotText {
        /// Line with the first wrong byte.
        line: usize,
    },
    /// The bytes are gzip, as in `.svgz`.
    #[error("the drawing is compressed (gzip, as .svgz is); unpack it first: gunzip -S .svgz drawing.svgz")]
    Compressed,
    /// There is no point at all.
    #[error("the drawing holds no point. Draw at least one stroke")]
    NoPoints,
    /// An SVG file shows no path or shape.
    #[error(
        "the drawing shows no path or shape. Text, images and files linked from an SVG are not read: \
         turn text into paths, and make sure the stroke is visible"
    )]
    NothingVisible,
    /// A JSON file is wrong.
    #[error("JSON, line {line}, column {column}, at point {point}: {problem}")]
    Json {
        /// Line of the file.
        line: usize,
        /// Column of that line.
        column: usize,
        /// Points read well before this one.
        point: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// A CSV file is wrong.
    #[error("CSV, line {line}, column {column}: {problem}")]
    Csv {
        /// Line of the file.
        line: u64,
        /// Field of that line.
        column: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// An SVG file is wrong.
    #[error("SVG, line {line}, column {column}: {problem}")]
    Svg {
        /// Line of the file.
        line: u32,
        /// Column of that line.
        column: u32,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// An SVG file asks for more than a drawing needs.
    #[error("SVG: {what}; at most {limit} are read. Simplify the drawing")]
    SvgTooComplex {
        /// What there is too much of.
        what: &'static str,
        /// The limit, from [`limits`].
        limit: usize,
    },
    /// A point given to [`crate::Curve`] is wrong.
    #[error("point {point}: {problem}")]
    Point {
        /// The point.
        point: usize,
        /// What is wrong.
        problem: String,
    },
    /// Times or pressures do not go with the points.
    #[error("{points} points, but {values} {what}. Give one for each point, or none")]
    CountMismatch {
        /// Number of points.
        points: usize,
        /// Number of values given.
        values: usize,
        /// What the values are.
        what: &'static str,
    },
    /// All points are the same, or there is only one: nothing can follow this curve.
    #[error(
        "the curve does not move: {points} point(s), all in one place. Draw a stroke with at least two distinct points"
    )]
    DoesNotMove {
        /// Number of points.
        points: usize,
    },
    /// Pen timing was asked of a curve without pen times, or with equal ones.
    #[error(
        "the curve has no pen time that advances. Use the arc length for timing, or give a time t to each point"
    )]
    NoPenTime,
    /// The number of frames is zero or above [`limits::MAX_FRAMES`].
    #[error("{frames} frames were asked for; 1 to {} are possible", limits::MAX_FRAMES)]
    FrameCount {
        /// The number asked for.
        frames: usize,
    },
    /// The width of the smoothing is negative, not a number, or above [`limits::MAX_SIGMA`].
    #[error("a smoothing of {sigma} frames was asked for; 0 to {} are possible", limits::MAX_SIGMA)]
    Sigma {
        /// The width asked for, in frames.
        sigma: f64,
    },
    /// A sample shape cannot be made with these numbers.
    #[error("this shape cannot be made: {problem}")]
    Shape {
        /// What is wrong.
        problem: &'static str,
    },
}
