//! A contact sheet: poses of a clip at equal times in one PNG, the way animators pin them to a wall.

mod capsule;
mod colours;
pub(crate) mod digits;
mod layout;
mod paint;
mod view;

use inkrig_motion::Clip;

/// How the sheet looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetOptions<'a> {
    /// How many poses, 1 to 10 000. A clip with fewer frames shows each frame once.
    pub poses: usize,
    /// Cells in a row, 1 to 1000; no more than there are poses.
    pub columns: usize,
    /// Width and height of a cell in pixels, 48 to 4096.
    pub cell: [u32; 2],
    /// The camera's turn about the vertical from the front of the first pose, radians. Turned to the right (as seen
    /// by the camera) when positive.
    pub yaw: f32,
    /// How far the camera looks down, radians, -1.5 to 1.5.
    pub pitch: f32,
    /// Light figures on a dark ground.
    pub dark: bool,
    /// These frames instead of equal times; those that the clip does not have are its last.
    pub frames: Option<&'a [usize]>,
    /// The control curve over the time of the clip, x to the right, y up: drawn small in every cell with a dot
    /// where the pose is.
    pub markers: Option<&'a [[f64; 2]]>,
}

impl Default for SheetOptions<'_> {
    /// 24 poses in 4 rows of 6, three-quarter view from a little above, light.
    fn default() -> Self {
        Self {
            poses: 24,
            columns: 6,
            cell: [240, 280],
            yaw: 0.6,
            pitch: 0.28,
            dark: false,
            frames: None,
            markers: None,
        }
    }
}

/// Why a sheet cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetError {
    /// A number of [`SheetOptions`] outside of its range.
    #[error("{what} of a contact sheet must be between {low} and {high}, not {got}")]
    Option {
        /// Which option.
        what: &'static str,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
        /// What was given.
        got: f64,
    },
    /// The picture would be too large.
    #[error(
        "a contact sheet of {width} x {height} pixels is larger than the limit of {limit} pixels: \
         ask for fewer poses or smaller cells"
    )]
    TooLarge {
        /// Width in pixels.
        width: u64,
        /// Height in pixels.
        height: u64,
        /// The most pixels a sheet may have.
        limit: u64,
    },
    /// The picture could not be written as PNG.
    #[error("the contact sheet could not be written as PNG: {0}")]
    Png(String),
}

/// Draws poses at equal times from the first frame to the last, and gives the bytes of a PNG. All poses have the
/// same scale, and the camera follows the character. The same input gives the same bytes.
///
/// # Errors
/// When an option is outside of its range, or the sheet would have more than [`MOST_PIXELS`] pixels.
pub fn contact_sheet(clip: &Clip, options: &SheetOptions<'_>) -> Result<Vec<u8>, SheetError> {
    let grid = layout::Grid::of(clip, options)?;
    let scene = view::Scene::of(clip, &grid.frames(clip, options), options);
    paint::sheet(std::slice::from_ref(&scene), &grid, options)
}

/// Draws two clips side by side at the same times, the first one pale, as [`contact_sheet`] draws one: every two cells
/// are one time. Both have one scale.
///
/// # Errors
/// As [`contact_sheet`].
pub fn contact_sheet_of_two(
    beside: &Clip,
    clip: &Clip,
    options: &SheetOptions<'_>,
) -> Result<Vec<u8>, SheetError> {
    let options = SheetOptions { poses: options.poses.div_ceil(2), ..*options };
    let single = layout::Grid::of(clip, &options)?;
    let frames = single.frames(clip, &options);
    let last = |clip: &Clip| frames.iter().map(|&frame| frame.min(clip.frames() - 1)).collect::<Vec<_>>();
    let mut scenes =
        [view::Scene::of(beside, &last(beside), &options), view::Scene::of(clip, &last(clip), &options)];
    scenes[0].pale = true;
    let (low, high) = (scenes[0].low.min(scenes[1].low), scenes[0].high.max(scenes[1].high));
    for scene in &mut scenes {
        (scene.low, scene.high) = (low, high);
    }
    paint::sheet(&scenes, &single.doubled()?, &options)
}

/// The strokes of a number (digits and a point), its upper left corner at `corner`, `height` pixels high.
pub(crate) fn number_path(number: &str, corner: [f32; 2], height: f32) -> Option<tiny_skia::Path> {
    let mut path = tiny_skia::PathBuilder::new();
    digits::add_text(&mut path, number, corner.into(), height);
    path.finish()
}

/// The most pixels that a sheet may have: 134 MB while it is drawn.
pub const MOST_PIXELS: u64 = 1 << 25;
