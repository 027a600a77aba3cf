//! The part of a page that is drawn on, at the size that a reader wants.

use super::{Ink, Placement};

/// Ink below this is paper.
const PAPER: f32 = 0.2;

/// A square picture, and where it lies on the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Crop {
    /// `side` x `side` pixels.
    pub ink: Ink,
    /// Pixels of the page that a pixel of the crop spans.
    pub scale: f32,
    /// The page's pixel, from the left and from the top, at the crop's upper left corner.
    pub corner: [f32; 2],
}

impl Crop {
    /// Where a pixel of the crop lies on the page.
    pub fn on_page(&self, pixel: [f32; 2]) -> [f32; 2] {
        [self.corner[0] + self.scale * pixel[0], self.corner[1] + self.scale * pixel[1]]
    }

    /// How units of marks lie in the crop, when those of the page lie so.
    pub fn placement(&self, page: &Placement) -> Placement {
        Placement {
            scale: page.scale / self.scale,
            origin: [
                (page.origin[0] - self.corner[0]) / self.scale,
                (page.origin[1] - self.corner[1]) / self.scale,
            ],
        }
    }
}

/// Cuts out the ink with a margin, as a share of its longer side, on each side. `None` where there is no ink.
pub fn crop(page: &Ink, side: usize, margin: f32) -> Option<Crop> {
    let [left, top, right, bottom] = bounds(page)?;
    let (width, height) = ((right - left) as f32, (bottom - top) as f32);
    let longer = width.max(height).max(1.0) * (1.0 + 2.0 * margin);
    let corner = [left as f32 + 0.5 * (width - longer), top as f32 + 0.5 * (height - longer)];
    let scale = longer / side as f32;
    let mut ink = Ink::new(side, side);
    for (at, pixel) in ink.pixels.iter_mut().enumerate() {
        let from = [corner[0] + scale * (at % side) as f32, corner[1] + scale * (at / side) as f32];
        *pixel = mean(page, from, scale);
    }
    // A fine pen becomes faint when a large page shrinks: the darkest lines are made dark again.
    let mut dark: Vec<f32> = ink.pixels.iter().copied().filter(|pixel| *pixel > 0.02).collect();
    dark.sort_by(f32::total_cmp);
    if let Some(&high) = dark.get(dark.len() * 9 / 10) {
        let gain = (0.9 / high).clamp(1.0, 6.0);
        ink.pixels.iter_mut().for_each(|pixel| *pixel = (gain * *pixel).min(1.0));
    }
    Some(Crop { ink, scale, corner })
}

/// Left, top, right, bottom (exclusive) of the ink.
fn bounds(page: &Ink) -> Option<[usize; 4]> {
    let mut bounds: Option<[usize; 4]> = None;
    for (y, row) in page.pixels.chunks_exact(page.width.max(1)).enumerate() {
        let Some(left) = row.iter().position(|pixel| *pixel > PAPER) else { continue };
        let right = row.iter().rposition(|pixel| *pixel > PAPER).unwrap_or(left) + 1;
        bounds = Some(match bounds {
            None => [left, y, right, y + 1],
            Some([l, t, r, _]) => [l.min(left), t, r.max(right), y + 1],
        });
    }
    bounds
}

/// The mean over a square of the page, or where that is less than a pixel, between pixels.
pub(in crate::readers) fn mean(page: &Ink, from: [f32; 2], side: f32) -> f32 {
    if side < 1.0 {
        return between(page, [from[0] + 0.5 * side - 0.5, from[1] + 0.5 * side - 0.5]);
    }
    let weights = |from: f32, size: usize| {
        let first = from.max(0.0) as usize;
        let end = ((from + side).max(0.0).ceil() as usize).min(size);
        (first..end).map(move |at| {
            let inside = (from + side).min(at as f32 + 1.0) - from.max(at as f32);
            (at, inside.clamp(0.0, 1.0))
        })
    };
    let mut sum = 0.0;
    for (y, high) in weights(from[1], page.height) {
        for (x, wide) in weights(from[0], page.width) {
            sum += high * wide * page.pixels[y * page.width + x];
        }
    }
    sum / (side * side)
}

fn between(page: &Ink, at: [f32; 2]) -> f32 {
    let pixel = |x: f32, y: f32| {
        let inside = x >= 0.0 && y >= 0.0 && x < page.width as f32 && y < page.height as f32;
        if inside { page.pixels[y as usize * page.width + x as usize] } else { 0.0 }
    };
    let (x, y) = (at[0].floor(), at[1].floor());
    let (right, down) = (at[0] - x, at[1] - y);
    let row = |y: f32| (1.0 - right) * pixel(x, y) + right * pixel(x + 1.0, y);
    (1.0 - down) * row(y) + down * row(y + 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::Mark;
    use super::*;

    #[test]
    fn the_crop_holds_the_ink_and_knows_its_place() {
        for (scale, width) in [(1.0, 3.0), (4.0, 3.0), (0.2, 8.0)] {
            let mut page = Ink::new(600, 400);
            let placement = Placement { scale, origin: [100.0, 300.0] };
            let points = vec![[10.0, 0.0, width], [60.0, 30.0, width]];
            page.draw(&[Mark::Stroke { points, ink: 1.0 }], &placement);
            let crop = crop(&page, 160, 0.1).unwrap();
            let inner = crop.placement(&placement);
            for end in [[10.0, 0.0], [60.0, 30.0]] {
                let pixel = inner.pixel(end);
                assert!(pixel.iter().all(|at| (10.0..150.0).contains(at)), "{pixel:?}");
                let dark = crop.ink.pixels[pixel[1] as usize * 160 + pixel[0] as usize];
                assert!(dark > 0.4, "{scale}: {dark}");
                let back = crop.on_page(pixel);
                let own = placement.pixel(end);
                assert!((back[0] - own[0]).abs() < 1e-2 && (back[1] - own[1]).abs() < 1e-2);
            }
        }
        assert!(crop(&Ink::new(50, 50), 160, 0.1).is_none());
        assert!(crop(&Ink::new(0, 0), 160, 0.1).is_none());
    }
}
