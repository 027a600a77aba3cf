//! Music and speech as control, on real dances and gestures.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{AlignError, Control, ControlKind, Report, SoundOptions};
use inkrig_sound::Sound;
use support::{assert_gates, follow, motion, sample, sound};

/// Of eight to eleven seconds.
const LOOPS: [&str; 3] = ["garzul", "safari", "tabla"];

const DANCES: [&str; 10] = [
    "salsa/01",
    "salsa/03",
    "salsa/05",
    "salsa/07",
    "salsa/04",
    "salsa/11",
    "indian/04",
    "indian/07",
    "indian/13",
    "indian/14",
];

#[test]
fn every_loop_is_danced_to() {
    let (mut structure, mut before, mut count) = (0.0, 0.0, 0.0);
    for dance in DANCES {
        let Some(clip) = motion(&format!("cmu-dance/{dance}.bvh"), 20.0) else { return };
        for music in LOOPS {
            let Some(sound) = sound(&format!("audio/loop_{music}.flac")) else { return };
            let name = format!("{music} on {dance}");
            let report =
                follow(&name, &clip, &Control::from_sound(&sound, &SoundOptions::default()).unwrap()).report;
            assert_gates(&name, ControlKind::Sound, 0.75, &report);
            let fit = report.sound.unwrap();
            structure += report.structure_pearson;
            before += fit.structure_pearson_unsmoothed;
            count += 1.0;
            assert!(
                fit.loudness_correlation.abs() <= 1.0 && fit.loudness_lag.abs() <= 0.25,
                "{name}: {fit:?}"
            );
            assert!((0.0..=1.0).contains(&fit.beat_alignment), "{name}: {fit:?}");
        }
    }
    println!("mean structure {:.3}, before smoothing {:.3}", structure / count, before / count);
    assert!(structure / count >= 0.82 && before / count >= 0.45);
}

#[test]
fn a_bar_of_two_seconds_is_followed_when_it_goes_on() {
    let (mut once, mut often, mut count) = (0.0, 0.0, 0.0);
    for dance in ["salsa/01", "salsa/05", "indian/04"] {
        let Some(clip) = motion(&format!("cmu-dance/{dance}.bvh"), 20.0) else { return };
        for music in ["amen", "breakbeat"] {
            let Some(sound) = sound(&format!("audio/loop_{music}.flac")) else { return };
            let played = |times| {
                let options = SoundOptions { times, ..SoundOptions::default() };
                let name = format!("{music} {times} times on {dance}");
                follow(&name, &clip, &Control::from_sound(&sound, &options).unwrap()).report
            };
            let (single, repeated) = (played(1), played(3));
            assert_gates(&format!("{music} three times on {dance}"), ControlKind::Sound, 0.8, &repeated);
            let hint = |report: &Report| report.notes.iter().any(|note| note.contains("--repeat"));
            assert_eq!(hint(&single), single.structure_pearson < 0.75, "{:?}", single.notes);
            assert!(!hint(&repeated));
            once += single.structure_pearson;
            often += repeated.structure_pearson;
            count += 1.0;
        }
    }
    println!("mean structure once {:.2}, three times {:.2}", once / count, often / count);
    assert!(often / count > once / count + 0.1);
}

#[test]
fn smoothing_is_what_lets_a_body_follow() {
    let Some(clip) = motion("cmu-dance/salsa/01.bvh", 20.0) else { return };
    let Some(sound) = sound("audio/loop_tabla.flac") else { return };
    let with = |smooth| {
        let control =
            Control::from_sound(&sound, &SoundOptions { smooth, ..SoundOptions::default() }).unwrap();
        follow(&format!("smoothed by {smooth}"), &clip, &control).report
    };
    let (plain, usual) = (with(0.0), with(2.7));
    assert!(usual.structure_pearson > plain.structure_pearson + 0.15);
    let unsmoothed = plain.sound.unwrap().structure_pearson_unsmoothed;
    assert!((unsmoothed - plain.structure_pearson).abs() < 1e-6, "without smoothing they are the same");
}

#[test]
fn a_sound_that_is_silent_too_long_or_too_short_is_said() {
    let says = |seconds: f64, level: f32, rate: u32| {
        let samples = (seconds * f64::from(rate)) as usize;
        let tone = (0..samples).map(|i| level * (i as f32 * 0.3).sin() * (i as f32 * 1e-4).cos()).collect();
        Control::from_sound(&Sound::new(tone, rate).unwrap(), &SoundOptions::default())
    };
    assert!(says(2.0, 0.0, 22_050).unwrap_err().to_string().contains("silent throughout"));
    // Two hours at the lowest rate that can be analysed: refused before anything is computed of it.
    let long = says(7200.0, 0.1, 1000).unwrap_err().to_string();
    assert!(long.contains("7200 s long") && long.contains("cut it"), "{long}");
    let short = says(0.2, 0.5, 22_050).unwrap();
    let error = inkrig_align::align(&sample("person").into(), &short, &Default::default(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    assert!(matches!(error, Err(AlignError::ControlTooShort { .. })));
    let loud = says(2.0, 0.5, 22_050).unwrap();
    assert_eq!(loud.heard.unwrap().loudness.len(), loud.features.frames());
}

/// Synthetic speech, made where the test runs; `None`, said in one line, where espeak-ng is not installed.
fn speech(text: &str) -> Option<Sound> {
    let file = std::env::temp_dir().join(format!("inkrig-speech-{}-{}.wav", std::process::id(), text.len()));
    let spoken =
        std::process::Command::new("espeak-ng").args(["-s", "140", "-w"]).arg(&file).arg(text).status();
    match spoken {
        Ok(status) if status.success() => {
            let bytes = std::fs::read(&file).unwrap();
            std::fs::remove_file(&file).unwrap();
            Some(inkrig_sound::decode(&bytes, "wav").unwrap().sound)
        }
        other => {
            assert_ne!(
                std::env::var("CI").as_deref(),
                Ok("true"),
                "espeak-ng: {other:?}; cargo xtask setup --system"
            );
            println!("skipped: espeak-ng is not installed (cargo xtask setup --system installs it)");
            None
        }
    }
}

#[test]
fn speech_moves_a_gesturing_person() {
    let texts = [
        "Good evening, and welcome. Tonight we look at how people move their hands when they speak. Some of them point, \
         some of them wave, and some stand quite still until they have something important to say.",
        "Stop! You there, on the left: wait. Now go, go, go. Thank you. And you, slowly, come to me. Stop.",
    ];
    // A person who directs traffic and waves.
    let Some(clip) = motion("cmu/13/13_26.bvh", 20.0) else { return };
    for text in texts {
        let Some(sound) = speech(text) else { return };
        let name = format!("speech of {:.1} s on gestures", sound.seconds());
        let report =
            follow(&name, &clip, &Control::from_sound(&sound, &SoundOptions::default()).unwrap()).report;
        assert_gates(&name, ControlKind::Sound, 0.75, &report);
    }
}
