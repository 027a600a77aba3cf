//! Fuzz targets of the decoder, on stable Rust. Under `cargo test` each runs for a second;
//! `BOLERO_RANDOM_TEST_TIME_MS=300000 cargo test --release -p inkrig-sound --test fuzz_sound` runs them for longer.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{ENCODED, fixture, seal_ogg};
use inkrig_sound::{MAX_SAMPLES_PER_BYTE, decode};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Changed fixtures tried, and those of them that were read.
static TRIED: AtomicUsize = AtomicUsize::new(0);
static READ: AtomicUsize = AtomicUsize::new(0);
/// Files on which a decoder panicked, which came out as an error.
static CONTAINED: AtomicUsize = AtomicUsize::new(0);

/// Kind, place, argument.
type Edit = (u8, u16, u8);

#[test]
fn fixtures_changed_at_random() {
    let seeds = ENCODED.map(|extension| fixture(&format!("melody.{extension}")));
    bolero::check!().with_type::<(u8, Vec<Edit>)>().for_each(|(seed, edits)| {
        let mut bytes = seeds[usize::from(*seed) % seeds.len()].clone();
        for edit in edits.iter().take(1 + usize::from(*seed) / 64) {
            apply(&mut bytes, *edit);
        }
        // With right checksums damage reaches the decoder.
        seal_ogg(&mut bytes);
        TRIED.fetch_add(1, Relaxed);
        READ.fetch_add(usize::from(check(&bytes)), Relaxed);
    });
    let (tried, read) = (TRIED.load(Relaxed), READ.load(Relaxed));
    println!("{tried} files, {read} of them read, {} panics contained", CONTAINED.load(Relaxed));
    // A mutator that breaks everything would test the decoders not at all.
    assert!(read * 20 > tried);
}

#[test]
fn bytes_at_random() {
    bolero::check!().for_each(|bytes: &[u8]| {
        check(bytes);
        for start in [
            &b"RIFF\xff\xff\xff\x7fWAVEfmt "[..],
            b"fLaC",
            b"OggS\0\x02",
            b"\xff\xfb\x90\x64",
            b"ID3\x04\0\0",
        ] {
            check(&[start, bytes].concat());
        }
    });
}

fn apply(bytes: &mut Vec<u8>, (kind, place, argument): Edit) {
    // Half of the edits fall on the headers.
    let reach = if kind & 1 == 0 { bytes.len().min(200) } else { bytes.len() };
    let place = usize::from(place) % reach.max(1);
    let end = (place + usize::from(argument) % 32).min(bytes.len());
    match (kind >> 1) % 8 {
        0 => bytes.insert(place.min(bytes.len()), argument),
        1 => drop(bytes.drain(place..end)),
        2 => bytes.truncate(place.max(100)),
        3 => bytes[place..end].fill(argument),
        4 => {
            let copy = bytes[place..end].to_vec();
            bytes.extend(copy);
        }
        _ => {
            if let Some(byte) = bytes.get_mut(place) {
                *byte = argument;
            }
        }
    }
}

/// No panic comes out, and no more than the bound. Whether it was read.
fn check(bytes: &[u8]) -> bool {
    match decode(bytes, "mp3") {
        Ok(decoded) => {
            let samples = decoded.sound.samples();
            assert!(samples.len() <= bytes.len() * MAX_SAMPLES_PER_BYTE);
            assert!(samples.iter().all(|sample| sample.is_finite()));
            true
        }
        Err(error) => {
            CONTAINED.fetch_add(usize::from(error.to_string().contains("gave up")), Relaxed);
            false
        }
    }
}
