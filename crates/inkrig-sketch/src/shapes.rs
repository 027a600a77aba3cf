//! Small curves made by formula: samples to start from, and figures for tests.
//!
//! All lie around the origin within a radius of about 1, have `samples` points at equal steps of their parameter, no pen
//! time, and coordinates rounded to six decimals, so that a stored copy stays the same on every machine.

use std::f64::consts::TAU;

use crate::limits::MAX_POINTS;
use crate::{Curve, SketchError};

/// A spiral that grows from circle to circle: `turns` rounds at constant angular speed, each wider than the one before.
///
/// The radius grows evenly from `1 / (turns + 1)` to 1, counter-clockwise from the positive x axis.
///
/// # Errors
/// No turn, fewer than two samples, or more than [`MAX_POINTS`].
pub fn growing_circles(turns: usize, samples: usize) -> Result<Curve, SketchError> {
    positive(turns, "at least one turn is needed")?;
    let turns = turns as f64;
    trace(samples, |u| {
        let radius = (1.0 + turns * u) / (1.0 + turns);
        polar(radius, TAU * turns * u)
    })
}

/// A figure of eight lying on its side, drawn `laps` times over: the Lissajous curve (sin a, sin 2a / 2), closed.
///
/// # Errors
/// No lap, fewer than two samples, or more than [`MAX_POINTS`].
pub fn figure_of_eight(laps: usize, samples: usize) -> Result<Curve, SketchError> {
    positive(laps, "at least one lap is needed")?;
    trace(samples, |u| {
        let a = TAU * laps as f64 * u;
        [a.sin(), 0.5 * (2.0 * a).sin()]
    })
}

/// A sine wave of `periods` periods along x from -1 to 1, 0.5 high to each side.
///
/// # Errors
/// No period, fewer than two samples, or more than [`MAX_POINTS`].
pub fn wave(periods: usize, samples: usize) -> Result<Curve, SketchError> {
    positive(periods, "at least one period is needed")?;
    trace(samples, |u| [2.0 * u - 1.0, 0.5 * (TAU * periods as f64 * u).sin()])
}

/// A zigzag of `periods` periods along x from -1 to 1, with straight flanks, 0.5 high to each side.
///
/// # Errors
/// As [`wave`].
pub fn zigzag(periods: usize, samples: usize) -> Result<Curve, SketchError> {
    positive(periods, "at least one period is needed")?;
    trace(samples, |u| {
        // A triangle wave that begins at 0 and rises.
        let phase = (periods as f64 * u + 0.25).fract();
        [2.0 * u - 1.0, 0.5 - (2.0 * phase - 1.0).abs()]
    })
}

/// A heart, closed, from its notch clockwise.
///
/// # Errors
/// Fewer than two samples, or more than [`MAX_POINTS`].
pub fn heart(samples: usize) -> Result<Curve, SketchError> {
    trace(samples, |u| {
        let a = TAU * u;
        let y = 13.0 * a.cos() - 5.0 * (2.0 * a).cos() - 2.0 * (3.0 * a).cos() - (4.0 * a).cos();
        [a.sin().powi(3), y / 16.0]
    })
}

/// A star of `tips` tips drawn along its outline, closed, from the upper tip.
///
/// # Errors
/// Fewer than two tips, fewer than two samples, or more than [`MAX_POINTS`].
pub fn star(tips: usize, samples: usize) -> Result<Curve, SketchError> {
    positive(tips.saturating_sub(1), "a star needs at least two tips")?;
    let corners = (2 * tips) as f64;
    let corner = |index: f64| {
        let radius = if (index as u64).is_multiple_of(2) { 1.0 } else { 0.4 };
        polar(radius, TAU * (0.25 + index / corners))
    };
    trace(samples, |u| {
        let (index, part) = ((u * corners).floor(), (u * corners).fract());
        let ([x0, y0], [x1, y1]) = (corner(index), corner(index + 1.0));
        [x0 + (x1 - x0) * part, y0 + (y1 - y0) * part]
    })
}

fn positive(count: usize, problem: &'static str) -> Result<(), SketchError> {
    if count > 0 { Ok(()) } else { Err(SketchError::Shape { problem }) }
}

fn polar(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.cos(), radius * angle.sin()]
}

/// Points of a parameter from 0 to 1, both included.
fn trace(samples: usize, at: impl Fn(f64) -> [f64; 2]) -> Result<Curve, SketchError> {
    if samples < 2 {
        return Err(SketchError::Shape { problem: "at least two samples are needed" });
    }
    if samples > MAX_POINTS {
        return Err(SketchError::TooManyPoints);
    }
    let last = (samples - 1) as f64;
    Curve::new((0..samples).map(|index| at(index as f64 / last).map(rounded)).collect())
}

/// Six decimals, without a negative zero.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_circle_is_wider_than_the_one_before() {
        let curve = growing_circles(5, 501).unwrap();
        assert_eq!(curve.point_count(), 501);
        let radii: Vec<f64> = curve.points().iter().map(|p| p[0].hypot(p[1])).collect();
        assert!(radii.windows(2).all(|pair| pair[1] > pair[0]), "grows all the way");
        let steps: Vec<f64> = (0..5).map(|turn| radii[(turn + 1) * 100] - radii[turn * 100]).collect();
        assert!(steps.iter().all(|step| (step - 1.0 / 6.0).abs() < 1e-5), "{steps:?}");
        // The positive x axis is passed once a turn.
        for turn in 0..=5 {
            assert!(curve.points()[turn * 100][1].abs() < 1e-6);
        }
    }

    #[test]
    fn loops_close_and_lines_do_not() {
        for curve in [figure_of_eight(1, 100), heart(100), star(5, 101), star(2, 9)] {
            let curve = curve.unwrap();
            assert!(curve.is_closed());
            assert_eq!(curve.points().first(), curve.points().last());
        }
        for curve in [growing_circles(5, 100), wave(3, 100), zigzag(3, 100)] {
            assert!(!curve.unwrap().is_closed());
        }
    }

    #[test]
    fn shapes_have_their_features() {
        let zigzag = zigzag(2, 17).unwrap();
        let heights: Vec<f64> = zigzag.points().iter().map(|p| p[1]).collect();
        let first = [0.0, 0.25, 0.5, 0.25, 0.0, -0.25, -0.5, -0.25];
        assert_eq!(heights[..8], first);
        assert_eq!(heights[8..16], first);
        let star = star(5, 11).unwrap();
        assert_eq!(star.points()[0], [0.0, 1.0]);
        let tips = star.points().iter().filter(|p| p[0].hypot(p[1]) > 0.99).count();
        assert_eq!(tips, 6, "five, the first drawn twice");
        let eight = figure_of_eight(1, 5).unwrap();
        assert_eq!(eight.points()[2], [0.0, 0.0], "the middle is crossed");
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(matches!(growing_circles(0, 10), Err(SketchError::Shape { .. })));
        assert!(matches!(star(1, 10), Err(SketchError::Shape { .. })));
        assert!(matches!(heart(1), Err(SketchError::Shape { .. })));
        assert_eq!(heart(MAX_POINTS + 1), Err(SketchError::TooManyPoints));
    }
}
