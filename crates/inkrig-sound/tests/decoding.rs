//! The same second of sound in all formats, sample formats of WAV, and sounds from elsewhere.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{ENCODED, fixture, reference_sounds, signals, wav};
use inkrig_sound::{
    FRAME_RATE_HZ, LoudnessScale, MfccOptions, SoundFormat, decode, loudness, mfcc, onset_strength,
};

#[test]
fn all_formats_hold_the_same_sound() {
    let melody = signals::by_name("melody", 8000, 8000.0);
    for (extension, format) in ENCODED.into_iter().zip([
        SoundFormat::Wav,
        SoundFormat::Flac,
        SoundFormat::OggVorbis,
        SoundFormat::Mp3,
    ]) {
        let bytes = fixture(&format!("melody.{extension}"));
        assert!(bytes.len() < 20_000);
        let decoded = decode(&bytes, extension).unwrap();
        assert_eq!((decoded.format, decoded.channels), (format, 1));
        assert_eq!((decoded.findings.as_slice(), decoded.sound.rate()), (&[][..], 8000), "{extension}");
        let samples = decoded.sound.samples();
        // Encoder delay and padding are gone: every format has exactly the second that went in.
        assert_eq!(samples.len(), melody.len(), "{extension}");
        let square =
            |values: &mut dyn Iterator<Item = f32>| values.map(|v| f64::from(v).powi(2)).sum::<f64>();
        let error = square(&mut samples.iter().zip(&melody).map(|(a, b)| a - b));
        let ratio = 10.0 * (square(&mut melody.iter().copied()) / error).log10();
        println!("{extension}: {} bytes, signal over error {ratio:.1} dB", bytes.len());
        let least = if matches!(extension, "wav" | "flac") { 75.0 } else { 25.0 };
        assert!(ratio > least, "{extension}: {ratio} dB");
    }
    let samples = |extension: &str| decode(&fixture(&format!("melody.{extension}")), "").unwrap().sound;
    assert_eq!(samples("wav"), samples("flac"));
}

#[test]
fn the_formats_have_the_same_features() {
    let features = |extension: &str| {
        let sound = decode(&fixture(&format!("melody.{extension}")), extension).unwrap().sound;
        loudness(&sound, LoudnessScale::Rms).unwrap().values
    };
    let wav = features("wav");
    for extension in ENCODED {
        let other = features(extension);
        let worst = wav.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("{extension}: largest difference of loudness {worst:.1e}");
        assert!(
            wav.len() == other.len() && worst < if extension == "mp3" { 0.03 } else { 0.002 },
            "{extension}: {worst}"
        );
    }
}

#[test]
fn wav_of_every_sample_format() {
    let values = [0.0, 0.5, -0.5, -1.0, 0.25];
    let scaled = |scale: f64| values.map(|value: f64| (value * scale) as i32);
    let files = [
        wav(1, 1, 8000, 8, &values.map(|value| (value * 128.0 + 128.0) as u8)),
        wav(1, 1, 8000, 16, &scaled(32768.0).map(|value| (value as i16).to_le_bytes()).concat()),
        wav(
            1,
            1,
            8000,
            24,
            &scaled(8_388_608.0)
                .iter()
                .flat_map(|value| value.to_le_bytes()[..3].to_vec())
                .collect::<Vec<_>>(),
        ),
        wav(1, 1, 8000, 32, &values.map(|value| ((value * 2_147_483_648.0) as i32).to_le_bytes()).concat()),
        wav(3, 1, 8000, 32, &values.map(|value| (value as f32).to_le_bytes()).concat()),
        wav(3, 1, 8000, 64, &values.map(f64::to_le_bytes).concat()),
    ];
    for (index, file) in files.iter().enumerate() {
        let decoded = decode(file, "wav").unwrap();
        assert_eq!(decoded.sound.samples(), values.map(|value| value as f32), "file {index}");
        assert_eq!(decoded.findings, []);
    }
}

#[test]
fn channels_are_averaged() {
    let frames: [[f32; 3]; 2] = [[0.3, 0.6, 0.0], [-0.9, 0.0, 0.3]];
    let data: Vec<u8> = frames.concat().iter().flat_map(|value| value.to_le_bytes()).collect();
    let decoded = decode(&wav(3, 3, 48_000, 32, &data), "WAV").unwrap();
    assert_eq!(decoded.channels, 3);
    let expected = [0.3, -0.2];
    assert!(decoded.sound.samples().iter().zip(expected).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-7));
}

#[test]
fn titles_and_pictures_in_front_do_no_harm() {
    let mut tagged = b"ID3\x04\0\0\0\x0f\x7f\x7f".to_vec();
    // What looks like the beginning of a frame may be in a picture.
    tagged.extend([0xff, 0xfb, 0x90, 0x64].repeat((15 << 14 | 127 << 7 | 127) / 4 + 1));
    let size = 15 << 14 | 127 << 7 | 127;
    tagged.truncate(10 + size);
    tagged.extend(fixture("melody.mp3"));
    // The tag's size in the header has seven bits a byte.
    tagged[6..10].copy_from_slice(&[0, 15, 127, 127]);
    assert_eq!(decode(&tagged, "mp3").unwrap().sound, decode(&fixture("melody.mp3"), "mp3").unwrap().sound);
}

#[test]
fn an_mp3_that_does_not_say_its_length_is_read_to_its_end() {
    // Its first frames are much longer than the others, so that a guess from them is far too short.
    let decoded = decode(&fixture("untagged.mp3"), "mp3").unwrap();
    assert_eq!(decoded.findings, []);
    let seconds = decoded.sound.seconds();
    println!("{seconds:.3} s");
    // The encoder's own delay and padding are in it, for nothing says how long they are.
    assert!((1.0..1.1).contains(&seconds), "{seconds} s");
}

#[test]
fn reference_loops_are_read() {
    let Some(files) = reference_sounds() else { return };
    let mut names = Vec::new();
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        let decoded = decode(&bytes, "flac").unwrap();
        let sound = &decoded.sound;
        // FLAC says in its header how long it is: 20 bits of rate, 3 of channels, 5 of depth, 36 of samples.
        let header = bytes[18..26].iter().fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
        let (rate, announced) = (header >> 44, header & ((1 << 36) - 1));
        assert_eq!((u64::from(sound.rate()), sound.samples().len() as u64), (rate, announced));
        assert_eq!(decoded.findings, []);
        let mfcc = mfcc(sound, &MfccOptions::default()).unwrap();
        assert!(mfcc.values.iter().all(|value| value.is_finite()));
        let seconds = mfcc.frames as f64 / FRAME_RATE_HZ;
        assert!((seconds - sound.seconds()).abs() < 0.03, "{seconds} {}", sound.seconds());
        let onsets = onset_strength(sound).unwrap();
        assert_eq!(onsets.values.len(), mfcc.frames);
        assert!(onsets.values.iter().any(|value| *value > 5.0), "a loop has beats");
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        println!(
            "{name}: {:.3} s at {rate} Hz, {} channels, {} frames",
            sound.seconds(),
            decoded.channels,
            mfcc.frames
        );
        names.push(name);
    }
    assert_eq!(names, ["loop_amen", "loop_breakbeat", "loop_garzul", "loop_safari", "loop_tabla"]);
}
