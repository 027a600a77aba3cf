//! Waves, labels and other motions as control, on real clips: the gates of every kind with the presets as they are.
//! Sounds have a suite of their own.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{Alignment, Control, ControlKind, CurveOptions, Options};
use inkrig_motion::Clip;
use inkrig_sketch::{Format, shapes};
use support::{assert_gates, follow, follow_with, motion, sample};

const WALK: &str = "cmu/35/35_05.bvh";
const STROLL: &str = "cmu/35/35_29.bvh";
const SALSA: &str = "cmu-dance/salsa/01.bvh";
const MARTIAL: &str = "cmu-dance/martial/08.bvh";

/// The first twenty seconds of a clip follow a control within the gates.
fn passes(path: &str, what: &str, control: &Control, least: f64) -> Option<Alignment> {
    let clip = motion(path, 20.0)?;
    let name = format!("{what} on {path}");
    let result = follow(&name, &clip, control);
    assert_gates(&name, control.kind, least, &result.report);
    Some(result)
}

fn wave(text: &str) -> Control {
    Control::from_wave(&text.parse().unwrap(), None, 30.0).unwrap()
}

fn labels(text: &str) -> Control {
    Control::from_labels(&text.parse().unwrap(), None, 30.0).unwrap()
}

fn like(clip: &Clip) -> Control {
    Control::from_motion(clip, 30.0, &Options::default().features).unwrap()
}

#[test]
fn circles_are_followed_as_the_reference_does() {
    for (path, samples, least) in [(SALSA, 300, 0.68), (STROLL, 200, 0.65)] {
        let circles = shapes::growing_circles(5, samples).unwrap();
        passes(path, "circles", &Control::from_curve(&circles, &CurveOptions::default()).unwrap(), least);
    }
}

#[test]
fn every_kind_of_wave_is_followed() {
    // A chirp from two to five periods in the length of the control is the reference's; the others have none.
    let cases = [
        (WALK, "sine(0.3Hz..0.75Hz) for 6.67s", 0.77),
        (WALK, "sine(0.5Hz..2Hz) for 10s", 0.75),
        (STROLL, "triangle(1Hz) for 8s", 0.75),
        (WALK, "square(0.5Hz) for 8s", 0.6),
        (SALSA, "square(0.5Hz) for 8s", 0.75),
        (STROLL, "ramp(0..1) for 3s; sine(1Hz) for 3s; constant(0) for 2s", 0.65),
        (SALSA, "ramp(0..1) for 3s; sine(1Hz) for 3s; constant(0) for 2s", 0.75),
        (WALK, "alternate(sine(1Hz), centres=-1|1, every=2s) for 8s", 0.6),
        ("cmu-dance/indian/04.bvh", "alternate(sine(1Hz), centres=-1|1, every=2s) for 8s", 0.75),
    ];
    for (path, text, least) in cases {
        passes(path, text, &wave(text), least);
    }
}

#[test]
fn samples_and_wav_files_are_waves_too() {
    let slow = |second: f64| (second * 3.0).sin() + 0.2 * second;
    let text: String = (0..240).map(|i| format!("{}\n", slow(f64::from(i) / 30.0))).collect();
    let table = inkrig_sketch::read_wave(text.as_bytes(), Format::Csv).unwrap();
    let samples = Control::from_table(&table, None, 30.0).unwrap();
    let by_samples = passes(STROLL, "CSV samples", &samples, 0.65);
    // The same curve as a sound of 8 kHz: slow enough to be the curve itself.
    let tone = |values: &dyn Fn(f64) -> f64| {
        let samples = (0..64_000).map(|i| values(f64::from(i) / 8000.0) as f32 * 0.3).collect();
        inkrig_sound::Sound::new(samples, 8000).unwrap()
    };
    let plain = Control::from_waveform(&tone(&slow), None, 30.0).unwrap();
    let by_wav = passes(STROLL, "WAV", &plain, 0.65);
    if let (Some(a), Some(b)) = (by_samples, by_wav) {
        let apart = a.report.structure_pearson - b.report.structure_pearson;
        assert!(apart.abs() < 0.05, "the same wave is followed alike: {apart}");
    }
    // Of something to hear it is the outline.
    let hum = tone(&|second| (second * 2000.0).sin() * (1.2 + (second * 4.0).sin()));
    let outline = Control::from_waveform(&hum, None, 30.0).unwrap();
    let row = |second: f64| outline.features.row((second * 30.0) as usize)[0];
    assert_eq!((outline.kind, outline.features.frames()), (ControlKind::Wave, 240));
    assert!(
        row(std::f64::consts::FRAC_PI_8) > row(3.0 * std::f64::consts::FRAC_PI_8) + 1.0,
        "loud above quiet"
    );
    assert_eq!(Control::from_waveform(&hum, Some(90), 30.0).unwrap().frames(30.0), 90);
}

#[test]
fn labels_become_movements_whatever_they_are_called() {
    // The first is the reference's own.
    let rows = [
        (MARTIAL, "0:75 1:75 0:75 2:75", 0.71),
        (MARTIAL, "walk:3s wave:2s walk:3s", 0.71),
        (SALSA, "A:75 B:75 A:75 C:75", 0.65),
        (SALSA, "\u{e9}t\u{e9}:3s hiver:2s \u{e9}t\u{e9}:3s", 0.65),
        ("cmu-dance/salsa/05.bvh", "A:60 B:60 C:60 A:60", 0.65),
        ("cmu-dance/indian/04.bvh", "rest:3s turn:2s rest:3s", 0.65),
    ];
    for (path, text, least) in rows {
        passes(path, text, &labels(text), least);
    }
}

#[test]
fn one_label_is_one_movement() {
    let Some(clip) = motion(SALSA, 20.0) else { return };
    let control = labels("A:75 B:75 A:75 C:75");
    let result = follow("A B A C", &clip, &control);
    // The moments that a label uses: nearer to those of the same label than to another's.
    let used = |from: usize| -> Vec<Vec<f32>> {
        let features = like(&result.clip).features;
        (from + 15..from + 60).map(|frame| features.row(frame).to_vec()).collect()
    };
    let nearest = |a: &[Vec<f32>], b: &[Vec<f32>]| -> f32 {
        let apart = |x: &[f32], y: &[f32]| x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum::<f32>().sqrt();
        a.iter().map(|x| b.iter().map(|y| apart(x, y)).fold(f32::INFINITY, f32::min)).sum::<f32>()
            / a.len() as f32
    };
    let (first, second, third, fourth) = (used(0), used(75), used(150), used(225));
    let (same, other) = (nearest(&third, &first), nearest(&third, &second).min(nearest(&third, &fourth)));
    println!("A is {same:.2} from A, {other:.2} from B and C");
    assert!(same < 0.7 * other);
}

#[test]
fn a_motion_follows_another_skeletons_motion() {
    let cases = [(WALK, SALSA, 0.6), ("cmu-dance/salsa/05.bvh", MARTIAL, 0.68)];
    for (control, path, least) in cases {
        let Some(other) = motion(control, 20.0) else { return };
        passes(path, control, &like(&other), least);
    }
    // A person's walk on four legs, and back.
    let hound = sample("quadruped");
    for path in [WALK, STROLL] {
        let Some(walk) = motion(path, 20.0) else { return };
        let report = follow(&format!("the hound walks as {path}"), &hound, &like(&walk)).report;
        assert_gates(path, ControlKind::Motion, 0.7, &report);
        let report = follow(&format!("{path} goes as the hound"), &walk, &like(&hound)).report;
        // A clip of a few steps has no gallop in it: it is strayed from.
        let gain = report.structure_pearson - report.structure_pearson_warp;
        assert!(gain >= 0.4 && report.jump_q999_ratio <= 2.0, "{path}: {report:?}");
        assert!(report.nearest_patch <= 0.36 && report.speed_mean_ratio >= 0.45, "{path}: {report:?}");
    }
    let dance = "bandai-namco-1-noncommercial/dataset-1_dance-short_normal_001.bvh";
    let Some(other) = motion(dance, 20.0) else { return };
    passes(SALSA, dance, &like(&other), 0.7);
}

#[test]
fn a_control_must_have_samples_enough_and_numbers_in_them() {
    let clip = sample("person");
    let says = |text: &str| inkrig_sketch::read_wave(text.as_bytes(), Format::Csv).unwrap_err().to_string();
    assert!(!says("").is_empty());
    assert!(says("1\nNaN\n2\n").to_lowercase().contains("nan"), "{}", says("1\nNaN\n2\n"));
    let table = inkrig_sketch::read_wave(b"1\n2\n", Format::Csv).unwrap();
    let control = Control::from_table(&table, None, 30.0).unwrap();
    let error = inkrig_align::align(&clip.clone().into(), &control, &Options::default(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    assert!(error.unwrap_err().to_string().contains("--length"));
    let control = inkrig_motion::Features::new(vec![0.0, f32::NAN], 1);
    assert!(control.unwrap_err().to_string().contains("not a"));
    // Every norm of either side is a choice, and none of them breaks.
    let circles =
        Control::from_curve(&shapes::growing_circles(3, 150).unwrap(), &CurveOptions::default()).unwrap();
    for norm in [inkrig_align::Norm::Quantile, inkrig_align::Norm::Learned, inkrig_align::Norm::Max] {
        let options = Options { control_norm: norm, ..Options::default() };
        let report = follow_with(&format!("{norm:?} of the control only"), &clip, &circles, &options).report;
        assert!(report.structure_pearson > 0.3 && report.jump_q999_ratio < 3.0, "{report:?}");
    }
}
