//! A curve over the ground as its points at rising arc lengths.

use super::{angle_of, direction, wrapped};
use glam::DVec2;

/// Points with directions. Beyond its ends a closed line goes around again, an open one goes on straight.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    /// Way to each point, metres, rising from 0.
    arc: Vec<f64>,
    points: Vec<DVec2>,
    /// Direction at each point, radians, continuous.
    angles: Vec<f64>,
    /// The last point is the first again.
    closed: bool,
}

impl Line {
    /// A line of at least two points. `hints` are turns that are expected from point to point, radians: where a line
    /// turns back, they say to which side.
    pub(super) fn new(arc: Vec<f64>, points: Vec<DVec2>, closed: bool, hints: Option<&[f64]>) -> Self {
        let last = points.len() - 1;
        let mut angle = angle_of(points[1] - points[0]);
        let angles = (0..points.len())
            .map(|index| {
                let (before, after) = match (closed, index) {
                    (true, 0) => (last - 1, 1),
                    (true, _) if index == last => (last - 1, 1),
                    _ => (index.saturating_sub(1), (index + 1).min(last)),
                };
                let chord = points[after] - points[before];
                // A line that turns back on itself has no direction at its tip.
                let shortest = 0.1 * (arc[index.max(1)] - arc[index.max(1) - 1]);
                if chord.length() > shortest {
                    let hint = hints.and_then(|hints| hints.get(index)).copied().unwrap_or(0.0);
                    let expected = angle + hint;
                    angle = expected + wrapped(angle_of(chord) - expected);
                }
                angle
            })
            .collect();
        Self { arc, points, angles, closed }
    }

    /// Metres.
    pub(super) fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// Whether a way of `s` metres ends on the line itself, not beyond it.
    pub(super) fn covers(&self, s: f64) -> bool {
        self.closed || s <= self.length()
    }

    /// The point and the direction (radians) after a way of `s` metres.
    pub(super) fn at(&self, s: f64) -> (DVec2, f64) {
        let (length, last) = (self.length(), self.points.len() - 1);
        if self.closed && length > 0.0 {
            let rounds = (s / length).floor();
            let (point, angle) = self.inside(s - rounds * length);
            return (point, angle + rounds * (self.angles[last] - self.angles[0]));
        }
        let beyond = if s < 0.0 { s } else { (s - length).max(0.0) };
        let (point, angle) = self.inside(s.clamp(0.0, length));
        (point + beyond * direction(angle), angle)
    }

    fn inside(&self, s: f64) -> (DVec2, f64) {
        let next = self.arc.partition_point(|&arc| arc <= s).clamp(1, self.points.len() - 1);
        let (low, high) = (self.arc[next - 1], self.arc[next]);
        let part = if high > low { ((s - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        let angle = self.angles[next - 1] + part * (self.angles[next] - self.angles[next - 1]);
        (self.points[next - 1].lerp(self.points[next], part), angle)
    }

    /// Distance of a point from the part of the line that lies within `reach` of the way `s`, metres.
    pub(super) fn distance(&self, point: DVec2, s: f64, reach: f64) -> f64 {
        let spacing = self.length() / (self.points.len() - 1) as f64;
        let steps = ((reach / spacing).ceil() as usize).clamp(1, 200);
        let at = |index: usize| self.at(s + reach * (index as f64 / steps as f64 - 1.0)).0;
        (0..2 * steps).map(|index| to_segment(point, at(index), at(index + 1))).fold(f64::INFINITY, f64::min)
    }
}

fn to_segment(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let length = along.length_squared();
    let part = if length > 0.0 { ((point - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + along * part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn an_open_line_goes_on_and_a_closed_one_goes_around() {
        let open = Line::new(vec![0.0, 2.0], vec![DVec2::ZERO, DVec2::new(0.0, 2.0)], false, None);
        assert_eq!(open.at(3.0), (DVec2::new(0.0, 3.0), 0.0));
        assert_eq!(open.at(-1.0).0, DVec2::new(0.0, -1.0));
        assert!((open.distance(DVec2::new(0.5, 1.0), 1.0, 0.5) - 0.5).abs() < 1e-12);

        let count = 400;
        let turn = |index: usize| index as f64 * TAU / f64::from(count);
        let points = (0..=count as usize).map(|index| direction(turn(index))).collect();
        let arc = (0..=count as usize).map(turn).collect();
        let circle = Line::new(arc, points, true, None);
        let (point, angle) = circle.at(TAU + FRAC_PI_2);
        assert!(point.distance(DVec2::X) < 1e-3 && (angle - (FRAC_PI_2 + FRAC_PI_2 + TAU)).abs() < 1e-3);
    }

    #[test]
    fn a_tip_turns_to_the_side_of_the_hint() {
        let points: Vec<DVec2> = [0.0, 1.0, 2.0, 1.0, 0.0].map(|y| DVec2::new(0.0, y)).to_vec();
        let arc: Vec<f64> = (0..5).map(f64::from).collect();
        for side in [-1.0, 1.0] {
            let hints = [0.0, 0.0, 0.0, side * 2.5, 0.0];
            let line = Line::new(arc.clone(), points.clone(), false, Some(&hints));
            assert!((line.at(4.0).1 - side * PI).abs() < 1e-9);
        }
    }
}
