//! Few keys in FBX files: angles with tangents, and held poses.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and shared ones print"
)]

mod common;

use inkrig_formats::{ExportOptions, ImportOptions, UpAxis, read_bvh, read_fbx, write_fbx};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{EulerRot, Quat, Vec3},
    keyframes::{KeyedClip, RotationForm, SparseOptions, deviation, sparse, stepped},
};
use std::sync::Arc;

/// A hip that travels and an arm that swings past the upright.
fn clip(frames: usize) -> Clip {
    let skeleton = Skeleton::new(vec![
        Joint::new("hip", None, Vec3::Y),
        Joint::new("arm", Some(0), Vec3::X * 0.2),
        Joint::end("arm_end", 1, Vec3::X * 0.4),
    ]);
    let rotations = (0..frames).flat_map(|frame| {
        let t = frame as f32 * 0.1;
        [
            Quat::from_rotation_y(0.3 * t),
            Quat::from_euler(EulerRot::YXZ, 2.0 * t.sin(), t, 0.4),
            Quat::IDENTITY,
        ]
    });
    let values = (0..frames).map(|frame| Vec3::new(0.01 * frame as f32, 1.0, (frame as f32 * 0.2).sin()));
    let track = TranslationTrack { joint: 0, values: values.collect() };
    Clip::new(Arc::new(skeleton.unwrap()), 30.0, rotations.collect(), vec![track]).unwrap()
}

fn few(clip: &Clip, up: UpAxis) -> KeyedClip {
    let form = RotationForm::Angles { axes: up.clip_from_file_turn() };
    sparse(clip, &SparseOptions { form, ..SparseOptions::default() })
}

fn there_and_back(keyed: &KeyedClip, up: UpAxis, rate: f64) -> Clip {
    let options = ExportOptions { keys: Some(keyed.clone()), up, ..ExportOptions::default() };
    let written = write_fbx(&keyed.clip().unwrap(), &options).unwrap();
    let options = ImportOptions { frame_rate: Some(rate), ..ImportOptions::default() };
    read_fbx(&written.bytes, &options).unwrap().clip
}

#[test]
fn curves_of_angles_come_back_in_both_axes() {
    let clip = clip(150);
    for up in [UpAxis::Y, UpAxis::Z] {
        let keyed = few(&clip, up);
        let count = keyed.count();
        assert!(4 * count.keys < count.dense, "{count:?}");
        let back = there_and_back(&keyed, up, 30.0);
        let apart = deviation(&clip, &back).unwrap();
        assert!(apart.metres <= 1e-3 && apart.radians <= 0.5_f64.to_radians(), "{up:?}: {apart:?}");
        // Half way between two frames too, where only the curves tell. Handles in the file are .3333 of the way long.
        let fine = deviation(&keyed.sampled(2).unwrap(), &there_and_back(&keyed, up, 60.0)).unwrap();
        assert!(fine.metres < 1e-4 && fine.radians < 1e-3, "{up:?}: {fine:?}");
    }
}

#[test]
fn held_poses_come_back_held() {
    let keyed = stepped(&clip(60), 5.0, &[]);
    let back = there_and_back(&keyed, UpAxis::Y, 30.0);
    let apart = deviation(&keyed.clip().unwrap(), &back).unwrap();
    assert!(apart.metres < 1e-5 && apart.radians < 1e-4, "{apart:?}");
    let fine = there_and_back(&keyed, UpAxis::Y, 300.0);
    assert_eq!(fine.rotations(49), fine.rotations(0));
    assert_ne!(fine.rotations(50), fine.rotations(49));
}

#[test]
fn quaternions_are_no_angles() {
    let keyed = sparse(&clip(40), &SparseOptions::default());
    let options = ExportOptions { keys: Some(keyed.clone()), ..ExportOptions::default() };
    let said = write_fbx(&keyed.clip().unwrap(), &options).unwrap_err().to_string();
    assert!(said.contains("FBX"), "{said}");
    let z_up = few(&clip(40), UpAxis::Z);
    let options = ExportOptions { keys: Some(z_up.clone()), ..ExportOptions::default() };
    assert!(write_fbx(&z_up.clip().unwrap(), &options).is_err());
}

/// The gate of the quaternions, for angles.
#[test]
fn a_walk_needs_a_quarter_of_its_keys() {
    let Some(files) = common::reference_files("bvh") else { return };
    for name in ["07/07_02", "35/35_01"] {
        let path = files.iter().find(|file| file.ends_with(format!("cmu/{name}.bvh"))).unwrap();
        let clip = read_bvh(&std::fs::read(path).unwrap(), &ImportOptions::default()).unwrap().clip;
        let keyed = few(&clip, UpAxis::Y);
        let count = keyed.count();
        let apart = deviation(&clip, &there_and_back(&keyed, UpAxis::Y, clip.frame_rate())).unwrap();
        println!("{name}: {} of {} keys, {:.3} mm", count.keys, count.dense, 1e3 * apart.metres);
        assert!(apart.metres <= 1e-3 && apart.radians <= 0.5_f64.to_radians(), "{name}: {apart:?}");
        assert!(4 * count.keys <= count.dense, "{name}: {count:?}");
    }
}
