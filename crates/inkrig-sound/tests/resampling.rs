//! Resampling against known sines and against librosa's `soxr_hq`.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{cases, difference, numbers, signals, sound_of};
use inkrig_sound::{MAX_RATE, MIN_TARGET_RATE, Sound, SoundError, resample};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// The largest error in the middle half of a second of a sine that was resampled, or of what should be nothing, dB.
fn error_db(hz: f64, from: u32, to: u32, gain: f64) -> f64 {
    let sine = |index: usize, rate: u32| (TAU * hz * index as f64 / f64::from(rate)).sin();
    let sound = Sound::new((0..from as usize).map(|index| sine(index, from) as f32).collect(), from).unwrap();
    let out = resample(&sound, to).unwrap();
    let samples = out.samples().iter().enumerate().skip(to as usize / 4).take(to as usize / 2);
    let worst = samples.map(|(index, value)| (f64::from(*value) - gain * sine(index, to)).abs());
    20.0 * worst.fold(0.0, f64::max).log10()
}

#[test]
fn sines_in_the_band_stay_the_same_sines() {
    // Among them ratios with one row of taps for each phase and ratios whose rows are interpolated.
    for (from, to) in [
        (44_100, 22_050),
        (48_000, 22_050),
        (96_000, 22_050),
        (16_000, 22_050),
        (8000, 22_050),
        (44_101, 22_050),
        (47_999, 22_050),
        (22_050, 48_000),
        (768_000, 22_050),
    ] {
        let nyquist = f64::from(from.min(to)) / 2.0;
        for share in [0.01, 0.3, 0.7, 0.91] {
            let error = error_db(share * nyquist, from, to, 1.0);
            println!("{from} to {to} Hz, sine at {share} of the band: {error:.1} dB");
            assert!(error < -110.0, "{from} to {to}, {share}: {error} dB");
        }
    }
}

#[test]
fn sines_above_the_band_are_gone_and_do_not_fold_back() {
    for (from, to) in [(44_100, 22_050), (48_000, 22_050), (96_000, 22_050), (44_101, 22_050)] {
        for share in [1.001, 1.2, 1.9] {
            let error = error_db(share * f64::from(to) / 2.0, from, to, 0.0);
            println!("{from} to {to} Hz, sine at {share} of the band: {error:.1} dB left");
            assert!(error < -110.0, "{from} to {to}, {share}: {error} dB");
        }
    }
}

#[test]
fn close_to_soxr_hq() {
    for case in cases("resampled.json") {
        let target = case["target"].as_u64().unwrap() as u32;
        let out = resample(&sound_of(&case), target).unwrap();
        assert_eq!(out.samples().len() as u64, case["length"].as_u64().unwrap());
        let every = case["every"].as_u64().unwrap() as usize;
        let theirs = numbers(&case["values"]);
        // The tones begin and end at once, and that step also fills the band where two filters may differ.
        let edge = EDGE.div_ceil(every);
        let inner = edge..theirs.len() - edge;
        let ours: Vec<f32> = out.samples().iter().step_by(every).copied().collect();
        let (whole, _) = difference(ours.iter().copied(), &theirs);
        let (largest, rms) = difference(ours[inner.clone()].iter().copied(), &theirs[inner]);
        let (signal, rate) = (case["signal"].as_str().unwrap(), &case["rate"]);
        println!(
            "{signal}, {rate} to {target} Hz: largest difference {largest:.1e} ({whole:.1e} with the ends), rms {rms:.1e}"
        );
        let bound = if signal == "noise" { NOISE } else { TONES };
        assert!(largest <= bound && whole <= 0.05, "{signal} {rate}: {largest}, {whole} with the ends");
    }
}

/// Samples at either end that are looked at apart.
const EDGE: usize = 1500;
/// White noise at full scale fills the band between 0.913 and 1, where the two filters fade out differently.
const NOISE: f64 = 0.01;
/// 0.002 dB of 0.3: soxr begins to roll off below the end of its passband, within 0.01 dB.
const TONES: f64 = 1e-4;

#[test]
fn rates_out_of_range_are_refused() {
    let sound = Sound::new(vec![0.5; 100], 8000).unwrap();
    for rate in [0, MIN_TARGET_RATE - 1, MAX_RATE + 1] {
        assert!(matches!(resample(&sound, rate), Err(SoundError::BadRate { .. })), "{rate}");
    }
    let slow = Sound::new(vec![0.5; 1000], 1).unwrap();
    assert!(matches!(resample(&slow, MAX_RATE), Err(SoundError::Limit { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Up and down again by any ratio: what lies within the band comes back.
    #[test]
    fn there_and_back(rate in 8001_u32..96_000, seed in any::<u32>()) {
        let hz = 100.0 + 3000.0 * signals::noise(1, seed).next().unwrap().abs();
        let sine = |index: usize| (TAU * hz * index as f64 / 8000.0).sin() as f32;
        let sound = Sound::new((0..4000).map(sine).collect(), 8000).unwrap();
        let back = resample(&resample(&sound, rate).unwrap(), 8000).unwrap();
        for index in 1000..3000 {
            let apart = (back.samples()[index] - sound.samples()[index]).abs();
            prop_assert!(apart < 2e-5, "{hz} Hz by way of {rate} Hz: {apart}");
        }
    }
}
