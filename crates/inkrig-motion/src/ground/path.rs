//! A path on the ground that was given.

use super::line::Line;
use super::low_pass::{REACH, low_pass};
use crate::MotionError;
use glam::DVec2;

/// Places of a path lie this close together when it is followed, in sizes of the character.
const SPACING: f64 = 0.02;
/// A path is held as at most so many places.
const MOST_PLACES: f64 = 50_000.0;
/// Coordinates may be this large, in the path's own units.
const LARGEST: f64 = 1e9;

/// A path on the ground, x and z, in units of its own, of at least two different points.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundPath {
    points: Vec<DVec2>,
    closed: bool,
}

impl GroundPath {
    /// Checks and keeps the points; doubled ones are left out. A closed path leads from its last point back to its
    /// first.
    ///
    /// # Errors
    /// [`MotionError::Path`] when a coordinate is not finite or beyond 1e9, or all points are one.
    pub fn new(points: &[DVec2], closed: bool) -> Result<Self, MotionError> {
        let wrong = |what: String| Err(MotionError::Path { what });
        for (index, point) in points.iter().enumerate() {
            if !(point.is_finite() && point.abs().max_element() <= LARGEST) {
                return wrong(format!(
                    "its point {} is ({}, {}), and coordinates go up to {LARGEST:e}",
                    index + 1,
                    point.x,
                    point.y
                ));
            }
        }
        let mut kept: Vec<DVec2> = points.to_vec();
        kept.dedup();
        if closed && kept.len() > 1 && kept.first() != kept.last() {
            kept.push(kept[0]);
        }
        if kept.len() < 2 {
            return wrong("it is a single point; draw a line of two points or more".to_string());
        }
        Ok(Self { points: kept, closed })
    }

    /// The points, without doubled ones; the last of a closed path is the first again.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Length from the first point to the last, and back to the first when closed, in the path's units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    /// The path in metres, as it is and with its corners rounded over about `corner` metres to either side. `from` is
    /// where it shall begin; its own place otherwise.
    pub(super) fn lines(&self, scale: f64, from: Option<DVec2>, size: f64, corner: f64) -> (Line, Line) {
        let length = self.length() * scale;
        let count = (length / (SPACING * size)).ceil().clamp(2.0, MOST_PLACES) as usize;
        let offset = from.map_or(DVec2::ZERO, |from| from - self.points[0] * scale);
        let points: Vec<DVec2> =
            self.at_equal_steps(count).into_iter().map(|point| point * scale + offset).collect();
        let arc: Vec<f64> = (0..=count).map(|index| length * index as f64 / count as f64).collect();
        let half = (corner / length * count as f64).round().min(count as f64) as usize;
        let smooth = if self.closed { around(&points, half) } else { low_pass(&points, half) };
        (Line::new(arc.clone(), points, self.closed, None), Line::new(arc, smooth, self.closed, None))
    }

    /// `count + 1` points at equal steps of arc length.
    fn at_equal_steps(&self, count: usize) -> Vec<DVec2> {
        let total = self.length();
        let mut pieces = self.points.windows(2).peekable();
        let mut walked = 0.0;
        let mut places = Vec::with_capacity(count + 1);
        for index in 0..=count {
            let way = total * index as f64 / count as f64;
            while let Some(piece) = pieces.peek() {
                let step = piece[0].distance(piece[1]);
                if walked + step >= way {
                    places.push(piece[0].lerp(piece[1], ((way - walked) / step).clamp(0.0, 1.0)));
                    break;
                }
                walked += step;
                pieces.next();
            }
            if places.len() <= index {
                // Rounding put the way beyond the end.
                places.extend(self.points.last());
            }
        }
        places
    }
}

/// [`low_pass`] of points whose last is the first again.
fn around(points: &[DVec2], half: usize) -> Vec<DVec2> {
    let ring = &points[..points.len() - 1];
    let reach = REACH * half;
    let all: Vec<DVec2> = (0..ring.len() + 2 * reach)
        .map(|index| {
            let back = reach % ring.len();
            ring[(index + ring.len() - back) % ring.len()]
        })
        .collect();
    let mut smooth = low_pass(&all, half)[reach..reach + ring.len()].to_vec();
    smooth.push(smooth[0]);
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec2> {
        [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(DVec2::from).to_vec()
    }

    #[test]
    fn what_is_no_path_is_said() {
        for (points, part) in [
            (vec![], "single point"),
            (vec![DVec2::ONE; 5], "single point"),
            (vec![DVec2::ZERO, DVec2::new(f64::NAN, 0.0)], "point 2 is (NaN, 0)"),
            (vec![DVec2::ZERO, DVec2::new(1e12, 0.0)], "1e9"),
        ] {
            let error = GroundPath::new(&points, true).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn corners_are_rounded_and_a_closed_path_has_no_seam() {
        let path = GroundPath::new(&square(), true).unwrap();
        assert_eq!(path.length(), 16.0);
        let (raw, round) = path.lines(0.5, Some(DVec2::ONE), 1.7, 0.4);
        assert_eq!((raw.length(), raw.at(0.0).0), (8.0, DVec2::ONE));
        assert!(raw.at(8.0 + 1.0).0.distance(DVec2::new(2.0, 1.0)) < 1e-9, "around again");
        let cut = round.at(2.0).0.distance(DVec2::new(3.0, 1.0));
        assert!((0.05..0.4).contains(&cut), "{cut}");
        let across = round.at(8.0 - 1e-6).0.distance(round.at(8.0 + 1e-6).0);
        assert!(across < 1e-5, "{across}");
    }
}
