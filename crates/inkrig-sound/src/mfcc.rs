//! Mel-frequency cepstral coefficients, with librosa's defaults.

use crate::{FRAME_RATE_HZ, MEL_BANDS, MelSpectrogram, Sound, SoundError};
use std::f64::consts::PI;

/// What may be chosen. The rest is fixed: 22 050 Hz, window 2048, hop 512, 128 Slaney bands, orthonormal DCT-II, no lifter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MfccOptions {
    /// Coefficients of a frame, 1 to [`MEL_BANDS`]. Default: 40. The first is the level, the others the timbre.
    pub coefficients: usize,
    /// Decibels below the loudest value of the whole sound at which levels are cut. Default: 80; `None` cuts nothing.
    pub range_db: Option<f64>,
}

impl Default for MfccOptions {
    fn default() -> Self {
        Self { coefficients: 40, range_db: Some(80.0) }
    }
}

/// Coefficients over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Mfcc {
    /// Frames x coefficients, time first. Decibels, scaled by the orthonormal DCT.
    pub values: Vec<f32>,
    /// Frames; frame `i` is centred on the time `i / rate_hz` seconds.
    pub frames: usize,
    /// Coefficients of a frame.
    pub coefficients: usize,
    /// Frames in a second: [`FRAME_RATE_HZ`].
    pub rate_hz: f64,
}

/// The coefficients of a sound, equal to librosa 0.11's `feature.mfcc(y, sr=22050, n_mfcc=40, pad_mode="constant")` for a
/// sound at 22 050 Hz; others are resampled by [`resample`](crate::resample) first.
///
/// # Errors
/// [`SoundError::Options`] for options out of range; as [`resample`](crate::resample).
pub fn mfcc(sound: &Sound, options: &MfccOptions) -> Result<Mfcc, SoundError> {
    options.check()?;
    MelSpectrogram::new(sound)?.mfcc(options)
}

impl MelSpectrogram {
    /// As [`mfcc`](fn@crate::mfcc).
    ///
    /// # Errors
    /// [`SoundError::Options`] for options out of range.
    pub fn mfcc(&self, options: &MfccOptions) -> Result<Mfcc, SoundError> {
        options.check()?;
        let basis = dct_basis(options.coefficients);
        let project =
            |row: &[f64], basis: &[f64]| row.iter().zip(basis).map(|(x, b)| x * b).sum::<f64>() as f32;
        let decibels = self.decibels(options.range_db);
        let rows = decibels.chunks_exact(MEL_BANDS);
        let values = rows.flat_map(|row| basis.chunks_exact(MEL_BANDS).map(move |basis| project(row, basis)));
        Ok(Mfcc {
            values: values.collect(),
            frames: self.frames(),
            coefficients: options.coefficients,
            rate_hz: FRAME_RATE_HZ,
        })
    }
}

impl MfccOptions {
    fn check(&self) -> Result<(), SoundError> {
        if !(1..=MEL_BANDS).contains(&self.coefficients) {
            return Err(SoundError::Options {
                what: format!("{} coefficients were asked for", self.coefficients),
                hint: "1 to 128 can be had; 40 is usual",
            });
        }
        if self.range_db.is_some_and(|range| !(range.is_finite() && range > 0.0)) {
            return Err(SoundError::Options {
                what: "the range in decibels is not a positive number".into(),
                hint: "80 is usual",
            });
        }
        Ok(())
    }
}

/// Orthonormal DCT-II: coefficients x [`MEL_BANDS`].
fn dct_basis(coefficients: usize) -> Vec<f64> {
    let bands = MEL_BANDS as f64;
    let value = |k: usize, n: usize| {
        let scale = if k == 0 { (1.0 / bands).sqrt() } else { (2.0 / bands).sqrt() };
        scale * (PI * k as f64 * (n as f64 + 0.5) / bands).cos()
    };
    (0..coefficients).flat_map(|k| (0..MEL_BANDS).map(move |n| value(k, n))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_orthonormal() {
        let basis = dct_basis(MEL_BANDS);
        for (i, a) in basis.chunks_exact(MEL_BANDS).enumerate() {
            for (j, b) in basis.chunks_exact(MEL_BANDS).enumerate() {
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}");
            }
        }
    }

    #[test]
    fn silence_is_level_and_nothing_else() {
        let sound = Sound::new(vec![0.0; 22_050], 22_050).unwrap();
        let mfcc = mfcc(&sound, &MfccOptions::default()).unwrap();
        for row in mfcc.values.chunks_exact(40) {
            // -100 dB in all bands, times the root of 128.
            assert!((row[0] + 1_131.370_8).abs() < 1e-3, "{}", row[0]);
            assert!(row[1..].iter().all(|value| value.abs() < 1e-4));
        }
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let sound = Sound::new(vec![0.0; 100], 22_050).unwrap();
        for options in [
            MfccOptions { coefficients: 0, ..Default::default() },
            MfccOptions { coefficients: 129, ..Default::default() },
            MfccOptions { range_db: Some(f64::NAN), ..Default::default() },
            MfccOptions { range_db: Some(0.0), ..Default::default() },
        ] {
            assert!(matches!(mfcc(&sound, &options), Err(SoundError::Options { .. })), "{options:?}");
        }
    }
}
