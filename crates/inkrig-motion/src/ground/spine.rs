//! The line along which a clip travels, and how far along it the character is at every frame.

use super::line::Line;
use super::low_pass::low_pass;
use super::{Trajectory, wrapped};
use crate::MotionError;

/// Shifts of weight smaller than this are no travel, in sizes of the character.
const STEP: f64 = 0.1;
/// Points of the line on either side that smooth it.
const HALF: usize = 2;
/// A clip that goes less far does not travel, in sizes of the character.
const LEAST: f64 = 0.3;

/// The way of a clip as a line and the progress along it. The line's arc lengths are those of the way itself.
#[derive(Debug, Clone)]
pub(super) struct Spine {
    pub(super) line: Line,
    /// Points of the line, metres, and the way to each.
    pub(super) points: Vec<glam::DVec2>,
    pub(super) arc: Vec<f64>,
    /// Way along the line at every frame, metres; it may go back.
    pub(super) progress: Vec<f64>,
}

impl Spine {
    /// The way of a character of a size, metres.
    ///
    /// # Errors
    /// [`MotionError::Still`] when the clip does not travel.
    pub(super) fn of(trajectory: &Trajectory, size: f64) -> Result<Self, MotionError> {
        let path = &trajectory.path;
        let mut knots: Vec<usize> = vec![0];
        for (frame, place) in path.iter().enumerate() {
            if place.distance(path[knots[knots.len() - 1]]) >= STEP * size {
                knots.push(frame);
            }
        }
        let mut arc = vec![0.0];
        for pair in knots.windows(2) {
            arc.push(arc[arc.len() - 1] + path[pair[0]].distance(path[pair[1]]));
        }
        let travelled = arc[arc.len() - 1];
        if knots.len() < 3 || travelled < LEAST * size {
            let least = LEAST * size;
            return Err(MotionError::Still {
                travelled: trajectory.length().min(travelled.max(STEP * size)),
                least,
            });
        }
        let progress = progress(trajectory, &knots, &arc);
        let points: Vec<_> = knots.iter().map(|&knot| path[knot]).collect();
        let points = low_pass(&points, HALF);
        // Where the way turns back, the body says to which side it turned.
        let mut hints = vec![0.0];
        hints.extend(
            knots.windows(2).map(|pair| wrapped(trajectory.headings[pair[1]] - trajectory.headings[pair[0]])),
        );
        let line = Line::new(arc.clone(), points.clone(), false, Some(&hints));
        Ok(Self { line, points, arc, progress })
    }

    /// Way from the first frame to the last, metres.
    pub(super) fn travelled(&self) -> f64 {
        self.progress.last().copied().unwrap_or(0.0).max(self.line.length())
    }
}

/// Between two knots, progress is the part of the chord that the place lies over, so that swaying to and fro on the
/// spot does not add up.
fn progress(trajectory: &Trajectory, knots: &[usize], arc: &[f64]) -> Vec<f64> {
    let path = &trajectory.path;
    (0..path.len())
        .map(|frame| {
            let next = knots.partition_point(|&knot| knot <= frame);
            let after_last = next == knots.len();
            let next = next.min(knots.len() - 1);
            let (from, to) = (path[knots[next - 1]], path[knots[next]]);
            let along = to - from;
            let part = (path[frame] - from).dot(along) / along.length_squared();
            let part = if after_last { part } else { part.clamp(0.0, 1.0) };
            arc[next - 1] + part * (arc[next] - arc[next - 1])
        })
        .collect()
}
