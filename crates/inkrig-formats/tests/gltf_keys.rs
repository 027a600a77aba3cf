//! Few keys in glTF files, and what formats without them say.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and shared ones print"
)]

mod common;

use common::{Difference, gltf::Doc};
use inkrig_formats::{
    ClipChoice, ExportOptions, Format, HUMAN_BONES, HumanBone, ImportOptions, no_files, read_gltf, write_bvh,
    write_glb, write_motion,
};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{EulerRot, Quat, Vec3},
    keyframes::{KeyedClip, SparseOptions, sparse, stepped},
};
use serde_json::{Value, json};
use std::sync::Arc;

/// A hip that travels, a spine that never turns, an arm that swings.
fn clip(frames: usize) -> Clip {
    let skeleton = Skeleton::new(vec![
        Joint::new("hip", None, Vec3::Y),
        Joint::new("spine", Some(0), Vec3::Y * 0.5),
        Joint::new("arm", Some(1), Vec3::X * 0.2),
        Joint::end("arm_end", 2, Vec3::X * 0.4),
    ]);
    let rotations = (0..frames).flat_map(|frame| {
        let t = frame as f32 * 0.1;
        let arm = Quat::from_euler(EulerRot::YXZ, t.sin(), 2.0 * (1.7 * t).cos(), t);
        [Quat::from_rotation_y(0.3 * t.sin()), Quat::from_rotation_x(0.3), arm, Quat::IDENTITY]
    });
    let values = (0..frames).map(|frame| Vec3::new(0.01 * frame as f32, 1.0, (frame as f32 * 0.2).sin()));
    let track = TranslationTrack { joint: 0, values: values.collect() };
    Clip::new(Arc::new(skeleton.unwrap()), 50.0, rotations.collect(), vec![track]).unwrap()
}

fn options(keys: &KeyedClip) -> ExportOptions {
    ExportOptions { keys: Some(keys.clone()), ..ExportOptions::default() }
}

fn read(bytes: &[u8], rate: f64, name: &str) -> Clip {
    let clip = Some(ClipChoice::Name(name.into()));
    let options = ImportOptions { frame_rate: Some(rate), clip, ..ImportOptions::default() };
    read_gltf(bytes, &options, &no_files).unwrap().clip
}

fn document(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Modes of the samplers of the last clip, and how many keys they have.
fn samplers(bytes: &[u8]) -> Vec<(String, u64)> {
    let document = document(bytes);
    let animation = document["animations"].as_array().unwrap().last().unwrap();
    let samplers = animation["samplers"].as_array().unwrap().iter();
    let keys = |index: &Value| document["accessors"][index.as_u64().unwrap() as usize]["count"].as_u64();
    samplers.map(|s| (s["interpolation"].as_str().unwrap().to_string(), keys(&s["input"]).unwrap())).collect()
}

#[test]
fn splines_come_back_as_the_same_poses() {
    let keyed = sparse(&clip(200), &SparseOptions::default());
    let dense = keyed.clip().unwrap();
    let written = write_glb(&dense, &options(&keyed)).unwrap();
    let back = read(&written.bytes, 50.0, "motion");
    assert_eq!(back.frames(), 200);
    assert!(Difference::between(&dense, &back).is_kept(), "{:?}", Difference::between(&dense, &back));
    // Half way between two frames too, where only the curves tell.
    let fine = read(&written.bytes, 100.0, "motion");
    let difference = Difference::between(&keyed.sampled(2).unwrap(), &fine);
    assert!(difference.is_kept(), "{difference:?}");
    let keys = |joint: usize| keyed.rotations[joint].keys.len() as u64;
    let spline = |keys: u64| ("CUBICSPLINE".to_string(), keys);
    let expected = [
        spline(keys(0)),
        spline(keyed.translations[0].keys.len() as u64),
        ("LINEAR".to_string(), 2),
        spline(keys(2)),
    ];
    assert_eq!(samplers(&written.bytes), expected);
    assert!(keys(0) < 60, "{}", keys(0));
}

#[test]
fn held_poses_come_back_held() {
    let keyed = stepped(&clip(50), 4.0, &[5]);
    let dense = keyed.clip().unwrap();
    let written = write_glb(&dense, &options(&keyed)).unwrap();
    let back = read(&written.bytes, 50.0, "motion");
    assert!(Difference::between(&dense, &back).is_kept());
    assert!(samplers(&written.bytes).iter().any(|(mode, keys)| mode == "STEP" && *keys == 14));
    // At any rate: nothing happens between keys.
    let fine = read(&written.bytes, 400.0, "motion");
    assert_eq!(fine.rotations(5 * 8 - 1)[2], fine.rotations(0)[2]);
    assert_ne!(fine.rotations(5 * 8)[2], fine.rotations(0)[2]);
    // A BVH repeats them.
    let bvh = write_bvh(&dense, &options(&keyed)).unwrap();
    let text = String::from_utf8(bvh.bytes).unwrap();
    let rows: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).collect();
    assert!(rows[0] == rows[4] && rows[4] != rows[5] && rows[5] == rows[7]);
}

/// Nodes that rest turned, scaled and below others have other numbers for the same curves.
#[test]
fn keys_go_into_a_figure_whose_nodes_rest_at_any_angle() {
    let mut doc = Doc::walking_leg();
    let turn = |x, y, z| json!(Quat::from_euler(EulerRot::XYZ, x, y, z).to_array());
    let nodes = doc.list("nodes");
    nodes[0]["rotation"] = turn(0.5, -0.7, 1.1);
    nodes[0]["scale"] = json!([2.0, 2.0, 2.0]);
    nodes[1]["rotation"] = turn(-1.0, 0.2, 0.4);
    nodes.push(json!({ "name": "armature", "rotation": turn(-1.57, 0.0, 0.3), "scale": [0.5, 0.5, 0.5], "translation": [1.0, 2.0, 3.0], "children": [0] }));
    doc.json["scenes"][0]["nodes"] = json!([3]);
    for (uneven, dense) in [(false, false), (true, true)] {
        if uneven {
            doc.list("nodes")[3]["scale"] = json!([0.5, 1.0, 0.5]);
        }
        let import = read_gltf(&doc.glb(), &ImportOptions::default(), &no_files).unwrap();
        // Another motion of that figure.
        let own = import.clip.skeleton().clone();
        let rotations = (0..90).flat_map(|frame| {
            let t = frame as f32 * 0.07;
            [Quat::from_euler(EulerRot::XYZ, t.sin(), t, 0.2), Quat::from_rotation_x(t.cos()), Quat::IDENTITY]
        });
        let values = (0..90).map(|frame| Vec3::new((frame as f32 * 0.1).sin(), 1.0, 0.02 * frame as f32));
        let track = TranslationTrack { joint: 0, values: values.collect() };
        let clip = Clip::new(own, 30.0, rotations.collect(), vec![track]).unwrap();
        let keyed = sparse(&clip, &SparseOptions::default());
        let frames = keyed.clip().unwrap();
        let options = ExportOptions { keys: Some(keyed.clone()), ..ExportOptions::like(&import.source) };
        let written = write_glb(&frames, &options).unwrap();
        let codes: Vec<&str> = written.findings.iter().map(|finding| finding.code).collect();
        assert_eq!(codes.contains(&"gltf-dense-keys"), dense, "{codes:?}");
        let back = read(&written.bytes, 30.0, "motion");
        if !uneven {
            let difference = Difference::between(&frames, &back);
            assert!(difference.is_kept(), "{difference:?}");
            let fine = Difference::between(&keyed.sampled(2).unwrap(), &read(&written.bytes, 60.0, "motion"));
            assert!(fine.is_kept(), "{fine:?}");
            assert!(samplers(&written.bytes).iter().all(|(mode, keys)| mode == "CUBICSPLINE" && *keys < 60));
        }
    }
}

#[test]
fn formats_with_a_pose_a_frame_say_that_they_have_no_curves() {
    let keyed = sparse(&clip(40), &SparseOptions::default());
    let dense = keyed.clip().unwrap();
    let humanoid = HUMAN_BONES.into_iter().map(|name| HumanBone { name, joint: 0 }).collect();
    let options = ExportOptions { humanoid, ..options(&keyed) };
    for format in [Format::Bvh, Format::Usda, Format::Vrma] {
        let said = write_motion(&dense, format, &options).unwrap_err().to_string();
        assert!(said.contains("a pose a frame") && said.contains(".glb"), "{said}");
    }
}
