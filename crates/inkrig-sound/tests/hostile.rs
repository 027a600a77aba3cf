//! Files that are cut, empty, damaged or meant to do harm.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{ENCODED, fixture, signals, wav};
use inkrig_sound::{Decoded, SoundError, SoundFormat, decode};

fn codes(decoded: &Decoded) -> Vec<&str> {
    decoded.findings.iter().map(|finding| finding.code).collect()
}

#[test]
fn nothing_is_an_error_of_its_own() {
    assert_eq!(decode(&[], "wav"), Err(SoundError::EmptyFile));
}

#[test]
fn other_bytes_are_no_sound() {
    for (bytes, extension) in
        [(&b"x,y\n1,2\n"[..], "wav"), (&[0; 1000], "flac"), (b"\x89PNG\r\n\x1a\n", "ogg"), (b"RIFF", "wav")]
    {
        let error = decode(bytes, extension).unwrap_err();
        assert!(matches!(error, SoundError::UnknownFormat { .. }), "{error}");
    }
    // With the name of an MP3, frames are looked for, and are not there.
    for bytes in [&b"x,y\n1,2\n"[..], &[0; 1000], &[0xff; 1000]] {
        assert!(matches!(decode(bytes, "mp3"), Err(SoundError::Damaged { format: SoundFormat::Mp3, .. })));
    }
}

#[test]
fn a_wrong_extension_is_said_and_read() {
    for content in ENCODED {
        for name in ENCODED {
            let decoded = decode(&fixture(&format!("melody.{content}")), name).unwrap();
            let expected: &[&str] = if content == name { &[] } else { &["sound-extension"] };
            assert_eq!(codes(&decoded), expected, "{content} called {name}");
        }
    }
}

#[test]
fn a_cut_file_gives_what_is_there_and_says_so() {
    for extension in ENCODED {
        let bytes = fixture(&format!("melody.{extension}"));
        let whole = decode(&bytes, extension).unwrap().sound;
        // Most of this Ogg are its headers.
        let kept = if extension == "ogg" { bytes.len() - 300 } else { bytes.len() * 3 / 4 };
        let decoded = decode(&bytes[..kept], extension).unwrap();
        let samples = decoded.sound.samples();
        println!(
            "{extension}: {} of {} samples, {}",
            samples.len(),
            whole.samples().len(),
            decoded.findings[0]
        );
        assert_eq!(codes(&decoded), ["sound-cut-short"], "{extension}");
        assert!(samples.len() > 3000 && samples.len() < 7900, "{extension}: {}", samples.len());
        // MP3 shares bits between frames, so its last one may differ.
        let same = samples.len() - 1152;
        assert_eq!(samples[..same], whole.samples()[..same], "{extension}");
    }
}

#[test]
fn every_shorter_file_is_read_or_refused() {
    for extension in ENCODED {
        let bytes = fixture(&format!("melody.{extension}"));
        let (mut read, mut refused) = (0, 0);
        for length in (0..bytes.len()).step_by(7) {
            match decode(&bytes[..length], extension) {
                Ok(decoded) => {
                    read += 1;
                    assert!(!decoded.findings.is_empty(), "{extension} of {length} bytes");
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.to_string().is_empty());
                }
            }
        }
        println!("{extension}: {read} read, {refused} refused");
        assert!(refused > 0);
    }
}

#[test]
fn damage_in_the_middle_keeps_the_time() {
    for extension in ENCODED {
        let mut bytes = fixture(&format!("melody.{extension}"));
        let whole = decode(&bytes, extension).unwrap().sound;
        let middle = if extension == "ogg" { bytes.len() - 500 } else { bytes.len() / 2 };
        bytes[middle..middle + 40].fill(0x55);
        let decoded = decode(&bytes, extension).unwrap();
        let samples = decoded.sound.samples();
        println!("{extension}: {} samples, {:?}", samples.len(), codes(&decoded));
        let expected: &[&str] = match extension {
            // Plain samples have no checksum, and so has MP3 by default.
            "wav" | "mp3" => &[],
            _ => &["sound-packets-lost"],
        };
        assert_eq!(codes(&decoded), expected, "{extension}");
        assert_eq!(samples.len(), 8000);
        assert_eq!(samples[7200..], whole.samples()[7200..], "{extension}");
        assert_ne!(samples, whole.samples(), "{extension}");
    }
}

#[test]
fn headers_with_absurd_numbers() {
    let data = [0_u8; 4000];
    let case = |tag, channels, rate, bits| decode(&wav(tag, channels, rate, bits, &data), "wav");
    for rate in [0, u32::MAX, 768_001] {
        assert!(matches!(case(1, 1, rate, 16), Err(SoundError::BadRate { .. })), "{rate}");
    }
    assert!(matches!(case(1, 0, 8000, 16), Err(SoundError::Damaged { .. })));
    for channels in [27, 300, 32_768, 65_535] {
        let error = case(1, channels, 8000, 16).unwrap_err();
        assert!(matches!(error, SoundError::Limit { .. }), "{channels} channels: {error}");
    }
    assert_eq!(case(1, 26, 8000, 16).unwrap().channels, 26);
    for bits in [0, 1, 7, 12, 64, 65_535] {
        assert!(case(1, 1, 8000, bits).is_err(), "{bits} bits");
    }
    assert!(matches!(case(2, 1, 8000, 4), Err(SoundError::Unsupported { .. } | SoundError::Damaged { .. })));
    assert!(case(0x55, 1, 8000, 16).is_err());

    // A length that is a lie gives what is there.
    let mut lie = fixture("melody.wav");
    lie[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    lie[40..44].copy_from_slice(&0xffff_fff0_u32.to_le_bytes());
    let decoded = decode(&lie, "wav").unwrap();
    assert_eq!(decoded.sound.samples().len(), 8000);
    assert_eq!(codes(&decoded), ["sound-cut-short"]);
    // A stream that did not know its length says so by the largest number.
    lie[40..44].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(decode(&lie, "wav").unwrap().sound.samples().len(), 8000);
}

#[test]
fn what_can_be_matched_is_the_limit() {
    // At 1 Hz 3334 s are as many samples.
    let at = |samples: usize| decode(&wav(1, 1, 1, 8, &vec![200; samples]), "wav");
    assert_eq!(at(3334).unwrap().sound.seconds(), 3334.0);
    let error = at(3335).unwrap_err();
    assert!(matches!(error, SoundError::Limit { .. }), "{error}");
}

#[test]
fn samples_that_are_none_become_silence() {
    let values = [0.5, f32::NAN, f32::INFINITY, 1e30, -0.5];
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let decoded = decode(&wav(3, 1, 8000, 32, &data), "wav").unwrap();
    assert_eq!(decoded.sound.samples(), [0.5, 0.0, 0.0, 0.0, -0.5]);
    assert_eq!(codes(&decoded), ["sound-bad-samples"]);
}

#[test]
fn silence_is_said() {
    let decoded = decode(&wav(1, 1, 8000, 16, &[0; 800]), "wav").unwrap();
    assert!(decoded.sound.is_silent());
    assert_eq!(codes(&decoded), ["sound-silent"]);
}

#[test]
fn flac_of_another_sound_than_its_checksum() {
    let mut bytes = fixture("melody.flac");
    bytes[26] ^= 1;
    assert_eq!(codes(&decode(&bytes, "flac").unwrap()), ["sound-checksum"]);
}

#[test]
fn noise_behind_a_good_header() {
    for extension in ENCODED {
        let good = fixture(&format!("melody.{extension}"));
        for seed in 0..200 {
            let kept = 4 + (seed as usize * 13) % 120;
            let noise = signals::noise(4000, seed).map(|value| (value * 128.0) as i8 as u8);
            let bytes: Vec<u8> = good[..kept].iter().copied().chain(noise).collect();
            // Read or refused; either way without a panic, and within the limits.
            if let Ok(decoded) = decode(&bytes, extension) {
                assert!(decoded.sound.samples().len() <= bytes.len() * 2048);
            }
        }
    }
}
