//! Power in mel bands over time.

use crate::{
    Sound, SoundError,
    mel_filters::{Filter, mel_filters},
    resample,
};
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// The rate that every analysis works at, Hz.
pub const ANALYSIS_RATE: u32 = 22_050;
/// Samples in a window at [`ANALYSIS_RATE`].
pub const WINDOW: usize = 2048;
/// Samples between frames at [`ANALYSIS_RATE`].
pub const HOP: usize = 512;
/// Bands on the mel scale, from 0 to half of [`ANALYSIS_RATE`].
pub const MEL_BANDS: usize = 128;
/// Frames in a second of every analysis: 22 050 / 512, about 43.066.
pub const FRAME_RATE_HZ: f64 = 22_050.0 / 512.0;

/// Level of no power at all, dB: ten times the logarithm of 1e-10.
const LEAST_POWER: f64 = 1e-10;

/// Power in [`MEL_BANDS`] bands at [`FRAME_RATE_HZ`], as librosa's `feature.melspectrogram` makes it by default: periodic
/// Hann window, power 2, frames centred on their time with zeros beyond the ends, Slaney's bands and norm.
///
/// MFCC and onsets come from it. One that is needed for both is computed once.
#[derive(Debug, Clone, PartialEq)]
pub struct MelSpectrogram {
    /// Frames x [`MEL_BANDS`], at least one frame.
    power: Vec<f32>,
}

impl MelSpectrogram {
    /// Resamples to [`ANALYSIS_RATE`] and transforms. There are `1 + samples / HOP` frames.
    ///
    /// # Errors
    /// As [`resample`].
    pub fn new(sound: &Sound) -> Result<Self, SoundError> {
        let sound = resample(sound, ANALYSIS_RATE)?;
        let samples = sound.samples();
        let frames = 1 + samples.len() / HOP;
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(WINDOW);
        let hann: Vec<f64> =
            (0..WINDOW).map(|i| 0.5 - 0.5 * (2.0 * PI * i as f64 / WINDOW as f64).cos()).collect();
        let filters = mel_filters(f64::from(ANALYSIS_RATE), WINDOW, MEL_BANDS);
        let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
        let mut scratch = transform.make_scratch_vec();
        let mut power = Vec::with_capacity(frames * MEL_BANDS);
        let mut bins = vec![0.0; WINDOW / 2 + 1];
        for frame in 0..frames {
            for ((place, value), hann) in (frame * HOP..).zip(&mut input).zip(&hann) {
                // Half a window of zeros in front.
                let sample = place.checked_sub(WINDOW / 2).and_then(|place| samples.get(place));
                *value = sample.map_or(0.0, |&sample| f64::from(sample)) * hann;
            }
            // It fails on buffers of another length alone, and these are its own.
            if transform.process_with_scratch(&mut input, &mut output, &mut scratch).is_err() {
                debug_assert!(false, "the buffers fit");
            }
            for (bin, value) in bins.iter_mut().zip(&output) {
                *bin = value.norm_sqr();
            }
            power.extend(filters.iter().map(|filter| apply(filter, &bins)));
        }
        Ok(Self { power })
    }

    /// Frames, at least one.
    pub fn frames(&self) -> usize {
        self.power.len() / MEL_BANDS
    }

    /// The power of each band, frame by frame: [`Self::frames`] slices of [`MEL_BANDS`].
    pub fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.power.chunks_exact(MEL_BANDS)
    }

    /// Decibels relative to a power of 1, frames x [`MEL_BANDS`]; nothing is below -100 dB, nor more than `range_db` below
    /// the loudest value of all. For that reason values depend on the whole sound. `None` leaves the range open.
    pub fn decibels(&self, range_db: Option<f64>) -> Vec<f64> {
        let decibels = |power: &f32| 10.0 * f64::from(*power).max(LEAST_POWER).log10();
        let mut values: Vec<f64> = self.power.iter().map(decibels).collect();
        if let Some(range) = range_db {
            let floor = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - range;
            for value in &mut values {
                *value = value.max(floor);
            }
        }
        values
    }
}

fn apply(filter: &Filter, bins: &[f64]) -> f32 {
    let bins = bins.get(filter.first..).unwrap_or_default();
    bins.iter().zip(&filter.weights).map(|(bin, weight)| bin * weight).sum::<f64>() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_is_in_its_band() {
        let tone = |i: i32| (f64::from(i) * 2.0 * PI * 1000.0 / 22_050.0).sin() as f32;
        let sound = Sound::new((0..22_050).map(tone).collect(), ANALYSIS_RATE).unwrap();
        let mel = MelSpectrogram::new(&sound).unwrap();
        assert_eq!(mel.frames(), 44);
        let row = mel.rows().nth(20).unwrap();
        let loudest = (0..MEL_BANDS).max_by(|&a, &b| row[a].total_cmp(&row[b])).unwrap();
        // 1000 Hz is 15 mel; the bands' middles lie 0.3872 mel apart, the first at one step.
        assert_eq!(loudest, 38);
    }

    #[test]
    fn the_range_is_cut_below_the_loudest() {
        let mut click = vec![0.0; 22_050];
        click[0] = 1.0;
        let mel = MelSpectrogram::new(&Sound::new(click, ANALYSIS_RATE).unwrap()).unwrap();
        let least = |range| mel.decibels(range).into_iter().fold(f64::INFINITY, f64::min);
        let most = mel.decibels(None).into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(least(None), -100.0);
        assert_eq!(least(Some(30.0)), most - 30.0);
    }
}
