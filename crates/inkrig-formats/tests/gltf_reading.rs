//! What the glTF reader makes of documents: every sampler mode, accessor layout and way to place a node.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use base64::{Engine as _, engine::general_purpose::STANDARD};
use common::gltf::{Doc, turn_x};
use inkrig_formats::{
    ClipChoice, Evidence, Format, FormatError, Import, ImportOptions, Severity, UpAxis, no_files, read_gltf,
    read_in_folder,
};
use inkrig_motion::{
    glam::{Quat, Vec3},
    kinematics,
};
use serde_json::json;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

fn read(doc: &Doc) -> Import {
    read_gltf(&doc.glb(), &ImportOptions::default(), &no_files).unwrap()
}

fn error(doc: &Doc) -> FormatError {
    read_gltf(&doc.glb(), &ImportOptions::default(), &no_files).unwrap_err()
}

fn near(a: Vec3, b: [f32; 3]) -> bool {
    a.distance(Vec3::from_array(b)) < 1e-6
}

fn angle_x(rotation: Quat) -> f32 {
    2.0 * rotation.x.atan2(rotation.w)
}

fn codes(import: &Import) -> Vec<&'static str> {
    import.findings.iter().map(|finding| finding.code).collect()
}

#[test]
fn a_walking_leg_is_read() {
    let import = read(&Doc::walking_leg());
    let (clip, joints) = (&import.clip, import.clip.skeleton().joints());
    assert_eq!((clip.frames(), clip.frame_rate()), (31, 30.0));
    let names: Vec<_> =
        joints.iter().map(|joint| (joint.name.as_str(), joint.parent, joint.end_site)).collect();
    assert_eq!(names, [("hip", None, false), ("knee", Some(0), false), ("knee_end", Some(1), true)]);
    let moved: Vec<_> = clip.translations().iter().map(|track| track.joint).collect();
    assert_eq!(moved, [0]);
    let positions = kinematics::positions(clip);
    assert!(near(positions.frame(30)[1], [0.0, 0.5, 1.0]));
    // The knee has turned by a quarter: down has become back.
    assert!(near(positions.frame(30)[2], [0.0, 0.5, 0.5]));
    assert_eq!(import.source.format, Format::Glb);
    assert_eq!((import.source.metres_per_unit, import.source.unit_evidence), (1.0, Evidence::Declared));
    assert_eq!(import.findings, []);
}

#[test]
fn linear_rotations_go_round_at_a_steady_speed() {
    let mut doc = Doc::leg();
    doc.animation("a");
    let far = turn_x(2.0);
    // The other sign of the same rotation: the short way is taken.
    let values: Vec<f32> = [turn_x(0.0), far.map(|number| -number)].concat();
    doc.channel(1, "rotation", "LINEAR", &[0.0, 1.0], "VEC4", &values);
    let import =
        read_gltf(&doc.glb(), &ImportOptions { frame_rate: Some(10.0), ..Default::default() }, &no_files);
    let clip = import.unwrap().clip;
    assert_eq!(clip.frames(), 11);
    for frame in 0..11 {
        assert!((angle_x(clip.rotations(frame)[1]) - 0.2 * frame as f32).abs() < 1e-6, "{frame}");
    }
}

#[test]
fn steps_stay_until_the_next_key() {
    let mut doc = Doc::leg();
    doc.animation("a");
    let times = [0.0, 1.0 / 30.0, 0.1, 0.2];
    let values: Vec<f32> = [0.0, 0.1, 0.2, 0.3].into_iter().flat_map(turn_x).collect();
    doc.channel(1, "rotation", "STEP", &times, "VEC4", &values);
    let clip = read(&doc).clip;
    let angles: Vec<f32> = (0..clip.frames()).map(|frame| angle_x(clip.rotations(frame)[1])).collect();
    let expected = [0.0, 0.1, 0.1, 0.2, 0.2, 0.2, 0.3];
    assert_eq!(angles.len(), expected.len());
    assert!(angles.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{angles:?}");
}

#[test]
fn cubic_splines_follow_their_tangents() {
    let mut doc = Doc::leg();
    doc.animation("a");
    // Keys of 0 and 1 m at 0 and 2 s, tangents of 1 and -0.5 m/s: worked out by hand for a quarter and a half.
    let key = |into: f32, value: f32, out: f32| [0.0, 0.0, into, 0.0, 1.0, value, 0.0, 0.0, out];
    let values = [key(9.0, 0.0, 1.0), key(-0.5, 1.0, 9.0)].concat();
    doc.channel(0, "translation", "CUBICSPLINE", &[0.0, 2.0], "VEC3", &values);
    let turns = [[0.0; 4], turn_x(0.0), [0.0; 4], [0.0; 4], turn_x(1.0), [0.0; 4]].concat();
    doc.channel(1, "rotation", "CUBICSPLINE", &[0.0, 2.0], "VEC4", &turns);
    let options = ImportOptions { frame_rate: Some(2.0), ..Default::default() };
    let clip = read_gltf(&doc.glb(), &options, &no_files).unwrap().clip;
    let z: Vec<f32> = clip.track(0).unwrap().iter().map(|place| place.z).collect();
    // h00 = 0.84375, h10 = 0.140625, h01 = 0.15625, h11 = -0.046875 at a quarter; .5, .125, .5, -.125 at a half.
    let quarter = 2.0 * 0.140_625 + 0.156_25 + 2.0 * -0.046_875 * -0.5;
    let half = 2.0 * 0.125 + 0.5 + 2.0 * -0.125 * -0.5;
    assert!(
        (z[0], z[4]) == (0.0, 1.0) && (z[1] - quarter).abs() < 1e-6 && (z[2] - half).abs() < 1e-6,
        "{z:?}"
    );
    // Without tangents the spline goes straight between the numbers of the keys, and is then brought to length 1.
    assert!((angle_x(clip.rotations(2)[1]) - 0.5).abs() < 1e-6);
    // A quarter of the time is less of the way: it starts slowly.
    assert!(angle_x(clip.rotations(1)[1]) < 0.2);
}

#[test]
fn normalised_integers_are_rotations() {
    for (kind, bytes) in [
        (5120, [0_i8, 0, 0, 127, 90, 0, 0, 90].map(|value| value as u8).to_vec()),
        (
            5122,
            [0_i16, 0, 0, 32_767, 23_170, 0, 0, 23_170]
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        ),
        (5121, vec![0, 0, 0, 255, 180, 0, 0, 180]),
        (
            5123,
            [0_u16, 0, 0, 65_535, 46_341, 0, 0, 46_341]
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        ),
    ] {
        let mut doc = Doc::leg();
        doc.animation("a");
        let input = doc.floats("SCALAR", &[0.0, 0.1]);
        let view = doc.view(&bytes);
        let output = doc.accessor(
            json!({ "bufferView": view, "componentType": kind, "normalized": true, "count": 2, "type": "VEC4" }),
        );
        doc.channel_of(1, "rotation", "LINEAR", input, output);
        let clip = read(&doc).clip;
        let last = clip.rotations(clip.frames() - 1)[1];
        assert!((angle_x(last) - FRAC_PI_2).abs() < 1e-4, "{kind}: {last}");
    }
}

#[test]
fn interleaved_and_sparse_numbers_are_read_where_they_lie() {
    let mut doc = Doc::leg();
    doc.animation("a");
    let input = doc.floats("SCALAR", &[0.0, 0.1, 0.2]);
    // Places and something else in turn, 20 bytes apart, behind 4 bytes of another's.
    let mut bytes = vec![0xff; 4];
    for z in [1.0_f32, 2.0, 3.0] {
        bytes.extend([0.0, 1.0, z, f32::NAN, f32::NAN].iter().flat_map(|value| value.to_le_bytes()));
    }
    let view = doc.view(&bytes);
    doc.list("bufferViews")[view]["byteStride"] = json!(20);
    // The second element is replaced.
    let index = doc.view(&1_u16.to_le_bytes());
    let value =
        doc.view(&[0.0_f32, 1.0, 7.0].iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
    let sparse = json!({ "count": 1, "indices": { "bufferView": index, "componentType": 5123 }, "values": { "bufferView": value } });
    let base = json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse });
    let mut laid = base.clone();
    laid["bufferView"] = json!(view);
    laid["byteOffset"] = json!(4);
    let output = doc.accessor(laid);
    doc.channel_of(0, "translation", "STEP", input, output);
    let z = |doc: &Doc| read(doc).clip.track(0).unwrap().iter().map(|place| place.z).collect::<Vec<_>>();
    let at_keys = |z: Vec<f32>| [z[0], z[(z.len() - 1) / 2], z[z.len() - 1]];
    assert_eq!(at_keys(z(&doc)), [1.0, 7.0, 3.0]);
    // Without a view all is zero but what is sparse.
    doc.list("accessors")[output] = base;
    assert_eq!(at_keys(z(&doc)), [0.0, 7.0, 0.0]);
}

#[test]
fn whatever_stands_above_the_joints_is_folded_into_them() {
    let quarter = turn_x(-FRAC_PI_2);
    for (case, above) in [
        (
            "parts",
            json!({ "scale": [100.0, 100.0, 100.0], "rotation": quarter, "translation": [3.0, 0.0, 0.0] }),
        ),
        // The same by columns.
        (
            "matrix",
            json!({ "matrix": [100.0, 0.0, 0.0, 0.0, 0.0, 0.0, -100.0, 0.0, 0.0, 100.0, 0.0, 0.0, 3.0, 0.0, 0.0, 1.0] }),
        ),
    ] {
        let mut doc = Doc::walking_leg();
        let mut node = above;
        node["name"] = json!("Armature");
        node["children"] = json!([0]);
        doc.list("nodes").push(node);
        let import = read(&doc);
        let joints = import.clip.skeleton().joints();
        assert_eq!(joints.len(), 3, "{case}");
        // Up has become forward, and all is a hundred times as large.
        assert!(
            near(joints[0].offset, [3.0, 0.0, -100.0]) && near(joints[1].offset, [0.0, 0.0, 50.0]),
            "{case}"
        );
        let positions = kinematics::positions(&import.clip);
        assert!(positions.frame(30)[0].distance(Vec3::new(3.0, 100.0, -100.0)) < 1e-4, "{case}");
        assert!(positions.frame(30)[2].distance(Vec3::new(3.0, 50.0, -50.0)) < 1e-4, "{case}");
        assert_eq!(codes(&import), ["gltf-size"], "{case}");
    }
}

#[test]
fn a_joint_that_rests_turned_has_a_rest_pose_without_rotations() {
    let mut doc = Doc::walking_leg();
    doc.json["nodes"][0]["rotation"] = json!(turn_x(FRAC_PI_4));
    let import = read(&doc);
    let joints = import.clip.skeleton().joints();
    let (s, c) = FRAC_PI_4.sin_cos();
    assert!(near(joints[1].offset, [0.0, -0.5 * c, -0.5 * s]));
    assert!(import.clip.rotations(0).iter().all(|rotation| rotation.angle_between(Quat::IDENTITY) < 1e-3));
    // The knee still turns about x by a quarter.
    assert!((angle_x(import.clip.rotations(30)[1]) - FRAC_PI_2).abs() < 1e-6);
}

#[test]
fn mirrored_and_uneven_scales_keep_places_and_are_said() {
    let mut doc = Doc::walking_leg();
    doc.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    doc.json["nodes"][1]["translation"] = json!([0.5, 0.0, 0.0]);
    let import = read(&doc);
    assert!(near(import.clip.skeleton().joints()[1].offset, [-0.5, 0.0, 0.0]));
    assert_eq!(codes(&import), ["gltf-uneven-scale"]);
    // Mirrored across x, a turn about x goes the other way round.
    assert!((angle_x(import.clip.rotations(30)[1]).abs() - FRAC_PI_2).abs() < 1e-5);
    let places = kinematics::positions(&import.clip);
    assert!(near(places.frame(30)[2], [-0.5, 1.0, 0.5]), "{}", places.frame(30)[2]);
}

#[test]
fn a_size_that_changes_moves_what_hangs_below() {
    let mut doc = Doc::walking_leg();
    doc.channel(0, "scale", "LINEAR", &[0.0, 1.0], "VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let import = read(&doc);
    assert_eq!(codes(&import), ["gltf-scale"]);
    assert!(near(kinematics::positions(&import.clip).frame(30)[1], [0.0, 0.0, 1.0]));
}

#[test]
fn clips_are_listed_and_chosen() {
    let mut doc = Doc::walking_leg();
    doc.animation("Rig|Walk");
    doc.channel(1, "rotation", "LINEAR", &[0.0], "VEC4", &turn_x(0.3));
    doc.animation("");
    let with = |clip| read_gltf(&doc.glb(), &ImportOptions { clip, ..Default::default() }, &no_files);
    let first = with(None).unwrap();
    let names: Vec<_> = first.clips.iter().map(|clip| clip.name.as_str()).collect();
    assert_eq!((names.as_slice(), first.clip_index), (&["bend", "Rig|Walk", "clip_3"][..], Some(0)));
    let said = &first.findings[0].message;
    assert_eq!(said, "the file has 3 clips and `bend`, the first, is read; `--clip` chooses another");
    for choice in ["Rig|Walk", "walk", "RIG|WALK"] {
        let import = with(Some(ClipChoice::Name(choice.into()))).unwrap();
        assert_eq!((import.clip_index, import.clip.frames()), (Some(1), 1), "{choice}");
    }
    assert_eq!(with(Some(ClipChoice::Number(2))).unwrap().clip_index, Some(1));
    let error = with(Some(ClipChoice::Name("run".into()))).unwrap_err().to_string();
    assert_eq!(error, "there is no clip `run` in the file; its clips are `bend`, `Rig|Walk`, `clip_3`");
    let long = "Rig_Medium|Melee_1H_Attack_Slice_Diagonal_From_The_Left_To_The_Right_And_Back_Again";
    doc.animation(long);
    let with = |clip| read_gltf(&doc.glb(), &ImportOptions { clip, ..Default::default() }, &no_files);
    let error = with(Some(ClipChoice::Name("run".into()))).unwrap_err().to_string();
    assert!(error.contains(long), "names are to be copied: {error}");
    for number in [0, 9, usize::MAX] {
        assert!(with(Some(ClipChoice::Number(number))).is_err());
    }
}

#[test]
fn a_file_without_clips_gives_its_rest_pose() {
    let import = read(&Doc::leg());
    assert_eq!((import.clip.frames(), import.clip_index, codes(&import)), (1, None, vec!["gltf-rest-pose"]));
    assert_eq!(kinematics::positions(&import.clip).frame(0)[2], Vec3::ZERO);
}

#[test]
fn joints_stand_after_their_parents_whatever_the_file_says() {
    let mut doc = Doc::leg();
    let moved = json!([
        { "name": "knee_end", "translation": [0.0, -0.5, 0.0] },
        { "name": "knee", "translation": [0.0, -0.5, 0.0], "children": [0] },
        { "name": "hip", "translation": [0.0, 1.0, 0.0], "children": [1] },
    ]);
    doc.json["nodes"] = moved;
    doc.json["skins"] = json!([{ "joints": [1, 2] }, { "joints": [2] }]);
    let import = read(&doc);
    let names: Vec<_> = import.clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["hip", "knee", "knee_end"]);
    assert_eq!(codes(&import), ["gltf-skins", "gltf-rest-pose"]);
}

#[test]
fn without_a_skin_the_nodes_that_move_are_joints() {
    let mut doc = Doc::walking_leg();
    doc.json["skins"] = json!([]);
    let import = read(&doc);
    assert_eq!((import.clip.skeleton().len(), codes(&import)), (3, vec!["gltf-no-skin"]));
    doc.json["animations"] = json!([]);
    let message = "the file: neither a skeleton nor a clip; a motion needs joints; rig the mesh first, or export it together with its armature";
    assert_eq!(error(&doc).to_string(), message);
    doc.json["nodes"][0]["mesh"] = json!(0);
    assert!(error(&doc).to_string().starts_with("the file: a mesh without a skeleton; "));
}

#[test]
fn channels_of_other_things_are_left_out() {
    let mut doc = Doc::walking_leg();
    doc.list("nodes").push(json!({ "name": "lamp" }));
    doc.channel(3, "translation", "LINEAR", &[0.0, 9.0], "VEC3", &[0.0; 6]);
    doc.channel_of(0, "weights", "LINEAR", 999, 999);
    let import = read(&doc);
    assert_eq!((import.clip.frames(), codes(&import)), (31, vec!["gltf-other-channels"]));
}

#[test]
fn data_in_the_text_and_files_beside_it() {
    let doc = Doc::walking_leg();
    let expected = read(&doc);
    let inside = doc.text(&format!("data:application/octet-stream;base64,{}", STANDARD.encode(&doc.bin)));
    let import = read_gltf(&inside, &ImportOptions::default(), &no_files).unwrap();
    assert_eq!((&import.clip, import.source.format), (&expected.clip, Format::Gltf));
    let files = |name: &str, most: usize| {
        assert!(name == "data/leg 1.bin" && most > doc.bin.len());
        Ok(doc.bin.clone())
    };
    let beside = read_gltf(&doc.text("data/leg%201.bin"), &ImportOptions::default(), &files).unwrap();
    assert_eq!(beside.clip, expected.clip);
}

#[test]
fn nothing_outside_of_the_folder_is_asked_for() {
    let doc = Doc::walking_leg();
    let never = |name: &str, _: usize| -> std::io::Result<Vec<u8>> { panic!("asked for {name}") };
    for address in
        ["../x", "a/../../x", "%2e%2e/x", "/etc/passwd", "file:///etc/passwd", "http://a/b", "C:\\x", ""]
    {
        let error = read_gltf(&doc.text(address), &ImportOptions::default(), &never).unwrap_err();
        assert_eq!(error.code(), "gltf-address", "{address}: {error}");
        assert!(error.to_string().starts_with(&format!("buffer 0: it lies at `{address}`: ")), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_not_followed() {
    let root = std::env::temp_dir().join(format!("inkrig-folder-{}", std::process::id()));
    let folder = root.join("in");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(root.join("secret"), b"secret").unwrap();
    std::fs::write(folder.join("near"), b"near").unwrap();
    std::os::unix::fs::symlink(root.join("secret"), folder.join("link")).unwrap();
    std::os::unix::fs::symlink(folder.join("near"), folder.join("inside")).unwrap();
    let read = |name: &str, most| read_in_folder(&folder, name, most).map_err(|error| error.to_string());
    assert_eq!(read("near", 4).unwrap(), b"near");
    assert_eq!(read("inside", 4).unwrap(), b"near");
    assert_eq!(read("near", 3).unwrap_err(), "it is too large");
    for name in ["link", "../secret", "/etc/passwd"] {
        assert_eq!(read(name, 99).unwrap_err(), "it lies outside of the document's folder", "{name}");
    }
    assert_eq!(read(".", 99).unwrap_err(), "it is no ordinary file");
    std::fs::remove_dir_all(&root).unwrap();
}

#[test]
fn the_bones_of_a_person_are_known() {
    let mut doc = Doc::leg();
    // A bone need not be in a skin.
    doc.json["skins"] = json!([{ "joints": [1] }]);
    doc.json["extensions"] = json!({ "VRMC_vrm": { "humanoid": { "humanBones": {
        "leftLowerLeg": { "node": 1 }, "hips": { "node": 0 }, "unknown": { "node": 0 } } } } });
    let import = read(&doc);
    let bones = |import: &Import| -> Vec<_> {
        import.source.humanoid.iter().map(|bone| (bone.name, bone.joint)).collect()
    };
    assert_eq!(bones(&import), [("hips", 0), ("leftLowerLeg", 1)]);
    assert_eq!((import.source.format, import.clip.skeleton().len()), (Format::Vrm, 3));
    // In VRM 0.x the bones of the thumb have other names.
    doc.json["extensions"] = json!({ "VRM": { "humanoid": { "humanBones": [
        { "bone": "leftThumbProximal", "node": 1 }, { "bone": "hips", "node": 0 }, { "bone": "jaw", "node": -1 }] } } });
    let import = read(&doc);
    assert_eq!(bones(&import), [("hips", 0), ("leftThumbMetacarpal", 1)]);
    // A VRMA has neither skin nor mesh.
    doc.json["skins"] = json!([]);
    doc.json["extensions"] =
        json!({ "VRMC_vrm_animation": { "humanoid": { "humanBones": { "hips": { "node": 0 } } } } });
    let import = read(&doc);
    assert_eq!((import.source.format, bones(&import)), (Format::Vrma, vec![("hips", 0)]));
}

#[test]
fn unit_axis_and_rate_can_be_given() {
    let doc = Doc::walking_leg();
    let options = ImportOptions {
        metres_per_unit: Some(0.01),
        up: Some(UpAxis::Z),
        frame_rate: Some(15.0),
        ..Default::default()
    };
    let import = read_gltf(&doc.glb(), &options, &no_files).unwrap();
    assert_eq!((import.clip.frames(), import.clip.frame_rate()), (16, 15.0));
    assert!(near(import.clip.skeleton().joints()[0].offset, [0.0, 0.0, -0.01]));
    assert!(near(kinematics::positions(&import.clip).frame(15)[0], [0.0, 0.01, -0.01]));
    let warned = import.findings.iter().find(|finding| finding.code == "gltf-size").unwrap();
    assert_eq!(warned.severity, Severity::Warning);
}
