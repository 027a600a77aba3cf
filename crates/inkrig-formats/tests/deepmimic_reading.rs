//! DeepMimic: rows become poses, and what does not belong together is said.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "a test may panic, and prints"
)]

mod common;

use inkrig_formats::{FormatError, Import, ImportOptions, read_deepmimic};
use inkrig_motion::glam::Vec3;
use inkrig_motion::kinematics;

const CHARACTER: &str = r#"{"Skeleton": {"Joints": [
{"ID": 0, "Name": "root", "Type": "none", "Parent": -1, "AttachX": 0, "AttachY": 50, "AttachZ": 0},
{"ID": 1, "Name": "hip", "Type": "spherical", "Parent": 0, "AttachX": 0, "AttachY": 0, "AttachZ": 0.1},
{"ID": 2, "Name": "knee", "Type": "revolute", "Parent": 1, "AttachX": 0, "AttachY": -0.4, "AttachZ": 0},
{"ID": 3, "Name": "foot", "Type": "fixed", "Parent": 2, "AttachX": 0, "AttachY": -0.4, "AttachZ": 0}]},
"BodyDefs": [{"ID": 3, "Shape": "box", "AttachX": 0.05, "AttachY": 0, "AttachZ": 0, "Param0": 0.2, "Param1": 0.05, "Param2": 0.1}]}"#;

const STILL: &str = "0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0";

fn motion(rows: &[&str]) -> String {
    format!(
        r#"{{"Loop": "wrap", "Frames": [{}]}}"#,
        rows.iter().map(|row| format!("[{row}]")).collect::<Vec<_>>().join(",")
    )
}

fn read(character: &str, motion: &str) -> Result<Import, FormatError> {
    let skeleton = Some(character.as_bytes().to_vec());
    read_deepmimic(motion.as_bytes(), &ImportOptions { skeleton, ..ImportOptions::default() })
}

#[test]
fn rows_become_poses() {
    // Knee bent by 90 degrees about z: the shin points to x.
    let bent = format!("0.0, {}", STILL.trim_end_matches('0')) + "1.5707963267948966";
    let import = read(CHARACTER, &motion(&[&format!("0.05, {STILL}"), &bent])).unwrap();
    let names: Vec<&str> = import.clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["root", "hip", "knee", "foot", "foot_end"]);
    assert_eq!((import.clip.frames(), import.source.frame_time), (2, Some(0.05)));
    assert!((import.clip.frame_rate() - 20.0).abs() < 1e-9);
    let positions = kinematics::positions(&import.clip);
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-5, "{a} is not {b}");
    near(positions.frame(0)[3], Vec3::new(0.0, 0.2, 0.1));
    near(positions.frame(0)[4], Vec3::new(0.15, 0.2, 0.1));
    near(positions.frame(1)[3], Vec3::new(0.4, 0.6, 0.1));
}

#[test]
fn frames_of_unequal_length_are_brought_to_one_rate() {
    let at = |duration: &str, x: &str| format!("{duration}, {}", STILL.replacen('0', x, 1));
    let rows = [at("0.1", "0"), at("0.2", "1"), at("0.1", "3"), at("0", "4")];
    let import = read(CHARACTER, &motion(&rows.iter().map(String::as_str).collect::<Vec<_>>())).unwrap();
    let x: Vec<f32> = import.clip.track(0).unwrap().iter().map(|place| place.x).collect();
    assert_eq!(x.len(), 5);
    x.iter().zip([0.0, 1.0, 2.0, 3.0, 4.0]).for_each(|(a, b)| assert!((a - b).abs() < 1e-4, "{x:?}"));
    assert!(import.findings.iter().any(|finding| finding.code == "deepmimic-duration"));
}

#[test]
fn what_is_broken_is_said() {
    let good = motion(&[&format!("0.05, {STILL}")]);
    let cases = [
        (
            CHARACTER.to_string(),
            good.replace("0.05, ", ""),
            "deepmimic-width",
            "has 12 numbers, the character needs 13",
        ),
        (CHARACTER.replace("\"fixed\"", "\"elastic\""), good.clone(), "deepmimic-type", "`elastic`"),
        (
            CHARACTER.replace("\"Parent\": 2", "\"Parent\": 3"),
            good.clone(),
            "deepmimic-parent",
            "joint `foot`",
        ),
        (
            CHARACTER.to_string(),
            good.replace("1, 0, 0, 0, 1, 0", "0, 0, 0, 0, 1, 0"),
            "deepmimic-rotation",
            "zero length",
        ),
        (CHARACTER.to_string(), good.replace("Frames", "Frame"), "deepmimic-json", "Frames"),
        (CHARACTER.to_string(), motion(&[]), "deepmimic-no-frames", "no frames"),
        (
            CHARACTER.to_string(),
            motion(&[&format!("-1, {STILL}"), &format!("0, {STILL}")]),
            "deepmimic-duration",
            "-1",
        ),
        (CHARACTER.to_string(), "{\"Frames\": [[1e999]]}".into(), "deepmimic-json", "line 1"),
        ("[]".into(), good.clone(), "deepmimic-json", "character file"),
    ];
    for (character, motion, code, words) in cases {
        let error = read(&character, &motion).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
        assert!(error.to_string().contains(words), "{error} does not say {words}");
    }
    let deep = "[".repeat(100_000);
    assert_eq!(read(CHARACTER, &deep).unwrap_err().code(), "deepmimic-json");
}

#[test]
fn every_reference_file_is_read() {
    let Some(files) = common::reference_files("txt") else { return };
    let motions: Vec<_> =
        files.iter().filter(|path| path.parent().is_some_and(|folder| folder.ends_with("motions"))).collect();
    for path in &motions {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let character =
            path.parent().unwrap().parent().unwrap().join(format!("{}.txt", name.split('_').next().unwrap()));
        let skeleton = Some(std::fs::read(character).unwrap());
        let import = read_deepmimic(
            &std::fs::read(path).unwrap(),
            &ImportOptions { skeleton, ..ImportOptions::default() },
        )
        .unwrap_or_else(|error| panic!("{name}: {error}"));
        let positions = kinematics::positions(&import.clip);
        let lowest =
            (0..import.clip.frames()).flat_map(|frame| positions.frame(frame).iter().map(|place| place.y));
        let lowest = lowest.fold(f32::INFINITY, f32::min);
        println!(
            "{name}: {} frames at {:.2} a second, lowest {lowest:.3} m",
            import.clip.frames(),
            import.clip.frame_rate()
        );
        assert!(lowest.abs() < 0.15, "{name}: the lowest joint is at {lowest} m");
    }
    assert_eq!(motions.len(), 24);
}
