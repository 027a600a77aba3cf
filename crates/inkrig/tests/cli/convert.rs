//! `inkrig convert`.

use crate::{desk, inkrig, text};
use inkrig::formats::{Format, ImportOptions, no_files, read_motion};
use inkrig::motion::{Clip, kinematics};
use std::path::Path;

fn read(path: &Path) -> Clip {
    let format = Format::from_extension(path.extension().unwrap().to_str().unwrap()).unwrap();
    let bytes = std::fs::read(path).unwrap();
    read_motion(&bytes, format, &ImportOptions::default(), &no_files).unwrap().clip
}

fn apart(a: &Clip, b: &Clip) -> f32 {
    assert_eq!((a.frames(), a.skeleton().len()), (b.frames(), b.skeleton().len()));
    let (a, b) = (kinematics::positions(a), kinematics::positions(b));
    let pairs = (0..a.frames()).flat_map(|frame| a.frame(frame).iter().zip(b.frame(frame)));
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn one_file_goes_there_and_back() {
    let (_keep, folder) = desk();
    let done = inkrig(&folder, &["convert", "person.bvh", "person.glb"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let back = inkrig(&folder, &["convert", "person.glb", "back.bvh", "--json"]);
    let record: serde_json::Value = serde_json::from_slice(&back.stdout).unwrap();
    assert_eq!((&record["clip"], &record["format"]), (&"person".into(), &"BVH".into()));
    let (first, last) = (read(&folder.join("person.bvh")), read(&folder.join("back.bvh")));
    assert!(apart(&first, &last) < 1e-4, "{}", apart(&first, &last));
    assert!(inkrig(&folder, &["convert", "person.glb", "p.usda"]).status.success());

    // Never over another file, nor over itself.
    let again = inkrig(&folder, &["convert", "person.bvh", "person.glb"]);
    assert!(!again.status.success() && text(&again.stderr).contains("--force"));
    let same = inkrig(&folder, &["convert", "person.bvh", "person.bvh", "--force"]);
    assert!(!same.status.success() && text(&same.stderr).contains("named twice"));
    assert_eq!(read(&folder.join("person.bvh")), first);
}

#[test]
fn an_fbx_is_read_and_written_like_any_other() {
    let (_keep, folder) = desk();
    let run = |arguments: &[&str]| {
        let done = inkrig(&folder, arguments);
        assert!(done.status.success(), "{arguments:?}: {}", text(&done.stderr));
        text(&done.stdout)
    };
    run(&["convert", "person.bvh", "person.fbx"]);
    run(&["convert", "person.fbx", "back.bvh"]);
    let first = read(&folder.join("person.bvh"));
    assert!(apart(&first, &read(&folder.join("person.fbx"))) < 1e-5);
    assert!(apart(&first, &read(&folder.join("back.bvh"))) < 1e-4);
    let facts: serde_json::Value = serde_json::from_str(&run(&["inspect", "person.fbx", "--json"])).unwrap();
    let found = [&facts["format"], &facts["unit_evidence"], &facts["clips"][0]["name"]];
    assert_eq!(found, ["FBX", "declared in the file", "person"]);
    assert_eq!((&facts["end_sites"], &facts["problems"]), (&5.into(), &serde_json::json!([])));
    run(&["align", "person.fbx", "--curve", "circles.csv", "--length", "2s", "-o", "new.fbx"]);
    assert_eq!(read(&folder.join("new.fbx")).frames(), 60);
    run(&["retarget", "person.bvh", "--onto", "person.fbx", "-o", "moved.fbx"]);
    assert!(apart(&first, &read(&folder.join("moved.fbx"))) < 0.01);
    run(&["convert", "*.fbx", "out", "--to", "fbx", "--fps", "24"]);
    assert_eq!(read(&folder.join("out/person.fbx")).frame_rate(), 24.0);
    std::fs::write(folder.join("bad.fbx"), b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0").unwrap();
    let bad = inkrig(&folder, &["inspect", "bad.fbx"]);
    assert!(!bad.status.success());
    assert!(text(&bad.stderr).contains("it ends in the middle of something"), "{}", text(&bad.stderr));
}

#[test]
fn many_files_go_to_a_folder_and_a_broken_one_is_said() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    std::fs::write(folder.join("broken.bvh"), "HIERARCHY\nROOT hip\n{\n  OFFSET 0 zero 0\n").unwrap();
    let convert = || inkrig(&folder, &["convert", "*.bvh", "out", "--to", "glb", "--json"]);
    let done = convert();
    assert_eq!(done.status.code(), Some(1));
    let said = text(&done.stderr);
    assert!(said.contains("1 of 3 files") && said.contains("broken.bvh"), "{said}");
    let record: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(record["converted"].as_array().unwrap().len(), 2);
    assert!(record["failed"][0]["error"].as_str().unwrap().contains("line 4"), "{record}");
    let mut names: Vec<String> = std::fs::read_dir(folder.join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = ["hound.glb", "hound.glb.inkrig.json", "person.glb", "person.glb.inkrig.json"];
    assert_eq!(names, expected, "nothing partial stays");

    // A second time nothing is replaced, and that is said of each.
    let record: serde_json::Value = serde_json::from_slice(&convert().stdout).unwrap();
    assert_eq!(record["failed"].as_array().unwrap().len(), 3);
    let one = inkrig(&folder, &["convert", "person.bvh", "hound.bvh", "out.glb"]);
    assert!(text(&one.stderr).contains("--to"), "{}", text(&one.stderr));
    let none = inkrig(&folder, &["convert", "*.amc", "out", "--to", "bvh"]);
    assert!(text(&none.stderr).contains("no file is called"), "{}", text(&none.stderr));
}

#[test]
fn rate_loop_and_ground_are_of_the_written_clip() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    let arguments = [
        "convert",
        "hound.bvh",
        "o.glb",
        "--range",
        "5s..",
        "--fps",
        "24",
        "--loop",
        "20",
        "--root",
        "in-place",
        "--json",
    ];
    let done = inkrig(&folder, &arguments);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let record: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&record["frames"], &record["root"]["mode"]), (&20.into(), &"in-place".into()));
    assert!((16..=25).contains(&record["loop"]["period"].as_u64().unwrap()), "{record}");
    let clip = read(&folder.join("o.glb"));
    assert_eq!(clip.frames(), 20);
    assert!((clip.frame_rate() - 24.0).abs() < 1e-3);
    let short = inkrig(&folder, &["convert", "hound.bvh", "p.bvh", "--loop", "3333s"]);
    assert!(text(&short.stderr).contains("hound.bvh"), "{}", text(&short.stderr));
    let range = inkrig(&folder, &["convert", "hound.bvh", "p.bvh", "--range", "1s..2s", "--json"]);
    let record: serde_json::Value = serde_json::from_slice(&range.stdout).unwrap();
    assert!((record["seconds"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{record}");
}

#[test]
fn a_person_of_common_names_becomes_a_vrma() {
    let (_keep, folder) = desk();
    let done = inkrig(&folder, &["convert", "person.bvh", "person.vrma"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let bytes = std::fs::read(folder.join("person.vrma")).unwrap();
    let again = read_motion(&bytes, Format::Vrma, &ImportOptions::default(), &no_files).unwrap();
    let bones: Vec<&str> = again.source.humanoid.iter().map(|bone| bone.name).collect();
    assert_eq!(bones.len(), 22, "{bones:?}");
    let first = read(&folder.join("person.bvh"));
    let place = |clip: &Clip, name: &str| {
        let joint = clip.skeleton().joints().iter().position(|joint| joint.name == name).unwrap();
        kinematics::positions(clip).frame(60)[joint]
    };
    for name in ["LeftHand", "RightFoot", "Head"] {
        let apart = place(&first, name).distance(place(&again.clip, name));
        assert!(apart < 0.01, "{name}: {apart} m");
    }
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    let hound = inkrig(&folder, &["convert", "hound.bvh", "hound.vrma"]);
    assert!(text(&hound.stderr).contains("bones that are not known: hips"), "{}", text(&hound.stderr));
    assert!(!folder.join("hound.vrma").exists());
}

#[test]
fn where_nothing_is_converted_no_folder_stays() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("broken.fbx"), "no FBX").unwrap();
    let done = inkrig(&folder, &["convert", "*.fbx", "c/many", "--to", "bvh"]);
    assert!(!done.status.success() && !folder.join("c").exists(), "{}", text(&done.stderr));
    std::fs::create_dir(folder.join("own")).unwrap();
    inkrig(&folder, &["convert", "*.fbx", "own/many", "--to", "bvh"]);
    assert!(folder.join("own").exists() && !folder.join("own/many").exists());
    // What cannot be is said before anything is read.
    let early = inkrig(&folder, &["convert", "no.bvh", "x.bvh", "--bake", "sparse"]);
    assert!(text(&early.stderr).contains("a pose a frame"), "{}", text(&early.stderr));
}
