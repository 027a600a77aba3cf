//! Sizes of a curve: bounding box, length, whether it closes.

use crate::Curve;

/// A curve counts as closed when its ends lie within this part of the bounding box's diagonal: a hand-drawn loop.
const CLOSED_WITHIN: f64 = 0.05;

/// An axis-aligned bounding box, in canvas units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest x and y.
    pub min: [f64; 2],
    /// Largest x and y.
    pub max: [f64; 2],
}

impl Bounds {
    /// The box around some points, or `None` around none.
    pub fn around(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        points.into_iter().fold(None, |bounds: Option<Self>, point| {
            let bounds = bounds.unwrap_or(Self { min: point, max: point });
            Some(Self {
                min: [bounds.min[0].min(point[0]), bounds.min[1].min(point[1])],
                max: [bounds.max[0].max(point[0]), bounds.max[1].max(point[1])],
            })
        })
    }

    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        distance(self.min, self.max)
    }
}

impl Curve {
    /// The bounding box of all points.
    pub fn bounds(&self) -> Bounds {
        // A curve has a point; the fallback is never met.
        Bounds::around(self.points().iter().copied()).unwrap_or(Bounds { min: [0.0; 2], max: [0.0; 2] })
    }

    /// Arc length from the first point to the last, in canvas units, the lines between strokes included.
    pub fn length(&self) -> f64 {
        cumulative_length(self.points()).last().copied().unwrap_or(0.0)
    }

    /// Whether there are at least two distinct points.
    pub fn moves(&self) -> bool {
        let mut points = self.points().iter();
        points.next().is_some_and(|first| points.any(|point| point != first))
    }

    /// Whether the curve is a loop: its ends lie within 5 % of the bounding box's diagonal, and between them it
    /// travels at least that diagonal.
    pub fn is_closed(&self) -> bool {
        let (Some(&first), Some(&last)) = (self.points().first(), self.points().last()) else { return false };
        let diagonal = self.bounds().diagonal();
        self.moves() && distance(first, last) <= CLOSED_WITHIN * diagonal && self.length() >= diagonal
    }

    /// The curve with its first point again at its end, an ordinary step after its last one; as it is where they lie
    /// nearer to each other than half of that.
    pub fn closed_up(&self) -> Self {
        let mut curve = self.clone();
        let (Some(&first), Some(&last)) = (self.points().first(), self.points().last()) else { return curve };
        let steps = self.point_count().saturating_sub(1).max(1) as f64;
        if distance(first, last) < 0.5 * self.length() / steps {
            return curve;
        }
        curve.points.push(first);
        if let Some(seconds) = &mut curve.seconds {
            let end = seconds.last().copied().unwrap_or(0.0);
            seconds.push(end + end / steps);
        }
        if let Some(pressure) = &mut curve.pressure {
            pressure.extend(pressure.first().copied());
        }
        curve
    }
}

/// Distance travelled up to each point; as many values as points, the first 0.
pub(crate) fn cumulative_length(points: &[[f64; 2]]) -> Vec<f64> {
    let mut total = 0.0;
    let mut previous = points.first().copied();
    points
        .iter()
        .map(|&point| {
            total += previous.map_or(0.0, |previous| distance(previous, point));
            previous = Some(point);
            total
        })
        .collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_measured() {
        let square = Curve::new(vec![[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0], [1.0, 1.0]]).unwrap();
        assert_eq!(square.bounds(), Bounds { min: [1.0, 1.0], max: [3.0, 3.0] });
        assert_eq!(square.length(), 8.0);
        assert!(square.is_closed());
    }

    #[test]
    fn open_and_still_curves_are_not_closed() {
        let line = Curve::new(vec![[0.0, 0.0], [1.0, 0.0]]).unwrap();
        assert!(line.moves() && !line.is_closed());
        let dot = Curve::new(vec![[2.0, 2.0]; 3]).unwrap();
        assert!(!dot.moves() && !dot.is_closed());
        assert_eq!(dot.length(), 0.0);
    }
}
