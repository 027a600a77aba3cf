//! Marks of a pen become pixels.

use super::Ink;

/// What a pen leaves. Places are of any unit, y up, and [`Placement`] brings them onto pixels.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line through places, each x, y and the line's width there.
    Stroke {
        /// Where the pen went.
        points: Vec<[f32; 3]>,
        /// How dark, 0 to 1.
        ink: f32,
    },
    /// The inside of outlines (those that run the other way round cut holes). With ink 0 it hides what was drawn before.
    Area {
        /// Corners of each.
        outlines: Vec<Vec<[f32; 2]>>,
        /// How dark, 0 to 1.
        ink: f32,
    },
}

/// From the units of marks to pixels, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Pixels a unit.
    pub scale: f32,
    /// Where the units' origin lies, pixels from the left and from the top.
    pub origin: [f32; 2],
}

impl Placement {
    /// A place in pixels.
    pub fn pixel(&self, place: [f32; 2]) -> [f32; 2] {
        [self.origin[0] + self.scale * place[0], self.origin[1] - self.scale * place[1]]
    }

    /// The place of a pixel.
    pub fn place(&self, pixel: [f32; 2]) -> [f32; 2] {
        [(pixel[0] - self.origin[0]) / self.scale, (self.origin[1] - pixel[1]) / self.scale]
    }
}

impl Ink {
    /// Draws marks in their order. Lines are at least a pixel wide on paper; thinner ones are lighter instead.
    pub fn draw(&mut self, marks: &[Mark], placement: &Placement) {
        for mark in marks {
            match mark {
                Mark::Stroke { points, ink } => self.stroke(points, *ink, placement),
                Mark::Area { outlines, ink } => {
                    let placed =
                        |outline: &Vec<[f32; 2]>| outline.iter().map(|at| placement.pixel(*at)).collect();
                    self.area(&outlines.iter().map(placed).collect::<Vec<_>>(), *ink);
                }
            }
        }
    }

    fn stroke(&mut self, points: &[[f32; 3]], ink: f32, placement: &Placement) {
        let placed = |point: &[f32; 3]| {
            let [x, y] = placement.pixel([point[0], point[1]]);
            [x, y, 0.5 * point[2] * placement.scale]
        };
        if let [point] = points {
            let point = placed(point);
            self.segment(point, point, ink);
        }
        for pair in points.windows(2) {
            self.segment(placed(&pair[0]), placed(&pair[1]), ink);
        }
    }

    /// A line from one place to another, each x, y and half the width, in pixels.
    fn segment(&mut self, from: [f32; 3], to: [f32; 3], ink: f32) {
        let radius = from[2].max(to[2]).max(0.5) + 1.0;
        let range = |a: f32, b: f32, size: usize| {
            let first = (a.min(b) - radius).max(0.0) as usize;
            let end = (a.max(b) + radius + 1.0).clamp(0.0, size as f32) as usize;
            first..end
        };
        let (columns, rows) = (range(from[0], to[0], self.width), range(from[1], to[1], self.height));
        let way = [to[0] - from[0], to[1] - from[1]];
        let square = way[0] * way[0] + way[1] * way[1];
        let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
        for y in rows {
            let dy = y as f32 + 0.5 - from[1];
            let Some(line) = self.pixels.get_mut(y * self.width..(y + 1) * self.width) else { continue };
            let Some(line) = line.get_mut(columns.clone()) else { continue };
            for (x, pixel) in columns.clone().zip(line) {
                let dx = x as f32 + 0.5 - from[0];
                let along = ((dx * way[0] + dy * way[1]) * inverse).clamp(0.0, 1.0);
                let (ax, ay) = (dx - along * way[0], dy - along * way[1]);
                let half = from[2] + along * (to[2] - from[2]);
                let (drawn, light) = (half.max(0.5), (2.0 * half).min(1.0));
                let reach = drawn + 0.5;
                let square = ax * ax + ay * ay;
                if square < reach * reach {
                    let cover = (reach - square.sqrt()).min(1.0) * light * ink;
                    *pixel = pixel.max(cover);
                }
            }
        }
    }

    /// The inside by the non-zero rule, on two lines a pixel, soft to the left and right.
    fn area(&mut self, outlines: &[Vec<[f32; 2]>], ink: f32) {
        let heights = || outlines.iter().flatten().map(|point| point[1]);
        let top = heights().fold(f32::INFINITY, f32::min).max(0.0) as usize;
        let bottom = (heights().fold(0.0, f32::max) + 1.0).clamp(0.0, self.height as f32) as usize;
        let (mut crossings, mut cover) = (Vec::new(), vec![0.0_f32; self.width]);
        for y in top..bottom {
            cover.fill(0.0);
            for half in [0.25, 0.75] {
                let level = y as f32 + half;
                crossings.clear();
                for outline in outlines {
                    let next = outline.iter().cycle().skip(1);
                    for (a, b) in outline.iter().zip(next) {
                        if (a[1] <= level) != (b[1] <= level) {
                            let x = a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                            crossings.push((x, if b[1] > a[1] { 1 } else { -1 }));
                        }
                    }
                }
                crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut winding = 0;
                for pair in crossings.windows(2) {
                    winding += pair[0].1;
                    if winding == 0 {
                        continue;
                    }
                    let (from, to) = (pair[0].0.max(0.0), pair[1].0.min(self.width as f32));
                    let end = (to.ceil().max(0.0) as usize).min(self.width);
                    for (x, cover) in cover.iter_mut().enumerate().take(end).skip(from as usize) {
                        let inside = (to.min(x as f32 + 1.0) - from.max(x as f32)).clamp(0.0, 1.0);
                        *cover += 0.5 * inside;
                    }
                }
            }
            let Some(line) = self.pixels.get_mut(y * self.width..(y + 1) * self.width) else { continue };
            for (pixel, cover) in line.iter_mut().zip(&cover) {
                *pixel += cover.min(1.0) * (ink - *pixel);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: Placement = Placement { scale: 1.0, origin: [0.0, 20.0] };

    fn sum(ink: &Ink) -> f32 {
        ink.pixels.iter().sum()
    }

    #[test]
    fn lines_have_their_width_and_areas_hide() {
        let mut ink = Ink::new(30, 20);
        let line =
            |width: f32| Mark::Stroke { points: vec![[5.0, 10.0, width], [25.0, 10.0, width]], ink: 1.0 };
        ink.draw(&[line(4.0)], &PIXELS);
        assert!((sum(&ink) - (20.0 * 4.0 + 12.6)).abs() < 3.0, "{}", sum(&ink));
        assert!(ink.pixels[9 * 30 + 15] > 0.99 && ink.pixels[15 * 30 + 15] == 0.0);
        let mut thin = Ink::new(30, 20);
        thin.draw(&[line(0.4)], &PIXELS);
        assert!((sum(&thin) - 8.0).abs() < 1.5, "{}", sum(&thin));
        let square = vec![[10.0, 5.0], [20.0, 5.0], [20.0, 15.0], [10.0, 15.0]];
        ink.draw(&[Mark::Area { outlines: vec![square.clone()], ink: 0.0 }], &PIXELS);
        assert!(ink.pixels[9 * 30 + 15] == 0.0 && ink.pixels[9 * 30 + 8] > 0.99);
        let mut full = Ink::new(30, 20);
        let hole = vec![[12.0, 7.0], [12.0, 9.0], [14.0, 9.0], [14.0, 7.0]];
        full.draw(&[Mark::Area { outlines: vec![square, hole], ink: 0.5 }], &PIXELS);
        assert!((sum(&full) - 48.0).abs() < 0.1);
    }

    #[test]
    fn what_lies_beyond_the_paper_is_passed_over() {
        let mut ink = Ink::new(30, 20);
        let far = vec![[-1e9, 3.0, 1.0], [1e9, 4.0, 1.0], [f32::NAN, 2.0, 1.0]];
        ink.draw(&[Mark::Stroke { points: far, ink: 1.0 }], &PIXELS);
        let outline = vec![[-1e9, -1e9], [1e9, -1e9], [f32::INFINITY, 1e9], [f32::NAN, 0.0]];
        let none = Mark::Area { outlines: vec![vec![]], ink: 1.0 };
        ink.draw(&[Mark::Area { outlines: vec![outline], ink: 1.0 }, none], &PIXELS);
        assert!(ink.pixels.iter().all(|pixel| (0.0..=1.0).contains(pixel)));
        assert_eq!(PIXELS.place(PIXELS.pixel([3.0, 4.0])), [3.0, 4.0]);
    }
}
