//! The stored samples: they are what the code makes, and they read cleanly.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use inkrig_formats::{Import, ImportOptions, Severity, read_bvh};
use inkrig_motion::{glam::Quat, kinematics};
use inkrig_samples::{Sample, curves, find, make, motions, storyboards};
use inkrig_sketch::storyboard::{Storyboard, read_storyboard};
use inkrig_sketch::{Curve, Format, read_curve};
use std::path::Path;

/// Of the body's size, of a radian, of the curve's unit.
const TOLERANCE: f64 = 1e-5;

fn import(bytes: &[u8]) -> Import {
    read_bvh(bytes, &ImportOptions::default()).unwrap()
}

fn curve(sample: &Sample, bytes: &[u8]) -> Curve {
    read_curve(bytes, Format::from_path(Path::new(sample.file_name)).unwrap()).unwrap()
}

/// Angle between two rotations, exact for small ones.
fn angle(a: Quat, b: Quat) -> f64 {
    let turn = (a.as_dquat().inverse() * b.as_dquat()).normalize();
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}

/// The largest difference of two imports: place over body size, rotation in radians.
fn difference(a: &Import, b: &Import) -> f64 {
    let (a, b) = (&a.clip, &b.clip);
    let names = |clip: &inkrig_motion::Clip| -> Vec<String> {
        clip.skeleton().joints().iter().map(|joint| joint.name.clone()).collect()
    };
    assert_eq!(names(a), names(b));
    assert_eq!((a.frames(), a.frame_rate()), (b.frames(), b.frame_rate()));
    let size = f64::from(a.skeleton().extent());
    let (places, others) = (kinematics::positions(a), kinematics::positions(b));
    let mut worst = 0.0_f64;
    for frame in 0..a.frames() {
        for (x, y) in places.frame(frame).iter().zip(others.frame(frame)) {
            worst = worst.max(x.as_dvec3().distance(y.as_dvec3()) / size);
        }
        for (x, y) in a.rotations(frame).iter().zip(b.rotations(frame)) {
            worst = worst.max(angle(*x, *y));
        }
    }
    worst
}

fn curve_difference(a: &Curve, b: &Curve) -> f64 {
    assert_eq!((a.point_count(), a.stroke_count()), (b.point_count(), b.stroke_count()));
    assert_eq!(a.seconds().is_some(), b.seconds().is_some());
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let places = a.points().iter().zip(b.points()).map(|(a, b)| apart(a, b));
    let times = a.seconds().unwrap_or_default().iter().zip(b.seconds().unwrap_or_default());
    places.chain(times.map(|(a, b)| (a - b).abs())).fold(0.0, f64::max)
}

/// The largest difference of places, in thousandths of a canvas unit, which is what a drawing is rounded to a tenth of.
fn board_difference(a: &[u8], b: &[u8]) -> f64 {
    let [a, b] = [a, b].map(|bytes| read_storyboard(bytes).unwrap());
    let words = |board: &Storyboard| board.frames.iter().map(|frame| frame.word.clone()).collect::<Vec<_>>();
    assert_eq!(words(&a), words(&b));
    let points = |board: &Storyboard| -> Vec<[f64; 2]> {
        let strokes = board.frames.iter().flat_map(|frame| frame.strokes().chain(&frame.scene));
        strokes.flat_map(|stroke| stroke.points.clone()).collect()
    };
    let (a, b) = (points(&a), points(&b));
    assert_eq!(a.len(), b.len());
    // A number that lies between two tenths may be rounded to either.
    let apart = |a: &[f64; 2], b: &[f64; 2]| ((a[0] - b[0]).hypot(a[1] - b[1]) - 0.15).max(0.0);
    a.iter().zip(&b).map(|(a, b)| apart(a, b)).fold(0.0, f64::max)
}

#[test]
fn the_stored_files_are_what_the_code_makes() {
    let made = make::make_all().unwrap();
    assert_eq!(made.len(), motions().len() + curves().len() + 2 * storyboards().len());
    for (path, bytes) in &made {
        let (folder, file) = path.split_once('/').unwrap();
        if file.ends_with(".svg") && folder == "storyboards" {
            let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
            let stored = std::fs::read_to_string(stored).unwrap();
            assert_eq!(stored.lines().count(), String::from_utf8_lossy(bytes).lines().count(), "{path}");
            continue;
        }
        let sample = find(file).unwrap();
        let apart = match folder {
            "storyboards" => board_difference(sample.bytes, bytes),
            "motions" => difference(&import(sample.bytes), &import(bytes)),
            _ => curve_difference(&curve(sample, sample.bytes), &curve(sample, bytes)),
        };
        assert!(
            apart < TOLERANCE,
            "{path} differs by {apart:.1e}: run `cargo xtask samples` and look at what changed"
        );
    }
}

#[test]
fn a_changed_file_is_noticed() {
    let sample = find("person").unwrap();
    let text = std::str::from_utf8(sample.bytes).unwrap();
    // A thigh that is a tenth of a millimetre longer.
    let offset = text.lines().find(|line| line.contains("OFFSET 0 -4")).unwrap();
    let changed = text.replacen(offset, &offset.replace("OFFSET 0 -4", "OFFSET 0.01 -4"), 1);
    assert!(difference(&import(text.as_bytes()), &import(changed.as_bytes())) > TOLERANCE);
}

#[test]
fn motions_read_without_warnings_in_metres() {
    for (name, seconds, metres) in [("person", 24.0, 1.72), ("quadruped", 15.0, 1.7), ("snake", 11.0, 1.95)] {
        let sample = find(name).unwrap();
        let import = import(sample.bytes);
        let warnings: Vec<String> = (import.findings.iter())
            .filter(|finding| finding.severity != Severity::Info)
            .map(ToString::to_string)
            .collect();
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
        assert_eq!(import.source.metres_per_unit, 0.01, "{name}");
        assert!((import.clip.frame_rate() - 30.0).abs() < 1e-3, "{name}: {}", import.clip.frame_rate());
        assert!((import.clip.duration() - seconds).abs() < 1e-3, "{name}: {}", import.clip.duration());
        let extent = import.clip.skeleton().extent();
        assert!((extent - metres).abs() < 0.05, "{name}: {extent} m");
        assert_eq!(inkrig_motion::lead_in::rest_pose_frames(&import.clip), 0, "{name}");
        assert!(sample.bytes.len() < 1_500_000, "{name}: {} bytes", sample.bytes.len());
    }
}

#[test]
fn curves_read_and_have_what_their_description_says() {
    let read = |name: &str| {
        let sample = find(name).unwrap();
        curve(sample, sample.bytes)
    };
    assert_eq!(read("spiral").point_count(), 300);
    assert_eq!(read("eight").point_count(), 300);
    assert!(read("eight").is_closed() && read("heart").is_closed());
    assert!((read("heart").duration().unwrap() - 6.0).abs() < 1e-3);
    // The wave's last crest is several times higher than its first.
    let wave = read("wave");
    let bounds = wave.bounds();
    let middle = 0.5 * (bounds.min[1] + bounds.max[1]);
    let high = |from: f64, to: f64| {
        let at = |part: f64| bounds.min[0] + part * (bounds.max[0] - bounds.min[0]);
        let near = wave.points().iter().filter(|point| point[0] >= at(from) && point[0] <= at(to));
        near.map(|point| (point[1] - middle).abs()).fold(0.0, f64::max)
    };
    assert!(high(0.83, 1.0) > 3.0 * high(0.0, 0.16));
}

#[test]
fn names_are_unique_and_found() {
    let all: Vec<&Sample> = motions().iter().chain(curves()).chain(storyboards()).collect();
    for sample in &all {
        assert_eq!(find(sample.name), Some(*sample));
        assert_eq!(find(sample.file_name), Some(*sample));
        assert!(sample.file_name.starts_with(sample.name) && !sample.description.is_empty());
    }
    assert_eq!(find("nothing"), None);
}
