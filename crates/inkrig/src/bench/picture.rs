//! Pictures of distances, and many of them on one sheet.

use super::sweep::{Swept, SweptCase, SweptCell};
use crate::sheet::{self, SheetError, SheetOptions, contact_sheet};
use inkrig_motion::Clip;
use inkrig_transport::Mat;
use tiny_skia::{Color, LineCap, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

/// Side of a picture at most, pixels: fewer than a long table has rows.
const MOST: usize = 104;
/// Shades of a picture. Few make borders visible and files small.
const SHADES: f32 = 16.0;
/// The distance that is lightest, in mean distances.
const FAR: f32 = 2.0;
/// Poses under every picture, and their size in pixels.
const POSES: usize = 4;
const POSE: [u32; 2] = [50, 60];

/// A square table of distances, made small: shades from 0, near, to 255, far.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Picture {
    side: usize,
    shades: Vec<u8>,
}

impl Picture {
    /// Of distances in units of their mean, or of another table's.
    pub(super) fn of(distances: &Mat<f32>) -> Self {
        let rows = distances.rows();
        let side = rows.min(MOST);
        let range = |cell: usize| cell * rows / side..((cell + 1) * rows / side).max(cell * rows / side + 1);
        let shade = |index: usize| {
            let (down, across) = (range(index / side), range(index % side));
            let count = (down.len() * across.len()) as f32;
            let sum: f32 = down.map(|row| distances.row(row)[across.clone()].iter().sum::<f32>()).sum();
            let part = (sum / count / FAR).clamp(0.0, 1.0);
            ((part * (SHADES - 1.0)).round() * 255.0 / (SHADES - 1.0)) as u8
        };
        Self { side, shades: (0..side * side).map(shade).collect() }
    }

    fn pixmap(&self) -> Option<Pixmap> {
        let mut pixmap = Pixmap::new(self.side as u32, self.side as u32)?;
        for (pixel, &shade) in pixmap.pixels_mut().iter_mut().zip(&self.shades) {
            let [red, green, blue] = colour(f32::from(shade) / 255.0);
            *pixel = PremultipliedColorU8::from_rgba(red, green, blue, 255)?;
        }
        Some(pixmap)
    }

    /// As PNG.
    pub(super) fn png(&self) -> Result<Vec<u8>, SheetError> {
        encoded(self.pixmap())
    }
}

/// A few poses of a clip side by side, as PNG.
pub(super) fn strip(clip: &Clip) -> Result<Vec<u8>, SheetError> {
    contact_sheet(clip, &SheetOptions { poses: POSES, columns: POSES, cell: POSE, ..SheetOptions::default() })
}

/// From near, dark blue, over teal to far, pale yellow.
fn colour(part: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 4] =
        [[28.0, 32.0, 68.0], [38.0, 98.0, 130.0], [112.0, 178.0, 152.0], [248.0, 240.0, 200.0]];
    let place = part * (STOPS.len() - 1) as f32;
    let low = (place as usize).min(STOPS.len() - 2);
    let part = place - low as f32;
    std::array::from_fn(|channel| {
        (STOPS[low][channel] + part * (STOPS[low + 1][channel] - STOPS[low][channel])).round() as u8
    })
}

/// Space around things, pixels.
const GAP: f32 = 8.0;
const HEADER: f32 = 26.0;

/// A sheet of one parameter: a row for each case, the control's distances first, then a cell for each value (its number
/// above): the result's distances, beside them structure, distance to the clip, jump and speed, below them poses. The cell
/// of the default value is framed.
pub(super) fn grid(swept: &Swept) -> Result<Vec<u8>, SheetError> {
    let cell = [POSES as f32 * POSE[0] as f32 + GAP, MOST as f32 + POSE[1] as f32 + 2.0 * GAP];
    let first = MOST as f32 + 2.0 * GAP;
    let values = swept.parameter.values();
    let (width, height) =
        (first + values.len() as f32 * cell[0], HEADER + swept.cases.len() as f32 * cell[1] + GAP);
    let mut page = Pixmap::new(width as u32, height as u32);
    if let Some(page) = &mut page {
        page.fill(Color::WHITE);
        for (column, value) in values.iter().enumerate() {
            write(page, &value.to_string(), [first + column as f32 * cell[0] + 2.0, 9.0], 11.0);
        }
        for (row, case) in swept.cases.iter().enumerate() {
            let top = HEADER + row as f32 * cell[1];
            place(page, case.control.pixmap(), [GAP, top]);
            for (column, one) in case.cells.iter().enumerate() {
                draw_cell(page, case, one, [first + column as f32 * cell[0], top]);
            }
        }
    }
    encoded(page)
}

fn draw_cell(page: &mut Pixmap, case: &SweptCase, cell: &SweptCell, [left, top]: [f32; 2]) {
    place(page, cell.result.pixmap(), [left, top]);
    place(page, Pixmap::decode_png(&cell.poses).ok(), [left, top + MOST as f32 + 2.0]);
    let quality = &cell.quality;
    let figures =
        [quality.structure_pearson, quality.nearest_patch, quality.jump_q999_ratio, quality.speed_mean_ratio];
    for (line, figure) in figures.iter().enumerate() {
        let corner = [left + MOST as f32 + 10.0, top + 12.0 + 24.0 * line as f32];
        write(page, &format!("{:.2}", figure.max(0.0)), corner, 10.0);
    }
    if (cell.value - case.default).abs() < 1e-9 {
        let (width, height) = (POSES as f32 * POSE[0] as f32 + 2.0, MOST as f32 + POSE[1] as f32 + 5.0);
        if let Some(frame) = tiny_skia::Rect::from_xywh(left - 2.0, top - 2.0, width + 2.0, height) {
            let path = PathBuilder::from_rect(frame);
            let stroke = Stroke { width: 1.5, ..Stroke::default() };
            page.stroke_path(&path, &ink([214, 72, 60]), &stroke, Transform::identity(), None);
        }
    }
}

fn place(page: &mut Pixmap, picture: Option<Pixmap>, [left, top]: [f32; 2]) {
    if let Some(picture) = picture {
        let (x, y) = (left as i32, top as i32);
        page.draw_pixmap(x, y, picture.as_ref(), &Default::default(), Transform::identity(), None);
    }
}

fn write(page: &mut Pixmap, number: &str, corner: [f32; 2], height: f32) {
    if let Some(path) = sheet::number_path(number, corner, height) {
        let stroke = Stroke { width: 1.3, line_cap: LineCap::Round, ..Stroke::default() };
        page.stroke_path(&path, &ink([60, 64, 72]), &stroke, Transform::identity(), None);
    }
}

fn ink([red, green, blue]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint.anti_alias = true;
    paint
}

fn encoded(page: Option<Pixmap>) -> Result<Vec<u8>, SheetError> {
    let page = page.ok_or_else(|| SheetError::Png("no memory for it".to_string()))?;
    page.encode_png().map_err(|error| SheetError::Png(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_dark_where_patches_are_alike() {
        let blocks = Mat::from_fn(300, 300, |i, j| if (i < 150) == (j < 150) { 0.0 } else { 2.5 });
        let picture = Picture::of(&blocks);
        assert_eq!((picture.side, picture.shades.len()), (MOST, MOST * MOST));
        assert_eq!((picture.shades[0], picture.shades[MOST - 1]), (0, 255));
        assert!(picture.png().unwrap().starts_with(b"\x89PNG"));
        assert_eq!(Picture::of(&Mat::from_fn(3, 3, |_, _| 1.0)).side, 3, "small tables are not blown up");
    }
}
