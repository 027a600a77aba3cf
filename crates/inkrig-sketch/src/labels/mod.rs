//! Motion by numbers: a row of named segments such as `A:30 B:45 A:30`.

mod one_hot;
mod read;
mod text;

pub use one_hot::OneHot;
pub use read::read_labels;

use std::collections::HashMap;

use crate::SketchError;
use crate::limits::MAX_FRAMES;

/// Most different labels of one row.
pub const MAX_LABELS: usize = 256;
/// Longest name of a label, in bytes.
const MAX_NAME: usize = 256;
/// Longest segment, in seconds.
const MAX_SECONDS: f64 = 1e6;

/// How long a segment is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LabelLength {
    /// In frames, 1 to [`MAX_FRAMES`].
    Frames(usize),
    /// In seconds, above 0 to a million.
    Seconds(f64),
}

/// A row of named segments, one after the other.
///
/// There are 2 to [`MAX_LABELS`] different names, each of 1 to 256 bytes, and at most [`MAX_FRAMES`] segments. The text
/// form reads back as the same row:
///
/// ```text
/// labels  = segment { space segment } ;
/// segment = name ":" length ;
/// name    = '"' { any character, with "" for one quote } '"'
///         | any characters but space and colon, the first of them no quote ;
/// length  = whole number of frames | number "s" ;      (* seconds *)
/// ```
///
/// ```
/// let labels: inkrig_sketch::Labels = "walk:2s \"wave left\":45 walk:1.5s".parse()?;
/// let control = labels.to_one_hot(30.0, None)?;
/// assert_eq!(control.names, ["walk", "wave left"]);
/// assert_eq!(control.frame_count(), 60 + 45 + 45);
/// assert_eq!(control.values[2 * 59..2 * 61], [1.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), inkrig_sketch::SketchError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// In order of first appearance.
    names: Vec<String>,
    /// Index into the names, and length.
    segments: Vec<(usize, LabelLength)>,
}

impl Labels {
    /// A row of segments.
    ///
    /// # Errors
    /// [`SketchError::Segment`] for a name or a length that cannot be; [`SketchError::NoLabels`],
    /// [`SketchError::OneLabel`], [`SketchError::TooManyLabels`], [`SketchError::TooManySegments`].
    pub fn new<N: Into<String>>(
        segments: impl IntoIterator<Item = (N, LabelLength)>,
    ) -> Result<Self, SketchError> {
        let mut builder = LabelsBuilder::default();
        for (segment, (name, length)) in segments.into_iter().enumerate() {
            builder.push(&name.into(), length).map_err(|refusal| match refusal {
                Refusal::Full(error) => error,
                Refusal::Name(problem) | Refusal::Length(problem) => {
                    SketchError::Segment { segment, problem }
                }
            })?;
        }
        builder.finish()
    }

    /// The different names, in order of first appearance.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Name and length of each segment, in order of time.
    pub fn segments(&self) -> impl Iterator<Item = (&str, LabelLength)> + '_ {
        self.segments
            .iter()
            .map(|&(label, length)| (self.names.get(label).map_or("", String::as_str), length))
    }

    /// How many frames the row is of itself at a rate, in frames a second; at least 1. May be more than [`MAX_FRAMES`].
    pub fn frame_count(&self, rate: f64) -> usize {
        self.length(rate).round().max(1.0) as usize
    }

    /// Length of all segments in frames, not rounded.
    fn length(&self, rate: f64) -> f64 {
        self.segments.iter().map(|(_, length)| length.in_frames(rate)).sum()
    }
}

impl LabelLength {
    fn in_frames(self, rate: f64) -> f64 {
        match self {
            Self::Frames(frames) => frames as f64,
            Self::Seconds(seconds) => seconds * rate,
        }
    }

    fn check(self) -> Result<(), String> {
        match self {
            Self::Frames(frames) if frames == 0 || frames > MAX_FRAMES => {
                Err(format!("a length of 1 to {MAX_FRAMES} frames"))
            }
            Self::Seconds(seconds) if !(seconds > 0.0 && seconds <= MAX_SECONDS) => {
                Err(format!("a length above 0 to {MAX_SECONDS} seconds"))
            }
            _ => Ok(()),
        }
    }
}

/// A row in the making. Every reader goes through it.
#[derive(Debug, Default)]
struct LabelsBuilder {
    names: Vec<String>,
    index: HashMap<String, usize>,
    segments: Vec<(usize, LabelLength)>,
}

/// Why a segment was refused: what is expected instead. The reader adds the place in its file.
#[derive(Debug)]
enum Refusal {
    Full(SketchError),
    Name(String),
    Length(String),
}

impl LabelsBuilder {
    fn push(&mut self, name: &str, length: LabelLength) -> Result<(), Refusal> {
        length.check().map_err(Refusal::Length)?;
        let label = self.label(name)?;
        if self.segments.len() >= MAX_FRAMES {
            return Err(Refusal::Full(SketchError::TooManySegments));
        }
        self.segments.push((label, length));
        Ok(())
    }

    /// One more frame, joined to those before it where the label is the same.
    fn push_frame(&mut self, name: &str) -> Result<(), Refusal> {
        let label = self.label(name)?;
        match self.segments.last_mut() {
            Some((last, LabelLength::Frames(frames))) if *last == label && *frames < MAX_FRAMES => {
                *frames += 1;
                Ok(())
            }
            _ => self.push(name, LabelLength::Frames(1)),
        }
    }

    fn label(&mut self, name: &str) -> Result<usize, Refusal> {
        if let Some(&label) = self.index.get(name) {
            return Ok(label);
        }
        if name.is_empty() || name.len() > MAX_NAME {
            return Err(Refusal::Name(format!("a name of 1 to {MAX_NAME} bytes")));
        }
        let label = self.names.len();
        if label >= MAX_LABELS {
            return Err(Refusal::Full(SketchError::TooManyLabels));
        }
        self.names.push(name.to_owned());
        self.index.insert(name.to_owned(), label);
        Ok(label)
    }

    fn finish(self) -> Result<Labels, SketchError> {
        match self.names.as_slice() {
            [] => Err(SketchError::NoLabels),
            [name] => Err(SketchError::OneLabel { name: name.clone() }),
            _ => Ok(Labels { names: self.names, segments: self.segments }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_the_order_of_first_appearance() {
        let labels = Labels::new([("b", LabelLength::Frames(3)), ("a", LabelLength::Seconds(1.5))]).unwrap();
        assert_eq!(labels.names(), ["b", "a"]);
        assert_eq!(labels.frame_count(30.0), 48);
        let segments: Vec<_> = labels.segments().collect();
        assert_eq!(segments, [("b", LabelLength::Frames(3)), ("a", LabelLength::Seconds(1.5))]);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let one = |name: &str, length| Labels::new([("a", LabelLength::Frames(1)), (name, length)]);
        for (name, length) in [
            ("", LabelLength::Frames(1)),
            (&*"x".repeat(257), LabelLength::Frames(1)),
            ("b", LabelLength::Frames(0)),
            ("b", LabelLength::Frames(MAX_FRAMES + 1)),
            ("b", LabelLength::Seconds(0.0)),
            ("b", LabelLength::Seconds(f64::NAN)),
            ("b", LabelLength::Seconds(1e7)),
        ] {
            assert!(
                matches!(one(name, length), Err(SketchError::Segment { segment: 1, .. })),
                "{name} {length:?}"
            );
        }
        assert_eq!(one("a", LabelLength::Frames(1)), Err(SketchError::OneLabel { name: "a".into() }));
        assert_eq!(Labels::new([] as [(&str, LabelLength); 0]), Err(SketchError::NoLabels));
        let many = |count: usize| Labels::new((0..count).map(|i| (i.to_string(), LabelLength::Frames(1))));
        assert_eq!(many(MAX_LABELS).unwrap().names().len(), MAX_LABELS);
        assert_eq!(many(MAX_LABELS + 1), Err(SketchError::TooManyLabels));
        let long = (0..=MAX_FRAMES).map(|i| (["a", "b"][i % 2], LabelLength::Frames(1)));
        assert_eq!(Labels::new(long), Err(SketchError::TooManySegments));
    }
}
