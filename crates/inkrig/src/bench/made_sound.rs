//! A sound that this project made: nobody else's music is needed to try sound as a control.

use inkrig_align::AlignError;
use inkrig_sound::Sound;
use std::f64::consts::TAU;

const RATE: u32 = 22_050;
/// Seconds of each of the three parts.
const PART: f64 = 4.0;

/// Twelve seconds: four of a quiet pad, four of a loud beat, four of a plucked melody. Always the same samples.
///
/// # Errors
/// Never; the sound is short and finite.
pub fn pad_beat_melody() -> Result<Sound, AlignError> {
    let mut noise = Noise(1);
    let samples = (0..(3.0 * PART * f64::from(RATE)) as usize).map(|index| {
        let t = index as f64 / f64::from(RATE);
        let hiss = noise.next();
        let value = match t {
            t if t < PART => pad(t),
            t if t < 2.0 * PART => beat(t - PART, hiss),
            t => melody(t - 2.0 * PART),
        };
        value as f32
    });
    Ok(Sound::new(samples.collect(), RATE)?)
}

/// Two chords of slowly swelling sines.
fn pad(t: f64) -> f64 {
    let chord = if t < 0.5 * PART { [220.0, 277.2, 329.6] } else { [196.0, 246.9, 293.7] };
    let swell = 0.5 - 0.5 * (TAU * t / (0.5 * PART)).cos();
    0.05 * (0.2 + swell) * chord.iter().map(|pitch| (TAU * pitch * t).sin()).sum::<f64>()
}

/// A deep drum twice a second, a hiss between its strokes.
fn beat(t: f64, hiss: f64) -> f64 {
    let (stroke, between) = ((2.0 * t).fract() / 2.0, (2.0 * t + 0.5).fract() / 2.0);
    let drum = (-18.0 * stroke).exp() * (TAU * (50.0 * stroke + 4.0 * (1.0 - (-30.0 * stroke).exp()))).sin();
    0.8 * drum + 0.25 * (-40.0 * between).exp() * hiss
}

/// Three plucked notes a second, up and down a scale.
fn melody(t: f64) -> f64 {
    const STEPS: [f64; 8] = [0.0, 2.0, 4.0, 7.0, 9.0, 7.0, 4.0, 2.0];
    let note = (3.0 * t) as usize;
    let since = t - note as f64 / 3.0;
    let pitch = 440.0 * 2.0_f64.powf(STEPS[note % STEPS.len()] / 12.0);
    let tone = |overtone: f64| (TAU * pitch * overtone * since).sin() / (overtone * overtone);
    0.35 * (-5.0 * since).exp() * (1..=4).map(|overtone| tone(f64::from(overtone))).sum::<f64>()
}

/// Numbers that sound like noise, from -1 to 1: a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_differ_in_loudness_and_nothing_clips() {
        let sound = pad_beat_melody().unwrap();
        assert_eq!(sound.seconds(), 12.0);
        assert!(sound.peak() > 0.3 && sound.peak() <= 1.0, "{}", sound.peak());
        let third = sound.samples().len() / 3;
        let power = |part: usize| {
            let samples = &sound.samples()[part * third..(part + 1) * third];
            samples.iter().map(|value| f64::from(value * value)).sum::<f64>() / third as f64
        };
        assert!(
            power(1) > 4.0 * power(0) && power(2) > 2.0 * power(0),
            "{} {} {}",
            power(0),
            power(1),
            power(2)
        );
    }
}
