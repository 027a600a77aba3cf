//! MFCC, loudness and onsets against numbers that librosa made; `tests/fixtures/make_mfcc.py` makes them again.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{cases, difference, numbers, sound_of};
use inkrig_sound::{ANALYSIS_RATE, LoudnessScale, MelSpectrogram, MfccOptions, loudness, mfcc};

#[test]
fn mfcc_are_librosas() {
    let (mut own_rate, mut resampled) = (0.0_f64, 0.0_f64);
    for case in cases("mfcc.json") {
        let sound = sound_of(&case);
        let ours = mfcc(&sound, &MfccOptions::default()).unwrap();
        assert_eq!(ours.frames as u64, case["frames"].as_u64().unwrap());
        assert_eq!(ours.values.len(), ours.frames * ours.coefficients);
        let every = case["every"].as_u64().unwrap() as usize;
        let ours = ours.values.chunks_exact(40).step_by(every).flatten().copied();
        let theirs: Vec<f64> = case["mfcc"].as_array().unwrap().iter().flat_map(numbers).collect();
        let (largest, rms) = difference(ours, &theirs);
        println!("{}: largest difference {largest:.2e}, rms {rms:.2e}", case["name"]);
        let worst = if sound.rate() == ANALYSIS_RATE { &mut own_rate } else { &mut resampled };
        *worst = worst.max(largest);
    }
    assert!(own_rate <= 1e-3, "{own_rate}");
    assert!(own_rate > 0.0 && resampled > 0.0);
    // Two resamplers differ in the last mel bands, where both fade out.
    assert!(resampled <= RESAMPLED, "{resampled}");
}

/// Bound for sounds that were resampled by another resampler than ours, in MFCC units.
const RESAMPLED: f64 = 0.1;

#[test]
fn loudness_and_onsets_are_librosas() {
    for case in cases("mfcc.json") {
        let sound = sound_of(&case);
        let (rms, _) =
            difference(loudness(&sound, LoudnessScale::Rms).unwrap().values, &numbers(&case["rms"]));
        let onsets = MelSpectrogram::new(&sound).unwrap().onset_strength();
        let (onset, _) = difference(onsets.values, &numbers(&case["onset"]));
        println!("{}: loudness {rms:.2e}, onsets {onset:.2e} dB", case["name"]);
        let own_rate = sound.rate() == ANALYSIS_RATE;
        assert!(rms <= if own_rate { 1e-6 } else { 1e-5 }, "{}: {rms}", case["name"]);
        assert!(onset <= if own_rate { 1e-3 } else { 0.01 }, "{}: {onset}", case["name"]);
    }
}
