//! Where something begins to sound.

use crate::{Envelope, FRAME_RATE_HZ, HOP, MEL_BANDS, MelSpectrogram, Sound, SoundError, WINDOW};

/// Frames by which the flux is moved later: a frame hears an onset half a window before its time.
const DELAY: usize = WINDOW / (2 * HOP);

/// The strength of onsets at [`FRAME_RATE_HZ`]: spectral flux, which is the mean over mel bands of the rise in decibels from
/// frame to frame, falls counting as 0. It is moved by two frames so that a beat's peak lies on the beat; librosa's
/// `onset.onset_strength` by default.
///
/// S. Böck and G. Widmer, "Maximum filter vibrato suppression for onset detection", DAFx 2013, with a filter width of 1.
///
/// # Errors
/// As [`resample`](crate::resample).
pub fn onset_strength(sound: &Sound) -> Result<Envelope, SoundError> {
    Ok(MelSpectrogram::new(sound)?.onset_strength())
}

impl MelSpectrogram {
    /// As [`onset_strength`](fn@crate::onset_strength).
    pub fn onset_strength(&self) -> Envelope {
        let decibels = self.decibels(Some(80.0));
        let rise = |before: &[f64], after: &[f64]| {
            let rises = before.iter().zip(after).map(|(before, after)| (after - before).max(0.0));
            (rises.sum::<f64>() / MEL_BANDS as f64) as f32
        };
        let rows = || decibels.chunks_exact(MEL_BANDS);
        let flux = rows().zip(rows().skip(1)).map(|(before, after)| rise(before, after));
        // The first frame has none before it.
        let values = std::iter::repeat_n(0.0, 1 + DELAY).chain(flux).take(self.frames()).collect();
        Envelope { values, rate_hz: FRAME_RATE_HZ }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beat_peaks_on_the_beat() {
        let mut samples = vec![0.0; 44_100];
        for i in 0..4000 {
            samples[22_050 + i] = (i as f32 * 0.3).sin() * (-(i as f32) / 800.0).exp();
        }
        let onsets = onset_strength(&Sound::new(samples, 22_050).unwrap()).unwrap();
        let values = &onsets.values;
        let peak = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap();
        let seconds = peak as f64 / onsets.rate_hz;
        assert!((seconds - 1.0).abs() < 0.03, "{seconds}");
    }

    #[test]
    fn a_single_frame_has_no_onset() {
        let onsets = onset_strength(&Sound::new(vec![1.0], 22_050).unwrap()).unwrap();
        assert_eq!(onsets.values, [0.0]);
    }
}
