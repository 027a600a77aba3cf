//! Collects the points of a curve and holds them to its rules; every reader goes through it.

use crate::limits::{MAX_MAGNITUDE, MAX_POINTS};
use crate::{Curve, Origin, SketchError};

/// One point as a reader meets it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) point: [f64; 2],
    pub(crate) seconds: Option<f64>,
    pub(crate) pressure: Option<f64>,
}

/// A curve in the making.
#[derive(Debug, Default)]
pub(crate) struct CurveBuilder {
    points: Vec<[f64; 2]>,
    starts: Vec<usize>,
    seconds: Vec<f64>,
    pressure: Vec<f64>,
}

/// Why a point was refused; the reader adds the place in its file.
#[derive(Debug)]
pub(crate) enum Refusal {
    Full,
    Wrong(usize, String),
}

impl From<Refusal> for SketchError {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Full => Self::TooManyPoints,
            Refusal::Wrong(point, problem) => Self::Point { point, problem },
        }
    }
}

impl CurveBuilder {
    pub(crate) fn point_count(&self) -> usize {
        self.points.len()
    }

    /// The next point begins a new stroke.
    pub(crate) fn begin_stroke(&mut self) {
        if self.starts.last() != Some(&self.points.len()) {
            self.starts.push(self.points.len());
        }
    }

    pub(crate) fn push(&mut self, sample: Sample) -> Result<(), Refusal> {
        let index = self.points.len();
        if index >= MAX_POINTS {
            return Err(Refusal::Full);
        }
        self.check(index, &sample).map_err(|problem| Refusal::Wrong(index, problem))?;
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.points.push(sample.point);
        self.seconds.extend(sample.seconds);
        self.pressure.extend(sample.pressure);
        Ok(())
    }

    pub(crate) fn finish(mut self, origin: Origin) -> Result<Curve, SketchError> {
        if self.points.is_empty() {
            return Err(SketchError::NoPoints);
        }
        if self.starts.last() == Some(&self.points.len()) {
            self.starts.pop();
        }
        Ok(Curve {
            points: self.points,
            starts: self.starts,
            seconds: (!self.seconds.is_empty()).then(|| from_zero(self.seconds)),
            pressure: (!self.pressure.is_empty()).then_some(self.pressure),
            origin,
        })
    }

    fn check(&self, index: usize, sample: &Sample) -> Result<(), String> {
        let [x, y] = sample.point;
        check_magnitude("x", x)?;
        check_magnitude("y", y)?;
        one_for_all("time t", index, self.seconds.len(), sample.seconds)?;
        one_for_all("pressure", index, self.pressure.len(), sample.pressure)?;
        if let Some(time) = sample.seconds {
            check_time(time, self.seconds.last().copied())?;
        }
        sample.pressure.map_or(Ok(()), check_pressure)
    }
}

fn one_for_all(what: &str, index: usize, before: usize, value: Option<f64>) -> Result<(), String> {
    match value {
        Some(_) if before != index => {
            Err(format!("has a {what}, but earlier points have none; give it to all or none"))
        }
        None if before != 0 => {
            Err(format!("has no {what}, but earlier points have one; give it to all or none"))
        }
        _ => Ok(()),
    }
}

fn check_magnitude(what: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value.abs() <= MAX_MAGNITUDE {
        Ok(())
    } else {
        Err(format!("{what} is {value:e}; a finite number of at most {MAX_MAGNITUDE:e} is expected"))
    }
}

pub(crate) fn check_time(time: f64, previous: Option<f64>) -> Result<(), String> {
    check_magnitude("time t", time)?;
    match previous {
        Some(previous) if time < previous => Err(format!(
            "time goes back from {previous} s to {time} s; pen times are seconds on one clock over all strokes"
        )),
        _ => Ok(()),
    }
}

pub(crate) fn check_pressure(value: f64) -> Result<(), String> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(format!("pressure is {value}; a number from 0 up is expected"))
    }
}

pub(crate) fn from_zero(mut seconds: Vec<f64>) -> Vec<f64> {
    let first = seconds.first().copied().unwrap_or(0.0);
    for time in &mut seconds {
        *time -= first;
    }
    seconds
}
