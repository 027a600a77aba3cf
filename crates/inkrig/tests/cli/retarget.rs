//! `inkrig retarget`.

use crate::{desk, inkrig, text};
use inkrig::formats::{ImportOptions, no_files, read_bvh, read_gltf};
use inkrig::motion::kinematics;
use std::path::{Path, PathBuf};

/// The person under the names of another program, and its pairs.
const NAMES: [(&str, &str); 12] = [
    ("Hips", "pelvis"),
    ("Shoulder", "Clavicle"),
    ("LeftForeArm", "lowerarm_l"),
    ("RightForeArm", "lowerarm_r"),
    ("LeftArm", "upperarm_l"),
    ("RightArm", "upperarm_r"),
    ("LeftUpLeg", "thigh_l"),
    ("RightUpLeg", "thigh_r"),
    ("LeftLeg", "calf_l"),
    ("RightLeg", "calf_r"),
    ("LeftFoot", "foot_l"),
    ("RightFoot", "foot_r"),
];

fn renamed(folder: &Path) {
    let mut bvh = text(inkrig::samples::find("person").unwrap().bytes);
    for (from, to) in NAMES {
        bvh = bvh.replace(from, to);
    }
    std::fs::write(folder.join("other.bvh"), bvh).unwrap();
}

fn record(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let done = inkrig(folder, &[&["retarget"], arguments, &["--json", "--force"]].concat());
    assert!(done.status.success(), "{}", text(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn the_person_moves_alike_under_other_names() {
    let (_keep, folder) = desk();
    renamed(&folder);
    let more =
        ["--range", "0s..4s", "--sheet", "s.png", "--preview", "p.html", "--report", "r.json", "--strict"];
    let given = [&["person.bvh", "--onto", "other.bvh", "-o", "new.bvh"], &more[..]].concat();
    let told = record(&folder, &given);
    let certificate = &told["certificate"];
    assert_eq!(certificate["verdict"], "pass", "{certificate}");
    assert!((certificate["scale"].as_f64().unwrap() - 1.0).abs() < 1e-4);
    let pairs = certificate["pairs"].as_array().unwrap();
    assert!(pairs.iter().any(|pair| pair["character"] == "thigh_l" && pair["motion"] == "LeftUpLeg"));
    assert_eq!(certificate["unmapped"].as_array().unwrap().len(), 0, "{certificate}");
    assert_eq!(certificate["limbs"].as_array().unwrap().len(), 8);
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    assert_eq!(report, told);
    assert!(std::fs::read(folder.join("s.png")).unwrap().starts_with(b"\x89PNG"));
    let page = std::fs::read_to_string(folder.join("p.html")).unwrap();
    assert!(page.contains("\"kind\":\"way\"") && page.contains("knees and elbows"));
    assert_eq!(told["read_back"]["kept"], true, "{}", told["read_back"]);
    assert_eq!(certificate["hinges"].as_array().unwrap().len(), 4);
    assert_eq!(certificate["joints"].as_array().unwrap().len(), pairs.len());

    // Without its feet held, the same body moves as it did.
    record(&folder, &["person.bvh", "--onto", "other.bvh", "-o", "new.bvh", "--no-keep-feet"]);
    let read = |name: &str| {
        read_bvh(&std::fs::read(folder.join(name)).unwrap(), &ImportOptions::default()).unwrap().clip
    };
    let (old, new) = (read("person.bvh"), read("new.bvh"));
    let (a, b) = (kinematics::positions(&old), kinematics::positions(&new));
    let mut largest = 0.0_f32;
    for frame in 0..old.frames() {
        for (one, other) in a.frame(frame).iter().zip(b.frame(frame)) {
            // The ground is put where the character's own is.
            largest = largest.max((*one - a.frame(frame)[0]).distance(*other - b.frame(frame)[0]));
        }
    }
    assert!(largest < 5e-3, "{largest} m");
}

#[test]
fn a_map_is_written_changed_and_obeyed() {
    let (_keep, folder) = desk();
    renamed(&folder);
    let base = ["person.bvh", "--onto", "other.bvh"];
    let suggested = record(&folder, &[&base[..], &["--suggest-map", "-o", "map.json"]].concat());
    assert!(suggested["pairs"].as_u64().unwrap() > 15, "{suggested}");
    let map = || [&base[..], &["--map", "map.json", "-o", "new.bvh", "--range", "0s..2s"]].concat();
    let told = record(&folder, &map());
    assert_eq!(told["certificate"]["verdict"], "pass");
    let plain = [&base[..], &["-o", "plain.bvh", "--range", "0s..2s"]].concat();
    record(&folder, &plain);
    let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("new.bvh"), bytes("plain.bvh"), "what was found, written and read");
    // An arm that shall rest is taken out.
    let text = std::fs::read_to_string(folder.join("map.json")).unwrap();
    let mut file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let joints = file["joints"].as_array_mut().unwrap();
    joints.retain(|entry| !entry["motion"].as_str().unwrap().starts_with("LeftForeArm"));
    std::fs::write(folder.join("map.json"), file.to_string()).unwrap();
    let told = record(&folder, &map());
    assert_eq!(told["certificate"]["unmapped"], serde_json::json!(["lowerarm_l"]));
    std::fs::write(folder.join("map.json"), text.replace("\"LeftArm\"", "\"LeftArn\"")).unwrap();
    let done = inkrig(&folder, &[&["retarget"], &map()[..], &["--force"]].concat());
    let said = text_of(&done.stderr);
    assert!(said.contains("no joint LeftArn") && said.contains("LeftArm"), "{said}");
}

/// What was said, lines joined.
fn text_of(bytes: &[u8]) -> String {
    text(bytes).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

#[test]
fn a_wrong_scale_is_a_broken_limit() {
    let (_keep, folder) = desk();
    renamed(&folder);
    let plain = [
        "retarget",
        "person.bvh",
        "--onto",
        "other.bvh",
        "-o",
        "new.bvh",
        "--scale",
        "0.5",
        "--report",
        "r.json",
    ];
    let refused = inkrig(&folder, &[&plain[..], &["--strict"]].concat());
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("was not written"), "{}", text(&refused.stderr));
    assert!(text(&refused.stdout).contains("certificate: warn"), "{}", text(&refused.stdout));
    assert!(!folder.join("new.bvh").exists() && folder.join("r.json").exists());
    let written = inkrig(&folder, &[&plain[..], &["--force"]].concat());
    assert!(written.status.success() && text(&written.stdout).contains("warning: "));
    assert!(folder.join("new.bvh").exists());
}

#[test]
fn a_motion_that_is_one_pose_is_said_and_a_characters_clips_are_not() {
    let (_keep, folder) = desk();
    let run = |arguments: &[&str]| {
        let done = inkrig(&folder, arguments);
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stderr)
    };
    run(&["convert", "person.bvh", "still.bvh", "--range", "0..1"]);
    let said = run(&["retarget", "still.bvh", "--onto", "person.bvh", "-o", "new.bvh"]);
    assert!(said.contains("still.bvh: nothing moves in this file"), "{said}");
    run(&["convert", "person.bvh", "one.glb", "--range", "0s..3s"]);
    run(&["align", "one.glb", "--curve", "circles.csv", "--length", "2s", "-o", "two.glb"]);
    let said = run(&["retarget", "two.glb", "--onto", "person.bvh", "-o", "a.bvh"]);
    assert!(said.contains("--clip"), "{said}");
    let said = run(&["retarget", "person.bvh", "--onto", "two.glb", "-o", "b.bvh", "--range", "0s..2s"]);
    assert!(!said.contains("--clip") && !said.contains("nothing moves"), "{said}");
    let map = ["retarget", "person.bvh", "--onto", "two.glb", "--suggest-map", "-o", "m.glb"];
    let done = inkrig(&folder, &map);
    assert!(text(&done.stderr).contains("a map is written as .json"), "{}", text(&done.stderr));
    assert!(!folder.join("m.glb").exists());
}

#[test]
fn who_is_no_person_is_named() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("snake.bvh"), inkrig::samples::find("snake").unwrap().bytes).unwrap();
    let said = |motion: &str, onto: &str| {
        let done = inkrig(&folder, &["retarget", motion, "--onto", onto, "-o", "new.bvh"]);
        assert!(!done.status.success());
        text(&done.stderr)
    };
    assert!(said("person.bvh", "snake.bvh").contains("snake.bvh: the character"));
    assert!(said("snake.bvh", "person.bvh").contains("snake.bvh: the motion"));
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    // Its joints have the names of a person's.
    assert!(said("person.bvh", "hound.bvh").contains("it stands on four legs"));
    assert!(!folder.join("new.bvh").exists());
}

fn reference(path: &str) -> Option<String> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("data").join(path);
    if !file.is_file() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "no {path}");
        println!("skipped: no reference file {path} in {}", folder.display());
        return None;
    }
    Some(file.to_string_lossy().into_owned())
}

#[test]
fn captured_walks_go_onto_real_characters() {
    let (Some(walk), Some(human), Some(jog)) = (
        reference("cmu/35/35_01.bvh"),
        reference("creatures/human-model.glb"),
        reference("deepmimic/motions/humanoid3d_walk.txt"),
    ) else {
        return;
    };
    let (_keep, folder) = desk();
    let told = record(&folder, &[&walk, "--onto", &human, "-o", "walk.glb", "--strict"]);
    println!("{}", told["certificate"]["direction_degrees"]);
    let bytes = std::fs::read(folder.join("walk.glb")).unwrap();
    let choice = Some(inkrig::formats::ClipChoice::Name("35_01".into()));
    let import =
        read_gltf(&bytes, &ImportOptions { clip: choice, ..ImportOptions::default() }, &no_files).unwrap();
    assert_eq!(import.clip.frames() as u64, told["frames"].as_u64().unwrap());
    assert!(bytes.len() as u64 > std::fs::metadata(&human).unwrap().len(), "its mesh is still there");
    record(&folder, &[&jog, "--onto", &walk, "-o", "jog.bvh", "--strict"]);
}
