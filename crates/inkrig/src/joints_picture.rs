//! A drawing with the joints that were found over it.

use crate::sheet::SheetError;
use inkrig_generate::readers::ink::Ink;
use inkrig_generate::readers::sketch::{KEY_POINTS, Reading};
use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

/// Pixels of the longer side.
const SIDE: f32 = 900.0;
/// Key points that bones join: trunk, then the left side, then the right one.
const BONES: [(usize, usize); 19] = [
    (0, 3),
    (3, 10),
    (10, 13),
    (0, 1),
    (1, 4),
    (4, 6),
    (6, 8),
    (10, 11),
    (11, 14),
    (14, 16),
    (0, 2),
    (2, 5),
    (5, 7),
    (7, 9),
    (10, 12),
    (12, 15),
    (15, 17),
    (3, 1),
    (3, 2),
];

/// The page in grey, bones over it (left red, right blue), joints as discs: full ones are sure, pale ones are not.
pub(crate) fn png(
    page: &Ink,
    places: &[[f32; 2]; KEY_POINTS],
    reading: &Reading,
) -> Result<Vec<u8>, SheetError> {
    let scale = SIDE / page.width.max(page.height).max(1) as f32;
    let size = |pixels: usize| ((pixels as f32 * scale).round() as u32).clamp(1, SIDE as u32);
    let (width, height) = (size(page.width), size(page.height));
    let failed = || SheetError::Png(format!("{width} x {height} pixels"));
    let mut pixmap = Pixmap::new(width, height).ok_or_else(failed)?;
    for (at, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
        let along = |place: usize, most: usize| ((place as f32 / scale) as usize).min(most.saturating_sub(1));
        let (x, y) = (along(at % width as usize, page.width), along(at / width as usize, page.height));
        let ink = page.pixels.get(y * page.width + x).copied().unwrap_or(0.0);
        let grey = (255.0 - 150.0 * ink) as u8;
        *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, 255).unwrap_or(*pixel);
    }
    let colour = |point: usize, strength: f32| {
        let [red, green, blue] = match point {
            0 | 3 | 10 | 13 => [60, 60, 60],
            1 | 4 | 6 | 8 | 11 | 14 | 16 => [200, 50, 40],
            _ => [40, 80, 200],
        };
        Color::from_rgba8(red, green, blue, (255.0 * strength.clamp(0.2, 1.0)) as u8)
    };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    for (from, to) in BONES {
        let strength = reading.drawn[from].min(reading.drawn[to]);
        let mut path = PathBuilder::new();
        path.move_to(places[from][0] * scale, places[from][1] * scale);
        path.line_to(places[to][0] * scale, places[to][1] * scale);
        paint.set_color(colour(to, 0.7 * strength));
        if let Some(path) = path.finish() {
            let stroke = Stroke { width: 3.0, ..Stroke::default() };
            pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }
    for (point, place) in places.iter().enumerate() {
        paint.set_color(colour(point, reading.confidence[point] * reading.drawn[point]));
        if let Some(disc) = PathBuilder::from_circle(place[0] * scale, place[1] * scale, 7.0) {
            pixmap.fill_path(&disc, &paint, FillRule::Winding, Transform::identity(), None);
        }
    }
    pixmap.encode_png().map_err(|_| failed())
}
