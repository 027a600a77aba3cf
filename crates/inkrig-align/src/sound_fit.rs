//! How a movement goes with the sound that it follows: is it quicker where the sound is loud, and do its stops fall on
//! the beats?

use crate::measures::{Dynamics, pearson};
use crate::{AlignError, MOST_FRAMES};
use inkrig_motion::{Clip, Features, time};
use inkrig_sketch::{Ends, smooth};
use serde::Serialize;

/// What is heard of a sound, one value a row of its control.
#[derive(Debug, Clone, PartialEq)]
pub struct Heard {
    /// Level, decibels of full scale.
    pub loudness: Vec<f32>,
    /// Strength of onsets: see [`inkrig_sound::onset_strength`].
    pub onsets: Vec<f32>,
    /// The coefficients before they were smoothed.
    pub plain: Features,
}

impl Heard {
    /// The same `times` times over.
    pub(crate) fn repeated(&self, times: usize) -> Result<Self, AlignError> {
        Ok(Self {
            loudness: self.loudness.repeat(times),
            onsets: self.onsets.repeat(times),
            plain: Features::new(self.plain.as_slice().repeat(times), self.plain.width())?,
        })
    }
}

/// How a movement goes with a sound. MAMM brings alike to alike, not loud to quick: which way round it goes is chance, so
/// correlations have either sign. Speed is the mean root-relative speed of the joints. A lag is how much later the
/// movement comes, at most a quarter second either way, chosen for the largest correlation; the same choice is made for the
/// baseline, the clip stretched to the sound's length.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SoundFit {
    /// [`Report::structure_pearson`](crate::Report::structure_pearson) against the coefficients before smoothing.
    pub structure_pearson_unsmoothed: f64,
    /// Pearson correlation of loudness in decibels and speed, -1..=1.
    pub loudness_correlation: f64,
    /// Its lag, seconds.
    pub loudness_lag: f64,
    /// The same of the baseline.
    pub loudness_correlation_warp: f64,
    /// Pearson correlation of onset strength and speed, -1..=1.
    pub onset_correlation: f64,
    /// Its lag, seconds.
    pub onset_lag: f64,
    /// The same of the baseline.
    pub onset_correlation_warp: f64,
    /// How near onsets have a movement that stops or turns, 0..=1: the mean over onsets of exp(-d^2 / 2 s^2), d being the
    /// time to the nearest minimum of speed and s 50 ms ("beat alignment score", Li et al., "AI Choreographer", ICCV 2021,
    /// Sec. 5.2.2, with onsets for beats).
    pub beat_alignment: f64,
    /// The same of the baseline.
    pub beat_alignment_warp: f64,
}

/// The largest lag that is looked at, seconds.
const MOST_LAG: f64 = 0.25;

/// Width of the Gaussian within which a stop counts as on the beat, seconds.
const ON_THE_BEAT: f64 = 0.05;

/// Smoothing of speed before its minima are taken, seconds: the beat alignment score's own.
const SPEED_SMOOTHING: f64 = 5.0 / 60.0;

impl SoundFit {
    /// Measures a result, and the clip that it is made of as the baseline, against a sound with `rate` rows a second.
    /// [`Self::structure_pearson_unsmoothed`] is left at 0.
    ///
    /// # Errors
    /// When a clip cannot be sampled.
    pub(crate) fn of(
        (result, source): (&Clip, &Clip),
        travel_joint: usize,
        heard: &Heard,
        rate: f64,
    ) -> Result<Self, AlignError> {
        let speeds = |clip: &Clip| -> Result<Vec<f32>, AlignError> {
            let rows = heard.loudness.len().clamp(2, MOST_FRAMES);
            let step = (clip.frames() - 1) as f64 / (rows - 1) as f64;
            let places: Vec<f64> = (0..rows).map(|row| row as f64 * step).collect();
            Ok(Dynamics::of(&time::sample_at(clip, &places, rate)?, travel_joint).speeds)
        };
        let (own, warp) = (speeds(result)?, speeds(source)?);
        let beats = peaks(&heard.onsets, rate);
        let lags = (MOST_LAG * rate).floor() as usize;
        let (loudness_correlation, loudness_lag) = best_lag(&heard.loudness, &own, lags);
        let (onset_correlation, onset_lag) = best_lag(&heard.onsets, &own, lags);
        Ok(Self {
            structure_pearson_unsmoothed: 0.0,
            loudness_correlation,
            loudness_lag: loudness_lag as f64 / rate,
            loudness_correlation_warp: best_lag(&heard.loudness, &warp, lags).0,
            onset_correlation,
            onset_lag: onset_lag as f64 / rate,
            onset_correlation_warp: best_lag(&heard.onsets, &warp, lags).0,
            beat_alignment: beat_alignment(&beats, &stops(&own, rate)?, rate),
            beat_alignment_warp: beat_alignment(&beats, &stops(&warp, rate)?, rate),
        })
    }
}

/// The correlation that is largest in size over lags of the second row, and that lag in rows.
fn best_lag(sound: &[f32], motion: &[f32], lags: usize) -> (f64, isize) {
    let length = sound.len().min(motion.len());
    let at = |lag: isize| {
        let (early, late) = (lag.min(0).unsigned_abs(), lag.max(0).unsigned_abs());
        let pair =
            sound.get(early..length.saturating_sub(late)).zip(motion.get(late..length.saturating_sub(early)));
        pair.map_or(0.0, |(sound, motion)| pearson(sound, motion))
    };
    let lags = (lags as isize).min(length as isize / 2);
    let all = (-lags..=lags).map(|lag| (at(lag), lag));
    // Of equals the one nearest to no lag.
    all.fold((0.0, 0), |best: (f64, isize), this| {
        let better = this.0.abs() - best.0.abs();
        if better > 1e-12 || (better > -1e-12 && this.1.abs() < best.1.abs()) { this } else { best }
    })
}

/// Rows where something begins to sound: the highest within 70 ms, and well above the mean of 100 ms to each side.
fn peaks(onsets: &[f32], rate: f64) -> Vec<usize> {
    let (reach, around) = ((0.07 * rate).round() as usize, (0.1 * rate).round() as usize);
    let most = onsets.iter().copied().fold(0.0, f32::max);
    let window = |row: usize, reach: usize| {
        onsets.get(row.saturating_sub(reach)..(row + reach + 1).min(onsets.len())).unwrap_or_default()
    };
    let is_peak = |row: usize, value: f32| {
        let beside = window(row, around);
        let mean = beside.iter().sum::<f32>() / beside.len().max(1) as f32;
        value > mean + 0.07 * most && window(row, reach).iter().all(|&other| other <= value)
    };
    onsets.iter().enumerate().filter(|&(row, &value)| is_peak(row, value)).map(|(row, _)| row).collect()
}

/// Rows where the movement stops or turns: minima of the smoothed speed.
fn stops(speeds: &[f32], rate: f64) -> Result<Vec<usize>, AlignError> {
    let rows: Vec<[f64; 1]> = speeds.iter().map(|&speed| [f64::from(speed)]).collect();
    let rows = smooth(&rows, SPEED_SMOOTHING * rate, Ends::Open)?;
    let minima = rows.windows(3).enumerate().filter(|(_, w)| w[1] < w[0] && w[1] <= w[2]);
    Ok(minima.map(|(before, _)| before + 1).collect())
}

fn beat_alignment(beats: &[usize], stops: &[usize], rate: f64) -> f64 {
    let near = |&beat: &usize| {
        let distance =
            stops.iter().map(|&stop| stop.abs_diff(beat)).min().unwrap_or(usize::MAX) as f64 / rate;
        (-0.5 * (distance / ON_THE_BEAT).powi(2)).exp()
    };
    beats.iter().map(near).sum::<f64>() / beats.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;

    #[test]
    fn a_later_motion_is_found_with_its_lag() {
        let sound: Vec<f32> = (0..200).map(|i| ((i * i) as f32 * 0.01).sin()).collect();
        let moved = |lag: isize| -> Vec<f32> {
            (0..200).map(|i: isize| -sound[(i - lag).clamp(0, 199) as usize]).collect()
        };
        for lag in [-5, 0, 7] {
            let (correlation, found) = best_lag(&sound, &moved(lag), 8);
            assert_eq!(found, lag);
            assert!((correlation + 1.0).abs() < 1e-6, "either sign: {correlation}");
        }
        assert_eq!(best_lag(&[1.0; 50], &[2.0; 50], 8), (0.0, 0), "nothing changes");
        assert_eq!(best_lag(&[1.0], &[2.0], 8), (0.0, 0), "nothing to compare");
    }

    #[test]
    fn stops_on_the_beat_count_and_others_do_not() {
        assert_eq!(beat_alignment(&[10, 40], &[10, 40], 43.0), 1.0);
        assert!(beat_alignment(&[10, 40], &[25], 43.0) < 1e-6);
        let one_frame = beat_alignment(&[10], &[11], 20.0);
        assert!((one_frame - (-0.5_f64).exp()).abs() < 1e-9);
        assert_eq!((beat_alignment(&[], &[1], 43.0), beat_alignment(&[1], &[], 43.0)), (0.0, 0.0));
    }

    #[test]
    fn peaks_are_onsets_and_minima_are_stops() {
        let onsets: Vec<f32> = (0..100).map(|i| if i % 20 == 10 { 5.0 } else { 0.1 }).collect();
        assert_eq!(peaks(&onsets, 43.0), [10, 30, 50, 70, 90]);
        assert_eq!(peaks(&[0.0; 9], 43.0), [0; 0]);
        // The smallest speeds of a swing: every 25 rows.
        let speeds: Vec<f32> =
            (0..100).map(|i| (i as f32 * std::f32::consts::PI / 25.0).cos().abs() + 0.1).collect();
        let stops = stops(&speeds, 30.0).unwrap();
        assert_eq!(stops.len(), 4, "{stops:?}");
        assert!(stops.iter().all(|stop| (stop % 25).abs_diff(12) <= 1), "{stops:?}");
    }

    #[test]
    fn a_clip_that_is_quick_where_it_is_loud_correlates() {
        let clip = swinging(6.0, 30.0);
        let speeds = Dynamics::of(&clip, 0).speeds;
        let loudness: Vec<f32> = speeds.iter().map(|&speed| 10.0 * speed - 40.0).collect();
        let plain = Features::new(vec![0.0; loudness.len()], 1).unwrap();
        let heard = Heard { onsets: loudness.clone(), loudness, plain };
        let still = time::sample_at(&clip, &[3.0; 90], 30.0).unwrap();
        let fit = SoundFit::of((&clip, &still), 0, &heard, 30.0).unwrap();
        assert!(fit.loudness_correlation > 0.98 && fit.loudness_lag.abs() < 0.04, "{fit:?}");
        // Where nothing moves there is only rounding.
        assert!(fit.loudness_correlation_warp.abs() < 0.3, "{fit:?}");
    }
}
