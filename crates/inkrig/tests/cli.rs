//! The program as a user meets it.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

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

    let bytes = std::fs::read(folder.join("new.bvh")).unwrap();
    let import = inkrig::formats::read_bvh(&bytes, &inkrig::formats::ImportOptions::default()).unwrap();
    assert_eq!(import.clip.frames(), 120);
    assert!(text(&std::fs::read(folder.join("p.html")).unwrap()).starts_with("<!"));
    assert!(std::fs::read(folder.join("s.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 6, "nothing else is left behind");
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
        (&["align", "person.bvh", "--curve", "circles.csv", "-o", "a.fbx"], 1, &["a.fbx", ".bvh"]),
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
fn the_demo_needs_nothing_and_replaces_only_its_own_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    std::fs::write(folder.path().join("out/mine.txt"), "mine").unwrap();
    for _ in 0..2 {
        let output = inkrig(folder.path(), &["demo", "out"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("Open out/person-follows-spiral.html in a browser"));
    }
    assert_eq!(std::fs::read(folder.path().join("out/mine.txt")).unwrap(), b"mine");
    for ending in ["bvh", "html", "png"] {
        let file = folder.path().join(format!("out/quadruped-follows-eight.{ending}"));
        assert!(file.metadata().unwrap().len() > 1000, "{}", file.display());
    }
}

#[test]
fn help_has_examples_and_completions_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    for command in [&["--help"][..], &["align", "--help"], &["demo", "--help"], &["inspect", "--help"]] {
        assert!(text(&inkrig(folder.path(), command).stdout).contains("Example"), "{command:?}");
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        assert!(text(&inkrig(folder.path(), &["completions", shell]).stdout).contains("inkrig"));
    }
}

/// Ctrl-C ends a long run with the shell's usual code and leaves no file.
#[cfg(unix)]
#[test]
fn ctrl_c_stops_and_leaves_nothing() {
    let (_keep, folder) = desk();
    let mut child = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .args([&ALIGN[..], &["--iterations", "20000"]].concat())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
}
