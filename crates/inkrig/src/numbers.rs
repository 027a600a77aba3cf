//! Numbers on the command line, refused before any work when they make no sense, each with its range.

use crate::span::Length;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Frames a second of a result. More than 1000 show nothing that the clip has not, and only make files huge; fewer
/// than one in ten seconds are no motion any more.
pub(crate) fn fps(text: &str) -> Result<f64, String> {
    within(text, 0.1..=1000.0, "frames a second (more only makes the file larger)")
}

/// Frames a second of a file: whatever a clip may have.
pub(crate) fn source_fps(text: &str) -> Result<f64, String> {
    within(text, inkrig_motion::Clip::FRAME_RATES, "frames a second")
}

/// Width of smoothing, frames.
pub(crate) fn smooth(text: &str) -> Result<f64, String> {
    within(text, 0.0..=inkrig_sketch::limits::MAX_SIGMA, "frames; 0 is none")
}

/// Seconds that tell travel from sway.
pub(crate) fn sway(text: &str) -> Result<f64, String> {
    within(text, 0.0..=60.0, "seconds; 0 takes every movement as travel")
}

/// How many poses are suggested.
pub(crate) fn poses(text: &str) -> Result<usize, String> {
    within(text, 1..=64, "poses")
}

/// How many solutions are looked for.
pub(crate) fn solutions(text: &str) -> Result<usize, String> {
    within(text, 1..=4, "solutions")
}

/// How often a control is followed.
pub(crate) fn times(text: &str) -> Result<usize, String> {
    within(text, 1..=1000, "times")
}

/// Minutes to train.
pub(crate) fn minutes(text: &str) -> Result<f64, String> {
    within(text, 0.01..=1e6, "minutes")
}

/// Threads to work with.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    within(text, 1..=1024, "threads")
}

/// Clips that are measured on.
pub(crate) fn windows(text: &str) -> Result<usize, String> {
    within(text, 1..=1_000_000, "clips")
}

/// Repeats of a measurement.
pub(crate) fn repeats(text: &str) -> Result<usize, String> {
    within(text, 1..=1000, "runs")
}

/// How much more a text counts than nothing does.
pub(crate) fn text_weight(text: &str) -> Result<f64, String> {
    within(text, 0.0..=100.0, "times")
}

/// Size of one character over that of another.
pub(crate) fn scale(text: &str) -> Result<f64, String> {
    within(text, 1e-4..=1e4, "times")
}

/// Metres in a unit of a file.
pub(crate) fn unit(text: &str) -> Result<f64, String> {
    within(text, 1e-6..=1e6, "metres (0.01 for centimetres)")
}

/// The longest result, in frames of 30 a second: what can be matched.
const MOST_FRAMES: usize = inkrig_align::MOST_FRAMES;
/// The same in seconds.
const MOST_SECONDS: f64 = MOST_FRAMES as f64 / 30.0;

/// Length of a clip that a model makes, which says itself what it can make.
pub(crate) fn clip_length(text: &str) -> Result<Length, String> {
    text.parse().map_err(|error: crate::span::SpanError| error.to_string())
}

/// Which of many results.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}

/// Length of a result: more than nothing, at most what can be matched.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    let length: Length = text.parse().map_err(|error: crate::span::SpanError| error.to_string())?;
    let good = match length {
        Length::Frames(frames) => (1..=MOST_FRAMES).contains(&frames),
        Length::Seconds(seconds) => seconds > 0.0 && seconds <= MOST_SECONDS,
    };
    if good {
        Ok(length)
    } else {
        Err(format!(
            "a result has at most {MOST_FRAMES} frames of 30 a second: give 1 to {MOST_FRAMES}, or more than 0s and at most \
             {MOST_SECONDS:.0}s"
        ))
    }
}

fn within<T: FromStr + PartialOrd + Display>(
    text: &str,
    range: RangeInclusive<T>,
    what: &str,
) -> Result<T, String> {
    // A number that is not finite is in no range.
    let number = text.trim().parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("give a number from {} to {}: {what}", range.start(), range.end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_and_are_said() {
        assert_eq!((fps("0.1"), fps("1000"), smooth("0")), (Ok(0.1), Ok(1000.0), Ok(0.0)));
        for bad in ["0", "1000.1", "-1", "nan", "inf", "1e400", "", "fast"] {
            assert!(fps(bad).unwrap_err().contains("from 0.1 to 1000"), "{bad}");
        }
        assert!(source_fps("0.001").unwrap_err().contains("from 0.01 to 100000"));
        assert!(smooth("-1").unwrap_err().contains("from 0 to 1000"));
        assert!(threads("0").is_err() && threads("-1").is_err() && unit("0").is_err());
        assert_eq!(length("3333s"), Ok(Length::Seconds(3333.0)));
        assert!(seed("-1").unwrap_err().contains("from 0 to") && seed("7") == Ok(7));
        for bad in ["0", "0s", "3334s", "100001", "100000000s"] {
            let said = length(bad).unwrap_err();
            assert!(said.contains("100000") && said.contains("3333s"), "{bad}: {said}");
        }
        assert!(length("-1").unwrap_err().contains("neither frames"));
    }
}
