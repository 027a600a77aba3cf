//! What is written as GLB comes back; what a clip is put into stays as it was.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and some print their tables"
)]

mod common;

use common::{Difference, gltf::Doc, odd_clip};
use inkrig_formats::{
    ClipChoice, ExportOptions, Format, Import, ImportOptions, UpAxis, no_files, read_bvh, read_gltf,
    read_motion, write_bvh, write_glb, write_motion,
};
use inkrig_motion::{
    Clip, Joint, Skeleton,
    glam::{Quat, Vec3},
    ground::{SkeletonChange, TravelOptions, add_root_bone},
    kinematics,
};
use serde_json::{Value, json};
use std::sync::Arc;

fn back(bytes: &[u8]) -> Import {
    read_gltf(bytes, &ImportOptions::default(), &no_files).unwrap()
}

#[test]
fn a_clip_comes_back_from_its_glb() {
    for (frames, rate) in [(1, 30.0), (2, 30.0), (3, 24.0), (40, 120.000_48), (41, 30.0 / 1.001), (300, 60.0)]
    {
        let clip = odd_clip(frames, rate);
        let options = ExportOptions { name: Some("walk \"1\"".into()), ..Default::default() };
        let import = back(&write_glb(&clip, &options).unwrap().bytes);
        let difference = Difference::between(&clip, &import.clip);
        assert!(difference.is_kept(), "{frames} frames: {difference:?}");
        let same_rate = (import.clip.frame_rate() / rate - 1.0).abs() < 1e-6;
        assert!(same_rate || frames == 1, "{rate}: {}", import.clip.frame_rate());
        assert_eq!(import.clips[0].name, "walk \"1\"");
        assert_eq!(
            import.findings.iter().filter(|finding| finding.code != "joint-duplicate-name").count(),
            0
        );
    }
}

#[test]
fn writing_twice_gives_the_same_bytes() {
    let clip = odd_clip(20, 30.0);
    let write = || write_glb(&clip, &ExportOptions::default()).unwrap().bytes;
    assert_eq!(write(), write());
}

#[test]
fn any_skeleton_has_a_body() {
    let lone = vec![Joint::new("", None, Vec3::ZERO)];
    let coinciding = vec![Joint::new("a", None, Vec3::ZERO), Joint::new("b", Some(0), Vec3::ZERO)];
    for joints in [lone, coinciding] {
        let count = joints.len();
        let skeleton = Arc::new(Skeleton::new(joints).unwrap());
        let clip = Clip::new(skeleton, 30.0, vec![Quat::IDENTITY; count], vec![]).unwrap();
        let bytes = write_glb(&clip, &ExportOptions::default()).unwrap().bytes;
        let json = parts(&bytes).0;
        let vertices = json["accessors"][0]["count"].as_u64().unwrap();
        assert_eq!(vertices % 34, 0);
        assert!(vertices > 0);
    }
}

#[test]
fn a_bvh_survives_the_way_through_a_glb() {
    let first = read_bvh(
        &write_bvh(&odd_clip(30, 60.0), &ExportOptions::default()).unwrap().bytes,
        &ImportOptions::default(),
    );
    let first = first.unwrap();
    let glb = write_motion(&first.clip, Format::Glb, &ExportOptions::like(&first.source)).unwrap();
    let second = read_motion(&glb.bytes, Format::Glb, &ImportOptions::default(), &no_files).unwrap();
    let bvh = write_motion(&second.clip, Format::Bvh, &ExportOptions::like(&first.source)).unwrap();
    let third =
        read_bvh(&bvh.bytes, &ImportOptions { metres_per_unit: Some(0.01), ..Default::default() }).unwrap();
    let difference = Difference::between(&first.clip, &third.clip);
    assert!(difference.is_kept(), "{difference:?}");
    assert_eq!(first.clip.frame_rate(), third.clip.frame_rate());
}

#[test]
fn reference_motions_survive_the_way_through_a_glb() {
    let Some(files) = common::reference_files("bvh") else { return };
    let mut worst = Difference::default();
    // Every tenth is enough: all collections are among them.
    let files: Vec<_> = files.iter().step_by(10).collect();
    for path in &files {
        let first = read_bvh(&std::fs::read(path).unwrap(), &ImportOptions::default()).unwrap();
        let glb = write_glb(&first.clip, &ExportOptions::default()).unwrap();
        let second = back(&glb.bytes);
        let difference = Difference::between(&first.clip, &second.clip);
        assert!(difference.is_kept(), "{}: {difference:?}", path.display());
        let rates = (first.clip.frame_rate(), second.clip.frame_rate());
        assert!((rates.0 / rates.1 - 1.0).abs() < 1e-6, "{}: {rates:?}", path.display());
        worst = worst.largest(difference);
    }
    println!("{} BVH files through GLB: {worst:?}", files.len());
}

/// JSON and bytes of a GLB.
fn parts(glb: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    (json, glb.get(28 + length..).unwrap_or_default().to_vec())
}

/// Everything of the old file is in the new one: all but the lists that got longer is the same, and those begin with
/// what they had. `replaced` is the clip that may differ.
fn nothing_else_changed(old: &[u8], new: &[u8], replaced: Option<usize>) {
    let ((mut old, old_bin), (mut new, new_bin)) = (parts(old), parts(new));
    assert_eq!(new_bin[..old_bin.len()], old_bin);
    assert_eq!(new["buffers"][0]["byteLength"], json!(new_bin.len()));
    for name in ["animations", "accessors", "bufferViews", "buffers"] {
        let (Value::Array(mut before), Value::Array(mut after)) = (old[name].take(), new[name].take()) else {
            assert!(name == "animations", "{name}");
            continue;
        };
        after.truncate(before.len());
        if name == "buffers" {
            (before[0]["byteLength"], after[0]["byteLength"]) = (Value::Null, Value::Null);
        }
        if let Some(index) = replaced.filter(|_| name == "animations") {
            (before[index], after[index]) = (Value::Null, Value::Null);
        }
        assert_eq!(before, after, "{name}");
    }
    for json in [&mut old, &mut new] {
        json.as_object_mut().unwrap().retain(|_, value| !value.is_null());
    }
    assert_eq!(old, new);
}

#[test]
fn a_clip_is_put_into_the_file_that_it_came_from() {
    let mut doc = Doc::walking_leg();
    // Above, between and in the joints: scales, turns, a matrix.
    doc.list("nodes").extend([
        json!({ "name": "Armature", "children": [4], "scale": [100, 100, 100], "rotation": [-0.5, 0.5, 0.5, 0.5] }),
        json!({ "name": "between", "children": [0], "translation": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8] }),
    ]);
    doc.json["nodes"][1]["rotation"] = json!([0.0, 0.0, 0.6, 0.8]);
    doc.json["nodes"][1]["scale"] = json!([2, 2, 2]);
    doc.json["materials"] =
        json!([{ "name": "ü \u{1} fur", "extras": { "deep": [1.10, 1e-7, 123456789012345678_u64] } }]);
    let file = doc.glb();
    let import = back(&file);
    // Another motion of the same skeleton.
    let shifted: Vec<Quat> = (0..import.clip.frames())
        .flat_map(|frame| {
            import.clip.rotations(frame).iter().enumerate().map(move |(joint, rotation)| {
                if joint == 2 { *rotation } else { Quat::from_rotation_y(0.02 * frame as f32) * *rotation }
            })
        })
        .collect();
    let tracks = import.clip.translations().to_vec();
    let clip = Clip::new(import.clip.skeleton().clone(), 30.0, shifted, tracks).unwrap();
    let like = ExportOptions::like(&import.source);
    let written = write_glb(&clip, &ExportOptions { name: Some("new".into()), ..like.clone() }).unwrap();
    assert_eq!(written.findings, []);
    nothing_else_changed(&file, &written.bytes, None);
    let read = |bytes: &[u8], number| {
        let options = ImportOptions { clip: Some(ClipChoice::Number(number)), ..Default::default() };
        read_gltf(bytes, &options, &no_files).unwrap()
    };
    let again = read(&written.bytes, 2);
    assert_eq!(again.clips[1].name, "new");
    let difference = Difference::between(&clip, &again.clip);
    assert!(difference.is_kept(), "{difference:?}");
    assert_eq!(read(&written.bytes, 1).clip, import.clip);
    // The same name: a number behind it, or the clip taken out.
    let bend = ExportOptions { name: Some("bend".into()), ..like.clone() };
    let second = read(&write_glb(&clip, &bend).unwrap().bytes, 2);
    assert_eq!(second.clips[1].name, "bend 2");
    let replaced = write_glb(&clip, &ExportOptions { replace: true, ..bend }).unwrap().bytes;
    nothing_else_changed(&file, &replaced, Some(0));
    let only = read(&replaced, 1);
    assert_eq!(only.clips.len(), 1);
    assert!(Difference::between(&clip, &only.clip).is_kept());
    // Read in another unit and with another axis, and put back by the same.
    let odd = ImportOptions { metres_per_unit: Some(0.0254), up: Some(UpAxis::Z), ..Default::default() };
    let import = read_gltf(&file, &odd, &no_files).unwrap();
    let written = write_glb(&import.clip, &ExportOptions::like(&import.source)).unwrap();
    let again =
        read_gltf(&written.bytes, &ImportOptions { clip: Some(ClipChoice::Number(2)), ..odd }, &no_files);
    assert!(Difference::between(&import.clip, &again.unwrap().clip).is_kept());
}

#[test]
fn a_joint_placed_by_a_matrix_gets_its_parts() {
    let mut doc = Doc::walking_leg();
    let node = doc.json["nodes"][0].as_object_mut().unwrap();
    node.remove("translation");
    node.insert("matrix".into(), json!([0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0.5, 1, 0, 1]));
    let import = back(&doc.glb());
    let written = write_glb(&import.clip, &ExportOptions::like(&import.source)).unwrap();
    assert_eq!(written.findings[0].code, "gltf-matrix");
    assert!(parts(&written.bytes).0["nodes"][0].get("matrix").is_none());
    assert!(Difference::between(&import.clip, &back(&written.bytes).clip).is_kept());
}

#[test]
fn text_files_get_their_clip_in_the_text() {
    let doc = Doc::walking_leg();
    let files = |_: &str, _: usize| Ok(doc.bin.clone());
    let text = doc.text("leg.bin");
    let import = read_gltf(&text, &ImportOptions::default(), &files).unwrap();
    let like = ExportOptions::like(&import.source);
    for format in [Format::Gltf, Format::Glb] {
        let written = write_motion(&import.clip, format, &like).unwrap().bytes;
        assert_eq!(written.starts_with(b"glTF"), format == Format::Glb);
        let options = ImportOptions { clip: Some(ClipChoice::Name("motion".into())), ..Default::default() };
        let again = read_gltf(&written, &options, &files).unwrap();
        assert!(Difference::between(&import.clip, &again.clip).is_kept());
    }
    let glb = ExportOptions::like(&back(&doc.glb()).source);
    assert!(write_motion(&import.clip, Format::Gltf, &glb).is_err());
    assert!(write_motion(&import.clip, Format::Gltf, &ExportOptions::default()).is_err());
}

#[test]
fn a_clip_of_another_skeleton_is_refused() {
    let import = back(&Doc::walking_leg().glb());
    let error = write_glb(&odd_clip(3, 30.0), &ExportOptions::like(&import.source)).unwrap_err().to_string();
    assert_eq!(
        error,
        "the clip has 7 joints, and the file 3; retarget the clip to the character first, or write a file of its own"
    );
}

#[test]
fn real_characters_get_their_own_clips_back() {
    let Some(files) = common::reference_files("glb") else { return };
    let mut worst = Difference::default();
    for path in files.iter().filter(|path| !path.ends_with("fox-model.glb")) {
        let file = std::fs::read(path).unwrap();
        let import = back(&file);
        let options = ExportOptions { name: Some("new".into()), ..ExportOptions::like(&import.source) };
        let written = write_glb(&import.clip, &options).unwrap();
        nothing_else_changed(&file, &written.bytes, None);
        let number = import.clips.len() + 1;
        let chosen = ImportOptions { clip: Some(ClipChoice::Number(number)), ..Default::default() };
        let again = read_gltf(&written.bytes, &chosen, &no_files).unwrap();
        let difference = Difference::between(&import.clip, &again.clip);
        assert!(difference.is_kept(), "{}: {difference:?}", path.display());
        worst = worst.largest(difference);
        let alone = write_glb(&import.clip, &ExportOptions::default()).unwrap();
        let alone = Difference::between(&import.clip, &back(&alone.bytes).clip);
        assert!(alone.is_kept(), "{}: {alone:?}", path.display());
        worst = worst.largest(alone);
    }
    println!("put into their own files and into new ones: {worst:?}");
}

/// Where joints are, frame after frame, the one left out that the other clip has not.
fn apart(bone: Option<usize>, with: &Clip, without: &Clip) -> f32 {
    let (a, b) = (kinematics::positions(with), kinematics::positions(without));
    let mut worst = 0.0_f32;
    for frame in 0..without.frames() {
        let left = a.frame(frame).iter().enumerate().filter(|(joint, _)| Some(*joint) != bone);
        let pairs = left.map(|(_, place)| place).zip(b.frame(frame));
        worst = pairs.map(|(a, b)| a.distance(*b)).fold(worst, f32::max);
    }
    worst
}

/// A clip with a root bone more goes into the character's own file: a node above the hips, everything else untouched,
/// and the clips that were there play as before.
#[test]
fn a_root_bone_becomes_a_node_of_the_file() {
    let leg = ("the leg".to_string(), Doc::walking_leg().glb());
    let files = common::reference_files("glb").unwrap_or_default();
    let files = files.iter().filter(|path| !path.ends_with("fox-model.glb"));
    let real = files.map(|path| (path.display().to_string(), std::fs::read(path).unwrap()));
    let mut inserted = 0;
    for (name, file) in std::iter::once(leg).chain(real) {
        let import = back(&file);
        let change = add_root_bone(&import.clip, &TravelOptions::default()).unwrap();
        let SkeletonChange::Inserted(bone) = change.skeleton else { continue };
        inserted += 1;
        let options = ExportOptions { name: Some("new".into()), ..ExportOptions::like(&import.source) };
        let written = write_glb(&change.clip, &options).unwrap();
        assert!(written.findings.iter().any(|finding| finding.code == "gltf-bone"), "{name}");
        let ((old, _), (new, _)) = (parts(&file), parts(&written.bytes));
        for kept in ["meshes", "skins", "materials", "textures", "images"] {
            assert_eq!(old.get(kept), new.get(kept), "{name}: {kept}");
        }
        let (old, new) = (old["nodes"].as_array().unwrap(), new["nodes"].as_array().unwrap());
        assert_eq!(new.len(), old.len() + 1, "{name}");
        let bone_name = &change.clip.skeleton().joints()[bone].name;
        assert_eq!(new[old.len()]["name"], json!(bone_name));
        // At most the node above has another child.
        assert!(old.iter().zip(new).filter(|(a, b)| a != b).count() <= 1, "{name}");
        let read = |number: usize| {
            let options = ImportOptions { clip: Some(ClipChoice::Number(number)), ..Default::default() };
            read_gltf(&written.bytes, &options, &no_files).unwrap().clip
        };
        let size = import.clip.skeleton().extent().max(1e-3);
        let far = apart(Some(bone), &change.clip, &read(import.clips.len() + 1)) / size;
        assert!(far < 1e-5, "{name}: {far} of its size");
        if !import.clips.is_empty() {
            assert_eq!(read(1), import.clip, "{name}");
        }
    }
    println!("{inserted} files got a root bone");
    assert!(inserted > 0);
}

#[test]
fn a_person_survives_the_way_through_a_vrma() {
    let Some(files) = common::reference_files("glb") else { return };
    let path = files.iter().find(|path| path.ends_with("Med_MovementAdvanced.glb")).unwrap();
    let mut import = back(&std::fs::read(path).unwrap());
    let bones = [
        ("hips", "hips"),
        ("spine", "spine"),
        ("chest", "chest"),
        ("head", "head"),
        ("leftUpperArm", "upperarm.l"),
        ("leftLowerArm", "lowerarm.l"),
        ("leftHand", "hand.l"),
        ("rightUpperArm", "upperarm.r"),
        ("rightLowerArm", "lowerarm.r"),
        ("rightHand", "hand.r"),
        ("leftUpperLeg", "upperleg.l"),
        ("leftLowerLeg", "lowerleg.l"),
        ("leftFoot", "foot.l"),
        ("rightUpperLeg", "upperleg.r"),
        ("rightLowerLeg", "lowerleg.r"),
        ("rightFoot", "foot.r"),
        ("leftToes", "toes.l"),
        ("rightToes", "toes.r"),
    ];
    let skeleton = import.clip.skeleton().clone();
    let bone = |(name, joint): &(&'static str, &str)| inkrig_formats::HumanBone {
        name,
        joint: skeleton.find(joint).unwrap_or_else(|| panic!("{joint}")),
    };
    import.source.humanoid = bones.iter().map(bone).collect();
    // A file that says no bones has them by their names.
    let found = write_motion(&import.clip, Format::Vrma, &ExportOptions::default()).unwrap();
    let found = back(&found.bytes).source.humanoid;
    let names = |own: &[inkrig_formats::HumanBone]| own.iter().map(|bone| bone.name).collect::<Vec<_>>();
    for bone in names(&import.source.humanoid) {
        assert!(names(&found).contains(&bone), "{bone}: {found:?}");
    }
    let written = write_motion(&import.clip, Format::Vrma, &ExportOptions::like(&import.source)).unwrap();
    let again = back(&written.bytes);
    assert_eq!((again.source.format, again.source.humanoid.len()), (Format::Vrma, bones.len()));
    let rest = again.clip.skeleton().rest_positions();
    let rest = |name: &str| rest[again.source.humanoid.iter().find(|bone| bone.name == name).unwrap().joint];
    // The rest pose is a T that faces z: arms along x, legs down, the lowest bone on the ground.
    let along = |from: &str, to: &str| (rest(to) - rest(from)).normalize();
    assert!(along("leftUpperArm", "leftHand").distance(Vec3::X) < 1e-4);
    assert!(along("rightUpperArm", "rightHand").distance(Vec3::NEG_X) < 1e-4);
    assert!(along("leftUpperLeg", "leftFoot").distance(Vec3::NEG_Y) < 1e-4);
    assert!(along("leftFoot", "leftToes").z > 0.5, "{}", along("leftFoot", "leftToes"));
    assert!(rest("leftToes").y.min(rest("rightToes").y).abs() < 1e-5);
    // Every bone is where it was, but for what moves in its parent, which the format does not hold.
    let (before, after) = (kinematics::positions(&import.clip), kinematics::positions(&again.clip));
    let joint = |import: &Import, name: &str| {
        import.source.humanoid.iter().find(|bone| bone.name == name).unwrap().joint
    };
    let mut worst = 0.0_f32;
    for (name, _) in bones.iter().take(4) {
        let (a, b) = (joint(&import, name), joint(&again, name));
        for frame in 0..import.clip.frames() {
            worst = worst.max(before.frame(frame)[a].distance(after.frame(frame)[b]));
        }
    }
    println!("hips to head through VRMA: {worst} m, findings {:?}", written.findings);
    assert!(worst < 1e-5);
}
