//! A mono sound in memory.

use crate::SoundError;

/// The highest sample rate that a [`Sound`] may have, Hz.
pub const MAX_RATE: u32 = 768_000;

/// A sound whose largest magnitude is below this is silent: 1e-4, which is -80 dB of full scale, three steps of 16 bits.
pub const SILENCE_PEAK: f32 = 1e-4;

/// Beyond 120 dB over full scale a number is no level but a damaged sample. The bound also keeps powers finite.
pub(crate) const MAX_LEVEL: f32 = 1e6;

/// A mono sound: at least one finite sample, full scale being -1 to 1, and a rate from 1 to [`MAX_RATE`] Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct Sound {
    samples: Vec<f32>,
    rate: u32,
}

impl Sound {
    /// A sound from its samples and their rate in Hz.
    ///
    /// # Errors
    /// [`SoundError::NoSamples`], [`SoundError::BadRate`], or [`SoundError::BadSample`] for a sample that is not finite
    /// or beyond 1e6.
    pub fn new(samples: Vec<f32>, rate: u32) -> Result<Self, SoundError> {
        if samples.is_empty() {
            return Err(SoundError::NoSamples);
        }
        if !(1..=MAX_RATE).contains(&rate) {
            return Err(SoundError::BadRate { rate: rate.into(), least: 1.0, most: MAX_RATE.into() });
        }
        if let Some((index, &value)) = samples.iter().enumerate().find(|(_, value)| !is_level(**value)) {
            return Err(SoundError::BadSample { index, value });
        }
        Ok(Self { samples, rate })
    }

    /// The samples, in order of time.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// Samples in a second.
    pub fn rate(&self) -> u32 {
        self.rate
    }

    /// Length in seconds.
    pub fn seconds(&self) -> f64 {
        self.samples.len() as f64 / f64::from(self.rate)
    }

    /// The largest magnitude of a sample; 1 is full scale.
    pub fn peak(&self) -> f32 {
        self.samples.iter().fold(0.0, |peak, sample| peak.max(sample.abs()))
    }

    /// Whether no sample reaches [`SILENCE_PEAK`]. Nothing useful can be matched with such a sound.
    pub fn is_silent(&self) -> bool {
        self.peak() < SILENCE_PEAK
    }
}

/// Whether a number can be a sample.
pub(crate) fn is_level(value: f32) -> bool {
    value.abs() <= MAX_LEVEL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_sound_is_refused() {
        assert_eq!(Sound::new(vec![], 8000), Err(SoundError::NoSamples));
        assert!(matches!(Sound::new(vec![0.0], 0), Err(SoundError::BadRate { .. })));
        assert!(matches!(Sound::new(vec![0.0], MAX_RATE + 1), Err(SoundError::BadRate { .. })));
        for value in [f32::NAN, f32::INFINITY, -2e6] {
            let sound = Sound::new(vec![0.0, value], 8000);
            assert!(matches!(sound, Err(SoundError::BadSample { index: 1, .. })), "{value}");
        }
    }

    #[test]
    fn silence_is_below_80_db_under_full_scale() {
        let sound = |peak: f32| Sound::new(vec![0.0, -peak, 0.0], 8000).unwrap();
        assert!(sound(0.99e-4).is_silent());
        assert!(!sound(1.01e-4).is_silent());
    }
}
