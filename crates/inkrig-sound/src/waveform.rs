//! The plain wave at the rate of a control.

use crate::{Envelope, MAX_SAMPLES, Sound, SoundError};

/// What stands for the samples of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WaveformKind {
    /// Their mean, with sign: for a file that holds a slow curve rather than something to hear.
    #[default]
    Mean,
    /// The largest magnitude: the outline of something to hear.
    Peak,
}

/// The wave at `rate_hz` frames a second. Frame `i` stands for the samples that lie less than half a frame from the time
/// `i / rate_hz`; where a frame has none, because the control is quicker than the sound, the value lies on the line
/// between the two samples around. There are as many frames as begin within the sound, at least one.
///
/// # Errors
/// [`SoundError::BadRate`] unless `rate_hz` is a positive number, [`SoundError::Limit`] for more than [`MAX_SAMPLES`]
/// frames.
pub fn waveform(sound: &Sound, rate_hz: f64, kind: WaveformKind) -> Result<Envelope, SoundError> {
    let frames = (sound.seconds() * rate_hz).ceil();
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(SoundError::BadRate { rate: rate_hz, least: 0.0, most: sound.rate().into() });
    }
    if frames > MAX_SAMPLES as f64 {
        return Err(SoundError::Limit {
            what: format!("{frames} frames at {rate_hz} Hz"),
            limit: format!("{MAX_SAMPLES} frames"),
            hint: "use the rate of the motion",
        });
    }
    let samples = sound.samples();
    let per_frame = f64::from(sound.rate()) / rate_hz;
    let value = |frame: usize| {
        let centre = frame as f64 * per_frame;
        let start = (centre - per_frame / 2.0).ceil().max(0.0) as usize;
        let end = ((centre + per_frame / 2.0).ceil() as usize).min(samples.len());
        match samples.get(start..end) {
            Some(window) if !window.is_empty() => of_window(window, kind),
            _ => between(samples, centre, kind),
        }
    };
    Ok(Envelope { values: (0..frames.max(1.0) as usize).map(value).collect(), rate_hz })
}

fn of_window(window: &[f32], kind: WaveformKind) -> f32 {
    match kind {
        WaveformKind::Mean => {
            let sum: f64 = window.iter().map(|&sample| f64::from(sample)).sum();
            (sum / window.len() as f64) as f32
        }
        WaveformKind::Peak => window.iter().fold(0.0, |peak, sample| peak.max(sample.abs())),
    }
}

fn between(samples: &[f32], place: f64, kind: WaveformKind) -> f32 {
    let last = samples.len().saturating_sub(1);
    let at = |index: usize| samples.get(index.min(last)).copied().unwrap_or_default();
    let before = place.floor();
    let (a, b) = (at(before as usize), at(before as usize + 1));
    let value = a + (b - a) * (place - before) as f32;
    match kind {
        WaveformKind::Mean => value,
        WaveformKind::Peak => value.abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sound(samples: &[f32], rate: u32) -> Sound {
        Sound::new(samples.to_vec(), rate).unwrap()
    }

    #[test]
    fn means_keep_the_sign_and_peaks_do_not() {
        let wave = sound(&[1.0, 3.0, -5.0, -7.0, 2.0, 2.0, 0.0, 0.0], 8);
        // Four samples a frame, the first frame having half of them: 0-1, 2-5, and 6-7 belong to a frame beyond the end.
        let mean = waveform(&wave, 2.0, WaveformKind::Mean).unwrap();
        assert_eq!(mean.values, [2.0, -2.0]);
        let peak = waveform(&wave, 2.0, WaveformKind::Peak).unwrap();
        assert_eq!(peak.values, [3.0, 7.0]);
    }

    #[test]
    fn a_slow_curve_is_drawn_through() {
        let mean = waveform(&sound(&[0.0, 1.0, 0.0], 2), 8.0, WaveformKind::Mean).unwrap();
        assert_eq!(mean.values.len(), 12);
        assert_eq!(&mean.values[..6], &[0.0, 0.25, 0.5, 0.75, 1.0, 0.75]);
        assert_eq!(&mean.values[8..], &[0.0; 4]);
    }

    #[test]
    fn rates_that_are_none_are_refused() {
        let wave = sound(&[0.0; 100], 10);
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(waveform(&wave, rate, WaveformKind::Mean), Err(SoundError::BadRate { .. })),
                "{rate}"
            );
        }
        assert!(matches!(waveform(&wave, 1e12, WaveformKind::Mean), Err(SoundError::Limit { .. })));
        assert_eq!(waveform(&wave, 1e-9, WaveformKind::Mean).unwrap().values.len(), 1);
    }
}
