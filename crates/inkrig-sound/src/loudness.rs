//! Level over time.

use crate::{ANALYSIS_RATE, Envelope, FRAME_RATE_HZ, HOP, Sound, SoundError, WINDOW, resample};

/// The lowest level that [`LoudnessScale::Decibels`] gives, dB of full scale.
pub const LOUDNESS_FLOOR_DB: f32 = -80.0;

/// How a level is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LoudnessScale {
    /// Root of the mean square; a sine at full scale has 0.707.
    #[default]
    Rms,
    /// The same in decibels of full scale, from [`LOUDNESS_FLOOR_DB`].
    Decibels,
}

/// The level of each frame: root mean square over 2048 samples around its time, at [`FRAME_RATE_HZ`], with zeros
/// beyond the ends; librosa's `feature.rms` by default.
///
/// # Errors
/// As [`resample`].
pub fn loudness(sound: &Sound, scale: LoudnessScale) -> Result<Envelope, SoundError> {
    let sound = resample(sound, ANALYSIS_RATE)?;
    let samples = sound.samples();
    let level = |frame: usize| {
        let centre = frame * HOP;
        let end = (centre + WINDOW / 2).min(samples.len());
        let window = samples.get(centre.saturating_sub(WINDOW / 2)..end).unwrap_or_default();
        let energy: f64 = window.iter().map(|&sample| f64::from(sample) * f64::from(sample)).sum();
        let rms = (energy / WINDOW as f64).sqrt();
        match scale {
            LoudnessScale::Rms => rms as f32,
            LoudnessScale::Decibels => (20.0 * rms.log10()).max(f64::from(LOUDNESS_FLOOR_DB)) as f32,
        }
    };
    Ok(Envelope { values: (0..=samples.len() / HOP).map(level).collect(), rate_hz: FRAME_RATE_HZ })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_sine_is_3_db_below_full_scale() {
        let tone = (0..44_100).map(|i| (f64::from(i) * 0.1).sin() as f32).collect();
        let sound = Sound::new(tone, 44_100).unwrap();
        let rms = loudness(&sound, LoudnessScale::Rms).unwrap();
        assert_eq!(rms.values.len(), 44);
        assert!((rms.values[20] - 0.5_f32.sqrt()).abs() < 2e-3, "{}", rms.values[20]);
        let decibels = loudness(&sound, LoudnessScale::Decibels).unwrap();
        assert!((decibels.values[20] + 3.01).abs() < 0.03, "{}", decibels.values[20]);
    }

    #[test]
    fn silence_has_the_lowest_level() {
        let sound = Sound::new(vec![0.0; 5000], 22_050).unwrap();
        let decibels = loudness(&sound, LoudnessScale::Decibels).unwrap();
        assert!(decibels.values.iter().all(|value| *value == LOUDNESS_FLOOR_DB));
    }
}
