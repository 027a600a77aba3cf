//! Another sample rate, band-limited: windowed-sinc interpolation with a Kaiser window, as a polyphase filter.
//!
//! Figures, in shares of the lower of the two Nyquist frequencies: passband to 0.913, stopband from 1.0, 120 dB down; the
//! same band edges as the `HQ` recipe of soxr, which librosa uses by default. Zero phase: sample 0 stays at time 0.
//! Where the ratio of the rates needs few filter phases each has its own row of taps; otherwise neighbouring rows are
//! interpolated linearly, with an error below -120 dB.
//!
//! J. F. Kaiser and R. W. Schafer, "On the use of the I0-sinh window for spectrum analysis", IEEE Trans. ASSP 28, 1980;
//! R. E. Crochiere and L. R. Rabiner, "Multirate Digital Signal Processing", 1983, chapter 3.

use crate::{MAX_SAMPLES, Sound, SoundError, sound::MAX_RATE};
use std::f64::consts::PI;

/// The lowest rate that a sound is resampled to, Hz. For the rates of controls see [`waveform`](crate::waveform).
pub const MIN_TARGET_RATE: u32 = 1000;

/// Middle of the transition band, in shares of the lower Nyquist frequency.
const CUTOFF: f64 = 0.9565;
/// Zero crossings on each side that 120 dB over that transition band need: (120 - 7.95) / (2.285 * 0.087 pi) / 2.
const HALF_WIDTH: f64 = 90.0;
/// Kaiser's beta for 120 dB: 0.1102 * (120 - 8.7).
const BETA: f64 = 12.265;
/// Rows between two input samples at which linear interpolation of a row is good to -120 dB.
const INTERPOLATED_ROWS: f64 = 1024.0;
/// Most taps of a table with one row for each phase.
const MOST_EXACT_TAPS: u64 = 1 << 20;

/// The sound at another rate, `ceil(samples * rate / old rate)` samples long.
///
/// # Errors
/// [`SoundError::BadRate`] unless `rate` is [`MIN_TARGET_RATE`] to [`MAX_RATE`](crate::MAX_RATE);
/// [`SoundError::Limit`] when the result would be longer than [`MAX_SAMPLES`].
pub fn resample(sound: &Sound, rate: u32) -> Result<Sound, SoundError> {
    if !(MIN_TARGET_RATE..=MAX_RATE).contains(&rate) {
        return Err(SoundError::BadRate {
            rate: rate.into(),
            least: MIN_TARGET_RATE.into(),
            most: MAX_RATE.into(),
        });
    }
    if rate == sound.rate() {
        return Ok(sound.clone());
    }
    let (up, down) = (u64::from(rate), u64::from(sound.rate()));
    let (up, down) = (up / gcd(up, down), down / gcd(up, down));
    let length = (sound.samples().len() as u64).saturating_mul(up).div_ceil(down);
    let length = usize::try_from(length).ok().filter(|length| *length <= MAX_SAMPLES).ok_or_else(|| {
        SoundError::Limit {
            what: format!("{length} samples at {rate} Hz"),
            limit: format!("{MAX_SAMPLES} samples"),
            hint: "cut the part that is needed",
        }
    })?;
    let filter = Polyphase::new(up, down);
    Sound::new((0..length as u64).map(|index| filter.at(sound.samples(), index)).collect(), rate)
}

struct Polyphase {
    up: u64,
    down: u64,
    /// Rows of taps, one after the other, phase 0 to 1 inclusive.
    taps: Vec<f32>,
    width: usize,
    rows: u64,
}

impl Polyphase {
    fn new(up: u64, down: u64) -> Self {
        // Downwards the kernel is as much wider as the band is narrower.
        let scale = (down as f64 / up as f64).max(1.0);
        let half = (HALF_WIDTH * scale).ceil() as usize;
        let width = 2 * half;
        let exact = up * width as u64 <= MOST_EXACT_TAPS;
        let rows = if exact { up } else { (INTERPOLATED_ROWS / scale).ceil().max(8.0) as u64 };
        let mut taps = Vec::with_capacity((rows as usize + 1) * width);
        for row in 0..=rows {
            let phase = row as f64 / rows as f64;
            let kernel = (0..width).map(|tap| kernel((phase + (half - 1) as f64 - tap as f64) / scale));
            let kernel: Vec<f64> = kernel.collect();
            // A row of unit sum lets a constant through unchanged at every phase.
            let sum: f64 = kernel.iter().sum();
            taps.extend(kernel.iter().map(|tap| (tap / sum) as f32));
        }
        Self { up, down, taps, width, rows }
    }

    fn at(&self, samples: &[f32], index: u64) -> f32 {
        let time = u128::from(index) * u128::from(self.down);
        let (whole, rest) = ((time / u128::from(self.up)) as usize, (time % u128::from(self.up)) as u64);
        let place = rest as f64 * self.rows as f64 / self.up as f64;
        let (row, between) = if self.rows == self.up { (rest, 0.0) } else { (place as u64, place.fract()) };
        let first = self.sum(samples, whole, row);
        if between == 0.0 {
            return first;
        }
        first + (self.sum(samples, whole, row + 1) - first) * between as f32
    }

    /// One row over the samples around `whole`; there is silence before the first and after the last.
    fn sum(&self, samples: &[f32], whole: usize, row: u64) -> f32 {
        let start = row as usize * self.width;
        let taps = self.taps.get(start..start + self.width).unwrap_or_default();
        let before = self.width / 2 - 1;
        let (skipped, from) = if whole >= before { (0, whole - before) } else { (before - whole, 0) };
        let taps = taps.get(skipped..).unwrap_or_default();
        let samples = samples.get(from..).unwrap_or_default();
        dot(samples, taps)
    }
}

/// Sum of products over the shorter length, in 16 lanes: quick, and always in the same order.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let length = a.len().min(b.len());
    let (a, b) = (a.get(..length).unwrap_or_default(), b.get(..length).unwrap_or_default());
    let (a, b) = (a.chunks_exact(16), b.chunks_exact(16));
    let tail: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let mut lanes = [0.0_f32; 16];
    for (a, b) in a.zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f32>() + tail
}

/// The windowed sinc at a distance in periods of twice the lower Nyquist frequency.
fn kernel(distance: f64) -> f64 {
    let share = distance / HALF_WIDTH;
    if share.abs() > 1.0 {
        return 0.0;
    }
    let angle = PI * CUTOFF * distance;
    let sinc = if angle == 0.0 { 1.0 } else { angle.sin() / angle };
    sinc * bessel_i0(BETA * (1.0 - share * share).sqrt())
}

/// Modified Bessel function of the first kind, order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let square = x * x / 4.0;
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..100 {
        term *= square / f64::from(k * k);
        sum += term;
        if term < sum * 1e-17 {
            break;
        }
    }
    sum
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_has_known_values() {
        // Abramowitz and Stegun, table 9.8.
        assert!((bessel_i0(1.0) - 1.266_065_877_752_008).abs() < 1e-14);
        assert!((bessel_i0(5.0) - 27.239_871_823_604_44).abs() < 1e-11);
    }

    #[test]
    fn a_constant_stays_what_it_is_away_from_the_ends() {
        for (from, to) in [(44_100, 22_050), (48_000, 22_050), (8000, 22_050), (44_101, 22_050)] {
            let sound = Sound::new(vec![0.5; from as usize], from).unwrap();
            let out = resample(&sound, to).unwrap();
            let middle = &out.samples()[5000..to as usize - 5000];
            let worst = middle.iter().map(|value| (value - 0.5).abs()).fold(0.0, f32::max);
            assert!(worst < 1e-6, "{from} to {to}: {worst}");
        }
    }

    #[test]
    fn lengths_round_up() {
        let length = |samples, from, to| {
            resample(&Sound::new(vec![0.0; samples], from).unwrap(), to).unwrap().samples().len()
        };
        assert_eq!(length(3, 44_100, 22_050), 2);
        assert_eq!(length(1, 768_000, 1000), 1);
        assert_eq!(length(1, 1, 22_050), 22_050);
    }
}
