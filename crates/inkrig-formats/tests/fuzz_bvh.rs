//! Fuzz targets of the BVH reader and writer, on stable Rust. Under `cargo test` each runs for a second;
//! `BOLERO_RANDOM_TEST_TIME_MS=300000 cargo test --release -p inkrig-formats --test fuzz_bvh` runs them for longer.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{Difference, fixture, fixture_names};
use inkrig_formats::{ExportOptions, FormatError, ImportOptions, Limits, UpAxis, read_bvh, write_bvh};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Changed fixtures tried, and those of them that were readable and so went through the writer.
static TRIED: AtomicUsize = AtomicUsize::new(0);
static READABLE: AtomicUsize = AtomicUsize::new(0);

/// Words that mean something to the reader, or nearly.
const WORDS: &[&str] = &[
    "{",
    "}",
    "\n",
    "\r",
    "\r\n",
    "\t",
    " ",
    "HIERARCHY",
    "ROOT a\n{\n",
    "JOINT b\n{\n",
    "End Site\n{\n",
    "OFFSET 1 2 3\n",
    "OFFSET",
    "CHANNELS 3 Zrotation Xrotation Yrotation\n",
    "CHANNELS 99999999999 ",
    "CHANNELS 2 Xrotation Xrotation\n",
    "CHANNELS 1 Yposition\n",
    "MOTION\n",
    "Frames: 99999999999\n",
    "Frames: 1\n",
    "Frame Time: 1e-400\n",
    "Frame Time: .1\n",
    "Frame",
    ":",
    "nan",
    "inf",
    "-",
    ".",
    "1e12",
    "-1e12",
    "1e-300",
    "1e300",
    "0",
    "90 ",
    "-90 ",
    "179.9999 ",
    "1e9 ",
    ",",
    "\u{feff}",
    "\0",
    "\u{1a}",
    "é",
    "0 0 0 0 0 0\n",
    "9999999999999999999999999999999999999999 ",
];

const NUMBERS: &[&str] = &[
    "0", "90", "-90", "180", "89.9999", "-0", "1e12", "-1e12", "1e-300", "1e-40", "3e38", ".5", "1e9",
    "360000.5", "7",
];

/// Kind, place, argument, second place.
type Edit = (u8, u16, u8, u16);

#[test]
fn fixtures_changed_at_random() {
    let seeds: Vec<Vec<u8>> = fixture_names().iter().map(|name| fixture(name)).collect();
    bolero::check!().with_type::<(u8, u8, Vec<Edit>)>().for_each(|(seed, flags, edits)| {
        let mut text = seeds[usize::from(*seed) % seeds.len()].clone();
        for edit in edits.iter().take(1 + usize::from(*flags >> 4) % 4) {
            apply(&mut text, *edit, &seeds);
        }
        TRIED.fetch_add(1, Ordering::Relaxed);
        let readable = check(&text, *flags);
        READABLE.fetch_add(usize::from(readable), Ordering::Relaxed);
    });
    let (tried, readable) = (TRIED.load(Ordering::Relaxed), READABLE.load(Ordering::Relaxed));
    println!("{tried} texts, {readable} of them readable");
    // A mutator that breaks everything would test the writer not at all.
    assert!(readable * 20 > tried);
}

#[test]
fn bytes_at_random() {
    bolero::check!().for_each(|bytes: &[u8]| {
        check(bytes, 0);
        // Behind a sound skeleton the bytes are rows.
        let mut text =
            b"HIERARCHY\nROOT a{OFFSET 0 0 0 CHANNELS 3 Xrotation Yrotation Zposition}MOTION\n".to_vec();
        text.extend_from_slice(bytes);
        check(&text, 1);
    });
}

fn apply(text: &mut Vec<u8>, (kind, place, argument, other): Edit, seeds: &[Vec<u8>]) {
    let place = usize::from(place) % (text.len() + 1);
    let end = (place + usize::from(argument) % 32).min(text.len());
    let other = usize::from(other);
    match kind % 32 {
        0 | 1 => text.insert(place, argument),
        2..=7 => {
            let word = WORDS[other % WORDS.len()];
            text.splice(place..place, word.bytes());
        }
        8 | 9 => {
            let word = WORDS[other % WORDS.len()];
            let end = place + text[place..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
            text.splice(place..end, word.bytes());
        }
        10 | 11 => drop(text.drain(place..end)),
        12 | 13 => {
            let copy: Vec<u8> = text[place..end].to_vec();
            let to = other % (text.len() + 1);
            text.splice(to..to, copy);
        }
        14 => {
            let source = &seeds[usize::from(argument) % seeds.len()];
            let from = other % (source.len() + 1);
            text.truncate(place);
            text.extend_from_slice(&source[from..]);
        }
        15 => text.truncate(place),
        // Most changes keep the text readable: another digit, or a whole number for another.
        16..=24 => {
            if let Some(digit) = text.iter_mut().skip(place).find(|byte| byte.is_ascii_digit()) {
                *digit = b'0' + argument % 10;
            }
        }
        _ => {
            let number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
            let start = place + text[place..].iter().take_while(|byte| !number(byte)).count();
            let end = start + text[start..].iter().take_while(|byte| number(byte)).count();
            text.splice(start..end, NUMBERS[other % NUMBERS.len()].bytes());
        }
    }
}

/// Reading does not panic; what was read can be written, and what was written can be read and is the same motion. Whether it
/// could be read.
fn check(text: &[u8], flags: u8) -> bool {
    let options = ImportOptions {
        metres_per_unit: (flags & 1 != 0).then_some(1.0),
        up: (flags & 2 != 0).then_some(UpAxis::Z),
        frame_rate: (flags & 4 != 0).then_some(24.0),
        skeleton: None,
        clip: None,
        limits: Limits { joints: 200, ..Limits::default() },
    };
    let first = match read_bvh(text, &options) {
        Ok(first) => first,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let export = if flags & 8 != 0 { ExportOptions::default() } else { ExportOptions::like(&first.source) };
    let written = match write_bvh(&first.clip, &export) {
        Ok(written) => written,
        // The default unit is another than the file's: numbers may grow out of range.
        Err(FormatError::Write { .. }) if flags & 8 != 0 => return true,
        Err(error) => panic!("{error}"),
    };
    let options = ImportOptions {
        metres_per_unit: Some(export.metres_per_unit),
        up: Some(export.up),
        ..Default::default()
    };
    let second = read_bvh(&written.bytes, &options).unwrap();
    assert_eq!(first.clip.frames(), second.clip.frames());
    assert_eq!(first.clip.skeleton().len(), second.clip.skeleton().len());
    if flags & 8 == 0 {
        assert_eq!(first.source.channels, second.source.channels);
    }
    assert!(Difference::of_rotations(&first.clip, &second.clip) < 0.01);
    true
}
