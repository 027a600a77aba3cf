//! The test signals by formula. `tests/fixtures/signals.py` has the same formulas; change both or neither.

use std::f64::consts::TAU;

pub(crate) fn by_name(name: &str, samples: usize, rate: f64) -> Vec<f32> {
    match name {
        "chirp" => chirp(samples, rate),
        "beat" => beat(samples, rate),
        "speech" => speech(samples, rate),
        "tones" => tones(samples, rate),
        "melody" => melody(samples, rate),
        "noise" => noise(samples, 3).map(|value| value as f32).collect(),
        _ => panic!("no signal is called {name}"),
    }
}

/// White noise from -1 to 1: a linear congruential generator (Numerical Recipes), the upper 24 bits.
pub(crate) fn noise(samples: usize, seed: u32) -> impl Iterator<Item = f64> {
    let mut state = seed;
    (0..samples).map(move |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    })
}

/// From 100 to 8000 Hz in two seconds, over faint noise.
fn chirp(samples: usize, rate: f64) -> Vec<f32> {
    let noise = noise(samples, 1);
    let value = |(t, noise): (f64, f64)| 0.4 * (TAU * (100.0 * t + 1975.0 * t * t)).sin() + 0.05 * noise;
    times(samples, rate).zip(noise).map(|pair| value(pair) as f32).collect()
}

/// Two beats a second, each a thud and a hiss, over a chord.
fn beat(samples: usize, rate: f64) -> Vec<f32> {
    let value = |(t, noise): (f64, f64)| {
        let age = t % 0.5;
        let chord: f64 = [220.0, 277.18, 329.63].iter().map(|hz| (TAU * hz * t).sin()).sum();
        let thud = (TAU * 150.0 * age).sin() * (-age * 18.0).exp();
        0.05 * chord + 0.5 * thud + 0.2 * noise * (-age * 60.0).exp()
    };
    times(samples, rate).zip(noise(samples, 2)).map(|pair| value(pair) as f32).collect()
}

/// Harmonics of a rising voice under two gliding formants, in syllables, and silence after 1.5 s.
fn speech(samples: usize, rate: f64) -> Vec<f32> {
    let value = |t: f64| {
        let (pitch, phase) = (120.0 + 20.0 * t, TAU * (120.0 * t + 10.0 * t * t));
        let formants = [(300.0 + 200.0 * t, 80.0), (2200.0 - 500.0 * t, 150.0)];
        let harmonic = |h: f64| {
            let weight = |(middle, width): (f64, f64)| 1.0 / (1.0 + ((h * pitch - middle) / width).powi(2));
            formants.into_iter().map(weight).sum::<f64>() * (h * phase).sin()
        };
        let sum: f64 = (1..25).map(|h| harmonic(f64::from(h))).sum();
        if t < 1.5 { 0.2 * sum * (TAU * 2.0 * t).sin().max(0.0) } else { 0.0 }
    };
    times(samples, rate).map(|t| value(t) as f32).collect()
}

/// Tones that every rate in the tests can hold.
fn tones(samples: usize, rate: f64) -> Vec<f32> {
    let value = |t: f64| {
        [(200.0, 0.0), (1000.0, 1.0), (3300.0, 2.0)]
            .iter()
            .map(|(hz, phase)| 0.3 * (TAU * hz * t + phase).sin())
            .sum::<f64>()
    };
    times(samples, rate).map(|t| value(t) as f32).collect()
}

/// What is in the encoded files: two notes, the second from 0.5 s.
fn melody(samples: usize, rate: f64) -> Vec<f32> {
    let value = |t: f64| {
        let hz = if t < 0.5 { 440.0 } else { 660.0 };
        let fade = ((t % 0.5).min(0.5 - t % 0.5) * 20.0).min(1.0);
        0.5 * fade * (TAU * hz * t).sin()
    };
    times(samples, rate).map(|t| value(t) as f32).collect()
}

fn times(samples: usize, rate: f64) -> impl Iterator<Item = f64> {
    (0..samples).map(move |i| i as f64 / rate)
}
