//! Which part of the clip each moment of a result is made of, as data.

use crate::{Alignment, Options};
use serde::Serialize;

/// For every control sample the source frame that it uses most, and how surely. Columns of equal length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// Control samples a second: sample `i` is at `i / rate` seconds of the result.
    pub rate: f64,
    /// Frame of the source as it was given, at its own rate, takes counted through: what a [`Key`](crate::Key) takes.
    pub frame: Vec<usize>,
    /// Its take, counted from 0; left out of JSON when there is one only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clip: Vec<usize>,
    /// Share of the sample's weight within a quarter second of that frame, 0..=1, to two decimals.
    pub confidence: Vec<f64>,
}

impl Explanation {
    /// What an alignment with these options is made of.
    pub fn of(alignment: &Alignment, options: &Options) -> Self {
        let takes = alignment.used.iter().map(|moment| moment.take);
        let hundredths = |share: &f32| (f64::from(*share) * 100.0).round() / 100.0;
        Self {
            rate: options.matching_rate,
            frame: alignment.used.iter().map(|moment| moment.frame).collect(),
            clip: if alignment.source.count() > 1 { takes.collect() } else { Vec::new() },
            confidence: alignment.confidence.iter().map(hundredths).collect(),
        }
    }
}
