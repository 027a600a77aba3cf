//! Lengths and ranges as people type them: `300` is frames, `10s` is seconds.

use crate::printable;
use inkrig_motion::Clip;
use std::{fmt, ops::Range, str::FromStr};

/// How long a clip is, as people are told: every frame lasts its time, the last one too, so that 300 frames of 30 a
/// second are 10 s. ([`Clip::duration`] is the time from the first frame to the last, a frame less.)
pub fn seconds(clip: &Clip) -> f64 {
    clip.frames() as f64 / clip.frame_rate()
}

/// A length of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// A number of frames.
    Frames(usize),
    /// Seconds.
    Seconds(f64),
}

impl Length {
    /// The length in frames at a rate, rounded.
    pub fn frames(self, rate: f64) -> usize {
        match self {
            Self::Frames(frames) => frames,
            // A saturating conversion: no float is too large for it.
            Self::Seconds(seconds) => (seconds * rate).round() as usize,
        }
    }
}

impl fmt::Display for Length {
    /// As it is typed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frames(frames) => write!(f, "{frames}"),
            Self::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

impl FromStr for Length {
    type Err = SpanError;

    fn from_str(text: &str) -> Result<Self, SpanError> {
        let text = text.trim();
        let bad = || SpanError(text.to_string());
        if let Some(seconds) = text.strip_suffix('s') {
            let seconds: f64 = seconds.trim().parse().map_err(|_| bad())?;
            return if (0.0..=1e12).contains(&seconds) { Ok(Self::Seconds(seconds)) } else { Err(bad()) };
        }
        text.parse().map(Self::Frames).map_err(|_| bad())
    }
}

/// A part of a clip, from and to (exclusive); an end left out is the clip's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Where it begins.
    pub start: Option<Length>,
    /// Where it ends.
    pub end: Option<Length>,
}

impl Span {
    /// The range in frames of a clip with that many frames at that rate, its end cut to the clip's.
    pub fn frames(self, rate: f64, frames: usize) -> Range<usize> {
        let start = self.start.map_or(0, |length| length.frames(rate));
        let end = self.end.map_or(frames, |length| length.frames(rate));
        start..end.min(frames)
    }
}

impl fmt::Display for Span {
    /// As it is typed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |length: Option<Length>| length.map(|length| length.to_string()).unwrap_or_default();
        write!(f, "{}..{}", part(self.start), part(self.end))
    }
}

impl FromStr for Span {
    type Err = SpanError;

    fn from_str(text: &str) -> Result<Self, SpanError> {
        let bad = || SpanError(text.to_string());
        let (start, end) = text.split_once("..").ok_or_else(bad)?;
        let part = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text.parse().map(Some).map_err(|_| bad()),
        };
        Ok(Self { start: part(start)?, end: part(end)? })
    }
}

/// A length or range that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpanError(String);

impl fmt::Display for SpanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "`{}` is neither frames (300) nor seconds (10s); a range is two of them with .. between (2s..10s, ..300)",
            printable::text(&self.0)
        )
    }
}

impl std::error::Error for SpanError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_seconds() {
        assert_eq!("300".parse(), Ok(Length::Frames(300)));
        assert_eq!(" 2.5s".parse(), Ok(Length::Seconds(2.5)));
        assert_eq!(Length::Seconds(2.5).frames(60.0), 150);
        for bad in ["", "s", "-1", "-1s", "nans", "infs", "1e99s", "10m", "1.5"] {
            assert!(bad.parse::<Length>().is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges() {
        let frames = |text: &str| text.parse::<Span>().unwrap().frames(30.0, 900);
        assert_eq!(frames("0s..20s"), 0..600);
        assert_eq!(frames("100.."), 100..900);
        assert_eq!(frames("..5000s"), 0..900);
        assert_eq!(frames(".."), 0..900);
        for text in ["0s..20s", "100..", "..2.5s", ".."] {
            assert_eq!(text.parse::<Span>().unwrap().to_string(), text);
        }
        assert!("5".parse::<Span>().is_err() && "a..b".parse::<Span>().is_err());
    }
}
