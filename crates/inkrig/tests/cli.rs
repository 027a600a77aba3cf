//! The program as a user meets it.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints")]

#[path = "cli/bake.rs"]
mod bake;
#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/clips.rs"]
mod clips;
#[path = "cli/controls.rs"]
mod controls;
#[path = "cli/convert.rs"]
mod convert;
#[path = "cli/demo.rs"]
mod demo;
#[path = "cli/explain.rs"]
mod explain;
#[path = "cli/files.rs"]
mod files;
#[path = "cli/generate.rs"]
mod generate;
#[path = "cli/keys.rs"]
mod keys;
#[path = "cli/model.rs"]
mod model;
#[path = "cli/over_ground.rs"]
mod over_ground;
#[path = "cli/redo.rs"]
mod redo;
#[path = "cli/retarget.rs"]
mod retarget;
#[path = "cli/sketch.rs"]
mod sketch;
#[path = "cli/stop.rs"]
mod stop;
#[path = "cli/storyboard.rs"]
mod storyboard;
#[path = "cli/storyboard_onto.rs"]
mod storyboard_onto;
#[path = "cli/studio.rs"]
mod studio;
#[path = "cli/words.rs"]
mod words;
#[path = "cli/wrong_controls.rs"]
mod wrong_controls;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn inkrig(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inkrig")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder with the person's clip and a short drawing.
fn desk() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    std::fs::write(path.join("person.bvh"), inkrig::samples::find("person").unwrap().bytes).unwrap();
    let curve = inkrig::sketch::shapes::growing_circles(3, 120).unwrap();
    std::fs::write(path.join("circles.csv"), inkrig::sketch::to_csv(&curve)).unwrap();
    (folder, path)
}

const ALIGN: [&str; 6] = ["align", "person.bvh", "--curve", "circles.csv", "-o", "new.bvh"];

fn align(folder: &Path, more: &[&str]) -> Output {
    inkrig(folder, &[&ALIGN, more].concat())
}

#[test]
fn a_clip_follows_a_drawing_and_everything_asked_for_is_there() {
    let (_keep, folder) = desk();
    let more = ["--report", "r.json", "--preview", "p.html", "--sheet", "s.png", "--range", "2s..20s"];
    let output = align(&folder, &more);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(
        said.contains("wrote new.bvh: 4.0 s, 120 frames") && said.contains("follows the drawing"),
        "{said}"
    );

    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    for name in [
        "structure_pearson",
        "structure_spearman",
        "structure_pearson_warp",
        "nearest_patch",
        "coverage",
        "speed_mean_ratio",
        "jump_q999_ratio",
        "jerk_ratio",
        "freeze",
        "solve_seconds",
    ] {
        assert!(report[name].is_f64(), "{name}: {}", report[name]);
    }
    assert_eq!(report["gradients"], 132);
    assert_eq!(report["levels"].as_array().unwrap().len(), 6);
    assert_eq!(report["parameters"]["alpha"], 0.9);
    assert_eq!(report["frames"], 120);
    assert!((report["seconds"].as_f64().unwrap() - 4.0).abs() < 1e-6);

    let bytes = std::fs::read(folder.join("new.bvh")).unwrap();
    let import = inkrig::formats::read_bvh(&bytes, &inkrig::formats::ImportOptions::default()).unwrap();
    assert_eq!(import.clip.frames(), 120);
    assert!(text(&std::fs::read(folder.join("p.html")).unwrap()).starts_with("<!"));
    assert!(std::fs::read(folder.join("s.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 7, "nothing else is left behind");
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let (_keep, folder) = desk();
    assert!(align(&folder, &["--threads", "1"]).status.success());
    let first = std::fs::read(folder.join("new.bvh")).unwrap();
    assert!(align(&folder, &["--threads", "2", "--force"]).status.success());
    assert_eq!(first, std::fs::read(folder.join("new.bvh")).unwrap());
}

#[test]
fn nothing_is_overwritten_without_force_and_inputs_are_safe() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("new.bvh"), "mine").unwrap();
    let output = align(&folder, &[]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("--force"), "{}", text(&output.stderr));
    assert_eq!(std::fs::read(folder.join("new.bvh")).unwrap(), b"mine");
    let arguments = ["align", "person.bvh", "--curve", "circles.csv", "-o", "./person.bvh", "--force"];
    let output = inkrig(&folder, &arguments);
    assert!(text(&output.stderr).contains("named twice"), "{}", text(&output.stderr));
    let sample = inkrig::samples::find("person").unwrap().bytes;
    assert_eq!(std::fs::read(folder.join("person.bvh")).unwrap(), sample);
}

#[test]
fn json_is_one_object_and_nothing_else() {
    let (_keep, folder) = desk();
    let output = align(&folder, &["--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value["structure_pearson"].is_f64());
    assert_eq!(value["warnings"].as_array().map(Vec::len), Some(0));
    let output = inkrig(&folder, &["inspect", "person.bvh", "--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["format"], "BVH");
    assert!((value["frame_rate"].as_f64().unwrap() - 30.0).abs() < 1e-6);
    assert!(value["unit_evidence"].as_str().unwrap().contains("guess"));
}

#[test]
fn inspect_says_what_is_in_a_file() {
    let (_keep, folder) = desk();
    let said = text(&inkrig(&folder, &["inspect", "person.bvh"]).stdout);
    for part in ["frames", "at 30.000 a second", "0.01 m (a guess", "LeftUpLeg", "problems     none"] {
        assert!(said.contains(part), "{part} is missing in:\n{said}");
    }
    let said = text(&inkrig(&folder, &["inspect", "person.bvh", "--unit", "0.02"]).stdout);
    assert!(said.contains("0.02 m (given by you)"), "{said}");
}

#[test]
fn errors_say_where_and_what_to_do() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("broken.bvh"), "HIERARCHY\nROOT hip\n{\n  OFFSET 0 zero 0\n").unwrap();
    std::fs::write(folder.join("dot.csv"), "1,1\n1,1\n1,1\n").unwrap();
    std::fs::write(folder.join("empty.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"/>").unwrap();
    let cases: [(&[&str], i32, &[&str]); 9] = [
        (&["inspect", "missing.bvh"], 1, &["missing.bvh"]),
        (&["inspect", "circles.csv"], 1, &[".bvh"]),
        (&["inspect", "broken.bvh"], 1, &["line 4", "hip"]),
        (&["align", "person.bvh", "--curve", "dot.csv", "-o", "a.bvh"], 1, &["dot.csv"]),
        (&["align", "person.bvh", "--curve", "empty.svg", "-o", "a.bvh"], 1, &["empty.svg"]),
        (&["align", "person.bvh", "--curve", "circles.csv", "-o", "a.obj"], 1, &["a.obj", ".bvh"]),
        (&["align", "person.bvh", "--curve", "circles.csv", "-o", "a.bvh", "--range", "5"], 2, &["2s..10s"]),
        (
            &["align", "person.bvh", "--curve", "circles.csv", "-o", "a.bvh", "--alpha", "7"],
            1,
            &["from 0 to 1"],
        ),
        (
            &["align", "person.bvh", "--curve", "circles.csv", "-o", "a.bvh", "--length", "5"],
            1,
            &["--length"],
        ),
    ];
    for (arguments, code, parts) in cases {
        let output = inkrig(&folder, arguments);
        // Long lines are wrapped for the terminal; what is said does not depend on where.
        let said = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        for part in parts {
            assert!(said.contains(&part.replace(' ', "")), "{arguments:?}: no `{part}` in {said}");
        }
        assert!(!said.contains("panicked"), "{said}");
        assert!(!folder.join("a.bvh").exists());
    }
}

#[test]
fn help_has_examples_and_completions_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        &["--help"][..],
        &["align", "--help"],
        &["demo", "--help"],
        &["inspect", "--help"],
        &["generate", "--help"],
    ] {
        assert!(text(&inkrig(folder.path(), command).stdout).contains("Example"), "{command:?}");
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        assert!(text(&inkrig(folder.path(), &["completions", shell]).stdout).contains("inkrig"));
    }
}

/// Everything that was asked for stands in the report, so that the result can be made again from it.
#[test]
fn a_result_can_be_repeated_from_its_report() {
    let (_keep, folder) = desk();
    let more = "--report r.json --range 2s..20s --length 4s --fps 15 --uniform --preset natural --unit 0.02 --up y \
                --source-fps 30 --threads 1 --loop --smooth 3";
    let output = align(&folder, &more.split_whitespace().collect::<Vec<_>>());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    let expected = serde_json::json!({
        "range": "2s..20s", "length": "4s", "fps": 15.0, "uniform": true, "preset": "natural", "unit": 0.02,
        "up": "y", "source_fps": 30.0, "threads": 1, "loop": true, "smooth": 3.0, "alpha": 0.7,
    });
    for (name, value) in expected.as_object().unwrap() {
        assert_eq!(&report["parameters"][name], value, "{name}");
    }
    assert_eq!(report["frames"], 60);
}

/// All results are of one clip: the one that is written.
#[test]
fn another_rate_is_the_same_in_all_results() {
    let (_keep, folder) = desk();
    let output = align(&folder, &["--fps", "12", "--report", "r.json", "--preview", "p.html"]);
    let said = text(&output.stdout);
    assert!(said.contains("wrote new.bvh: 4.0 s, 48 frames at 12 a second"), "{said}");
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    let import =
        inkrig::formats::read_bvh(&read("new.bvh"), &inkrig::formats::ImportOptions::default()).unwrap();
    assert_eq!((import.clip.frames(), import.clip.frame_rate().round()), (48, 12.0));
    let report: serde_json::Value = serde_json::from_slice(&read("r.json")).unwrap();
    assert_eq!((&report["frames"], &report["frame_rate"]), (&48.into(), &12.0.into()));
    let page = text(&read("p.html"));
    assert!(page.contains("\"resultRate\":12.0,\"resultFrames\":48"));
}
