//! USD text: what is written says what the clip is.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use inkrig_formats::{ExportOptions, UpAxis, write_usda};
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, Joint, Skeleton, TranslationTrack};
use std::sync::Arc;

fn clip() -> Clip {
    let skeleton = Skeleton::new(vec![
        Joint::new("rig:hips", None, Vec3::Y),
        Joint::new("a \"knee\"", Some(0), Vec3::new(0.0, -0.5, 0.25)),
    ]);
    let turns = vec![Quat::IDENTITY, Quat::IDENTITY, Quat::from_xyzw(0.0, 0.6, 0.0, 0.8), Quat::IDENTITY];
    let track = TranslationTrack { joint: 0, values: vec![Vec3::Y, Vec3::new(0.5, 1.0, 0.25)] };
    Clip::new(Arc::new(skeleton.unwrap()), 24.0, turns, vec![track]).unwrap()
}

#[test]
fn a_clip_becomes_a_skeleton_and_its_animation() {
    let options = ExportOptions { metres_per_unit: 1.0, ..ExportOptions::default() };
    let written = write_usda(&clip(), &options).unwrap();
    let expected = include_str!("fixtures/usda/two_joints.usda");
    assert_eq!(String::from_utf8(written.bytes).unwrap(), expected);
    assert_eq!(written.findings.len(), 1);
}

#[test]
fn units_and_axes_are_the_files() {
    let options = ExportOptions { metres_per_unit: 0.01, up: UpAxis::Z, ..ExportOptions::default() };
    let text = String::from_utf8(write_usda(&clip(), &options).unwrap().bytes).unwrap();
    for line in [
        "metersPerUnit = 0.01",
        "upAxis = \"Z\"",
        "1: [(50, -25, 100), (0, -25, -50)]",
        "1: [(0.8, 0, -0, 0.6), (1, 0, -0, 0)]",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    let clip_of =
        |rate| Clip::new(clip().skeleton().clone(), rate, clip().rotations(0).repeat(2), Vec::new()).unwrap();
    for (rate, said) in [(30.000000003, "framesPerSecond = 30\n"), (29.97, "framesPerSecond = 29.97\n")] {
        let text = String::from_utf8(write_usda(&clip_of(rate), &options).unwrap().bytes).unwrap();
        assert!(text.contains(said), "{text}");
    }
    let bad = ExportOptions { metres_per_unit: 0.0, ..ExportOptions::default() };
    assert!(write_usda(&clip(), &bad).is_err());
}
