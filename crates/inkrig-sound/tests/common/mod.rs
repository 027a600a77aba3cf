//! What the suites share: signals, fixtures, files built by hand.
#![allow(dead_code, reason = "each suite uses its part")]

pub(crate) mod signals;

use inkrig_sound::Sound;
use std::path::{Path, PathBuf};

/// The extensions of the encoded melody.
pub(crate) const ENCODED: [&str; 4] = ["wav", "flac", "ogg", "mp3"];

/// The bytes of a fixture.
pub(crate) fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)).unwrap()
}

/// The cases of a JSON fixture.
pub(crate) fn cases(name: &str) -> Vec<serde_json::Value> {
    let json: serde_json::Value = serde_json::from_slice(&fixture(name)).unwrap();
    json["cases"].as_array().unwrap().clone()
}

/// The sound that a case names.
pub(crate) fn sound_of(case: &serde_json::Value) -> Sound {
    let (samples, rate) = (case["samples"].as_u64().unwrap(), case["rate"].as_u64().unwrap());
    let samples = signals::by_name(case["signal"].as_str().unwrap(), samples as usize, rate as f64);
    Sound::new(samples, rate as u32).unwrap()
}

/// Numbers of a JSON list.
pub(crate) fn numbers(list: &serde_json::Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Largest and root-mean-square difference; the lengths must agree.
pub(crate) fn difference(ours: impl IntoIterator<Item = f32>, theirs: &[f64]) -> (f64, f64) {
    let ours: Vec<f32> = ours.into_iter().collect();
    assert_eq!(ours.len(), theirs.len(), "lengths");
    let apart: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| (f64::from(*a) - b).abs()).collect();
    let square: f64 = apart.iter().map(|apart| apart * apart).sum();
    (apart.iter().copied().fold(0.0, f64::max), (square / apart.len() as f64).sqrt())
}

/// A FLAC file of blocks of 16384 equal samples, a dozen bytes each, that announces a number of samples.
pub(crate) fn still_flac(rate: u32, blocks: u32, announced: u64) -> Vec<u8> {
    let mut file = b"fLaC\x80\0\0\x22\x40\0\x40\0".to_vec();
    file.extend([0; 6]);
    // Rate in 20 bits, channels less one in 3, bits less one in 5, samples in 36.
    let described = u64::from(rate) << 44 | 15 << 36 | announced;
    file.extend(described.to_be_bytes());
    file.extend([0; 16]);
    for block in 0..block_numbers(blocks) {
        let mut frame = vec![0xff, 0xf8, 0xe0, 0x00];
        let mut number = [0; 4];
        frame.extend(char::from_u32(block).unwrap().encode_utf8(&mut number).as_bytes());
        frame.push(crc(&frame, 8, 0x07) as u8);
        // A subframe of one value, 1000.
        frame.extend([0x00, 0x03, 0xe8]);
        let sum = crc(&frame, 16, 0x8005);
        frame.extend((sum as u16).to_be_bytes());
        file.extend(frame);
    }
    file
}

/// Numbers below the gap in what UTF-8 can say.
fn block_numbers(blocks: u32) -> u32 {
    assert!(blocks < 0xd800);
    blocks
}

/// The remainder of bytes over a polynomial of 8 or 16 bits.
fn crc(bytes: &[u8], bits: u32, polynomial: u32) -> u32 {
    let top = 1 << (bits - 1);
    bytes.iter().fold(0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte) << (bits - 8), |sum, _| {
            let next = sum << 1 & ((1 << bits) - 1);
            if sum & top > 0 { next ^ polynomial } else { next }
        })
    })
}

/// A WAV file. `tag` is 1 for PCM and 3 for float.
pub(crate) fn wav(tag: u16, channels: u16, rate: u32, bits: u16, data: &[u8]) -> Vec<u8> {
    let mut file = b"RIFF".to_vec();
    file.extend((36 + data.len() as u32).to_le_bytes());
    file.extend(b"WAVEfmt \x10\0\0\0");
    file.extend(tag.to_le_bytes());
    file.extend(channels.to_le_bytes());
    file.extend(rate.to_le_bytes());
    let block = channels.wrapping_mul(bits / 8);
    file.extend(rate.wrapping_mul(u32::from(block)).to_le_bytes());
    file.extend(block.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(b"data");
    file.extend((data.len() as u32).to_le_bytes());
    file.extend(data);
    file
}

/// Gives every page of an Ogg file its right checksum, as far as its pages can be walked.
pub(crate) fn seal_ogg(bytes: &mut [u8]) {
    let mut start = 0;
    while bytes.len() >= start + 27 && bytes[start..].starts_with(b"OggS") {
        let lacing = start + 27..start + 27 + usize::from(bytes[start + 26]);
        let Some(lengths) = bytes.get(lacing.clone()) else { return };
        let end = lacing.end + lengths.iter().map(|length| usize::from(*length)).sum::<usize>();
        let Some(page) = bytes.get_mut(start..end) else { return };
        page[22..26].fill(0);
        let mut sum = 0_u32;
        for byte in page.iter() {
            sum ^= u32::from(*byte) << 24;
            for _ in 0..8 {
                sum = if sum >> 31 == 1 { sum << 1 ^ 0x04c1_1db7 } else { sum << 1 };
            }
        }
        page[22..26].copy_from_slice(&sum.to_le_bytes());
        start = end;
    }
}

/// The sounds of the reference folder, sorted; `None`, with a line that says so, when there is no such folder.
pub(crate) fn reference_sounds() -> Option<Vec<PathBuf>> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or(default, PathBuf::from).join("data/audio");
    if !folder.is_dir() {
        assert!(std::env::var("CI").is_err(), "no reference sounds in {}", folder.display());
        println!("skipped: no reference sounds in {} (set INKRIG_REFERENCE)", folder.display());
        return None;
    }
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "flac"));
    files.sort();
    Some(files)
}
