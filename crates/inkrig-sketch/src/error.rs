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
    /// A storyboard's file is wrong.
    #[error("storyboard, {place}: {problem}")]
    Storyboard {
        /// Frame (counted from 1) and part of it, or line and column of the file.
        place: String,
        /// What is wrong, and what to do.
        problem: String,
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
    /// The text of a wave or of labels is wrong.
    #[error("{what}, column {column}: found {found}, expected {expected}{}", sentence(hint.as_deref()))]
    Syntax {
        /// What the text describes: `wave` or `labels`.
        what: &'static str,
        /// Character of the text, counted from 1.
        column: usize,
        /// What stands there, in backquotes, or `the end`.
        found: String,
        /// What may stand there.
        expected: String,
        /// What to write instead, where that is known.
        hint: Option<String>,
    },
    /// The file of a control is larger than [`limits::MAX_BYTES`].
    #[error(
        "the file of the {what} has {bytes} bytes; at most {} are read. Leave out rows, or split it",
        limits::MAX_BYTES
    )]
    FileTooLarge {
        /// What the file holds.
        what: &'static str,
        /// Size of the file, in bytes.
        bytes: usize,
    },
    /// The file of a control is not text.
    #[error("the file of the {what}, line {line}: this is not UTF-8 text. Save it as CSV or JSON in UTF-8")]
    FileNotText {
        /// What the file should hold.
        what: &'static str,
        /// Line with the first wrong byte.
        line: usize,
    },
    /// A wave or labels were asked of an SVG file.
    #[error("{what} is not read from SVG. Give CSV or JSON")]
    NotFromSvg {
        /// What was asked for.
        what: &'static str,
    },
    /// A number or a label in a JSON file is wrong.
    #[error("JSON, line {line}, column {column}, at {item} {index}: {problem}")]
    JsonItem {
        /// Line of the file.
        line: usize,
        /// Column of that line.
        column: usize,
        /// What the array holds: `sample` or `label`.
        item: &'static str,
        /// Items read well before this one.
        index: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// There are more rows than [`limits::MAX_FRAMES`].
    #[error("the {what} has more than {} rows. Keep every tenth row, or split the file", limits::MAX_FRAMES)]
    TooManyRows {
        /// What the rows are.
        what: &'static str,
    },
    /// There are more numbers than [`crate::MAX_CONTROL_VALUES`].
    #[error(
        "the {what} holds more than {} numbers, rows times columns. Leave out rows or columns",
        crate::MAX_CONTROL_VALUES
    )]
    TooManyValues {
        /// What the numbers are.
        what: &'static str,
    },
    /// A control needs at least two rows.
    #[error("the {what} has {rows} row(s) of numbers; at least two are needed. Give one row for each frame")]
    TooFewRows {
        /// What the rows are.
        what: &'static str,
        /// Number of rows.
        rows: usize,
    },
    /// All values are the same: nothing can follow this control.
    #[error("the {what} does not move: all its {rows} samples are the same. Give at least two that differ")]
    Still {
        /// What does not move.
        what: &'static str,
        /// Number of samples.
        rows: usize,
    },
    /// There is a time for each row, but they are all the same.
    #[error("the times t of the {what} are all the same. Give seconds that advance, or leave t out")]
    TimeStands {
        /// What the times belong to.
        what: &'static str,
    },
    /// A rate is not a positive number, or too large.
    #[error("a rate of {rate} samples a second was asked for; above 0 to {} are possible", crate::MAX_RATE)]
    Rate {
        /// The rate asked for, in samples a second.
        rate: f64,
    },
    /// More frames were asked for than all segments of a wave are long.
    #[error(
        "the wave lasts {seconds} s, which is {own} frames, but {frames} were asked for. \
         Ask for fewer, or leave out the last `for`: that segment then lasts to the end"
    )]
    WaveTooShort {
        /// Length of the wave, in seconds.
        seconds: f64,
        /// Length of the wave, in frames.
        own: usize,
        /// Frames asked for.
        frames: usize,
    },
    /// A wave goes faster than samples at this rate can show.
    #[error(
        "the wave reaches {hertz} Hz, but {rate} samples a second show only what is below {} Hz. Lower the frequency",
        rate / 2.0
    )]
    WaveTooFast {
        /// The highest frequency of the wave, in hertz.
        hertz: f64,
        /// The rate asked for, in samples a second.
        rate: f64,
    },
    /// A wave leaves the numbers that can be handled.
    #[error(
        "the wave is {value:e} at frame {frame}; a finite number of at most {:e} is expected. Make its factors smaller",
        limits::MAX_MAGNITUDE
    )]
    WaveValue {
        /// The first such frame.
        frame: usize,
        /// The value there.
        value: f64,
    },
    /// There is no label at all.
    #[error("there is no label. Write segments such as `walk:30 wave:45`, or one label a line")]
    NoLabels,
    /// There is only one label: nothing tells the frames apart.
    #[error(
        "all frames have the label {name:?}. Give at least two different labels, such as `walk:30 wave:45`"
    )]
    OneLabel {
        /// The label.
        name: String,
    },
    /// There are more different labels than [`crate::MAX_LABELS`].
    #[error(
        "there are more than {} different labels. Use fewer, and look for misspelt ones",
        crate::MAX_LABELS
    )]
    TooManyLabels,
    /// There are more segments of labels than [`limits::MAX_FRAMES`].
    #[error(
        "there are more than {} segments of labels. Join neighbours, or split the row",
        limits::MAX_FRAMES
    )]
    TooManySegments,
    /// A segment given to [`crate::Labels::new`] is wrong.
    #[error("segment {segment}: {problem}")]
    Segment {
        /// The segment, counted from 0.
        segment: usize,
        /// What is wrong.
        problem: String,
    },
    /// The row of labels is too short for all of them.
    #[error(
        "the label {name:?} gets none of the {frames} frames. Ask for more frames, or make its segment longer"
    )]
    LabelLost {
        /// The label.
        name: String,
        /// Number of frames.
        frames: usize,
    },
}

fn sentence(hint: Option<&str>) -> String {
    hint.map(|hint| format!(". {hint}")).unwrap_or_default()
}
