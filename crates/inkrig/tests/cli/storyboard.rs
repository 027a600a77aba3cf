//! `inkrig storyboard` on the command line.

use crate::{inkrig, text};
use std::process::Command;

/// A folder with the kick.
fn desk() -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    std::fs::write(path.join("kick.json"), inkrig::samples::find("kick.json").unwrap().bytes).unwrap();
    (folder, path)
}

#[test]
fn a_storyboard_becomes_a_motion_with_all_that_is_known_of_it() {
    let (_keep, folder) = desk();
    let arguments = |out: &'static str| {
        ["storyboard", "kick.json", "-o", out, "--candidates", "1", "--guide-every", "25", "--exact", "pin"]
    };
    let more = ["--clips", "--sheet", "kick.png", "--report", "kick-report.json", "--preview", "kick.html"];
    let output = inkrig(&folder, &[&arguments("kick.bvh")[..], &more[..]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("way of right_foot"), "{}", text(&output.stdout));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("kick-report.json")).unwrap()).unwrap();
    let part = &report["parts"][0];
    assert_eq!((&part["word"], &part["trajectories"][0]["figure"]), (&"kick".into(), &"start".into()));
    let [sampled, result] = ["sampled", "result"].map(|name| part[name][0].as_f64().unwrap());
    assert!(result < 0.01 && result < 0.3 * sampled, "{sampled} {result}");
    let page = std::fs::read_to_string(folder.join("kick.html")).unwrap();
    let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let frame = &data["board"][0];
    let way = frame["ways"][0]["points"].as_array().unwrap();
    assert!(frame["key"] == 0.0 && way.len() > 10 && way[0].as_array().unwrap().len() == 3, "{frame}");
    assert!(frame["strokes"].as_array().unwrap().iter().any(|stroke| stroke[0] == "way"));
    for name in ["kick-1.bvh", "kick.png", "kick.bvh.inkrig.json"] {
        assert!(folder.join(name).exists(), "{name}");
    }
    // The same again, byte for byte, by the record.
    let output = inkrig(&folder, &["redo", "kick.bvh.inkrig.json", "--check"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = inkrig(&folder, &arguments("kick.bvh"));
    assert_eq!(output.status.code(), Some(1), "files are not replaced");
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let (_keep, folder) = desk();
    let board = |inside: &str| format!("{{\"inkrig_storyboard\": 1, \"frames\": [{{{inside}}}]}}");
    for (name, content, part) in [
        ("empty.json", board(""), "frame 1: it has no figure"),
        ("word.json", board("\"word\": \"kikc\""), "near ones are: kick"),
        ("broken.json", "{".into(), "line 1"),
        ("board.txt", String::new(), "what kind of file"),
        (
            "board.svg",
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>".into(),
            "no path or shape",
        ),
    ] {
        std::fs::write(folder.join(name), content).unwrap();
        let output = inkrig(&folder, &["storyboard", name, "-o", "out.bvh", "--candidates", "1"]);
        let said = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert!(output.status.code() == Some(1) && said.contains(&part.replace(' ', "")), "{name}: {said}");
        assert!(!folder.join("out.bvh").exists());
    }
}

/// The report of a storyboard that is made with these options.
fn report(folder: &std::path::Path, name: &str, more: &[&str]) -> serde_json::Value {
    let (out, report) = (format!("{name}-made.bvh"), format!("{name}-report.json"));
    let board = format!("{name}.json");
    let arguments = ["storyboard", &board, "-o", &out, "--report", &report, "--candidates", "1", "--force"];
    let output = inkrig(folder, &[&arguments, &["--guide-every", "25"][..], more].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&std::fs::read(folder.join(report)).unwrap()).unwrap()
}

/// The channels of a motion's frames in a BVH file.
fn motion(folder: &std::path::Path, name: &str) -> Vec<Vec<f64>> {
    let file = std::fs::read_to_string(folder.join(name)).unwrap();
    let lines = file.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1);
    lines.map(|line| line.split_whitespace().map(|number| number.parse().unwrap()).collect()).collect()
}

/// The largest difference of two motions' channels, whole turns left out.
fn differ(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_joint_is_put_in_space_and_ends_can_be_kept() {
    let (_keep, folder) = desk();
    let sample = inkrig::samples::find("walk-and-wave.json").unwrap();
    let board: serde_json::Value = serde_json::from_slice(sample.bytes).unwrap();
    let write = |name: &str, edit: serde_json::Value| {
        let mut board = board.clone();
        if edit.is_object() {
            board["frames"][0]["edits"] = serde_json::json!([edit]);
        }
        std::fs::write(folder.join(format!("{name}.json")), board.to_string()).unwrap();
    };
    write("plain", serde_json::Value::Null);
    let before = report(&folder, "plain", &["--clips"]);
    // The whole body goes aside near the clip's end.
    write("edited", serde_json::json!({"joint": "pelvis", "frame": 36, "at": [0.4, 0.9, 1.6]}));
    let free = report(&folder, "edited", &["--clips"]);
    let locked = report(&folder, "edited", &["--lock-ends"]);
    let shift =
        |report: &serde_json::Value| [0, 2].map(|axis| report["parts"][1]["shift"][axis].as_f64().unwrap());
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    for made in [&free, &locked] {
        let edit = &made["parts"][0]["edits"][0];
        assert!(edit["miss"].as_f64().unwrap() < 0.002 && edit["joint"] == "pelvis", "{edit}");
    }
    assert!(apart(shift(&before), shift(&free)) > 0.1, "{free}");
    assert_eq!(before["parts"][1]["shift"], locked["parts"][1]["shift"]);
    assert_eq!(
        (&locked["parts"][0]["lock_ends"], &free["parts"][0]["lock_ends"]),
        (&true.into(), &serde_json::Value::Null)
    );
    // The other frame's own motion is the same in both, but for the body that it is written on.
    let [own, other] = [1, 2].map(|number| {
        let [before, after] =
            ["plain", "edited"].map(|name| motion(&folder, &format!("{name}-made-{number}.bvh")));
        differ(&before, &after)
    });
    println!("channels differ by {own} in the edited frame, by {other} in the other");
    assert!(other < 5.0 && own > 20.0, "{own} {other}");
    write("far", serde_json::json!({"joint": "head", "frame": 3, "at": [0, 9, 0]}));
    write("late", serde_json::json!({"joint": "head", "frame": 300, "at": [0, 1, 0]}));
    write("nobody", serde_json::json!({"joint": "tail", "frame": 3, "at": [0, 1, 0]}));
    for (name, part) in [
        ("far.json", "frame 1: the edit of head at frame 3 is"),
        ("late.json", "frame 1: the edit of head at frame 300 is behind the clip's end: it has frames 0 to"),
        ("nobody.json", "frame 1: there is no joint \"tail\""),
    ] {
        let output = inkrig(&folder, &["storyboard", name, "-o", "out.bvh", "--candidates", "1"]);
        let said = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert!(output.status.code() == Some(1) && said.contains(&part.replace(' ', "")), "{name}: {said}");
        assert!(!folder.join("out.bvh").exists());
    }
}

#[test]
fn a_pin_that_is_missed_is_said_and_one_off_all_paper_refused() {
    let (_keep, folder) = desk();
    let mut board: serde_json::Value =
        serde_json::from_slice(inkrig::samples::find("kick.json").unwrap().bytes).unwrap();
    let mut pinned = |name: &str, x: f64| {
        board["frames"][0]["pins"] = serde_json::json!([{"joint": "right_wrist", "at": [x, 2]}]);
        std::fs::write(folder.join(name), board.to_string()).unwrap();
        let more = ["-o", "out.bvh", "--candidates", "1", "--guide-every", "25", "--force"];
        text(&inkrig(&folder, &[&["storyboard", name], &more[..]].concat()).stderr)
    };
    let said = pinned("far.json", 1000.0);
    assert!(said.contains("frame 1: the pin of right_wrist is missed by"), "{said}");
    let said = pinned("off.json", 1e6).replace(['\n', '│', ' '], "");
    assert!(said.contains("timesasfaroffthedrawing"), "{said}");
}

#[test]
fn a_frame_takes_over_the_path_of_another() {
    let (_keep, folder) = desk();
    let sample = inkrig::samples::find("walk-and-wave.json").unwrap();
    let mut board: serde_json::Value = serde_json::from_slice(sample.bytes).unwrap();
    let write = |name: &str, board: &serde_json::Value| {
        std::fs::write(folder.join(format!("{name}.json")), board.to_string()).unwrap();
    };
    board["frames"][1] = serde_json::json!({"word": "walk", "path": "continue"});
    write("on", &board);
    let soft = report(&folder, "on", &[]);
    let path = &soft["parts"][1]["path"];
    assert_eq!((&path["of"], &path["continues"]), (&1.into(), &true.into()), "{soft}");
    assert!(path["result"][0].as_f64().unwrap() < 0.06, "{path}");
    assert_eq!(soft["parts"][0]["path"], serde_json::Value::Null);
    let pinned = report(&folder, "on", &["--exact", "pin", "--sheet", "on.png", "--video", "on.gif"]);
    assert!(pinned["parts"][1]["path"]["result"][1].as_f64().unwrap() < 0.01, "{pinned}");
    let off = report(&folder, "on", &["--exact", "off"]);
    assert!(off["parts"][1]["path"]["result"][0].as_f64().unwrap() < 0.25, "{off}");
    // The motion depends on it, and on the frame that leads.
    board["frames"][1]["path"] = serde_json::Value::Null;
    write("alone", &board);
    let alone = report(&folder, "alone", &[]);
    assert_ne!(alone["parts"][1]["evaluations"], soft["parts"][1]["evaluations"]);
    assert_ne!(motion(&folder, "on-made.bvh"), motion(&folder, "alone-made.bvh"));
    for (name, path, part) in [
        (
            "late",
            serde_json::json!(2),
            "frame 2: it is to go the way of frame 2, which is not made before it",
        ),
        ("odd", serde_json::json!("repeat"), "\"continue\", or the place of an earlier frame"),
    ] {
        board["frames"][1]["path"] = path;
        write(name, &board);
        let output = inkrig(&folder, &["storyboard", &format!("{name}.json"), "-o", "out.bvh"]);
        let said = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert!(output.status.code() == Some(1) && said.contains(&part.replace(' ', "")), "{name}: {said}");
    }
    board["frames"][0]["path"] = "continue".into();
    board["frames"][1]["path"] = serde_json::Value::Null;
    write("own", &board);
    let output = inkrig(&folder, &["storyboard", "own.json", "-o", "out.bvh"]);
    assert!(text(&output.stderr).contains("cannot go both ways"), "{}", text(&output.stderr));
}

const TROT: &str = r#"{"inkrig_storyboard": 1, "frames": [{"word": "trot", "trajectories": [{"points": [[0,0,0],[60,10,1],[100,50,2],[110,90,3]]}]}]}"#;

/// A folder of one sample, and words for it.
fn clips(folder: &std::path::Path, name: &str, file: &str) {
    let place = folder.join(name);
    std::fs::create_dir_all(&place).unwrap();
    std::fs::write(place.join(file), inkrig::samples::find(file).unwrap().bytes).unwrap();
    std::fs::write(place.join("words.csv"), format!("file,words\n{file},trot gallop\n")).unwrap();
}

#[test]
fn an_animal_is_animated_from_its_own_clips() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("trot.json"), TROT).unwrap();
    clips(&folder, "hound", "quadruped.bvh");
    let ask = [
        "storyboard",
        "trot.json",
        "--engine",
        "example",
        "--examples",
        "hound",
        "-o",
        "trot.bvh",
        "--exact",
        "pin",
    ];
    let more = ["--report", "r.json", "--sheet", "trot.png", "--video", "trot.gif"];
    let output = inkrig(&folder, &[&ask[..], &more[..]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("from quadruped"), "{}", text(&output.stdout));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    let part = &report["parts"][0];
    assert_eq!((&part["example"]["word"], &report["engine"]), (&0.0.into(), &"example".into()));
    assert!(part["result"][1].as_f64().unwrap() < 1e-3, "{part}");
    let gif = std::fs::read(folder.join("trot.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a") && gif.last() == Some(&0x3b) && gif.len() < 1 << 20, "{}", gif.len());
    // The same again, byte for byte, by the record.
    let output = inkrig(&folder, &["redo", "trot.bvh.inkrig.json", "--check"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    // With other clips in the folder it becomes another motion: theirs.
    let place = folder.join("hound/quadruped.bvh");
    let file = std::fs::read_to_string(&place).unwrap();
    let (head, frames) = file.split_once("Frames:").unwrap();
    let mut rows: Vec<&str> = frames.lines().skip(2).filter(|row| !row.trim().is_empty()).collect();
    rows.reverse();
    let time = frames.lines().nth(1).unwrap();
    std::fs::write(&place, format!("{head}Frames: {}\n{time}\n{}\n", rows.len(), rows.join("\n"))).unwrap();
    let output = inkrig(&folder, &["redo", "trot.bvh.inkrig.json", "--check"]);
    let told = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert!(!output.status.success() && told.contains("haschanged"), "{told}");
    let output = inkrig(&folder, &["redo", "trot.bvh.inkrig.json", "-o", "again.bvh", "--anyway"]);
    assert!(text(&output.stdout).contains("not the same"), "{}", text(&output.stderr));
    let fresh = ["--engine", "example", "--examples", "hound", "-o", "fresh.bvh", "--exact", "pin"];
    assert!(inkrig(&folder, &[&["storyboard", "trot.json"], &fresh[..]].concat()).status.success());
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read("again.bvh") == read("fresh.bvh") && read("again.bvh") != read("trot.bvh"));
    for (more, said) in [
        (["--engine", "both"], "--engine both does nothing"),
        (["--preview", "p.html"], "--preview does nothing"),
        (["--candidates", "2"], "--candidates does nothing with --engine example"),
        (["--text-weight", "2"], "--text-weight does nothing with --engine example"),
        (["--guide-every", "2"], "--guide-every does nothing with --engine example"),
    ] {
        let output = inkrig(
            &folder,
            &[
                &["storyboard", "trot.json", "--examples", "hound", "-o", "x.bvh"][..],
                &more[..],
                if more[0] == "--engine" { &[][..] } else { &["--engine", "example"][..] },
            ]
            .concat(),
        );
        assert!(!output.status.success() && text(&output.stderr).contains(said), "{}", text(&output.stderr));
    }
}

#[test]
fn constraints_are_told_one_by_one() {
    let (_keep, folder) = desk();
    let mut board: serde_json::Value =
        serde_json::from_slice(inkrig::samples::find("kick.json").unwrap().bytes).unwrap();
    board["frames"][0]["constraints"] = serde_json::json!([
        {"kind": "distance", "joints": ["left_wrist", "right_wrist"]},
        {"kind": "plane", "joint": "left_wrist", "height": 0.0},
        {"kind": "plane", "joint": "head", "height": 1.8},
    ]);
    std::fs::write(folder.join("held.json"), board.to_string()).unwrap();
    let made = report(&folder, "held", &["--exact", "pin"]);
    let miss = |at: usize| made["parts"][0]["constraints"][at]["miss"].as_f64().unwrap();
    assert!(made["parts"][0]["constraints"][0]["metres"].as_f64().unwrap() > 0.05, "{made}");
    assert!(miss(1) + miss(2) > 0.4, "no arm is that long: {made}");
    let warned = made["warnings"].as_array().unwrap();
    let told = |part: &str| warned.iter().any(|warning| warning.as_str().unwrap().contains(part));
    assert!(told("frame 1: constraint 2 (plane) is missed by up to") && told("move the plane"), "{warned:?}");
    let far = serde_json::json!([{"kind": "plane", "joint": "left_wrist", "height": 9}]);
    board["frames"][0]["constraints"] = far;
    std::fs::write(folder.join("far.json"), board.to_string()).unwrap();
    let output = inkrig(&folder, &["storyboard", "far.json", "-o", "out.bvh", "--candidates", "1"]);
    let said = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert!(output.status.code() == Some(1) && said.contains("mfromthemotion"), "{said}");
    let soft = report(&folder, "held", &[]);
    assert!(soft["warnings"].to_string().contains("--exact pin keeps it"), "{soft}");
}

#[test]
fn engines_are_compared_and_what_does_not_go_together_is_said() {
    let (_keep, folder) = desk();
    clips(&folder, "people", "person.bvh");
    let ask = ["storyboard", "kick.json", "-o", "kick.bvh", "--candidates", "1", "--guide-every", "25"];
    let both = ["--engine", "both", "--examples", "people", "--report", "r.json"];
    let output = inkrig(&folder, &[&ask[..], &both[..]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    let engines: Vec<&str> =
        report["engines"].as_array().unwrap().iter().map(|own| own["engine"].as_str().unwrap()).collect();
    assert_eq!(engines, ["learned", "example", "both"]);
    let results: Vec<f64> =
        (0..3).map(|at| report["engines"][at]["result"][0][0].as_f64().unwrap()).collect();
    assert!(results.iter().all(|own| *own < 0.3) && results[0] != results[2], "{results:?}");
    assert_eq!(report["parts"][0]["result"][0].as_f64(), Some(results[2]), "what is written is that of both");
    assert_eq!(report["parts"][0]["sides"].as_array().map(Vec::len), Some(4));
    assert!(report["engines"][0].get("seconds").is_none(), "a report is the same each time");
    assert!(text(&output.stdout).contains(" s"), "{}", text(&output.stdout));
    let taken = std::fs::read_to_string(folder.join("kick.json")).unwrap();
    std::fs::write(folder.join("taken.json"), taken.replacen("\"word\"", "\"take\": 1, \"word\"", 1))
        .unwrap();
    let example = ["--engine", "example", "--examples", "people", "--report", "taken-report.json"];
    let output = inkrig(&folder, &[&["storyboard", "taken.json", "-o", "taken.bvh"], &example[..]].concat());
    let told = std::fs::read_to_string(folder.join("taken-report.json")).unwrap();
    assert!(told.contains("`take` counts for nothing"), "{told} {}", text(&output.stderr));
    for (more, said) in [
        (&["--engine", "example"][..], "need clips"),
        (&["--examples", "people"], "--engine learned"),
        (&["--video", "kick.mp4"], "moving pictures are .webm and .gif"),
        (&["--engine", "both", "--examples", "people", "--steps", "2"], "does nothing with --steps"),
    ] {
        let output = inkrig(&folder, &[&["storyboard", "kick.json", "-o", "new.bvh"][..], more].concat());
        assert!(!output.status.success(), "{more:?}");
        assert!(text(&output.stderr).contains(said), "{more:?}: {}", text(&output.stderr));
    }
    assert!(!folder.join("new.bvh").exists());
}

#[test]
fn a_video_says_how_long_it_is_and_is_the_same_on_any_number_of_threads() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("trot.json"), TROT).unwrap();
    clips(&folder, "hound", "quadruped.bvh");
    let ask = ["storyboard", "trot.json", "--engine", "example", "--examples", "hound", "-o", "trot.bvh"];
    let [webm, again] = ["trot.webm", "again.webm"].map(|name| {
        let threads = if name == "again.webm" { "1" } else { "3" };
        let ask = [&ask[..], &["--force", "--report", "r.json", "--video", name]].concat();
        let mut program = Command::new(env!("CARGO_BIN_EXE_inkrig"));
        program.current_dir(&folder).args(ask).env("RAYON_NUM_THREADS", threads);
        let output = program.output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        std::fs::read(folder.join(name)).unwrap()
    });
    assert!(webm == again, "the number of threads takes part in a video");
    // Twenty pictures a second, two seconds in a cluster, all sizes known.
    let whole = elements(&webm);
    assert_eq!(whole.iter().map(|own| own.0).collect::<Vec<_>>(), [0x1A45_DFA3, 0x1853_8067]);
    assert!(whole[0].1.windows(4).any(|four| four == b"webm"));
    let segment = elements(whole[1].1);
    let blocks: Vec<usize> = segment
        .iter()
        .filter(|own| own.0 == 0x1F43_B675)
        .map(|own| elements(own.1).iter().filter(|own| own.0 == 0xA3).count())
        .collect();
    let pictures: usize = blocks.iter().sum();
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    let seconds = report["parts"][0]["frames"].as_f64().unwrap() / report["frame_rate"].as_f64().unwrap();
    assert_eq!(pictures as f64, (20.0 * seconds).ceil());
    assert!(blocks.iter().rev().skip(1).all(|count| *count == 40), "{blocks:?}");
    let info = elements(segment.iter().find(|own| own.0 == 0x1549_A966).unwrap().1);
    let duration = info.iter().find(|own| own.0 == 0x4489).unwrap().1;
    assert_eq!(f64::from_be_bytes(duration.try_into().unwrap()), 50.0 * pictures as f64);
}

/// What is in a Matroska file or in one of its elements: number and bytes.
fn elements(mut bytes: &[u8]) -> Vec<(u32, &[u8])> {
    let mut found = Vec::new();
    while let Some(first) = bytes.first() {
        let name = 1 + first.leading_zeros() as usize;
        let long = 1 + bytes[name].leading_zeros() as usize;
        let number = |bytes: &[u8]| bytes.iter().fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte));
        let size = (number(&bytes[name..name + long]) & !(1 << (7 * long))) as usize;
        found.push((number(&bytes[..name]) as u32, &bytes[name + long..name + long + size]));
        bytes = &bytes[name + long + size..];
    }
    found
}
