//! From a drawing to frames.

use crate::limits::MAX_FRAMES;
use crate::measure::cumulative_length;
use crate::{Curve, Origin, SketchError};

/// How the way along a curve becomes time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Timing {
    /// Frames lie at equal steps of pen time: the speed of drawing becomes the speed of the motion.
    Pen,
    /// Frames lie at equal steps of arc length: constant speed.
    ArcLength,
    /// Points lie at equal steps of time. n rows asked for as n frames stay exactly as they are.
    AsSampled,
}

impl Timing {
    /// The choice for a curve that is to become `frames` frames, where the user made none:
    ///
    /// 1. [`Timing::Pen`], where there is pen time that advances;
    /// 2. [`Timing::AsSampled`], where points were sampled densely, at least one for two frames (n rows without t are
    ///    n frames, and other lengths stretch them);
    /// 3. [`Timing::ArcLength`] otherwise: for every outline, and for a few corners given by hand.
    pub fn automatic(curve: &Curve, frames: usize) -> Self {
        if curve.duration().is_some_and(|duration| duration > 0.0) {
            Self::Pen
        } else if curve.origin() == Origin::Sampled && 2 * curve.point_count() >= frames {
            Self::AsSampled
        } else {
            Self::ArcLength
        }
    }
}

/// How many frames a curve is of itself at a rate, in frames a second.
///
/// Pen time of d seconds makes `round(d * rate) + 1` frames; n sampled points without time are n frames; an outline has
/// no length in time: `None`. Never more than [`MAX_FRAMES`].
pub fn frame_count(curve: &Curve, rate: f64) -> Option<usize> {
    match (curve.duration(), curve.origin()) {
        (Some(duration), _) if duration > 0.0 => {
            let steps = (duration * rate).round().clamp(0.0, (MAX_FRAMES - 1) as f64);
            Some(steps as usize + 1)
        }
        (_, Origin::Sampled) => Some(curve.point_count()),
        (_, Origin::Outline) => None,
    }
}

/// Brings a curve to `frames` points at equal steps of the chosen [`Timing`], with straight lines between its points.
///
/// The first frame is the first point and, for two frames or more, the last frame is the last point.
///
/// # Errors
/// - [`SketchError::FrameCount`]: no frame, or more than [`MAX_FRAMES`].
/// - [`SketchError::DoesNotMove`]: fewer than two distinct points.
/// - [`SketchError::NoPenTime`]: [`Timing::Pen`] without pen time that advances.
pub fn resample(curve: &Curve, frames: usize, timing: Timing) -> Result<Vec<[f64; 2]>, SketchError> {
    if frames == 0 || frames > MAX_FRAMES {
        return Err(SketchError::FrameCount { frames });
    }
    let points = curve.points();
    if !curve.moves() {
        return Err(SketchError::DoesNotMove { points: points.len() });
    }
    let places = match timing {
        Timing::Pen => match curve.seconds() {
            Some(seconds) if seconds.last().is_some_and(|&duration| duration > 0.0) => seconds.to_vec(),
            _ => return Err(SketchError::NoPenTime),
        },
        Timing::ArcLength => cumulative_length(points),
        Timing::AsSampled if points.len() == frames => return Ok(points.to_vec()),
        Timing::AsSampled => (0..points.len()).map(|index| index as f64).collect(),
    };
    Ok(at_equal_steps(points, &places, frames))
}

/// The points at `frames` equal steps of their ascending places, which begin at 0.
fn at_equal_steps(points: &[[f64; 2]], places: &[f64], frames: usize) -> Vec<[f64; 2]> {
    let total = places.last().copied().unwrap_or(0.0);
    let mut pieces = points.windows(2).zip(places.windows(2));
    let mut piece = pieces.next();
    let mut samples: Vec<[f64; 2]> = (0..frames)
        .map(|frame| {
            let place = if frames > 1 { total * (frame as f64 / (frames - 1) as f64) } else { 0.0 };
            loop {
                match piece {
                    Some(([from, to], [start, end])) if place <= *end => {
                        let part =
                            if end > start { ((place - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
                        return [from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part];
                    }
                    Some(_) => piece = pieces.next(),
                    // Rounding put the place beyond the end.
                    None => return points.last().copied().unwrap_or_default(),
                }
            }
        })
        .collect();
    // The ends are the curve's own, whatever the rounding.
    if let (Some(first), Some(start)) = (samples.first_mut(), points.first()) {
        *first = *start;
    }
    if let ([_, .., last], Some(end)) = (samples.as_mut_slice(), points.last()) {
        *last = *end;
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Curve {
        Curve::new(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 3.0]]).unwrap()
    }

    #[test]
    fn arc_length_is_constant_speed() {
        let frames = resample(&corner(), 5, Timing::ArcLength).unwrap();
        assert_eq!(frames, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]);
    }

    #[test]
    fn pen_time_keeps_the_speed_of_drawing() {
        let curve = corner().with_seconds(vec![5.0, 8.0, 9.0]).unwrap();
        assert_eq!(Timing::automatic(&curve, 3), Timing::Pen);
        let frames = resample(&curve, 5, Timing::Pen).unwrap();
        let third = 1.0 / 3.0;
        let expected = [[0.0, 0.0], [third, 0.0], [2.0 * third, 0.0], [1.0, 0.0], [1.0, 3.0]];
        for (got, want) in frames.iter().zip(expected) {
            assert!((got[0] - want[0]).abs() < 1e-12 && (got[1] - want[1]).abs() < 1e-12, "{got:?} {want:?}");
        }
    }

    #[test]
    fn a_pause_of_the_pen_is_a_pause_of_the_control() {
        let curve = Curve::new(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).unwrap();
        let frames =
            resample(&curve.with_seconds(vec![0.0, 1.0, 3.0, 4.0]).unwrap(), 5, Timing::Pen).unwrap();
        assert_eq!(frames.map_x(), [0.0, 1.0, 1.0, 1.0, 2.0]);
    }

    #[test]
    fn n_rows_without_time_are_n_frames() {
        let rows = vec![[0.0, 0.0], [0.5, 0.0], [5.0, 1.0], [5.0, 1.0]];
        let curve = Curve::new(rows.clone()).unwrap();
        assert_eq!(frame_count(&curve, 30.0), Some(4));
        assert_eq!(Timing::automatic(&curve, 4), Timing::AsSampled);
        assert_eq!(resample(&curve, 4, Timing::AsSampled).unwrap(), rows);
        assert_eq!(Timing::automatic(&curve, 8), Timing::AsSampled);
        assert_eq!(Timing::automatic(&curve, 9), Timing::ArcLength);
        let seven = resample(&curve, 7, Timing::AsSampled).unwrap();
        assert_eq!(seven.map_x(), [0.0, 0.25, 0.5, 2.75, 5.0, 5.0, 5.0]);
    }

    #[test]
    fn time_sets_the_number_of_frames() {
        let curve = corner().with_seconds(vec![0.0, 0.5, 2.0]).unwrap();
        assert_eq!(frame_count(&curve, 30.0), Some(61));
        assert_eq!(frame_count(&curve, f64::INFINITY), Some(MAX_FRAMES));
    }

    #[test]
    fn nothing_to_follow_is_said() {
        let dot = Curve::new(vec![[1.0, 1.0]; 4]).unwrap();
        for timing in [Timing::Pen, Timing::ArcLength, Timing::AsSampled] {
            assert_eq!(resample(&dot, 4, timing), Err(SketchError::DoesNotMove { points: 4 }));
        }
        assert_eq!(resample(&corner(), 0, Timing::ArcLength), Err(SketchError::FrameCount { frames: 0 }));
        assert_eq!(resample(&corner(), 9, Timing::Pen), Err(SketchError::NoPenTime));
        let still_clock = corner().with_seconds(vec![2.0; 3]).unwrap();
        assert_eq!(Timing::automatic(&still_clock, 9), Timing::ArcLength);
        assert_eq!(resample(&still_clock, 9, Timing::Pen), Err(SketchError::NoPenTime));
    }

    #[test]
    fn two_points_and_one_frame_work() {
        let line = Curve::new(vec![[0.0, 0.0], [2.0, 4.0]]).unwrap();
        assert_eq!(resample(&line, 1, Timing::ArcLength).unwrap(), [[0.0, 0.0]]);
        assert_eq!(resample(&line, 3, Timing::ArcLength).unwrap()[1], [1.0, 2.0]);
    }

    trait MapX {
        fn map_x(&self) -> Vec<f64>;
    }
    impl MapX for Vec<[f64; 2]> {
        fn map_x(&self) -> Vec<f64> {
            self.iter().map(|point| point[0]).collect()
        }
    }
}
