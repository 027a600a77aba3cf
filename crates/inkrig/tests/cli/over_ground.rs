//! `--root` and `--path`.

use crate::{align, desk, inkrig, text};
use inkrig::formats::{ClipChoice, ImportOptions, no_files, read_bvh, read_gltf};
use inkrig::motion::{Clip, kinematics};
use std::path::Path;

fn record(folder: &Path, more: &[&str]) -> serde_json::Value {
    record_of("person.bvh", folder, more)
}

fn record_of(clip: &str, folder: &Path, more: &[&str]) -> serde_json::Value {
    let plain =
        ["align", clip, "--curve", "circles.csv", "-o", "new.bvh", "--json", "--force", "--levels", "2"];
    let output = inkrig(folder, &[&plain, more].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn written(folder: &Path) -> Clip {
    read_bvh(&std::fs::read(folder.join("new.bvh")).unwrap(), &ImportOptions::default()).unwrap().clip
}

#[test]
fn a_root_bone_is_written_and_folded_back() {
    let (_keep, folder) = desk();
    assert_eq!(record(&folder, &[])["root"]["mode"], "travel");
    let plain = written(&folder);
    let root = &record(&folder, &["--root", "bone"])["root"];
    assert_eq!((&root["joint"], &root["skeleton"]), (&"root".into(), &"a joint more".into()));
    let bone = written(&folder);
    assert_eq!(bone.skeleton().len(), plain.skeleton().len() + 1);
    assert_eq!(bone.skeleton().joints()[1].name, "Hips");
    let (a, b) = (kinematics::positions(&plain), kinematics::positions(&bone));
    for frame in 0..plain.frames() {
        for (one, other) in a.frame(frame).iter().zip(&b.frame(frame)[1..]) {
            assert!(one.distance(*other) < 1e-4, "frame {frame}: written with rounded angles");
        }
    }
    // All results are of the written clip.
    record(&folder, &["--root", "bone", "--preview", "p.html", "--sheet", "s.png", "--fps", "15"]);
    assert_eq!(written(&folder).frames(), plain.frames() / 2);
    assert!(text(&std::fs::read(folder.join("p.html")).unwrap()).contains("carries"));
}

/// A character's own file keeps its body, and gets the bone as a node.
#[test]
fn a_root_bone_goes_into_the_characters_own_file() {
    let (_keep, folder) = desk();
    assert!(inkrig(&folder, &["convert", "person.bvh", "hero.glb"]).status.success());
    let made = |name: &str, more: &[&str]| {
        let plain = ["align", "hero.glb", "--curve", "circles.csv", "-o", name, "--levels", "2", "--json"];
        let output = inkrig(&folder, &[&plain, more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let options = ImportOptions { clip: Some(ClipChoice::Number(2)), ..Default::default() };
        (json, read_gltf(&bytes, &options, &no_files).unwrap().clip)
    };
    let (own, plain) = made("plain.glb", &[]);
    let (json, bone) = made("bone.glb", &["--root", "bone"]);
    for kept in ["meshes", "skins", "materials"] {
        assert_eq!((&own[kept], own[kept].is_array()), (&json[kept], true), "{kept}");
    }
    assert_eq!(json["animations"].as_array().unwrap().len(), 2);
    let nodes = json["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), own["nodes"].as_array().unwrap().len() + 1);
    assert_eq!(nodes.last().unwrap()["name"], "root");
    let (a, b) = (kinematics::positions(&plain), kinematics::positions(&bone));
    assert_eq!(plain.frames(), bone.frames());
    for frame in 0..plain.frames() {
        let far = a.frame(frame).iter().zip(b.frame(frame)).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(far < 1e-4, "frame {frame}: {far} m");
    }
    // Folding keeps the file too.
    let (hips, _) = made("hips.glb", &["--root", "hips"]);
    assert_eq!(hips["skins"], own["skins"]);
}

#[test]
fn in_place_and_paths() {
    let (_keep, folder) = desk();
    let root = &record(&folder, &["--root", "in-place"])["root"];
    let travelled = root["travelled_metres"].as_f64().unwrap();
    let still = written(&folder);
    let values = still.track(0).unwrap();
    let far =
        values.iter().map(|place| place.with_y(0.0).distance(values[0].with_y(0.0))).fold(0.0, f32::max);
    assert!(f64::from(far) < 0.5 * travelled, "{far} m of {travelled} m");

    // Four seconds of the person stay on the spot; the hound runs.
    std::fs::write(folder.join("way.csv"), "0,0\n3,0\n3,3\n").unwrap();
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    let output = align(&folder, &["--path", "straight", "--force"]);
    assert!(text(&output.stderr).contains("does not travel"), "{}", text(&output.stderr));
    let record = |more: &[&str]| record_of("hound.bvh", &folder, more);
    let value = record(&["--path", "way.csv"]);
    let path = &value["root"]["path"];
    let number = |name: &str| path[name].as_f64().unwrap();
    assert!((number("length_metres") / number("travelled_metres") - 1.0).abs() < 1e-6, "{path}");
    assert!(number("mean_distance_metres") < 0.15 && path["slide_after"]["mean_step_mm"].is_f64(), "{path}");
    assert_eq!((&path["route"], &value["parameters"]["path"]), (&"way.csv".into(), &"way.csv".into()));
    assert!(value["inputs"].as_array().unwrap().contains(&"way.csv".into()));
    let path = &record(&["--path", "way.csv", "--path-scale", "1"])["root"]["path"];
    assert_eq!((&path["metres_per_unit"], &path["length_metres"]), (&1.0.into(), &6.0.into()));
    for shape in ["straight", "arc:-90", "bend:45"] {
        assert!(record(&["--path", shape])["root"]["path"]["mean_distance_metres"].is_f64());
    }
}

#[test]
fn paths_that_lead_nowhere_are_refused_with_reasons() {
    let (_keep, folder) = desk();
    for (name, content) in [
        ("dot.csv", "1,1\n1,1\n"),
        ("one.json", "[[1,2]]"),
        ("nan.csv", "0,0\nnan,1\n"),
        ("way.csv", "0,0\n1,0\n"),
    ] {
        std::fs::write(folder.join(name), content).unwrap();
    }
    for (arguments, part) in [
        (&["--path", "dot.csv"][..], "single point"),
        (&["--path", "one.json"], "single point"),
        (&["--path", "nan.csv"], "nan.csv"),
        (&["--path", "none.csv"], "none.csv"),
        (&["--path", "arc:x"], "arc:90"),
        (&["--path", "zigzag"], "zigzag"),
        (&["--path", "way.csv", "--path-scale", "0"], "0.01 for centimetres"),
        (&["--sway", "-1"], "from 0 to 60"),
        (&["--path", "new.bvh"], "named twice"),
    ] {
        let output = align(&folder, arguments);
        let said = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert!(!output.status.success() && said.contains(&part.replace(' ', "")), "{arguments:?}: {said}");
        assert!(!folder.join("new.bvh").exists() && !said.contains("panicked"), "{said}");
    }
}

#[test]
fn a_loop_has_exactly_the_frames_that_were_asked_for() {
    let (_keep, folder) = desk();
    for (rate, frames) in [("24", 96), ("30", 120), ("25", 100), ("60", 240)] {
        let value = record(&folder, &["--loop", "--length", "120", "--fps", rate]);
        assert_eq!(
            (value["frames"].as_u64(), written(&folder).frames()),
            (Some(frames), frames as usize),
            "{rate}"
        );
    }
    // A clip of another rate, asked for in frames of 30 a second.
    let value = record(&folder, &["--loop", "--length", "100", "--source-fps", "24", "--fps", "30"]);
    assert_eq!(value["frames"], 100);
    assert!(value["loop_seam_ratio"].as_f64().unwrap() <= 1.5);
}
