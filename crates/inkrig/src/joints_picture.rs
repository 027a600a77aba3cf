//! A drawing with the joints that were found over it.

use crate::sheet::SheetError;
use inkrig_generate::readers::ink::Ink;
use inkrig_generate::readers::sketch::{KEY_POINTS, Reading};
use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

/// Pixels of the longer side.
const SIDE: f32 = 900.0;
/// Pixels of a side of one figure of a sheet.
const TILE: u32 = 220;
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

/// A page and the joints that were found on it, pixels.
pub(crate) struct Figure<'a> {
    pub page: &'a Ink,
    pub places: [[f32; 2]; KEY_POINTS],
    /// How likely each is drawn, 0 to 1.
    pub drawn: [f32; KEY_POINTS],
    /// How sure its place is, 0 to 1.
    pub sure: [f32; KEY_POINTS],
}

/// The page in grey, bones over it (left red, right blue), joints as discs: full ones are sure, pale ones are not.
pub(crate) fn png(
    page: &Ink,
    places: &[[f32; 2]; KEY_POINTS],
    reading: &Reading,
) -> Result<Vec<u8>, SheetError> {
    let scale = SIDE / page.width.max(page.height).max(1) as f32;
    let size = |pixels: usize| ((pixels as f32 * scale).round() as u32).clamp(1, SIDE as u32);
    let mut pixmap = blank(size(page.width), size(page.height))?;
    let figure = Figure { page, places: *places, drawn: reading.drawn, sure: reading.confidence };
    figure.paint(&mut pixmap, [0, 0], scale);
    encoded(&pixmap)
}

/// Figures in rows, each of a kind.
pub(crate) fn sheet(rows: &[Vec<Figure<'_>>]) -> Result<Vec<u8>, SheetError> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let mut pixmap = blank(TILE * columns as u32, TILE * rows.len() as u32)?;
    for (row, figures) in rows.iter().enumerate() {
        for (column, figure) in figures.iter().enumerate() {
            let scale = TILE as f32 / figure.page.width.max(figure.page.height).max(1) as f32;
            figure.paint(&mut pixmap, [column, row].map(|at| at * TILE as usize), scale);
        }
    }
    encoded(&pixmap)
}

fn blank(width: u32, height: u32) -> Result<Pixmap, SheetError> {
    let mut pixmap =
        Pixmap::new(width, height).ok_or_else(|| SheetError::Png(format!("{width} x {height} pixels")))?;
    pixmap.fill(Color::WHITE);
    Ok(pixmap)
}

fn encoded(pixmap: &Pixmap) -> Result<Vec<u8>, SheetError> {
    pixmap
        .encode_png()
        .map_err(|error| SheetError::Png(format!("{} x {} pixels: {error}", pixmap.width(), pixmap.height())))
}

impl Figure<'_> {
    /// With its upper left corner at a place of the picture. Joints that were found nowhere are left out.
    fn paint(&self, pixmap: &mut Pixmap, corner: [usize; 2], scale: f32) {
        let wide = pixmap.width() as usize;
        let [right, down] =
            [self.page.width, self.page.height].map(|size| (size as f32 * scale).round() as usize);
        for y in 0..down.min((pixmap.height() as usize).saturating_sub(corner[1])) {
            for x in 0..right.min(wide.saturating_sub(corner[0])) {
                let along =
                    |at: usize, most: usize| ((at as f32 / scale) as usize).min(most.saturating_sub(1));
                let at = along(y, self.page.height) * self.page.width + along(x, self.page.width);
                let grey = (255.0 - 150.0 * self.page.pixels.get(at).copied().unwrap_or(0.0)) as u8;
                let pixel = &mut pixmap.pixels_mut()[(corner[1] + y) * wide + corner[0] + x];
                *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, 255).unwrap_or(*pixel);
            }
        }
        let size = scale * self.page.width.max(self.page.height) as f32 / SIDE;
        let at = |point: usize| [0, 1].map(|axis| corner[axis] as f32 + self.places[point][axis] * scale);
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        for (from, to) in BONES {
            let strength = self.drawn[from].min(self.drawn[to]);
            let ([x, y], [a, b]) = (at(from), at(to));
            if [x, y, a, b].iter().any(|along| !along.is_finite()) {
                continue;
            }
            let mut path = PathBuilder::new();
            path.move_to(x, y);
            path.line_to(a, b);
            paint.set_color(colour(to, 0.7 * strength));
            if let Some(path) = path.finish() {
                let stroke = Stroke { width: (3.0 * size).max(1.5), ..Stroke::default() };
                pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
            }
        }
        for point in 0..KEY_POINTS {
            let [x, y] = at(point);
            if !(x.is_finite() && y.is_finite()) {
                continue;
            }
            paint.set_color(colour(point, self.sure[point] * self.drawn[point]));
            if let Some(disc) = PathBuilder::from_circle(x, y, (7.0 * size).max(2.5)) {
                pixmap.fill_path(&disc, &paint, FillRule::Winding, Transform::identity(), None);
            }
        }
    }
}

fn colour(point: usize, strength: f32) -> Color {
    let [red, green, blue] = match point {
        0 | 3 | 10 | 13 => [60, 60, 60],
        1 | 4 | 6 | 8 | 11 | 14 | 16 => [200, 50, 40],
        _ => [40, 80, 200],
    };
    Color::from_rgba8(red, green, blue, (255.0 * strength.clamp(0.2, 1.0)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_has_a_tile_for_every_figure() {
        let mut page = Ink::new(40, 40);
        page.pixels.fill(1.0);
        let figure = |x: f32| {
            let mut places = [[20.0, 20.0]; KEY_POINTS];
            places[16] = [x, 10.0];
            Figure { page: &page, places, drawn: [1.0; KEY_POINTS], sure: [1.0; KEY_POINTS] }
        };
        let bytes = sheet(&[vec![figure(10.0), figure(30.0)], vec![figure(20.0)]]).unwrap();
        let seen = Pixmap::decode_png(&bytes).unwrap();
        assert_eq!((seen.width(), seen.height()), (2 * TILE, 2 * TILE));
        let unit = TILE as f32 / 40.0;
        let colour = |x: f32, y: f32| {
            let pixel = seen.pixel((x * unit) as u32, (y * unit) as u32).unwrap();
            [pixel.red(), pixel.green(), pixel.blue()]
        };
        // Hands are red, in every tile at its own place; paper that no figure stands on is white.
        for (x, y) in [(10.0, 10.0), (70.0, 10.0), (20.0, 50.0)] {
            assert_eq!(colour(x, y), [200, 50, 40], "{x} {y}");
        }
        assert_eq!(colour(30.0, 8.0), [105; 3]);
        assert_eq!(colour(70.0, 60.0), [255; 3]);
        let nowhere = Figure { places: [[f32::INFINITY; 2]; KEY_POINTS], ..figure(0.0) };
        let seen = Pixmap::decode_png(&sheet(&[vec![nowhere]]).unwrap()).unwrap();
        assert!(seen.pixels().iter().all(|pixel| pixel.red() == pixel.blue()));
        assert!(sheet(&[]).is_err());
    }
}
