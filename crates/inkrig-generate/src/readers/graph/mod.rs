//! A second opinion on a drawn figure, without a network: lines are thinned to a graph, the roundest closed line is the head, and
//! the rest is matched with a body of a trunk, two arms and two legs.

mod head;
mod limbs;
mod thin;
mod walk;

use super::ink::Ink;
use super::sketch::KEY_POINTS;
use head::{Head, find_head};
use limbs::match_body;
pub use thin::thin;
use walk::Lines;

/// Ink above this is a line.
const LINE: f32 = 0.35;

/// A figure as its lines say it. Places are pixels, from the left and from the top. The figure is taken to face the viewer: its left
/// hand is on the right of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeGraph {
    /// Where each key point is.
    pub places: [[f32; 2]; KEY_POINTS],
    /// How sure that is, 0 to 1, by how well the lines fit a body.
    pub confidence: [f32; KEY_POINTS],
}

/// Reads a crop with one figure. `None` where no body is found: no head, or not the lines of a trunk and limbs.
pub fn read(crop: &Ink) -> Option<StrokeGraph> {
    let (width, height) = (crop.width, crop.height);
    if width < 8 || height < 8 || crop.pixels.len() != width * height {
        return None;
    }
    let mut lines: Vec<bool> = crop.pixels.iter().map(|pixel| *pixel > LINE).collect();
    let head = find_head(&lines, width)?;
    clear(&mut lines, width, &head);
    thin(&mut lines, width);
    let lines = Lines::new(&lines, width, head.middle, head.radius)?;
    match_body(&lines, &head)
}

/// Takes the head's line away, and what is drawn on the head.
fn clear(lines: &mut [bool], width: usize, head: &Head) {
    for (at, line) in lines.iter_mut().enumerate() {
        let off =
            ((at % width) as f32 + 0.5 - head.middle[0]).hypot((at / width) as f32 + 0.5 - head.middle[1]);
        if off < head.radius + head.line + 1.0 {
            *line = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ink::{Mark, Placement};
    use super::*;

    fn stroke(points: &[[f32; 2]], width: f32) -> Mark {
        Mark::Stroke { points: points.iter().map(|[x, y]| [*x, *y, width]).collect(), ink: 1.0 }
    }

    /// A figure with its arms out and one leg to the side, y up.
    fn figure(width: f32) -> Ink {
        let ring: Vec<[f32; 2]> = (0..=24)
            .map(|at| {
                let (sin, cos) = (at as f32 / 24.0 * std::f32::consts::TAU).sin_cos();
                [80.0 + 12.0 * sin, 130.0 + 12.0 * cos]
            })
            .collect();
        let marks = [
            stroke(&ring, width),
            stroke(&[[80.0, 118.0], [80.0, 70.0]], width),
            stroke(&[[40.0, 112.0], [60.0, 95.0], [80.0, 108.0], [105.0, 100.0], [120.0, 125.0]], width),
            stroke(&[[55.0, 15.0], [62.0, 45.0], [80.0, 70.0], [105.0, 50.0], [110.0, 15.0]], width),
        ];
        let mut ink = Ink::new(160, 160);
        ink.draw(&marks, &Placement { scale: 1.0, origin: [0.0, 160.0] });
        ink
    }

    #[test]
    fn the_joints_of_a_plain_figure_are_found() {
        for width in [2.0, 4.0, 6.0] {
            let graph = read(&figure(width)).unwrap();
            // Key points and where they were drawn, y up.
            let truth = [
                (0, [80.0, 70.0]),
                (13, [80.0, 130.0]),
                (16, [120.0, 125.0]),
                (17, [40.0, 112.0]),
                (14, [105.0, 100.0]),
                (15, [60.0, 95.0]),
                (6, [110.0, 15.0]),
                (7, [55.0, 15.0]),
                (4, [105.0, 50.0]),
                (5, [62.0, 45.0]),
            ];
            for (point, [x, y]) in truth {
                let off = (graph.places[point][0] - x).hypot(graph.places[point][1] - (160.0 - y));
                assert!(off < 9.0, "pen {width}, key point {point}: {:?}", graph.places[point]);
            }
            assert!(graph.confidence[16] > 0.3, "{:?}", graph.confidence);
        }
    }

    #[test]
    fn what_is_no_figure_is_none() {
        assert!(read(&Ink::new(160, 160)).is_none());
        assert!(read(&Ink::new(3, 3)).is_none());
        let mut line = Ink::new(160, 160);
        line.draw(
            &[stroke(&[[10.0, 10.0], [150.0, 140.0]], 3.0)],
            &Placement { scale: 1.0, origin: [0.0, 160.0] },
        );
        assert!(read(&line).is_none());
        let full = Ink { width: 160, height: 160, pixels: vec![1.0; 160 * 160] };
        assert!(read(&full).is_none());
    }
}
