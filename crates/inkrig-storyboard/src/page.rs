//! Strokes on a page of ink, as the readers of drawings want it.

use inkrig_generate::readers::ink::{Ink, Mark, Placement};
use inkrig_sketch::storyboard::Stroke;

/// Pixels of the longer side.
const SIDE: f64 = 640.0;
/// Pixels of paper around.
const MARGIN: f64 = 40.0;
/// Width of the pen, as a share of the longer side.
const PEN: f64 = 1.0 / 70.0;

/// A page, and where the canvas lies on it.
#[derive(Debug, Clone)]
pub(crate) struct Page {
    pub(crate) ink: Ink,
    /// Canvas units a pixel.
    scale: f64,
    /// Canvas place of the page's upper left corner.
    corner: [f64; 2],
}

impl Page {
    /// Draws strokes; `None` where there is no point.
    pub(crate) fn of(strokes: &[Stroke]) -> Option<Self> {
        let points = || strokes.iter().flat_map(|stroke| &stroke.points);
        let (low, high) = bounds(points())?;
        let size = [high[0] - low[0], high[1] - low[1]];
        let longer = size[0].max(size[1]).max(f64::MIN_POSITIVE);
        let placed = |point: &[f64; 2]| {
            [((point[0] - low[0]) / longer) as f32, ((point[1] - low[1]) / longer) as f32, PEN as f32]
        };
        let marks: Vec<Mark> = strokes
            .iter()
            .map(|stroke| Mark::Stroke { points: stroke.points.iter().map(placed).collect(), ink: 1.0 })
            .collect();
        let pixels = |length: f64| (length / longer * SIDE + 2.0 * MARGIN).ceil() as usize;
        let mut ink = Ink::new(pixels(size[0]), pixels(size[1]));
        let scale = longer / SIDE;
        let top = MARGIN + size[1] / scale;
        ink.draw(&marks, &Placement { scale: SIDE as f32, origin: [MARGIN as f32, top as f32] });
        Some(Self { ink, scale, corner: [low[0] - MARGIN * scale, high[1] + MARGIN * scale] })
    }

    /// The canvas place of a pixel.
    pub(crate) fn on_canvas(&self, pixel: [f32; 2]) -> [f64; 2] {
        [self.corner[0] + self.scale * f64::from(pixel[0]), self.corner[1] - self.scale * f64::from(pixel[1])]
    }
}

/// Lowest and highest x and y; `None` of nothing.
pub(crate) fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Option<([f64; 2], [f64; 2])> {
    points.fold(None, |found, [x, y]| {
        let ([left, low], [right, high]) = found.unwrap_or(([*x, *y], [*x, *y]));
        Some(([left.min(*x), low.min(*y)], [right.max(*x), high.max(*y)]))
    })
}

pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
