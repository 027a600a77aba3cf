//! A drawn curve: points in strokes, with pen time and pressure where they were recorded.

use crate::SketchError;
use crate::builder::{CurveBuilder, Sample, check_pressure, check_time, from_zero};

/// What the points of a curve are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Origin {
    /// Each point is a sample: of the pen, or one frame of a control. Rows of JSON and CSV.
    Sampled,
    /// The points are corners of an outline; how densely they lie means nothing. Paths of SVG.
    Outline,
}

/// One drawing: one or several strokes of points in the plane, in the order in which they were drawn.
///
/// Points are in canvas units, y up; scale and position do not matter to the engine. Every value is finite and at
/// most [`crate::limits::MAX_MAGNITUDE`]; there are 1 to [`crate::limits::MAX_POINTS`] points. Pen times are in
/// seconds, never go back, run on one clock over all strokes, and start at 0.
///
/// Several strokes make **one** control: the end of a stroke is joined to the start of the next by a straight line,
/// which counts in the arc length, so that the control never jumps. Where there is pen time, the time between the
/// strokes is kept, so the line is travelled in the time the pen was up.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    pub(crate) points: Vec<[f64; 2]>,
    /// First point of each stroke, ascending; the first entry is 0.
    pub(crate) starts: Vec<usize>,
    pub(crate) seconds: Option<Vec<f64>>,
    pub(crate) pressure: Option<Vec<f64>>,
    pub(crate) origin: Origin,
}

impl Curve {
    /// A curve of one stroke, without pen time.
    ///
    /// # Errors
    /// No point, too many, or a coordinate that is not finite or too large.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, SketchError> {
        Self::from_strokes([points])
    }

    /// A curve of several strokes, without pen time. Strokes without a point are left out.
    ///
    /// # Errors
    /// As [`Curve::new`].
    pub fn from_strokes(strokes: impl IntoIterator<Item = Vec<[f64; 2]>>) -> Result<Self, SketchError> {
        let mut builder = CurveBuilder::default();
        for stroke in strokes {
            builder.begin_stroke();
            for point in stroke {
                builder.push(Sample { point, seconds: None, pressure: None })?;
            }
        }
        builder.finish(Origin::Sampled)
    }

    /// The same curve with pen times, one for each point, in seconds; they are moved so that the first is 0.
    ///
    /// # Errors
    /// Another number of times than of points; a time that is not finite or goes back.
    pub fn with_seconds(self, seconds: Vec<f64>) -> Result<Self, SketchError> {
        let (points, values) = (self.points.len(), seconds.len());
        if points != values {
            return Err(SketchError::CountMismatch { points, values, what: "pen times" });
        }
        let mut previous = None;
        for (point, &time) in seconds.iter().enumerate() {
            check_time(time, previous).map_err(|problem| SketchError::Point { point, problem })?;
            previous = Some(time);
        }
        Ok(Self { seconds: Some(from_zero(seconds)), ..self })
    }

    /// The same curve with pen pressures, one for each point: 0 is a pen that barely touches; 1 is full in a browser.
    ///
    /// # Errors
    /// Another number of pressures than of points; a pressure that is negative or not finite.
    pub fn with_pressure(self, pressure: Vec<f64>) -> Result<Self, SketchError> {
        let (points, values) = (self.points.len(), pressure.len());
        if points != values {
            return Err(SketchError::CountMismatch { points, values, what: "pressures" });
        }
        for (point, &value) in pressure.iter().enumerate() {
            check_pressure(value).map_err(|problem| SketchError::Point { point, problem })?;
        }
        Ok(Self { pressure: Some(pressure), ..self })
    }

    /// All points, stroke after stroke: x and y in canvas units, y up.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Number of points over all strokes; at least 1.
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// Pen time of each point, in seconds from the first, or `None` where none was recorded.
    pub fn seconds(&self) -> Option<&[f64]> {
        self.seconds.as_deref()
    }

    /// Pen pressure of each point, or `None` where none was recorded.
    pub fn pressure(&self) -> Option<&[f64]> {
        self.pressure.as_deref()
    }

    /// Whether the points are samples or corners of an outline.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// Number of strokes; at least 1.
    pub fn stroke_count(&self) -> usize {
        self.starts.len()
    }

    /// The points of each stroke as a range into [`Curve::points`], in drawing order.
    pub fn stroke_ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let ends = self.starts.iter().skip(1).copied().chain([self.points.len()]);
        self.starts.iter().copied().zip(ends).map(|(start, end)| start..end)
    }

    /// The points of each stroke, in drawing order.
    pub fn strokes(&self) -> impl Iterator<Item = &[[f64; 2]]> + '_ {
        self.stroke_ranges().filter_map(|range| self.points.get(range))
    }

    /// Time from the first point to the last, in seconds, where pen times were recorded.
    pub fn duration(&self) -> Option<f64> {
        self.seconds.as_ref().and_then(|seconds| seconds.last().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_keep_their_order_and_empty_ones_vanish() {
        let curve =
            Curve::from_strokes([vec![], vec![[0.0, 0.0], [1.0, 0.0]], vec![], vec![[2.0, 2.0]]]).unwrap();
        let strokes: Vec<_> = curve.strokes().map(<[_]>::len).collect();
        assert_eq!(strokes, [2, 1]);
        assert_eq!(curve.points(), [[0.0, 0.0], [1.0, 0.0], [2.0, 2.0]]);
        assert_eq!(curve.stroke_count(), 2);
    }

    #[test]
    fn times_start_at_zero_and_keep_the_gap() {
        let curve = Curve::from_strokes([vec![[0.0, 0.0]], vec![[1.0, 0.0]]]).unwrap();
        let curve = curve.with_seconds(vec![100.0, 103.0]).unwrap();
        assert_eq!(curve.seconds(), Some([0.0, 3.0].as_slice()));
        assert_eq!(curve.duration(), Some(3.0));
    }

    #[test]
    fn what_is_wrong_is_said() {
        assert_eq!(Curve::new(vec![]), Err(SketchError::NoPoints));
        let bad = Curve::new(vec![[0.0, 0.0], [f64::NAN, 0.0]]).unwrap_err();
        assert!(matches!(bad, SketchError::Point { point: 1, .. }), "{bad}");
        let two = || Curve::new(vec![[0.0, 0.0], [1.0, 0.0]]).unwrap();
        let back = two().with_seconds(vec![1.0, 0.5]).unwrap_err();
        assert!(back.to_string().starts_with("point 1: time goes back from 1 s to 0.5 s"), "{back}");
        assert!(matches!(two().with_seconds(vec![1.0]), Err(SketchError::CountMismatch { values: 1, .. })));
        assert!(matches!(two().with_pressure(vec![0.5, -0.1]), Err(SketchError::Point { point: 1, .. })));
    }
}
