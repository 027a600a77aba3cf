//! `inkrig convert`.

use crate::{desk, inkrig, text};
use inkrig::formats::{ImportOptions, no_files, read_bvh, read_gltf};
use inkrig::motion::{Clip, kinematics};
use std::path::Path;

fn read(path: &Path) -> Clip {
    let bytes = std::fs::read(path).unwrap();
    if path.extension().unwrap() == "bvh" {
        read_bvh(&bytes, &ImportOptions::default()).unwrap().clip
    } else {
        read_gltf(&bytes, &ImportOptions::default(), &no_files).unwrap().clip
    }
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
    assert_eq!(names, ["hound.glb", "person.glb"], "nothing partial stays");

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
    let short = inkrig(&folder, &["convert", "hound.bvh", "p.bvh", "--loop", "3599s"]);
    assert!(text(&short.stderr).contains("hound.bvh"), "{}", text(&short.stderr));
    let range = inkrig(&folder, &["convert", "hound.bvh", "p.bvh", "--range", "1s..2s", "--json"]);
    let record: serde_json::Value = serde_json::from_slice(&range.stdout).unwrap();
    assert!((record["seconds"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{record}");
}
