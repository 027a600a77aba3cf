//! `inkrig storyboard --onto`: drawn frames on somebody else's character.

use crate::{inkrig, text};
use std::path::Path;

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap()
}

/// By how much limits are broken, in shares of themselves.
fn beyond(report: &serde_json::Value) -> f64 {
    let broken = report["certificate"]["broken"].as_array().unwrap();
    broken
        .iter()
        .map(|broken| broken["value"].as_f64().unwrap() / broken["limit"].as_f64().unwrap() - 1.0)
        .sum()
}

/// A body with short legs and long forearms, of a motion's BVH file.
fn of_other_build(bvh: &str) -> String {
    let mut factor = 1.0;
    let mut lines = Vec::new();
    for line in bvh.lines() {
        if let Some(name) = line.trim().strip_prefix("JOINT ") {
            factor = if name.contains("ankle") || name.contains("knee") { 0.85 } else { 1.0 };
            factor = if name.contains("wrist") { 1.3 } else { factor };
        }
        lines.push(match line.trim().strip_prefix("OFFSET ") {
            Some(offset) => {
                let by = |number: &str| (factor * number.parse::<f64>().unwrap()).to_string();
                format!("OFFSET {}", offset.split_whitespace().map(by).collect::<Vec<_>>().join(" "))
            }
            None => line.to_owned(),
        });
    }
    lines.join("\n")
}

#[test]
fn of_a_frames_motions_one_that_lands_on_the_character_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let quick = ["--steps", "2", "--candidates", "4", "--exact", "pin", "--report", "r.json", "--force"];
    let made = |board: &str, out: &str, more: &[&str]| {
        let output = inkrig(folder, &[&["storyboard", board, "-o", out], &quick[..], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        (report(folder), text(&output.stdout).to_owned())
    };
    let onto = ["--onto", "hero.bvh"];
    let mut others = 0;
    let frames = [("kick", 0), ("turn-and-run", 1), ("jump", 1), ("dance", 2), ("walk-and-wave", 0)];
    for (name, frame) in frames {
        let sample = inkrig::samples::find(&format!("{name}.json")).unwrap().bytes;
        let mut board: serde_json::Value = serde_json::from_slice(sample).unwrap();
        board["frames"] = serde_json::json!([board["frames"][frame]]);
        let write =
            |board: &serde_json::Value| std::fs::write(folder.join("b.json"), board.to_string()).unwrap();
        write(&board);
        made("b.json", "own.bvh", &[]);
        let own = std::fs::read_to_string(folder.join("own.bvh")).unwrap();
        std::fs::write(folder.join("hero.bvh"), of_other_build(&own)).unwrap();
        let (chosen, said) = made("b.json", "out.bvh", &onto);
        let take = chosen["parts"][0]["take"].as_u64().unwrap();
        assert_eq!(said.contains(&format!("motion {} of 4", take + 1)), take > 0, "{said}");
        println!("{name}, frame {}: motion {take} of 0 to 3, beyond by {}", frame + 1, beyond(&chosen));
        others += take;
        // Those before it did not land; where none does, the best stays.
        let lands = beyond(&chosen) == 0.0;
        assert!(lands || take == 0, "{said}");
        for other in 1..if lands { take } else { 4 } {
            board["frames"][0]["take"] = other.into();
            write(&board);
            let (told, _) = made("b.json", "out.bvh", &onto);
            assert_eq!(told["parts"][0]["take"], other, "who says a take has it");
            assert!(beyond(&told) > 0.0, "{name}: motion {other} lands, too");
        }
        // A joint that was put in space was put so in the best motion.
        if take > 0 {
            board["frames"][0].as_object_mut().unwrap().remove("take");
            let at = [0.3, 1.0, 0.2];
            board["frames"][0]["edits"] = serde_json::json!([{"joint": "left_wrist", "frame": 20, "at": at}]);
            write(&board);
            assert_eq!(made("b.json", "out.bvh", &onto).0["parts"][0]["take"], 0);
        }
    }
    assert!(others > 0, "the best of all of them landed, which shows nothing");
}

/// From the drawing to somebody else's character, where that is there: limbs, trunk, knees and elbows, feet, ground.
#[test]
fn drawn_boards_are_certified_on_a_character() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| beside.into(), std::path::PathBuf::from);
    let character = shared.join("data/creatures/human-model.glb");
    if !character.is_file() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{}", character.display());
        println!("skipped: no reference data at {}", character.display());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["kick", "jump", "turn-and-run"] {
        let file = format!("{name}.json");
        std::fs::write(folder.join(&file), inkrig::samples::find(&file).unwrap().bytes).unwrap();
        let character = character.to_string_lossy();
        let out = format!("{name}.glb");
        let ask = [
            "storyboard",
            &file,
            "--exact",
            "pin",
            "--onto",
            &character,
            "-o",
            &out,
            "--report",
            "r.json",
            "--force",
        ];
        let output = inkrig(folder, &ask);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report = report(folder);
        let certificate = &report["certificate"];
        println!(
            "{name}: limbs {} degrees, trunk {}, feet slide {} mm, sink {} mm",
            certificate["direction_degrees"]["p95"],
            certificate["trunk_degrees"]["p95"],
            certificate["slide_mm"]["max"],
            certificate["below_ground_mm"]["max"]
        );
        assert_eq!(certificate["verdict"], "pass", "{certificate}");
        assert_eq!(certificate["broken"].as_array().map(Vec::len), Some(0));
        let pairs = certificate["pairs"].as_array().unwrap().len();
        assert!(pairs > 15 && report["parts"][0]["result"][1].as_f64().unwrap() < 0.02, "{pairs}");
        let own = inkrig(folder, &["inspect", &out]);
        assert!(own.status.success(), "{}", text(&own.stderr));
    }
}
