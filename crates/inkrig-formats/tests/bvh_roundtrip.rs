//! What is written is read again as the same motion.
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
use inkrig_formats::{Axis, Channel, ExportOptions, FormatError, ImportOptions, UpAxis, read_bvh, write_bvh};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{Quat, Vec3},
};
use proptest::prelude::*;
use std::sync::Arc;

#[test]
fn readable_fixtures_survive_writing_and_are_then_stable() {
    let mut count = 0;
    for name in fixture_names() {
        let Ok(first) = read_bvh(&fixture(&name), &ImportOptions::default()) else { continue };
        count += 1;
        let written = write_bvh(&first.clip, &ExportOptions::like(&first.source)).unwrap();
        assert!(written.findings.is_empty(), "{name}: {:?}", written.findings);
        let second = read_bvh(&written.bytes, &ImportOptions::default()).unwrap();
        let difference = Difference::between(&first.clip, &second.clip);
        assert!(difference.is_kept(), "{name}: {difference:?}");
        let expected = first.source.frame_time.or(Some(0.03333333333));
        assert_eq!(second.source.frame_time, expected, "{name}");
        assert_eq!(first.source.channels, second.source.channels, "{name}");
        assert_eq!(first.source.metres_per_unit, second.source.metres_per_unit, "{name}");
        let again = write_bvh(&second.clip, &ExportOptions::like(&second.source)).unwrap();
        assert_eq!(String::from_utf8(written.bytes), String::from_utf8(again.bytes), "{name}");
    }
    assert!(count > 30);
}

#[test]
fn the_plain_file_comes_back_as_it_was() {
    for name in ["plain", "duplicate-names", "positions-on-every-joint", "few-rotations"] {
        let import = read_bvh(&fixture(name), &ImportOptions::default()).unwrap();
        let written = write_bvh(&import.clip, &ExportOptions::like(&import.source)).unwrap();
        assert_eq!(String::from_utf8(written.bytes), String::from_utf8(fixture(name)), "{name}");
    }
    let import = read_bvh(&fixture("short-frame-time"), &ImportOptions::default()).unwrap();
    let written = write_bvh(&import.clip, &ExportOptions::like(&import.source)).unwrap();
    assert!(String::from_utf8(written.bytes).unwrap().contains("Frame Time: 0.0083333\n"));
}

fn clip(joints: Vec<Joint>, rotations: Vec<Quat>, translations: Vec<TranslationTrack>) -> Clip {
    Clip::new(Arc::new(Skeleton::new(joints).unwrap()), 25.0, rotations, translations).unwrap()
}

#[test]
fn without_a_source_the_usual_channels_are_written() {
    let joints = vec![
        Joint::new("hip", None, Vec3::ZERO),
        Joint::new("box", Some(0), Vec3::X),
        Joint::end("box_end", 1, Vec3::Y),
    ];
    let track = TranslationTrack { joint: 1, values: vec![Vec3::new(1.0, -0.0, 0.0)] };
    let clip = clip(joints, vec![Quat::from_rotation_x(0.5); 3], vec![track]);
    let written = write_bvh(&clip, &ExportOptions::default()).unwrap();
    let expected = "HIERARCHY
ROOT hip
{
\tOFFSET 0 0 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
\tJOINT box
\t{
\t\tOFFSET 100 0 0
\t\tCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 100 0
\t\t}
\t}
}
MOTION
Frames: 1
Frame Time: 0.04
0 0 0 0 0 28.64789 100 0 0 0 0 28.64789
";
    assert_eq!(String::from_utf8(written.bytes).unwrap(), expected);
    assert!(written.findings.is_empty());
}

#[test]
fn channels_are_added_where_the_motion_needs_them() {
    let source = read_bvh(&fixture("few-rotations"), &ImportOptions::default()).unwrap();
    let skeleton = source.clip.skeleton().clone();
    let turned = vec![Quat::IDENTITY, Quat::from_rotation_y(0.5), Quat::IDENTITY];
    let track = TranslationTrack { joint: 1, values: vec![Vec3::new(0.0, -0.7, 0.0)] };
    let clip = Clip::new(skeleton, 30.0, turned, vec![track]).unwrap();
    let written = write_bvh(&clip, &ExportOptions::like(&source.source)).unwrap();
    let text = String::from_utf8(written.bytes.clone()).unwrap();
    assert!(text.contains("CHANNELS 4 Yposition Xrotation Zrotation Yrotation\n"), "{text}");
    assert_eq!(
        written.findings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "warning [bvh-channels-added] joint `knee` moves in ways that its channels cannot hold; channels are added"
        ]
    );
    let second = read_bvh(&written.bytes, &ImportOptions::default()).unwrap();
    assert!(Difference::of_rotations(&clip, &second.clip) < 0.01);
}

#[test]
fn what_a_bvh_cannot_hold_is_said() {
    let one = |joint: Joint| clip(vec![joint], vec![Quat::IDENTITY], vec![]);
    let far = one(Joint::new("far", None, Vec3::new(1e11, 0.0, 0.0)));
    let error = write_bvh(&far, &ExportOptions::default()).unwrap_err();
    assert!(matches!(error, FormatError::Write { .. }));
    assert!(error.to_string().starts_with("joint `far` is "), "{error}");
    let slow = one(Joint::new("a", None, Vec3::ZERO)).with_frame_rate(0.05).unwrap();
    assert_eq!(
        write_bvh(&slow, &ExportOptions::default()).unwrap_err().to_string(),
        "0.05 frames a second is not a rate that BVH readers accept; resample the motion to a rate between 0.1 and 100000"
    );
    let unit = ExportOptions { metres_per_unit: -1.0, ..Default::default() };
    assert!(matches!(write_bvh(&slow, &unit), Err(FormatError::Options { .. })));

    let odd = write_bvh(&one(Joint::new(" a{b\n", None, Vec3::ZERO)), &ExportOptions::default()).unwrap();
    assert_eq!(odd.findings[0].code, "bvh-renamed");
    let again = read_bvh(&odd.bytes, &ImportOptions::default()).unwrap();
    assert_eq!(again.clip.skeleton().joints()[0].name, "a_b_");

    let other = ExportOptions { channels: vec![vec![]; 7], ..Default::default() };
    let written = write_bvh(&one(Joint::new("a", None, Vec3::ZERO)), &other).unwrap();
    assert_eq!(written.findings[0].code, "bvh-other-channels");

    let joints = [None, Some(0), Some(0), Some(1)].map(|parent| Joint::new("j", parent, Vec3::Y));
    let crossed = clip(joints.to_vec(), vec![Quat::IDENTITY; 4], vec![]);
    assert_eq!(write_bvh(&crossed, &ExportOptions::default()).unwrap().findings[0].code, "bvh-joint-order");
}

#[test]
fn a_deep_chain_is_not_indented_without_end() {
    let joints =
        (0..5000_usize).map(|i| Joint::new(format!("j{i}"), i.checked_sub(1), Vec3::Y * 0.001)).collect();
    let clip = clip(joints, vec![Quat::from_rotation_z(0.01); 5000], vec![]);
    let written = write_bvh(&clip, &ExportOptions::default()).unwrap();
    assert!(written.bytes.len() < 5000 * 600, "{}", written.bytes.len());
    let second = read_bvh(&written.bytes, &ImportOptions::default()).unwrap();
    let difference = Difference::between(&clip, &second.clip);
    assert!(difference.is_kept(), "{difference:?}");
}

fn axis() -> impl Strategy<Value = Axis> {
    prop_oneof![Just(Axis::X), Just(Axis::Y), Just(Axis::Z)]
}

/// Positions in any order, all or none, mixed with three rotations about axes that can express anything.
fn channels() -> impl Strategy<Value = Vec<Channel>> {
    let rotations =
        prop::array::uniform3(axis()).prop_filter("can turn any way", |[a, b, c]| a != b && b != c);
    let positions = prop::option::of(Just(Axis::ALL.to_vec()).prop_shuffle());
    (rotations, positions, any::<bool>()).prop_map(|(rotations, positions, first)| {
        let turns = rotations.map(Channel::Rotation).to_vec();
        let places: Vec<_> = positions.into_iter().flatten().map(Channel::Position).collect();
        if first { [places, turns].concat() } else { [turns, places].concat() }
    })
}

type Parts = (Vec<(usize, [f32; 3], bool, Vec<Channel>)>, usize, f64, f64, bool);

fn parts() -> impl Strategy<Value = Parts> {
    let joint = (any::<usize>(), prop::array::uniform3(-0.5_f32..0.5), any::<bool>(), channels());
    let unit = prop_oneof![Just(1.0), Just(0.01), Just(0.001), Just(0.0254), Just(0.0564)];
    (prop::collection::vec(joint, 2..20), 1..6_usize, unit, 1.0..240.0, any::<bool>())
}

/// A clip in depth-first order, and its channels.
fn build((joints, frames, _, rate, _): &Parts, seed: u32) -> (Clip, Vec<Vec<Channel>>) {
    let mut built: Vec<Joint> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut lists = Vec::new();
    for (index, (pick, offset, spaced, list)) in joints.iter().enumerate() {
        // Closing some of the open joints keeps the order depth first; closing all begins another root.
        open.truncate(open.len() - pick % (open.len() + 1));
        let name = if *spaced { "same name".into() } else { format!("j{index}") };
        built.push(Joint::new(name, open.last().copied(), Vec3::from_array(*offset)));
        open.push(index);
        lists.push(list.clone());
    }
    let mut state = u64::from(seed) | 1;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    };
    let mut turn = || Quat::from_xyzw(random(), random(), random(), random() + 1e-3).normalize();
    let rotations = (0..frames * joints.len()).map(|_| turn()).collect();
    let moving = |list: &[Channel]| list.iter().any(|channel| matches!(channel, Channel::Position(_)));
    let tracks = (0..lists.len()).filter(|&joint| moving(&lists[joint])).map(|joint| {
        let values =
            (0..*frames).map(|frame| Vec3::new(frame as f32 * 0.1, joint as f32 * 0.01, -0.3)).collect();
        TranslationTrack { joint, values }
    });
    let tracks = tracks.collect();
    (Clip::new(Arc::new(Skeleton::new(built).unwrap()), *rate, rotations, tracks).unwrap(), lists)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_skeleton_order_unit_and_up_axis_comes_back(parts in parts(), seed: u32) {
        let (clip, channels) = build(&parts, seed);
        let up = if parts.4 { UpAxis::Z } else { UpAxis::Y };
        let export = ExportOptions { metres_per_unit: parts.2, up, channels, ..Default::default() };
        let written = write_bvh(&clip, &export).unwrap();
        prop_assert!(written.findings.is_empty(), "{:?}", written.findings);
        let options = ImportOptions { metres_per_unit: Some(parts.2), up: Some(up), ..Default::default() };
        let import = read_bvh(&written.bytes, &options).unwrap();
        let difference = Difference::between(&clip, &import.clip);
        prop_assert!(difference.is_kept(), "{difference:?}");
        prop_assert_eq!(&import.source.channels, &export.channels);
        prop_assert!((import.clip.frame_rate() / clip.frame_rate() - 1.0).abs() < 1e-9);
        let tracks = |clip: &Clip| clip.translations().iter().map(|track| track.joint).collect::<Vec<_>>();
        prop_assert_eq!(tracks(&import.clip), tracks(&clip));
    }

    #[test]
    fn the_usual_channels_hold_any_motion(parts in parts(), seed: u32) {
        let (clip, _) = build(&parts, seed);
        let written = write_bvh(&clip, &ExportOptions::default()).unwrap();
        let options = ImportOptions { metres_per_unit: Some(0.01), ..Default::default() };
        let import = read_bvh(&written.bytes, &options).unwrap();
        let difference = Difference::between(&clip, &import.clip);
        prop_assert!(difference.is_kept(), "{difference:?}");
    }
}

/// Rows that are kept come back byte for byte, and the angles around them run on into them without a jump of a turn.
#[test]
fn rows_of_an_earlier_file_are_kept() {
    let joints = vec![Joint::new("hip", None, Vec3::ZERO), Joint::end("hip_end", 0, Vec3::Y)];
    let turns = |frames: std::ops::Range<i32>| {
        frames
            .flat_map(|frame| [Quat::from_rotation_y(0.1 * frame as f32), Quat::IDENTITY])
            .collect::<Vec<_>>()
    };
    // A spin that has gone on for two turns; the second time the rest of it is made anew.
    let earlier = clip(joints.clone(), turns(0..200), vec![]);
    let written = write_bvh(&earlier, &ExportOptions::default()).unwrap();
    let text = String::from_utf8(written.bytes.clone()).unwrap();
    let rows: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).collect();
    let kept = inkrig_formats::bvh_rows(&written.bytes, 150..160).unwrap();
    assert_eq!(kept.len(), 10);
    assert_eq!((kept[3].frame, kept[3].text.as_slice()), (153, rows[153].as_bytes()));
    let wobbling = turns(0..200).into_iter().map(|turn| turn * Quat::from_rotation_y(0.003)).collect();
    let anew = clip(joints, wobbling, vec![]);
    let again = write_bvh(&anew, &ExportOptions { kept, ..ExportOptions::default() }).unwrap();
    let text = String::from_utf8(again.bytes).unwrap();
    let anew: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).collect();
    assert_eq!(anew[150..160], rows[150..160]);
    assert_ne!(anew[149], rows[149]);
    let angle = |row: &str| row.split(' ').map(|word| word.parse::<f64>().unwrap()).nth(4).unwrap();
    for pair in anew.windows(2) {
        assert!((angle(pair[1]) - angle(pair[0])).abs() < 10.0, "{} {}", pair[0], pair[1]);
    }
    assert!(
        inkrig_formats::bvh_rows(&written.bytes, 150..300)
            .unwrap_err()
            .to_string()
            .contains("frames that are there")
    );
    let other = vec![inkrig_formats::KeptRow { frame: 1, text: b"1 2 3".to_vec() }];
    let error = write_bvh(&earlier, &ExportOptions { kept: other, ..ExportOptions::default() }).unwrap_err();
    assert!(error.to_string().contains("other channels"), "{error}");
}
