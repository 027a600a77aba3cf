//! What the motion shall follow.

use crate::{AlignError, MOST_FRAMES};
use inkrig_motion::{Clip, FeatureOptions, Features, frame_features, time};
use inkrig_sketch::{Curve, Ends, Timing, frame_count, resample, smooth};

/// A control as the solver sees it: a table of numbers over time, never a file. Only distances between its rows
/// count, so its scale and place do not matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// One row a sample.
    pub features: Features,
    /// Samples a second. Matching resamples the control when this is not the matching rate.
    pub rate: f64,
    /// Whether the last sample is followed by the first: the result is then a seamless loop.
    pub cyclic: bool,
    /// What it is of, which decides the presets: see [`Options::for_control`](crate::Options::for_control).
    pub kind: ControlKind,
}

/// Kinds of control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ControlKind {
    /// A drawn curve, of any number of dimensions.
    #[default]
    Curve,
    /// Another motion.
    Motion,
}

/// How a drawn curve becomes a control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveOptions {
    /// Number of samples; `None`: the curve's own, or ten seconds for an outline that has no time of its own.
    pub samples: Option<usize>,
    /// Samples a second.
    pub rate: f64,
    /// Standard deviation of the Gaussian that takes out the hand's tremble, in samples (Sec. 4.1). 0 for none.
    pub smooth: f64,
    /// How the samples are spread along the curve; `None` chooses by what the curve has.
    pub timing: Option<Timing>,
}

impl Default for CurveOptions {
    fn default() -> Self {
        Self { samples: None, rate: 30.0, smooth: 2.0, timing: None }
    }
}

impl Control {
    /// Its length at another rate, in samples, at least 1.
    pub fn frames(&self, rate: f64) -> usize {
        (self.features.frames() as f64 * rate / self.rate).round().max(1.0) as usize
    }

    pub(crate) fn validate(&self) -> Result<(), AlignError> {
        if self.rate.is_finite() && self.rate > 0.0 {
            Ok(())
        } else {
            Err(AlignError::Option { name: "the control's rate", value: self.rate, range: "above 0" })
        }
    }

    /// The control of another motion, of any skeleton: its frame features (MAMM Sec. 4.5). A rest-pose lead-in is
    /// left out.
    ///
    /// # Errors
    /// When the motion cannot be resampled.
    pub fn from_motion(motion: &Clip, rate: f64, features: &FeatureOptions) -> Result<Self, AlignError> {
        let lead_in = inkrig_motion::lead_in::rest_pose_frames(motion);
        let motion = time::trim(motion, lead_in..motion.frames())?;
        let frames = time::resampled_frames(&motion, rate);
        if frames > MOST_FRAMES {
            let what = "the motion to be like";
            return Err(AlignError::TooLong { what, frames, most: MOST_FRAMES, cut: "another file" });
        }
        let motion = time::decimate(&motion, rate)?;
        let rate = motion.frame_rate();
        let features = frame_features(&motion.into(), features);
        Ok(Self { features, rate, cyclic: false, kind: ControlKind::Motion })
    }

    /// The control of a drawn 2D curve: points at constant time intervals, smoothed (MAMM Sec. 4.1).
    ///
    /// # Errors
    /// When the curve does not move, or the number of samples is not usable.
    pub fn from_curve(curve: &Curve, options: &CurveOptions) -> Result<Self, AlignError> {
        /// Length of a drawing without time, seconds.
        const TIMELESS: f64 = 10.0;
        let own = || frame_count(curve, options.rate).unwrap_or((TIMELESS * options.rate).round() as usize);
        let samples = options.samples.unwrap_or_else(own);
        if samples > MOST_FRAMES {
            let cut = "--length";
            return Err(AlignError::TooLong { what: "the control", frames: samples, most: MOST_FRAMES, cut });
        }
        let timing = options.timing.unwrap_or_else(|| Timing::automatic(curve, samples));
        let points = smooth(&resample(curve, samples, timing)?, options.smooth, Ends::Open)?;
        // Centred in f64: a small drawing far from the origin would lose its digits in f32.
        let count = points.len().max(1) as f64;
        let mean = points
            .iter()
            .fold([0.0, 0.0], |sum, point| [sum[0] + point[0] / count, sum[1] + point[1] / count]);
        let size =
            points.iter().flat_map(|p| [(p[0] - mean[0]).abs(), (p[1] - mean[1]).abs()]).fold(0.0, f64::max);
        let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
        let values = points
            .iter()
            .flat_map(|p| [((p[0] - mean[0]) * scale) as f32, ((p[1] - mean[1]) * scale) as f32]);
        Ok(Self {
            features: Features::new(values.collect(), 2)?,
            rate: options.rate,
            cyclic: false,
            kind: ControlKind::Curve,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_and_scale_do_not_matter() {
        let circle = |x: f64, size: f64| {
            let at = |i: usize| (i as f64 * 0.1).sin_cos();
            let points = (0..90).map(|i| [x + size * at(i).0, -x + size * at(i).1]).collect();
            Control::from_curve(&Curve::new(points).unwrap(), &CurveOptions::default()).unwrap()
        };
        let (near, far) = (circle(0.0, 1.0), circle(1e6, 1e-3));
        assert_eq!(near.features.frames(), 90);
        for (a, b) in near.features.as_slice().iter().zip(far.features.as_slice()) {
            assert!((a - b).abs() < 1e-5);
        }
    }
}
