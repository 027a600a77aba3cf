//! What odd but readable files mean, number by number; and limits.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::{Difference, fixture};
use inkrig_formats::{
    Axis, Channel, Evidence, FormatError, Import, ImportOptions, Limits, Place, UpAxis, read_bvh,
};
use inkrig_motion::glam::{Quat, Vec3};

fn read(name: &str) -> Import {
    read_bvh(&fixture(name), &ImportOptions::default()).unwrap()
}

fn names(import: &Import) -> Vec<&str> {
    import.clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect()
}

fn turn(axis: Vec3, degrees: f32) -> Quat {
    Quat::from_axis_angle(axis, degrees.to_radians())
}

fn assert_turned(got: Quat, wanted: Quat) {
    assert!(got.dot(wanted).abs() > 1.0 - 1e-6, "{got} is not {wanted}");
}

#[test]
fn the_plain_file_is_read_number_by_number() {
    let import = read("plain");
    assert_eq!(names(&import), ["hip", "knee", "knee_end"]);
    let joints = import.clip.skeleton().joints();
    assert_eq!(joints[1].offset, Vec3::new(0.0, -0.8, 0.0));
    assert!(joints[2].end_site && !joints[1].end_site);
    assert_eq!(import.clip.frame_rate(), 1.0 / 0.0333333);
    assert_eq!(import.clip.track(0).unwrap()[1], Vec3::new(0.015, 1.6, -0.02));
    assert!(import.clip.track(1).is_none());
    let hip = turn(Vec3::Z, 10.0) * turn(Vec3::X, 20.0) * turn(Vec3::Y, 30.0);
    assert_turned(import.clip.rotations(1)[0], hip);
    assert_turned(import.clip.rotations(1)[1], turn(Vec3::X, 45.0));
    assert_eq!((import.source.metres_per_unit, import.source.unit_evidence), (0.01, Evidence::Guessed));
    assert_eq!((import.source.up, import.source.up_evidence), (UpAxis::Y, Evidence::Assumed));
    assert_eq!(import.source.channels[1], [Axis::Z, Axis::X, Axis::Y].map(Channel::Rotation));
    assert_eq!(import.source.channels[2], []);
}

#[test]
fn the_same_motion_however_the_text_is_laid_out() {
    let plain = read("plain");
    for name in [
        "crlf",
        "cr",
        "bom",
        "tabs",
        "keyword-case",
        "braces-beside-names",
        "blank-lines",
        "dos-end",
        "wrapped-rows",
        "fewer-rows",
        "more-rows",
        "huge-frame-count",
        "no-frame-count",
        "zero-frame-count",
        "large-angles",
    ] {
        let other = read(name);
        assert_eq!(plain.source, other.source, "{name}");
        let difference = Difference::between(&plain.clip, &other.clip);
        assert!(difference.position < 1e-6 && difference.degrees < 1e-4, "{name}: {difference:?}");
    }
}

#[test]
fn names_stay_as_they_are() {
    assert_eq!(names(&read("spaced-names")), ["left hip", "Bip01 L  Knee", "Bip01 L  Knee_end"]);
    assert_eq!(names(&read("duplicate-names")), ["hip", "hip", "hip_end"]);
    assert_eq!(names(&read("latin1-name")), ["hip", "kn\u{fffd}e", "kn\u{fffd}e_end"]);
    assert_eq!(names(&read("no-name")), ["hip", "", "_end"]);
    assert_eq!(names(&read("several-end-sites")), ["hip", "knee", "knee_end", "knee_end2"]);
}

#[test]
fn roots_stand_side_by_side() {
    let import = read("two-roots");
    assert_eq!(import.clip.skeleton().roots().collect::<Vec<_>>(), [0, 3]);
    assert_eq!(import.clip.track(3).unwrap()[1], Vec3::new(0.6, 0.0, 0.0));
    assert_turned(import.clip.rotations(1)[4], turn(Vec3::Y, 90.0));
}

#[test]
fn positions_take_the_place_of_offsets() {
    let import = read("positions-on-every-joint");
    assert_eq!(import.clip.track(1).unwrap()[1], Vec3::new(0.0, -0.9, 0.05));
    let import = read("some-positions");
    assert_eq!(import.clip.track(0).unwrap()[1], Vec3::new(0.07, 1.5, 0.09));
}

#[test]
fn channels_come_in_any_order_and_number() {
    let import = read("positions-after-rotations");
    assert_eq!(import.clip.track(0).unwrap()[0], Vec3::new(0.015, 1.6, -0.02));
    let hip = turn(Vec3::Y, 30.0) * turn(Vec3::X, 20.0) * turn(Vec3::Z, 10.0);
    assert_turned(import.clip.rotations(0)[0], hip);
    assert_turned(read("few-rotations").clip.rotations(1)[1], turn(Vec3::X, 45.0));
    let knee = turn(Vec3::Z, 10.0) * turn(Vec3::X, 20.0) * turn(Vec3::Z, 30.0);
    assert_turned(read("repeated-axis").clip.rotations(0)[1], knee);
    let knee = turn(Vec3::Z, 30.0) * turn(Vec3::X, 30.0) * turn(Vec3::Y, 40.0) * turn(Vec3::X, 50.0);
    assert_turned(read("five-rotations").clip.rotations(0)[1], knee);
    assert_eq!(read("joint-without-channels").clip.rotations(1)[1], Quat::IDENTITY);
}

#[test]
fn the_caller_knows_better() {
    let options = ImportOptions {
        metres_per_unit: Some(0.0254),
        up: Some(UpAxis::Z),
        frame_rate: Some(24.0),
        ..Default::default()
    };
    let import = read_bvh(&fixture("plain"), &options).unwrap();
    assert_eq!((import.source.metres_per_unit, import.source.unit_evidence), (0.0254, Evidence::Given));
    assert_eq!((import.source.up, import.source.up_evidence), (UpAxis::Z, Evidence::Given));
    assert_eq!((import.clip.frame_rate(), import.source.frame_time), (24.0, Some(0.0333333)));
    assert_eq!(import.clip.skeleton().joints()[1].offset, Vec3::new(0.0, 0.0, 80.0 * 0.0254));
    assert_turned(import.clip.rotations(1)[1], turn(Vec3::X, 45.0));
    assert!(import.findings.is_empty());
    for name in ["frame-time-zero", "frame-time-missing", "frame-time-comma", "frame-time-empty"] {
        let import = read_bvh(&fixture(name), &options).unwrap();
        assert_eq!((import.clip.frame_rate(), import.source.frame_time), (24.0, None), "{name}");
    }
}

#[test]
fn limits_are_said() {
    let plain = fixture("plain");
    let default = Limits::default();
    let refuse = |bytes: &[u8], limits: Limits| {
        let options = ImportOptions { limits, ..Default::default() };
        read_bvh(bytes, &options).unwrap_err()
    };
    let message = |limits: Limits| refuse(&plain, limits).to_string();
    assert_eq!(
        message(Limits { bytes: 100, ..default }),
        format!(
            "the file has {} bytes, more than the limit of 100; cut it into shorter motions",
            plain.len()
        )
    );
    assert_eq!(
        message(Limits { joints: 2, ..default }),
        "line 10, column 3, joint `knee_end`: the skeleton has 3 joints or more, more than the limit of 2; leave some out where the file is made, \
         such as those of fingers, hair and cloth"
    );
    assert_eq!(
        message(Limits { name_bytes: 3, ..default }),
        "line 6, column 8: a joint name has 4 bytes, more than the limit of 3; give the joint a shorter name"
    );
    assert_eq!(
        message(Limits { cells: 5, ..default }),
        "line 19, column 1: 2 frames of 3 joints make 6 rotations, more than the limit of 5; cut the motion into shorter ones"
    );
    let error = refuse(&plain, Limits { joints: 2, ..default });
    assert_eq!(error.place(), Some(&Place { line: 10, column: 3, joint: Some("knee_end".into()) }));
}

#[test]
fn thousands_of_nested_joints_cost_no_stack() {
    let deep = |joints: usize| {
        let mut text = String::from("HIERARCHY\n");
        for joint in 0..joints {
            let keyword = if joint == 0 { "ROOT" } else { "JOINT" };
            text += &format!("{keyword} j{joint} {{ OFFSET 0 0.01 0 CHANNELS 1 Xrotation\n");
        }
        text += &"}".repeat(joints);
        text += "\nMOTION\nFrames: 1\nFrame Time: 0.1\n";
        text += &"1 ".repeat(joints);
        text
    };
    // A small stack shows that depth costs none of it.
    let read = |joints: usize| {
        let text = deep(joints);
        let run = move || read_bvh(text.as_bytes(), &ImportOptions::default());
        std::thread::Builder::new().stack_size(128 << 10).spawn(run).unwrap().join().unwrap()
    };
    let import = read(16_384).unwrap();
    assert_eq!(import.clip.skeleton().depths().last(), Some(&16_383));
    let error = read(16_385).unwrap_err();
    assert!(matches!(error, FormatError::Limit { limit: 16_384, .. }), "{error}");
    assert_eq!(error.place().unwrap().line, 16_386);
}

#[test]
fn rows_of_a_wide_skeleton_cannot_ask_for_more_than_their_bytes() {
    // 4000 joints, one channel, and rows of two bytes: 64 kB of memory for each.
    let mut text = String::from("HIERARCHY\nROOT a{OFFSET 0 0 0 CHANNELS 1 Xrotation ");
    text += &"JOINT b{OFFSET 0 1 0}".repeat(4000);
    text += "}\nMOTION\nFrames: 100000\nFrame Time: 0.1\n";
    text += &"0\n".repeat(100_000);
    let error = read_bvh(text.as_bytes(), &ImportOptions::default()).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains(": 100000 frames of 4001 joints make 400100000 rotations, more than"),
        "{message}"
    );
}
