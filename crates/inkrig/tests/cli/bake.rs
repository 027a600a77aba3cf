//! `--bake`: few keys, and poses that are held.

use crate::{align, desk, inkrig, text};
use inkrig::formats::{ImportOptions, no_files, read_bvh, read_gltf};
use inkrig::motion::{Clip, keyframes::deviation};
use std::path::Path;

fn read(path: &Path, rate: f64) -> Clip {
    let bytes = std::fs::read(path).unwrap();
    let options = ImportOptions { frame_rate: Some(rate), ..ImportOptions::default() };
    match path.extension().unwrap().to_str().unwrap() {
        "bvh" => read_bvh(&bytes, &options).unwrap().clip,
        _ => read_gltf(&bytes, &options, &no_files).unwrap().clip,
    }
}

#[test]
fn a_clip_becomes_few_keys_within_the_tolerance() {
    let (_keep, folder) = desk();
    let arguments =
        ["convert", "person.bvh", "few.glb", "--bake", "sparse", "--tolerance", "2mm,1deg", "--json"];
    let done = inkrig(&folder, &arguments);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let record: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let bake = &record["bake"];
    assert_eq!((&bake["mode"], &bake["sparse"]["tolerance_mm"]), (&"sparse".into(), &2.0.into()));
    let number = |name: &str| bake[name].as_u64().unwrap();
    assert!(4 * number("keys") < number("keys_before"), "{bake}");
    let source = read(&folder.join("person.bvh"), 30.0);
    let apart = deviation(&source, &read(&folder.join("few.glb"), 30.0)).unwrap();
    assert!(apart.metres <= 2e-3 && apart.radians <= 1_f64.to_radians(), "{apart:?}");
    assert!((1e3 * apart.metres - bake["sparse"]["largest_mm"].as_f64().unwrap()).abs() < 0.05);
    let said = text(&inkrig(&folder, &["convert", "person.bvh", "b.glb", "--bake", "sparse"]).stdout);
    assert!(said.contains(" keys of ") && said.contains("on every frame"), "{said}");
}

#[test]
fn poses_are_held_on_twos() {
    let (_keep, folder) = desk();
    let done =
        inkrig(&folder, &["convert", "person.bvh", "held.bvh", "--fps", "24", "--bake", "stepped", "--json"]);
    let record: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(record["bake"]["hold_frames"], 2.0);
    let held = read(&folder.join("held.bvh"), 24.0);
    let same = |a: usize, b: usize| held.rotations(a) == held.rotations(b);
    assert!((0..100).step_by(2).all(|frame| same(frame, frame + 1)));
    assert!((0..100).step_by(2).filter(|&frame| !same(frame + 1, frame + 2)).count() > 40);
    let glb = ["convert", "person.bvh", "held.glb", "--bake", "stepped", "--on", "5", "--keep-key", "33"];
    assert!(inkrig(&folder, &glb).status.success());
    let held = read(&folder.join("held.glb"), 30.0);
    let apart = |a: usize, b: usize| held.rotations(a)[0].angle_between(held.rotations(b)[0]);
    assert!(apart(33, 39) < 1e-6 && apart(32, 33) > 1e-6, "33 takes the place of 35");
}

/// The exact pose of `--key` is a key of the result, with exactly that pose.
#[test]
fn exact_poses_are_keys() {
    let (_keep, folder) = desk();
    let key = ["--key", "1.5s=frame:200", "--report", "r.json"];
    assert!(align(&folder, &key).status.success());
    let mut few =
        vec!["align", "person.bvh", "--curve", "circles.csv", "-o", "few.glb", "--key", "1.5s=frame:200"];
    few.extend(["--bake", "sparse", "--tolerance", "2cm,5deg", "--json"]);
    let done = inkrig(&folder, &few);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let record: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(record["bake"]["kept_frames"], serde_json::json!([45]));
    let (dense, few) = (read(&folder.join("new.bvh"), 30.0), read(&folder.join("few.glb"), 30.0));
    let turned = |frame: usize| {
        let pairs = dense.rotations(frame).iter().zip(few.rotations(frame)).zip(dense.skeleton().joints());
        let turns = pairs.filter(|(_, joint)| !joint.end_site).map(|((a, b), _)| a.angle_between(*b));
        turns.fold(0.0_f32, f32::max)
    };
    // What a BVH rounds.
    assert!(turned(45) < 2e-3, "{}", turned(45));
    assert!((0..dense.frames()).any(|frame| turned(frame) > 1e-2));
}

#[test]
fn what_does_not_go_together_is_said() {
    let (_keep, folder) = desk();
    let cases: [(&[&str], &str); 6] = [
        (&["a.bvh", "--bake", "sparse"], "a pose a frame"),
        (&["a.usda", "--bake", "sparse"], "a pose a frame"),
        (&["a.glb", "--tolerance", "1mm"], "--tolerance goes with --bake sparse"),
        (&["a.glb", "--bake", "sparse", "--on", "2s"], "--on goes with --bake stepped"),
        (&["a.glb", "--bake", "sparse", "--keep-key", "1000s"], "not in the result"),
        (&["a.glb", "--bake", "stepped", "--on", "2x"], "on twos"),
    ];
    for (more, expected) in cases {
        let done = inkrig(&folder, &[&["convert", "person.bvh"], more].concat());
        let said = text(&done.stderr).replace(['\n', '│', ' '], "");
        assert!(!done.status.success() && said.contains(&expected.replace(' ', "")), "{more:?}: {said}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2, "nothing is written");
    }
}
