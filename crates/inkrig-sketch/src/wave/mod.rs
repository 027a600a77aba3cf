//! Waveforms as text: `sine(2Hz..8Hz)`, `sine(1Hz) for 3s; sine(4Hz) for 2s`, `triangle(1Hz) * ramp(0..1)`.
//!
#![doc = concat!("```text\n", include_str!("grammar.txt"), "```")]

mod display;
mod expression;
mod generator;
mod lexer;
mod parser;
mod read;

pub use read::read_wave;

use std::str::FromStr;

use crate::SketchError;
use crate::limits::{MAX_FRAMES, MAX_MAGNITUDE};
use expression::{Expression, Moment};
pub(crate) use lexer::shown;

/// Longest text of a wave, in bytes.
pub const MAX_WAVE_TEXT: usize = 128 << 10;
/// Most numbers, generators and centres of a wave: bounds what one sample costs.
pub const MAX_WAVE_PARTS: usize = 256;
/// Deepest nesting of parentheses in a wave, those of `alternate` included.
pub const MAX_WAVE_DEPTH: usize = 32;
/// Highest rate of sampling, in samples a second.
pub const MAX_RATE: f64 = 1e6;

/// A waveform: one number over time, written as in `sine(2Hz..8Hz)`.
///
/// ```text
/// sine(0.5Hz..4Hz)                                 from slow to fast, evenly
/// triangle(1Hz, amplitude=0.2..1)                  sharp turns that grow
/// sine(1Hz) for 3s; sine(4Hz) for 2s               one after the other
/// alternate(sine(2Hz), centres=-1|1, every=2s)     a sine that changes sides every two seconds
/// square(0.5s, duty=0.25) + 0.1 * noise(8Hz, seed=3)
/// ```
///
/// In every segment time starts at 0 and phases start anew; `t` is the time in the segment, in seconds. A range `a..b`
/// goes evenly from a to b over the segment; a frequency does so without a jump of phase (a linear chirp). A segment
/// without length lasts to the end of what is sampled.
///
/// Every oscillator lies within centre - amplitude to centre + amplitude, -1 to 1 where neither is given. `sine` and
/// `triangle` start at the centre and rise, `square` starts high, `saw` rises from lowest to highest and drops, `noise`
/// starts each period at another height and goes smoothly to the next: the same heights for the same seed.
///
/// The text of a wave reads back as the same wave. Space is free, capitals do not matter, and `center` and `centers` are
/// understood. The whole grammar:
#[doc = concat!("\n```text\n", include_str!("grammar.txt"), "```")]
///
/// ```
/// let wave: inkrig_sketch::Wave = "sine(1Hz) for 3s; triangle(4Hz, centre=2) for 2s".parse()?;
/// assert_eq!(wave.duration(), Some(5.0));
/// let values = wave.sample(30.0, 150)?;
/// assert!((values[7] - 1.0).abs() < 0.01 && (values[90] - 2.0).abs() < 1e-9);
/// assert_eq!(wave.to_string().parse(), Ok(wave));
/// # Ok::<(), inkrig_sketch::SketchError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Wave {
    /// At least one; all but the last have a length.
    segments: Vec<Segment>,
}

#[derive(Debug, Clone, PartialEq)]
struct Segment {
    expression: Expression,
    /// In seconds, above 0.
    length: Option<f64>,
}

impl FromStr for Wave {
    type Err = SketchError;

    /// Reads a wave from its text.
    ///
    /// # Errors
    /// [`SketchError::Syntax`] with the column, what stands there and what is expected.
    fn from_str(text: &str) -> Result<Self, SketchError> {
        parser::parse(text).map(|segments| Self { segments })
    }
}

impl Wave {
    /// Length in seconds, or `None` where the last segment has none and lasts to the end of what is sampled.
    pub fn duration(&self) -> Option<f64> {
        self.segments.iter().map(|segment| segment.length).sum()
    }

    /// How many frames the wave is of itself at a rate, in frames a second: `round(duration * rate)`, at least 1 and at
    /// most [`MAX_FRAMES`]. `None` where it has no length of its own.
    pub fn frame_count(&self, rate: f64) -> Option<usize> {
        self.duration().map(|duration| (duration * rate).round().clamp(1.0, MAX_FRAMES as f64) as usize)
    }

    /// The wave's value at `frames` frames: frame i lies at i / `rate` seconds.
    ///
    /// Fewer frames than [`Wave::frame_count`] cut the wave off.
    ///
    /// # Errors
    /// - [`SketchError::Rate`]: the rate is not above 0, or above [`MAX_RATE`].
    /// - [`SketchError::FrameCount`]: no frame, or more than [`MAX_FRAMES`].
    /// - [`SketchError::WaveTooShort`]: more frames than all segments are long.
    /// - [`SketchError::WaveTooFast`]: a frequency of half the rate or above.
    /// - [`SketchError::WaveValue`]: a value beyond [`MAX_MAGNITUDE`], as products may reach.
    /// - [`SketchError::Still`]: two frames or more, all the same.
    pub fn sample(&self, rate: f64, frames: usize) -> Result<Vec<f64>, SketchError> {
        self.check_sampling(rate, frames)?;
        let mut segments = self.segments.iter().peekable();
        let (mut current, mut start) = (segments.next(), 0.0);
        let mut values = Vec::with_capacity(frames);
        for frame in 0..frames {
            let time = frame as f64 / rate;
            // A frame at the border, but for rounding, belongs to the segment that begins there.
            while let Some(length) = current.and_then(|segment| segment.length)
                && time >= start + length - 1e-9
                && segments.peek().is_some()
            {
                start += length;
                current = segments.next();
            }
            let Some(Segment { expression, length }) = current else { break };
            let length = length.unwrap_or(frames as f64 / rate - start);
            let value = expression.value(Moment::new(time - start, length));
            if !value.is_finite() || value.abs() > MAX_MAGNITUDE {
                return Err(SketchError::WaveValue { frame, value });
            }
            values.push(value);
        }
        match values.split_first() {
            Some((first, rest)) if !rest.is_empty() && rest.iter().all(|value| value == first) => {
                Err(SketchError::Still { what: "wave", rows: frames })
            }
            _ => Ok(values),
        }
    }

    fn check_sampling(&self, rate: f64, frames: usize) -> Result<(), SketchError> {
        if !(rate > 0.0 && rate <= MAX_RATE) {
            return Err(SketchError::Rate { rate });
        }
        if frames == 0 || frames > MAX_FRAMES {
            return Err(SketchError::FrameCount { frames });
        }
        if let (Some(seconds), Some(own)) = (self.duration(), self.frame_count(rate))
            && frames > own
        {
            return Err(SketchError::WaveTooShort { seconds, own, frames });
        }
        let hertz =
            self.segments.iter().map(|segment| segment.expression.highest_hertz()).fold(0.0, f64::max);
        if hertz >= rate / 2.0 { Err(SketchError::WaveTooFast { hertz, rate }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(text: &str, rate: f64, frames: usize) -> Vec<f64> {
        text.parse::<Wave>().unwrap().sample(rate, frames).unwrap()
    }

    fn near(got: &[f64], want: &[f64]) {
        assert_eq!(got.len(), want.len());
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-7), "got {got:?}, want {want:?}");
    }

    #[test]
    fn generators_have_their_values() {
        near(&sample("sine(1Hz)", 4.0, 5), &[0.0, 1.0, 0.0, -1.0, 0.0]);
        near(&sample("triangle(1Hz, amplitude=2, centre=1)", 8.0, 5), &[1.0, 2.0, 3.0, 2.0, 1.0]);
        near(&sample("square(1s, duty=0.25)", 4.0, 5), &[1.0, -1.0, -1.0, -1.0, 1.0]);
        near(&sample("saw(0.5Hz)", 4.0, 9), &[-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, -1.0]);
        near(&sample("ramp(1..3) for 1s", 4.0, 4), &[1.0, 1.5, 2.0, 2.5]);
        near(&sample("sine(1Hz, phase=0.25)", 4.0, 3), &[1.0, 0.0, -1.0]);
        near(&sample("sine(1Hz, amplitude=0..4) for 1s", 4.0, 4), &[0.0, 1.0, 0.0, -3.0]);
        near(&sample("sine(1Hz, centre=0..4) for 1s", 4.0, 4), &[0.0, 2.0, 2.0, 2.0]);
    }

    #[test]
    fn sums_products_and_signs_bind_as_in_school() {
        near(&sample("1 + 2 * t - -3", 1.0, 3), &[4.0, 6.0, 8.0]);
        near(&sample("-(1 + t) * 2 - t", 1.0, 3), &[-2.0, -5.0, -8.0]);
        near(&sample("1 - t - 1", 1.0, 3), &[0.0, -1.0, -2.0]);
        near(&sample("--t * ---2", 1.0, 2), &[0.0, -2.0]);
        near(&sample("constant(-.5e1) + t", 1.0, 2), &[-5.0, -4.0]);
    }

    #[test]
    fn a_sweep_keeps_its_phase() {
        // From 1 Hz to 3 Hz over two seconds: t + t * t / 2 periods.
        let values = sample("sine(1Hz..3Hz) for 2s", 100.0, 200);
        for (frame, value) in values.iter().enumerate() {
            let t = frame as f64 / 100.0;
            assert!((value - (std::f64::consts::TAU * (t + t * t / 2.0)).sin()).abs() < 1e-9, "{t}");
        }
        assert_eq!(values, sample("sine(1..3Hz) for 2s", 100.0, 200));
        assert_eq!(values[..100], sample("sine(1Hz..3Hz) for 2s", 100.0, 100), "cut off, not squeezed");
        // Without a length it reaches its end where the sampling ends.
        assert_eq!(values, sample("sine(1Hz..3Hz)", 100.0, 200));
    }

    #[test]
    fn segments_follow_each_other_and_start_anew() {
        let values = sample("t for 0.3s; 10 + t for 0.2s; 20 + t", 10.0, 7);
        near(&values, &[0.0, 0.1, 0.2, 10.0, 10.1, 20.0, 20.1]);
        let wave: Wave = "t for 0.3s; 10 + t for 0.2s;".parse().unwrap();
        assert_eq!((wave.duration(), wave.frame_count(10.0)), (Some(0.5), Some(5)));
        assert_eq!("t for 1s; t".parse::<Wave>().unwrap().duration(), None);
        // A thousand borders on frames at a rate that no binary fraction holds: none is a frame late.
        let many = vec!["t for 0.1s"; 200].join(";");
        let values = sample(&many, 30.0, 600);
        assert!(values.chunks(3).all(|three| three[0] < 1e-9 && three[1] > 0.03), "{values:?}");
    }

    #[test]
    fn centres_alternate() {
        let values = sample("alternate(0.1 * t, centres=-1|1|5, every=2s)", 1.0, 8);
        near(&values, &[-1.0, -0.9, 1.2, 1.3, 5.4, 5.5, -0.4, -0.3]);
        assert_eq!(values, sample("Alternate(0.1*t,every=2s,centers=-1|1|5)", 1.0, 8));
    }

    #[test]
    fn jumps_on_a_frame_are_never_a_frame_late() {
        for half in 3..40_u32 {
            let seconds = f64::from(half) / 30.0;
            let side = |frame: usize| if (frame / half as usize).is_multiple_of(2) { 1.0 } else { -1.0 };
            let expected: Vec<f64> = (0..3000).map(side).collect();
            assert_eq!(sample(&format!("square({}s)", 2.0 * seconds), 30.0, 3000), expected, "{half}");
            let alternating = format!("alternate(0, centres=1|-1, every={seconds}s)");
            assert_eq!(sample(&alternating, 30.0, 3000), expected, "{half}");
            let falls = sample(&format!("saw({seconds}s)"), 30.0, 3000);
            assert!(
                (1..3000).all(|i| (falls[i] < falls[i - 1]) == i.is_multiple_of(half as usize)),
                "{half}"
            );
        }
    }

    #[test]
    fn what_cannot_be_sampled_is_refused() {
        let sample = |text: &str, rate, frames| text.parse::<Wave>().unwrap().sample(rate, frames);
        for rate in [0.0, -1.0, f64::INFINITY, 1e7] {
            assert_eq!(sample("t", rate, 5), Err(SketchError::Rate { rate }));
        }
        assert!(matches!(sample("t", f64::NAN, 5), Err(SketchError::Rate { .. })));
        for frames in [0, MAX_FRAMES + 1, 10_000_000] {
            assert_eq!(sample("t", 30.0, frames), Err(SketchError::FrameCount { frames }));
        }
        let short = SketchError::WaveTooShort { seconds: 2.0, own: 60, frames: 61 };
        assert_eq!(sample("t for 1s; t for 1s", 30.0, 61), Err(short));
        let fast = SketchError::WaveTooFast { hertz: 15.0, rate: 30.0 };
        assert_eq!(sample("1 + alternate(sine(2Hz..15Hz) * 2, centres=0|1, every=1s)", 30.0, 9), Err(fast));
        assert_eq!(sample("constant(2)", 30.0, 9), Err(SketchError::Still { what: "wave", rows: 9 }));
        assert_eq!(sample("constant(2)", 30.0, 1), Ok(vec![2.0]));
        let large = vec!["1e15"; 30].join("*");
        assert_eq!(sample(&large, 30.0, 9), Err(SketchError::WaveValue { frame: 0, value: f64::INFINITY }));
        let nan = format!("t + {large} - {large}");
        assert!(matches!(sample(&nan, 30.0, 9), Err(SketchError::WaveValue { frame: 0, .. })));
    }

    #[test]
    fn display_leaves_out_what_is_standard() {
        for (text, shown) in [
            ("SINE", "sine(1Hz)"),
            ("sine ( 0.5s .. 4 Hz , phase = -0.5 )", "sine(2Hz..4Hz, phase=-0.5)"),
            ("square(2Hz, duty=0.5)", "square(2Hz)"),
            ("noise(2Hz, 7)", "noise(2Hz, seed=7)"),
            ("(((t)))*(t+1)*(t*t)", "t * (t + 1) * (t * t)"),
            ("-(-(t))+-(t+1)-(1-t)", "t + -(t + 1) - (1 - t)"),
            ("saw(1Hz,center=0..2,amplitude=3..3) for .5s;", "saw(1Hz, amplitude=3, centre=0..2) for 0.5s"),
            ("alternate(-sine,every=1e-9s,centres=1|--1)", "alternate(-sine(1Hz), centres=1|1, every=1e-9s)"),
        ] {
            let wave: Wave = text.parse().unwrap();
            assert_eq!(wave.to_string(), shown);
            assert_eq!(shown.parse(), Ok(wave), "{text}");
        }
    }
}
