//! A clip's map as a picture to draw on in any drawing program.
//!
//! The map is an image inside of an SVG, and images are no curves: a path drawn over it and saved is all that is read of
//! the file. The canvas is made of the map alone, so whoever has the clip knows where on the map a drawing is.

use crate::guide::Suggestions;
use crate::sheet::{SheetError, digits};
use base64::prelude::{BASE64_STANDARD, Engine};
use inkrig_align::{Key, MotionMap, Place};
use inkrig_motion::glam::Vec2;
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Pixels of the longer side of the map.
const SIDE: f64 = 1000.0;
/// Pixels around it.
const MARGIN: f64 = 60.0;

/// Where the map lies on a canvas of pixels, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Canvas {
    left: f64,
    top: f64,
    scale: f64,
    size: [f64; 2],
}

impl Canvas {
    pub(crate) fn of(map: &MotionMap) -> Self {
        let range = |axis: usize| {
            let values = map.frames.iter().map(|at| at.place[axis]);
            values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)))
        };
        let (x, y) = (range(0), range(1));
        let (wide, high) = ((x.1 - x.0).max(1e-9), (y.1 - y.0).max(1e-9));
        let scale = SIDE / wide.max(high);
        let size = [wide, high].map(|length| (length * scale + 2.0 * MARGIN).ceil());
        Self { left: x.0, top: y.1, scale, size }
    }

    /// The pixel of a place, y down.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.left) * self.scale + MARGIN, (self.top - y) * self.scale + MARGIN]
    }

    /// Brings keys on the map to what is read of a drawing on this canvas: pixels, y up.
    pub(crate) fn move_keys(&self, keys: &mut [Key]) {
        for key in keys {
            if let Key::Soft { place: Place::Value(value), .. } = key
                && let [x, y] = value[..]
            {
                let [x, y] = self.pixel([x, y]);
                *value = vec![x, -y];
            }
        }
    }
}

/// The map as SVG.
pub(crate) fn svg(suggestions: &Suggestions, canvas: &Canvas) -> Result<Vec<u8>, SheetError> {
    let [width, height] = canvas.size;
    let picture = BASE64_STANDARD.encode(png(suggestions, canvas)?);
    let text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <image width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{picture}\"/>\n</svg>\n"
    );
    Ok(text.into_bytes())
}

/// The clip's way over its map, from blue to red, and the numbered candidates.
fn png(suggestions: &Suggestions, canvas: &Canvas) -> Result<Vec<u8>, SheetError> {
    let [width, height] = canvas.size.map(|side| side as u32);
    let no_memory = || SheetError::Png(format!("no memory for {width} x {height} pixels"));
    let mut page = Pixmap::new(width, height).ok_or_else(no_memory)?;
    page.fill(Color::WHITE);
    let spot = |place| canvas.pixel(place).map(|value| value as f32);
    let frames = &suggestions.map.frames;
    for (index, pair) in frames.windows(2).enumerate() {
        // A cut is a cut: nothing moves from one clip to the next.
        if pair[0].moment.take != pair[1].moment.take {
            continue;
        }
        let ([x0, y0], [x1, y1]) = (spot(pair[0].place), spot(pair[1].place));
        let mut line = PathBuilder::new();
        line.move_to(x0, y0);
        line.line_to(x1, y1);
        stroke(&mut page, line, ramp(index as f32 / frames.len() as f32), 3.0);
    }
    for (number, candidate) in suggestions.candidates.iter().enumerate() {
        let [x, y] = spot(suggestions.place(candidate));
        if let Some(disc) = PathBuilder::from_circle(x, y, 18.0) {
            page.fill_path(&disc, &paint([40, 46, 58]), FillRule::Winding, Transform::identity(), None);
        }
        let text = (number + 1).to_string();
        let mut path = PathBuilder::new();
        digits::add_text(&mut path, &text, Vec2::new(x - 4.5 * text.len() as f32, y - 8.0), 16.0);
        stroke(&mut page, path, [255, 255, 255], 2.2);
    }
    page.encode_png().map_err(|error| SheetError::Png(error.to_string()))
}

fn stroke(page: &mut Pixmap, path: PathBuilder, colour: [u8; 3], width: f32) {
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    if let Some(path) = path.finish() {
        page.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
}

fn paint(colour: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
    paint
}

/// The colour of a part (0 to 1) of the clip: as on the preview page, in few steps.
fn ramp(part: f32) -> [u8; 3] {
    const STEPS: [[u8; 3]; 5] =
        [[122, 122, 214], [40, 150, 190], [60, 165, 110], [190, 160, 40], [232, 130, 80]];
    let place = part.clamp(0.0, 1.0) * (STEPS.len() - 1) as f32;
    let low = (place as usize).min(STEPS.len() - 2);
    let mix = |channel: usize| {
        let (a, b) = (f32::from(STEPS[low][channel]), f32::from(STEPS[low + 1][channel]));
        (a + (b - a) * (place - low as f32)).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}
