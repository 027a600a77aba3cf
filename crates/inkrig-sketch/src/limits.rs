//! How much a drawing may ask of us. Every limit is checked before the memory it guards is taken.

/// Largest file, in bytes (64 MiB).
pub const MAX_BYTES: usize = 64 << 20;
/// Most points of one curve, all strokes together, read or flattened.
pub const MAX_POINTS: usize = 1_000_000;
/// Largest magnitude of a coordinate (canvas units) or of a pen time (seconds).
pub const MAX_MAGNITUDE: f64 = 1e15;
/// Most frames that [`crate::resample`] makes: nine hours at 30 frames a second.
pub const MAX_FRAMES: usize = 1_000_000;
/// Widest Gaussian of [`crate::smooth`], in frames: 33 seconds at 30 frames a second.
pub const MAX_SIGMA: f64 = 1000.0;

/// Most elements of an SVG drawing, after each `<use>` has been replaced by what it refers to: about 1 kB each in memory.
pub const MAX_SVG_ELEMENTS: usize = 50_000;
/// Deepest nesting of an SVG drawing, counted through `<use>`.
pub const MAX_SVG_DEPTH: usize = 128;
/// Most attributes of an SVG drawing, as written in the file.
pub const MAX_SVG_ATTRIBUTES: usize = 1_000_000;
/// Most attributes of one SVG element.
pub const MAX_SVG_ELEMENT_ATTRIBUTES: usize = 256;
/// Most bytes of attribute text (path data above all), after `<use>` and entities have been expanded (16 MiB).
pub const MAX_SVG_TEXT: usize = 16 << 20;
/// Most style rules times elements: what matching a style sheet costs.
pub const MAX_SVG_STYLE_MATCHES: usize = 5_000_000;
/// Most declarations of name spaces times distinct prefixes, and most references times entities: what resolving costs.
pub const MAX_SVG_LOOKUPS: usize = 16 << 20;

/// Most frames of a storyboard.
pub const MAX_STORYBOARD_FRAMES: usize = 500;
/// Most points of a storyboard, all strokes of all frames together.
pub const MAX_STORYBOARD_POINTS: usize = 500_000;
/// Most `[` of a storyboard's file, and most `{`: what its lists and objects cost beyond their bytes.
pub const MAX_STORYBOARD_LISTS: usize = 1_000_000;
/// See [`MAX_STORYBOARD_LISTS`].
pub const MAX_STORYBOARD_OBJECTS: usize = 50_000;
/// Longest word, note or name of a storyboard, bytes.
pub const MAX_STORYBOARD_TEXT: usize = 4096;
/// Shortest and longest frame of a storyboard, seconds.
pub const MIN_STORYBOARD_SECONDS: f64 = 0.1;
/// See [`MIN_STORYBOARD_SECONDS`].
pub const MAX_STORYBOARD_SECONDS: f64 = 60.0;
/// Most edits of a storyboard's frame, and most constraints.
pub const MAX_STORYBOARD_EDITS: usize = 2000;
/// See [`MAX_STORYBOARD_EDITS`].
pub const MAX_STORYBOARD_CONSTRAINTS: usize = 64;
/// Farthest that a place of an edit or a constraint is from where its clip begins, along each axis, metres.
pub const MAX_STORYBOARD_METRES: f64 = 100.0;
/// Farthest that a pin of a storyboard is from what is drawn in its frame, in longer sides of the drawing: twenty pages off is a
/// number typed wrongly, not a place.
pub const MAX_STORYBOARD_PIN_PAGES: f64 = 20.0;
/// Most motions of a storyboard's frame that one can be taken of.
pub const MAX_STORYBOARD_TAKES: u32 = 64;
/// The largest number of a storyboard's frame.
pub const MAX_STORYBOARD_NUMBER: u32 = 1_000_000;
