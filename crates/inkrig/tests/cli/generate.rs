//! `inkrig generate` on the command line, with a tiny model of random weights.

use crate::{inkrig, text};
use inkrig::formats::{ImportOptions, read_bvh};
use inkrig::motion::kinematics;
use inkrig_generate::checkpoint::{Listed, ModelHeader, ModelStatistics, NumberKind, write_model};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::networks::{Parts, Sizes};
use inkrig_generate::sampling::Semantics;
use inkrig_generate::text::{VERBS, VerbTable};
use inkrig_generate::weights::{Tensor, hashed};
use inkrig_motion::humanml::{JOINTS, NAMES, PARENTS, RAW_DIRECTIONS, WIDTH};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;

const WORD: [&str; 7] = ["generate", "--model", "m.safetensors", "--word", "kick", "-o", "k.bvh"];

pub(crate) fn header(guidance_width: usize) -> ModelHeader {
    let sizes = Sizes { guidance_width, ..Sizes::tiny() };
    let statistics = ModelStatistics {
        mean: vec![0.0; WIDTH],
        std: vec![0.05; WIDTH],
        mean_raw: vec![0.1; 3 * JOINTS],
        std_raw: vec![0.5; 3 * JOINTS],
    };
    ModelHeader {
        statistics: Some(statistics),
        skeleton: Some(RAW_DIRECTIONS.map(|direction| (0.2 * direction).to_array()).to_vec()),
        licence: "CC0-1.0".into(),
        ..ModelHeader::new("tiny", sizes, Semantics::Paper, TextEncoderKind::Verbs)
    }
}

pub(crate) fn model(header: &ModelHeader, parts: Parts) -> Vec<u8> {
    let (mut weights, width) = (hashed(&header.sizes, parts), header.sizes.text_width);
    let verbs = (0..VERBS.len() * width).map(|at| (at as f32 * 0.7).sin()).collect();
    weights.insert(VerbTable::VERBS, Tensor::new(vec![VERBS.len(), width], verbs).unwrap());
    weights.insert(VerbTable::NOTHING, Tensor::new(vec![width], vec![0.1; width]).unwrap());
    let listed: Vec<Listed> = weights
        .iter()
        .map(|(name, tensor)| Listed {
            name: name.into(),
            kind: NumberKind::F32,
            shape: tensor.shape().to_vec(),
        })
        .collect();
    let mut file = Cursor::new(Vec::new());
    write_model(&mut file, header, &listed, |at| Ok(weights.get(&listed[at].name).unwrap().clone())).unwrap();
    file.into_inner()
}

/// A folder with a model that was not distilled.
fn studio() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    std::fs::write(path.join("m.safetensors"), model(&header(0), Parts::ALL)).unwrap();
    (folder, path)
}

/// The rest pose of the model's body, a metre above the ground, in metres times `unit`.
fn pose(unit: f32) -> Vec<[f32; 3]> {
    let mut joints = vec![inkrig_motion::glam::Vec3::Y; JOINTS];
    for joint in 1..JOINTS {
        joints[joint] = joints[PARENTS[joint]] + 0.2 * RAW_DIRECTIONS[joint];
    }
    joints.iter().map(|joint| (unit * *joint).to_array()).collect()
}

/// What is refused, without its line ends; nothing is written.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = inkrig(folder, arguments);
    let said = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    assert!(!said.contains("panicked") && !folder.join("k.bvh").exists(), "{arguments:?}: {said}");
    said
}

#[test]
fn a_word_becomes_a_motion_and_the_seed_says_which() {
    let (_keep, folder) = studio();
    let made = |more: &[&str]| {
        let output = inkrig(&folder, &[&WORD, more, &["--force"]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        (std::fs::read(folder.join("k.bvh")).unwrap(), text(&output.stdout))
    };
    let (first, said) = made(&[]);
    assert!(said.contains("wrote k.bvh: 2.0 s, 40 frames at 20 a second; model tiny, seed 0"), "{said}");
    assert!(said.contains("licence of the model: CC0-1.0"), "{said}");
    let clip = read_bvh(&first, &ImportOptions::default()).unwrap().clip;
    assert_eq!((clip.frames(), clip.frame_rate().round()), (40, 20.0));
    let names: Vec<&str> = clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert!(NAMES.iter().all(|name| names.contains(name)), "{names:?}");
    assert_eq!(made(&["--seed", "0"]).0, first);
    assert_ne!(made(&["--seed", "1"]).0, first);
    let other = ["generate", "--word", "a person is walking", "-o", "walk.bvh"];
    let run = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .env("INKRIG_MODEL", "m.safetensors")
        .args(other)
        .output();
    assert!(run.unwrap().status.success());
    assert_ne!(std::fs::read(folder.join("walk.bvh")).unwrap(), first);
    let short = read_bvh(&made(&["--frames", "1s"]).0, &ImportOptions::default()).unwrap().clip;
    assert_eq!(short.frames(), 20);
    for out in ["k.glb", "k.fbx", "k.usda", "k.vrma"] {
        let output = inkrig(&folder, &["generate", "--model", "m.safetensors", "--word", "kick", "-o", out]);
        assert!(output.status.success(), "{out}: {}", text(&output.stderr));
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 13, "nothing else but records is left behind");
}

#[test]
fn motions_are_made_again_from_their_records() {
    let (_keep, folder) = studio();
    let way = serde_json::json!({ "joint": 11, "frames": [3], "points": [[0.1, 0.4, 0.2]] });
    std::fs::write(folder.join("way.json"), way.to_string()).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .env("INKRIG_MODEL", "m.safetensors")
        .args(["generate", "--word=kick", "--trajectory3d=way.json", "--seed=5", "-o", "k.bvh"])
        .output();
    assert!(run.unwrap().status.success());
    let record = std::fs::read(folder.join("k.bvh.inkrig.json")).unwrap();
    let record: serde_json::Value = serde_json::from_slice(&record).unwrap();
    assert_eq!((&record["seed"], &record["command"]), (&5.into(), &"generate".into()));
    assert_eq!(record["licences"], serde_json::json!(["CC0-1.0", "unknown: way.json"]));
    let redone = inkrig(&folder, &["redo", "k.bvh.inkrig.json", "-o", "again.bvh"]);
    assert!(redone.status.success(), "{}", text(&redone.stderr));
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_eq!(read("k.bvh"), read("again.bvh"));
    std::fs::write(folder.join("m.safetensors"), model(&header(16), Parts::ALL)).unwrap();
    let other = inkrig(&folder, &["redo", "k.bvh.inkrig.json", "-o", "other.bvh"]);
    assert!(text(&other.stderr).contains("has changed") && !folder.join("other.bvh").exists());
}

#[test]
fn feet_are_on_the_floor_unless_they_shall_stay_as_they_come() {
    let (_keep, folder) = studio();
    let made = |ground: &str, out: &str| {
        let more = ["--ground", ground, "-o", out, "--report", "r.json", "--force"];
        let output = inkrig(&folder, &[&WORD[..5], &more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report = std::fs::read(folder.join("r.json")).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        (text(&output.stdout), report["ground"].clone(), std::fs::read(folder.join(out)).unwrap())
    };
    let (said, ground, on) = made("on", "on.bvh");
    assert!(said.contains("feet on the floor") && said.contains(": body raised or lowered by"), "{said}");
    assert!(!said.contains("before)"), "feet that floated do not count as sliding: {said}");
    // What is said is what stands in the file.
    let options = ImportOptions { metres_per_unit: Some(0.01), ..ImportOptions::default() };
    let clip = read_bvh(&on, &options).unwrap().clip;
    let (places, joints) = (kinematics::positions(&clip), clip.skeleton().joints());
    let feet: Vec<usize> = ["left_ankle", "right_ankle", "left_foot", "right_foot"]
        .map(|name| joints.iter().position(|joint| joint.name == name).unwrap())
        .to_vec();
    let lower =
        |frame: usize| feet.iter().map(|joint| places.frame(frame)[*joint].y).fold(f32::MAX, f32::min);
    let above: Vec<f32> = (0..clip.frames()).map(lower).filter(|height| *height > 0.05).collect();
    assert_eq!(ground["above_frames"], above.len(), "{ground}");
    assert_eq!(said.contains("feet on the floor:"), above.is_empty(), "{said}");
    for name in ["height_mm", "travel_mm", "lower_foot_mm", "skating"] {
        assert!(ground[name].as_array().unwrap().iter().all(serde_json::Value::is_f64), "{name}: {ground}");
    }
    let (said, ground, off) = made("off", "off.bvh");
    assert!(!said.contains("feet on the floor") && ground.is_null() && on != off, "{said}");
    for (name, bytes) in [("on.bvh", on), ("off.bvh", off)] {
        let record = format!("{name}.inkrig.json");
        let redone = inkrig(&folder, &["redo", &record, "-o", "again.bvh", "--force"]);
        assert!(redone.status.success(), "{}", text(&redone.stderr));
        assert_eq!(std::fs::read(folder.join("again.bvh")).unwrap(), bytes);
    }
}

#[test]
fn conditions_move_the_motion_and_guidance_brings_it_nearer() {
    let (_keep, folder) = studio();
    let pose = serde_json::json!({ "frame": 12, "joints": pose(1.0) });
    std::fs::write(folder.join("pose.json"), pose.to_string()).unwrap();
    let way = serde_json::json!({ "joint": "right_foot", "frames": [0, 20, 39], "points": vec![[0.1, 0.4, 0.2]; 3] });
    std::fs::write(folder.join("way.json"), way.to_string()).unwrap();
    let made = |out: &str, more: &[&str]| {
        let both =
            ["--keypose3d", "pose.json", "--trajectory3d", "way.json", "--report", "r.json", "--force"];
        let base = ["generate", "--model", "m.safetensors", "--word", "kick", "-o", out];
        let output = inkrig(&folder, &[&base, &both[..], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&std::fs::read(folder.join("r.json")).unwrap()).unwrap()
    };
    let (soft, off) = (made("soft.bvh", &[]), made("off.bvh", &["--guidance", "off"]));
    let error = |report: &serde_json::Value| report["trajectory"]["mean_error_metres"].as_f64().unwrap();
    assert!(error(&soft) < 0.9 * error(&off), "{} {}", error(&soft), error(&off));
    assert_eq!(
        (&soft["sampler"], &soft["steps"], &soft["actions"][0]),
        (&"ddim".into(), &50.into(), &"kick".into())
    );
    assert_eq!((&off["trajectory"]["guided"], &off["trajectory"]["evaluations"]), (&false.into(), &0.into()));
    // What the report says is what stands in the file.
    let options = ImportOptions { metres_per_unit: Some(0.01), ..ImportOptions::default() };
    let clip = read_bvh(&std::fs::read(folder.join("soft.bvh")).unwrap(), &options).unwrap().clip;
    let foot = clip.skeleton().joints().iter().position(|joint| joint.name == "right_foot").unwrap();
    let places = kinematics::positions(&clip);
    let wanted = inkrig_motion::glam::Vec3::new(0.1, 0.4, 0.2);
    let mean = [0, 20, 39].map(|frame| places.frame(frame)[foot].distance(wanted)).iter().sum::<f32>() / 3.0;
    assert!((f64::from(mean) - error(&soft)).abs() < 1e-3, "{mean} {}", error(&soft));
    let glb = made("k.glb", &["--json"]);
    assert_eq!(glb["read_back"]["kept"], true);
    assert_ne!(
        std::fs::read(folder.join("soft.bvh")).unwrap(),
        std::fs::read(folder.join("off.bvh")).unwrap()
    );
}

#[test]
fn a_distilled_model_takes_few_steps_and_no_other() {
    let (_keep, folder) = studio();
    assert!(refused(&folder, &[&WORD[..], &["--steps", "2"]].concat()).contains("notdistilled"));
    // As the published ones are.
    let published = ModelHeader { semantics: Semantics::Official, ..header(16) };
    std::fs::write(folder.join("m.safetensors"), model(&published, Parts::ALL)).unwrap();
    assert!(refused(&folder, &[&WORD[..], &["--steps", "ddim"]].concat()).contains("--steps1,2or4"));
    for (out, steps) in [("1.bvh", "1"), ("2.bvh", "2"), ("4.bvh", "4")] {
        let base = ["generate", "--model", "m.safetensors", "--word", "kick", "-o", out, "--steps", steps];
        assert!(inkrig(&folder, &base).status.success());
    }
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_ne!(read("1.bvh"), read("2.bvh"));
    let usual = ["generate", "--model", "m.safetensors", "--word", "kick", "-o", "u.bvh"];
    assert!(inkrig(&folder, &usual).status.success());
    assert_eq!(read("u.bvh"), read("2.bvh"));
    let clip = read_bvh(&read("u.bvh"), &ImportOptions::default()).unwrap().clip;
    assert_eq!(clip.frames(), 40, "cut from the length that it was trained with");
    std::fs::write(folder.join("pose.json"), serde_json::json!(pose(1.0)).to_string()).unwrap();
    std::fs::write(folder.join("way.json"), r#"{"joint": "Left Wrist", "points": [[0, 1, 0], [0, 1.1, 0]]}"#)
        .unwrap();
    let more = ["--keypose3d", "pose.json", "--trajectory3d", "way.json"];
    assert!(inkrig(&folder, &[&WORD[..], &more].concat()).status.success());
    assert_ne!(read("k.bvh"), read("u.bvh"));
}

#[test]
fn what_is_wrong_with_words_and_conditions_is_said() {
    let (_keep, folder) = studio();
    let write = |name: &str, content: &str| std::fs::write(folder.join(name), content).unwrap();
    write("nan.json", &format!("[[NaN,0,0]{}]", ",[0,0,0]".repeat(21)));
    write("few.json", "[[0,0,0]]");
    write("late.json", r#"{"joint": "head", "frames": [40], "points": [[0,1,0]]}"#);
    write("joint.json", r#"{"joint": "rihgt_foot", "points": [[0,1,0]]}"#);
    write("empty.json", "");
    write("cm.json", &serde_json::json!(pose(100.0)).to_string());
    write("cm-way.json", r#"{"joint": "head", "points": [[10,160,5]]}"#);
    let more = |more: &[&'static str]| [&WORD[..], more].concat();
    for (arguments, part) in [
        (more(&["--keypose3d", "nan.json"]), "nan.json:"),
        (more(&["--keypose3d", "few.json"]), "1joints,butaposehas22"),
        (more(&["--keypose3d", "empty.json"]), "empty.json:"),
        (more(&["--keypose3d", "cm.json"]), "arethesecentimetres"),
        (more(&["--trajectory3d", "cm-way.json"]), "arethesecentimetres"),
        (["generate", "--model", "m.safetensors", "--word", " ", "-o", "k.bvh"].to_vec(), "saysnothing"),
        (more(&["--length", "0"]), "makes2to62"),
        (more(&["--length", "100000000s"]), "makes2to62"),
        (more(&["--sheet", "k.jpg"]), "apictureiswrittenas.png"),
        (more(&["--trajectory3d", "late.json"]), "frame40isbeyondthemotion"),
        (more(&["--trajectory3d", "joint.json"]), "nearestnamesareright_foot"),
        (more(&["--trajectory3d", "no.json"]), "no.json"),
        (more(&["--guidance", "soft"]), "--guidancedoesnothing"),
        (more(&["--length", "63"]), "makes2to62"),
        (more(&["--text-model", "."]), "--text-modeldoesnothing"),
        (
            ["generate", "--model", "m.safetensors", "--word", "kikc", "-o", "k.bvh"].to_vec(),
            "nearonesare:kick",
        ),
        (["generate", "--model", "m.safetensors", "--word", "kick", "-o", "k.obj"].to_vec(), "k.obj"),
        (
            ["generate", "--model", "m.safetensors", "--word", "kick", "-o", "m.safetensors"].to_vec(),
            "toldfromitsname",
        ),
    ] {
        let said = refused(&folder, &arguments);
        assert!(said.contains(part), "{arguments:?}: no {part} in {said}");
    }
}

#[test]
fn models_that_cannot_be_used_are_refused_with_what_is_needed() {
    let (_keep, folder) = studio();
    let base = header(0);
    let with = |bytes: Vec<u8>| std::fs::write(folder.join("m.safetensors"), bytes).unwrap();
    with(model(&ModelHeader { statistics: None, ..base.clone() }, Parts::ALL));
    assert!(refused(&folder, &WORD).contains("ithasnostatistics:importitoncemore,with--stats"));
    with(model(&ModelHeader { skeleton: None, ..base.clone() }, Parts::ALL));
    assert!(refused(&folder, &WORD).contains("ithasnoskeleton"));
    with(model(&ModelHeader { text: TextEncoderKind::SentenceT5, ..base.clone() }, Parts::ALL));
    assert!(refused(&folder, &WORD).contains("give--text-modelwithafolder"));
    let whole = model(&base, Parts::ALL);
    with(whole[..whole.len() - 5].to_vec());
    assert!(refused(&folder, &WORD).contains("m.safetensors:"));
    with(model(&base, Parts { control: false, control_2d: false, ..Parts::ALL }));
    std::fs::write(folder.join("way.json"), r#"{"joint": 0, "points": [[0, 1, 0]]}"#).unwrap();
    assert!(
        refused(&folder, &[&WORD[..], &["--trajectory3d", "way.json"]].concat()).contains("followswordsonly")
    );
    assert!(inkrig(&folder, &WORD).status.success());
}

#[test]
fn the_model_inside_the_program_needs_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let made = |more: &[&str]| {
        let jump = ["generate", "--word", "jump", "-o", "jump.bvh", "--force", "--sheet", "jump.png"];
        let output = inkrig(folder.path(), &[&jump, more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let record = std::fs::read(folder.path().join("jump.bvh.inkrig.json")).unwrap();
        let record: serde_json::Value = serde_json::from_slice(&record).unwrap();
        let licences = record["licences"].as_array().unwrap();
        let said: Vec<&str> = licences.iter().map(|licence| licence.as_str().unwrap()).collect();
        assert!(said.len() == 1 && said[0].contains("mocap.cs.cmu.edu"), "{said:?}");
        let bytes = std::fs::read(folder.path().join("jump.bvh")).unwrap();
        let again = inkrig(folder.path(), &["redo", "jump.bvh.inkrig.json", "-o", "again.bvh", "--force"]);
        assert!(again.status.success(), "{}", text(&again.stderr));
        assert!(std::fs::read(folder.path().join("again.bvh")).unwrap() == bytes, "made again to the byte");
        read_bvh(&bytes, &ImportOptions::default()).unwrap().clip
    };
    let sheet = || std::fs::read(folder.path().join("jump.png")).unwrap();
    let heights = |clip: &inkrig::motion::Clip| -> (f32, f32) {
        let (places, joints) = (kinematics::positions(clip), clip.skeleton().joints());
        let of = |name: &str| joints.iter().position(|joint| joint.name == name).unwrap();
        let row = |joint: usize| (0..clip.frames()).map(move |frame| (frame, joint));
        let lowest = row(of("left_foot"))
            .chain(row(of("right_foot")))
            .map(|(frame, joint)| places.frame(frame)[joint].y)
            .fold(f32::MAX, f32::min);
        let pelvis = row(of("pelvis")).map(|(frame, joint)| places.frame(frame)[joint].y);
        (lowest, pelvis.clone().fold(f32::MIN, f32::max) - pelvis.fold(f32::MAX, f32::min))
    };
    for more in [&["--steps", "ddim"][..], &["--steps", "4"]] {
        let (lowest, rise) = heights(&made(more));
        println!("{more:?}: feet down to {lowest} m, the pelvis goes up and down by {rise} m");
        assert!((-0.1..0.15).contains(&lowest) && (0.01..1.5).contains(&rise), "{more:?} {lowest} {rise}");
        assert!(sheet().starts_with(b"\x89PNG"));
    }
}

#[test]
fn a_packed_model_is_half_as_large_and_makes_motions() {
    let (_keep, folder) = studio();
    let said = |arguments: &[&str]| {
        let output = inkrig(&folder, arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let pack = ["model", "pack", "m.safetensors", "--name", "mine", "--licence", "CC0", "-o"];
    said(&[&pack[..], &["half.safetensors"]].concat());
    let size = |name: &str| std::fs::metadata(folder.join(name)).unwrap().len() as f64;
    assert!(size("half.safetensors") < 0.7 * size("m.safetensors"));
    let made = said(&["generate", "--model", "half.safetensors", "--word", "kick", "-o", "k.bvh"]);
    assert!(made.contains("model mine") && made.contains("licence of the model: CC0"), "{made}");
    let other = inkrig(&folder, &[&pack[..], &["half.bin"]].concat());
    assert!(text(&other.stderr).contains("a model is written as"), "{}", text(&other.stderr));
    // What the other has too is left out; all of it, here.
    let rest = said(&[&pack[..], &["rest.safetensors", "--without", "m.safetensors"]].concat());
    assert!(rest.contains("wrote rest.safetensors: 0 tensors"), "{rest}");
    let again = inkrig(&folder, &[&pack[..], &["m.safetensors", "--force"]].concat());
    assert!(!again.status.success(), "a model is not packed over itself");
}
