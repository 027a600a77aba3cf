//! Records beside results, and results made again from them.

use crate::{align, desk, inkrig, text};
use serde_json::{Value, json};
use std::path::Path;

fn record(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

/// What was said, without the places where it was wrapped for the terminal.
fn said(output: &std::process::Output) -> String {
    text(&output.stderr).replace(['\n', '│', ' '], "")
}

/// Runs a command, makes its result again from its record, and compares the bytes.
fn made_again(folder: &Path, arguments: &[&str], out: &str) -> Value {
    let done = inkrig(folder, arguments);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let name = format!("{out}.inkrig.json");
    let again = format!("again.{}", out.rsplit('.').next().unwrap());
    let redone = inkrig(folder, &["redo", &name, "-o", &again, "--force"]);
    assert!(redone.status.success(), "{}", text(&redone.stderr));
    assert!(text(&redone.stdout).contains("the same, byte for byte"));
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read(out) == read(&again), "{out}");
    let (mut first, mut second) = (record(folder, &name), record(folder, &format!("{again}.inkrig.json")));
    assert_eq!(second["output"]["path"], again);
    first["output"]["path"] = Value::Null;
    second["output"]["path"] = Value::Null;
    assert_eq!(first, second);
    first
}

#[test]
fn alignments_are_made_again_to_the_byte() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("loop.wav"), crate::controls::tune()).unwrap();
    std::fs::write(folder.join("hound.bvh"), inkrig::samples::find("quadruped").unwrap().bytes).unwrap();
    std::fs::write(folder.join("keys.json"), r#"[{"time": 1.0, "frame": 90}, {"never": 10}]"#).unwrap();
    let curve =
        ["align", "person.bvh", "--curve", "circles.csv", "-o", "curve.bvh", "--seed", "3", "--threads", "1"];
    let facts = made_again(&folder, &curve, "curve.bvh");
    assert_eq!((&facts["seed"], &facts["command"]), (&3.into(), &"align".into()));
    assert!(facts["evaluations"]["gradients"].as_u64().unwrap() > 10, "{facts}");
    assert_eq!(facts["parameters"]["engine"]["alpha"], 0.9);
    assert_eq!(facts["parameters"]["said"]["preset"], "follow");
    let inputs: Vec<&str> =
        facts["inputs"].as_array().unwrap().iter().map(|i| i["path"].as_str().unwrap()).collect();
    assert_eq!(inputs, ["person.bvh", "circles.csv"]);
    assert_eq!(facts["licences"], json!(["unknown: circles.csv", "unknown: person.bvh"]));

    let sound =
        ["align", "person.bvh", "--sound", "loop.wav", "-o", "sound.glb", "--bake", "sparse", "--loop"];
    assert_eq!(made_again(&folder, &sound, "sound.glb")["inputs"].as_array().unwrap().len(), 2);

    // Keys of a file, a pose of another clip, two solutions, options that begin with a hyphen.
    let keys = [
        "align",
        "person.bvh",
        "--wave",
        "-1*sine(1Hz) for 3s",
        "-o",
        "keys.bvh",
        "--key-file",
        "keys.json",
        "--key",
        "2s~person.bvh:20",
        "--solutions",
        "2",
        "--report",
        "r.json",
    ];
    let facts = made_again(&folder, &keys, "keys.bvh");
    assert_eq!(facts["inputs"].as_array().unwrap().len(), 2, "each file once: {facts}");
    if folder.join("keys-2.bvh").exists() {
        assert_eq!(record(&folder, "keys-2.bvh.inkrig.json")["solution"], 2);
        let second = inkrig(&folder, &["redo", "keys-2.bvh.inkrig.json", "--check"]);
        assert!(second.status.success(), "{}", text(&second.stderr));
    }
}

#[test]
fn conversions_and_retargets_are_made_again_to_the_byte() {
    let (_keep, folder) = desk();
    std::fs::create_dir(folder.join("in")).unwrap();
    for name in ["one.bvh", "two.bvh"] {
        std::fs::copy(folder.join("person.bvh"), folder.join("in").join(name)).unwrap();
    }
    let few = ["convert", "person.bvh", "few.glb", "--bake", "sparse", "--fps", "15", "--range", "1s..6s"];
    let facts = made_again(&folder, &few, "few.glb");
    assert_eq!((&facts["seed"], &facts["evaluations"]), (&Value::Null, &Value::Null));
    let held =
        ["convert", "person.bvh", "held.bvh", "--bake", "stepped", "--on", "3", "--path", "circles.csv"];
    assert_eq!(made_again(&folder, &held, "held.bvh")["inputs"].as_array().unwrap().len(), 2);
    let many = ["convert", "in/*.bvh", "out", "--to", "glb", "--path", "circles.csv"];
    let facts = made_again(&folder, &many, "out/two.glb");
    assert_eq!(facts["files"], json!(["in/two.bvh"]));
    assert_eq!(facts["inputs"].as_array().unwrap().len(), 2, "the path and its own motion");
    let onto = ["retarget", "person.bvh", "--onto", "few.glb", "-o", "moved.glb", "--no-keep-feet"];
    made_again(&folder, &onto, "moved.glb");
}

#[test]
fn inputs_that_changed_and_other_programs_are_refused() {
    let (_keep, folder) = desk();
    assert!(align(&folder, &[]).status.success());
    let redo = |more: &[&str]| inkrig(&folder, &[&["redo", "new.bvh.inkrig.json"], more].concat());
    // The result is there.
    assert!(said(&redo(&[])).contains("--force"));
    assert!(redo(&["--check"]).status.success());
    let before = std::fs::read(folder.join("new.bvh")).unwrap();
    let listed = text(&redo(&["--list"]).stdout);
    assert!(listed.contains("reads  person.bvh (") && listed.contains("writes new.bvh"), "{listed}");

    let curve = std::fs::read_to_string(folder.join("circles.csv")).unwrap();
    let changed = curve.replacen('1', "2", 1);
    assert_ne!(curve, changed);
    std::fs::write(folder.join("circles.csv"), &changed).unwrap();
    let output = redo(&["--check"]);
    assert!(
        said(&output).contains("circles.csv") && said(&output).contains("haschanged"),
        "{}",
        said(&output)
    );
    std::fs::write(folder.join("circles.csv"), changed.clone() + "\n").unwrap();
    assert!(said(&redo(&["--check"])).contains("haschanged"));
    let anyway = redo(&["-o", "other.bvh", "--anyway"]);
    assert!(text(&anyway.stdout).contains("not the same"), "{}", text(&anyway.stderr));
    assert!(folder.join("other.bvh").exists() && !folder.join("other.bvh.inkrig.json").exists());
    std::fs::remove_file(folder.join("circles.csv")).unwrap();
    assert!(said(&redo(&["--check"])).contains("notthere"));
    std::fs::write(folder.join("circles.csv"), &curve).unwrap();

    for (field, value, expected) in [
        ("build", "0".repeat(64), "anotherbuild"),
        ("instruction_set", "older".into(), "instructionlevel"),
        ("system", "plan9 mips".into(), "anotherbuild"),
    ] {
        let mut other = record(&folder, "new.bvh.inkrig.json");
        other[field] = value.into();
        std::fs::write(folder.join("x.bvh.inkrig.json"), other.to_string()).unwrap();
        let output = inkrig(&folder, &["redo", "x.bvh.inkrig.json"]);
        assert!(said(&output).contains(expected), "{field}: {}", said(&output));
        assert!(!folder.join("x.bvh").exists());
        assert!(inkrig(&folder, &["redo", "x.bvh.inkrig.json", "--anyway", "--check"]).status.success());
    }
    // Another hash of the result: the work is done, and nothing is written.
    let mut other = record(&folder, "new.bvh.inkrig.json");
    other["output"]["sha256"] = "0".repeat(64).into();
    std::fs::write(folder.join("x.bvh.inkrig.json"), other.to_string()).unwrap();
    let output = inkrig(&folder, &["redo", "x.bvh.inkrig.json"]);
    assert!(said(&output).contains("notthesame") && !folder.join("x.bvh").exists(), "{}", said(&output));
    assert_eq!(std::fs::read(folder.join("new.bvh")).unwrap(), before);
}

#[test]
fn hostile_records_read_and_write_nothing_else() {
    let (_keep, folder) = desk();
    assert!(align(&folder, &[]).status.success());
    std::fs::write(folder.join("secret.csv"), "1,2\n3,4\n5,6\n7,1\n").unwrap();
    let good = record(&folder, "new.bvh.inkrig.json");
    let place = folder.join("x.bvh.inkrig.json");
    let names = || {
        let entries = std::fs::read_dir(&folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    std::fs::write(&place, "").unwrap();
    let before = names();
    let mut cases: Vec<(Value, &str)> = Vec::new();
    let mut case = |pointer: &str, value: Value, expected: &'static str| {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).unwrap() = value;
        cases.push((bad, expected));
    };
    case("/inkrig_sidecar", 2.into(), "version2");
    case("/command", "demo".into(), "nocommand");
    case("/command", "completions".into(), "nocommand");
    case("/options", json!(["--curve=circles.csv", "--report=stolen.json"]), "nooption");
    case("/options", json!(["--curve=circles.csv", "--force"]), "nooption");
    case("/options", json!(["--curve=circles.csv", "-oother.bvh"]), "nooption");
    case("/options", json!(["--curve=circles.csv", "--out=other.bvh"]), "nooption");
    case("/options", json!(["--curve=circles.csv", "--help"]), "nooption");
    case("/options", json!(["--curve=circles.csv", "--alpha=x"]), "invalidvalue");
    case("/options", json!(vec!["--loop"; 10_001]), "morethan");
    case("/options", json!(["--curve=secret.csv"]), "notamongtheinputs");
    case("/files", json!(["person.bvh", "--force"]), "whatkindoffile");
    case("/files", json!([]), "required");
    case("/files", json!(["../../../../../../etc/passwd"]), "");
    case("/inputs/0/sha256", "../x".into(), "64digits");
    case("/inputs/0/path", "x\0y".into(), "holdsazero");
    case("/inputs/0/path", "/dev/zero".into(), "noordinaryfile");
    case("/inputs/0/bytes", (1_u64 << 60).into(), "haschanged");
    case("/solution", 0.into(), "nosolution");
    case("/solution", 7.into(), "solution7");
    case("/output/path", "../../escaped.glb".into(), "thesameending");
    for (bad, expected) in cases {
        std::fs::write(&place, bad.to_string()).unwrap();
        let output = inkrig(&folder, &["redo", "x.bvh.inkrig.json"]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{expected}: {said}");
        assert!(said.contains(expected) && !said.contains("panicked"), "{expected}: {said}");
        assert_eq!(names(), before, "{expected}");
    }
    // Where it says that the result was does not matter: the result goes beside the record.
    let mut moved = good.clone();
    moved["output"]["path"] = "/etc/escaped.bvh".into();
    std::fs::write(&place, moved.to_string()).unwrap();
    assert!(inkrig(&folder, &["redo", "x.bvh.inkrig.json"]).status.success());
    assert!(folder.join("x.bvh").exists() && !Path::new("/etc/escaped.bvh").exists());
    let deep = "[".repeat(100_000);
    for text in ["", "{}", "null", &deep, "{\"inkrig_sidecar\": 1}", &" ".repeat((4 << 20) + 1)] {
        std::fs::write(&place, text).unwrap();
        let output = inkrig(&folder, &["redo", "x.bvh.inkrig.json"]);
        assert!(said(&output).contains("norecord"), "{}", said(&output));
    }
}

#[test]
fn licences_are_passed_on() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("person.bvh.license"), "SPDX-License-Identifier: CC0-1.0\n").unwrap();
    assert!(align(&folder, &["--licence-note", "my own drawing"]).status.success());
    let facts = record(&folder, "new.bvh.inkrig.json");
    assert_eq!(facts["licences"], json!(["CC0-1.0", "my own drawing"]));
    assert_eq!(facts["inputs"][0]["licences"][0]["from"], "person.bvh.license beside it");
    // What is made of a result has the licences of what that was made of.
    assert!(inkrig(&folder, &["convert", "new.bvh", "new.glb"]).status.success());
    assert_eq!(record(&folder, "new.glb.inkrig.json")["licences"], json!(["CC0-1.0", "my own drawing"]));
    // Records are replaced with their results, other files of such names are not.
    assert!(inkrig(&folder, &["convert", "person.bvh", "p.glb", "--no-sidecar"]).status.success());
    assert!(!folder.join("p.glb.inkrig.json").exists());
    std::fs::write(folder.join("q.glb.inkrig.json"), "mine").unwrap();
    assert!(said(&inkrig(&folder, &["convert", "person.bvh", "q.glb"])).contains("--force"));
    assert!(!folder.join("q.glb").exists());
    std::fs::remove_file(folder.join("new.glb")).unwrap();
    assert!(inkrig(&folder, &["convert", "new.bvh", "new.glb"]).status.success());
}
