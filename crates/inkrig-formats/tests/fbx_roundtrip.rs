//! What is written as FBX comes back.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and some print their tables"
)]

mod common;

use common::{Difference, odd_clip};
use inkrig_formats::{
    Evidence, ExportOptions, Format, Import, ImportOptions, SourceInfo, UpAxis, read_bvh, read_fbx, write_fbx,
};
use inkrig_motion::{
    Clip, Joint, Skeleton,
    glam::{Quat, Vec3},
};
use std::{path::Path, sync::Arc, time::Instant};

fn back(bytes: &[u8]) -> Import {
    read_fbx(bytes, &ImportOptions::default()).unwrap()
}

/// What an FBX must keep: 1e-5 m, 0.01 degree.
fn assert_kept(what: &str, before: &Clip, after: &Clip) -> (f64, f64) {
    let difference = Difference::between(before, after);
    let metres = difference.position * f64::from(before.skeleton().extent()).max(0.1);
    assert!(
        metres <= 1e-5 && difference.degrees <= 0.01,
        "{what}: {metres} m, {} degrees",
        difference.degrees
    );
    (metres, difference.degrees)
}

#[test]
fn a_clip_comes_back_from_its_fbx() {
    let ntsc = 30_000.0 / 1001.0;
    for (frames, rate) in
        [(1, 30.0), (2, 30.0), (3, 24.0), (40, 120.000_48), (41, ntsc), (300, 60.0), (90, 0.5)]
    {
        for (up, metres_per_unit) in [(UpAxis::Y, 0.01), (UpAxis::Z, 1.0), (UpAxis::Y, 0.0564)] {
            let clip = odd_clip(frames, rate);
            let options = ExportOptions {
                name: Some("walk \"1\"|ä".into()),
                up,
                metres_per_unit,
                ..Default::default()
            };
            let import = back(&write_fbx(&clip, &options).unwrap().bytes);
            assert_kept(&format!("{frames} frames"), &clip, &import.clip);
            assert_eq!(import.clip.frame_rate(), rate);
            assert_eq!(import.clips[0].name, "walk \"1\"|ä");
            let source = &import.source;
            assert_eq!(
                (source.format, source.metres_per_unit, source.up),
                (Format::Fbx, metres_per_unit, up)
            );
            assert_eq!((source.unit_evidence, source.up_evidence), (Evidence::Declared, Evidence::Declared));
            let said: Vec<_> = import.findings.iter().map(|finding| finding.code).collect();
            assert_eq!(said, ["joint-duplicate-name"]);
        }
    }
}

#[test]
fn samples_come_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/motions");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "bvh") {
            let first = read_bvh(&std::fs::read(&path).unwrap(), &ImportOptions::default()).unwrap();
            let written = write_fbx(&first.clip, &ExportOptions::like(&first.source)).unwrap();
            assert_kept(&path.display().to_string(), &first.clip, &back(&written.bytes).clip);
            read += 1;
        }
    }
    assert!(read >= 3);
}

#[test]
fn captured_motion_comes_back() {
    let Some(files) = common::reference_files("bvh") else { return };
    let (mut largest, mut read, mut frames) = ((0.0_f64, 0.0_f64), 0, 0);
    let start = Instant::now();
    // A few of every folder: all 357 take a minute.
    let mut folders = std::collections::BTreeMap::<_, usize>::new();
    for path in files {
        let count = folders.entry(path.parent().unwrap().to_path_buf()).or_default();
        *count += 1;
        if *count > 3 {
            continue;
        }
        let first = read_bvh(&std::fs::read(&path).unwrap(), &ImportOptions::default()).unwrap();
        let written = write_fbx(&first.clip, &ExportOptions::default()).unwrap();
        let (metres, degrees) =
            assert_kept(&path.display().to_string(), &first.clip, &back(&written.bytes).clip);
        largest = (largest.0.max(metres), largest.1.max(degrees));
        (read, frames) = (read + 1, frames + first.clip.frames());
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{read} files, {frames} frames: {:.2e} m, {:.2e} degrees at most, {seconds:.1} s",
        largest.0, largest.1
    );
    assert!(read >= 10);
}

#[test]
fn writing_twice_gives_the_same_bytes() {
    let clip = odd_clip(20, 30.0);
    let write = || write_fbx(&clip, &ExportOptions::default()).unwrap().bytes;
    assert_eq!(write(), write());
}

#[test]
fn small_movements_are_kept() {
    let joints = vec![
        Joint::new("hips", None, Vec3::new(0.1, 0.937, 0.3)),
        Joint::new("spine", Some(0), Vec3::new(0.003, 0.271, 0.017)),
        Joint::new("jaw", Some(1), Vec3::new(0.01, 0.4, 0.033)),
    ];
    let (skeleton, frames) = (Arc::new(Skeleton::new(joints).unwrap()), 20);
    let values = (0..frames).map(|frame| Vec3::new(0.01, 0.4, 0.033 + 2.5e-7 * frame as f32)).collect();
    let track = inkrig_motion::TranslationTrack { joint: 2, values };
    let clip = Clip::new(skeleton, 30.0, vec![Quat::from_rotation_x(0.3); 3 * frames], vec![track]).unwrap();
    for up in [UpAxis::Y, UpAxis::Z] {
        let options = ExportOptions { up, ..Default::default() };
        let again = back(&write_fbx(&clip, &options).unwrap().bytes).clip;
        assert_kept("a jaw", &clip, &again);
        let moving: Vec<_> = again.translations().iter().map(|track| track.joint).collect();
        assert_eq!(moving, [2]);
    }
}

#[test]
fn turns_run_on_over_many_rounds() {
    let skeleton = Arc::new(Skeleton::new(vec![Joint::new("top", None, Vec3::ZERO)]).unwrap());
    let turns = (0..2000).map(|frame| Quat::from_rotation_y(0.2 * frame as f32)).collect();
    let clip = Clip::new(skeleton, 60.0, turns, vec![]).unwrap();
    let bytes = write_fbx(&clip, &ExportOptions::default()).unwrap().bytes;
    assert_kept("a top", &clip, &back(&bytes).clip);
    // Between the frames it turns on as well: a jump of a turn would show here.
    let options = ImportOptions { frame_rate: Some(120.0), ..ImportOptions::default() };
    let between = read_fbx(&bytes, &options).unwrap().clip;
    assert_eq!(between.frames(), 3999);
    for frame in 0..between.frames() {
        let expected = Quat::from_rotation_y(0.1 * frame as f32);
        assert!(between.rotations(frame)[0].angle_between(expected) < 1e-3, "{frame}");
    }
}

#[test]
fn what_does_not_fit_is_said() {
    let clip = odd_clip(3, 30.0);
    let far = ExportOptions { metres_per_unit: 1e-9, ..Default::default() };
    let skeleton = Skeleton::new(vec![Joint::new("a", None, Vec3::X * 1e4)]).unwrap();
    let lone = Clip::new(Arc::new(skeleton), 30.0, vec![Quat::IDENTITY], vec![]).unwrap();
    assert_eq!(
        write_fbx(&lone, &far).unwrap_err().to_string(),
        "joint `a` is 1e13 units away, and numbers go up to 1e12; write in a larger unit, or bring the motion nearer to the origin"
    );
    let slow = clip.with_frame_rate(0.01).unwrap();
    assert!(write_fbx(&slow, &ExportOptions::default()).is_ok());
    let bad = ExportOptions { metres_per_unit: 0.0, ..Default::default() };
    assert!(write_fbx(&slow, &bad).unwrap_err().to_string().starts_with("the unit given is 0 m long"));
    let skeleton = Skeleton::new(vec![Joint::new("a\nb", None, Vec3::X)]).unwrap();
    let lone = Clip::new(Arc::new(skeleton), 30.0, vec![Quat::IDENTITY], vec![]).unwrap();
    let written = write_fbx(&lone, &ExportOptions::default()).unwrap();
    assert_eq!(written.findings[0].code, "fbx-renamed");
    assert_eq!(back(&written.bytes).clip.skeleton().joints()[0].name, "a_b");
}

#[test]
fn what_comes_from_elsewhere_is_written_in_centimetres() {
    let inches = ImportOptions { metres_per_unit: Some(0.0254), up: Some(UpAxis::Z), ..Default::default() };
    let text = common::fixture("plain");
    let source = read_bvh(&text, &inches).unwrap().source;
    let unit = |format: Format, source: &_| {
        let options = ExportOptions::in_format(format, source);
        (options.metres_per_unit, options.up)
    };
    assert_eq!(unit(Format::Fbx, &source), (0.01, UpAxis::Y));
    assert_eq!(unit(Format::Bvh, &source), (0.0254, UpAxis::Z));
    let own = SourceInfo { format: Format::Fbx, ..source };
    assert_eq!(unit(Format::Fbx, &own), (0.0254, UpAxis::Z));
}
