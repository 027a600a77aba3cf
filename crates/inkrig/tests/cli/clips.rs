//! Files that hold several clips, and clips that are loops.

use super::{desk, inkrig, text};
use serde_json::Value;
use std::path::Path;

fn align(folder: &Path, arguments: &[&str]) -> Value {
    let fixed = ["align", "--curve", "circles.csv", "--force", "--json"];
    let output = inkrig(folder, &[&fixed, arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn clips_of_one_file_are_named_behind_it() {
    let (_keep, folder) = desk();
    assert!(inkrig(&folder, &["convert", "person.bvh", "one.glb"]).status.success());
    // The result is a second clip in a copy of the file.
    let first = align(&folder, &["one.glb", "-o", "two.glb"]);
    let frames = |report: &Value| report["source_frames"].as_u64().unwrap();
    let both = align(&folder, &["two.glb#person", "two.glb#one follows circles", "-o", "three.bvh"]);
    assert_eq!(frames(&both), frames(&first) + 120);
    let all = align(&folder, &["two.glb#*", "-o", "three.bvh"]);
    assert_eq!(frames(&all), frames(&both));
    assert_eq!(all["structure_pearson"], both["structure_pearson"]);
    assert_eq!(frames(&align(&folder, &["two.glb#*circles", "-o", "three.bvh"])), 120);

    let said = |arguments: &[&str]| {
        let output = inkrig(&folder, &[&["align", "--curve", "circles.csv"], arguments].concat());
        assert!(!output.status.success(), "{arguments:?}");
        text(&output.stderr)
    };
    assert!(said(&["two.glb#Run", "-o", "no.bvh"]).contains("no clip `Run`"));
    assert!(said(&["two.glb#R*", "-o", "no.bvh"]).contains("two.glb#R*"));
    let own = said(&["two.glb#person", "-o", "two.glb", "--force"]);
    assert!(own.contains("named twice"), "never over its own input: {own}");
}

#[test]
fn a_short_loop_is_played_as_often_as_asked() {
    let (_keep, folder) = desk();
    let convert = ["convert", "person.bvh", "step.bvh", "--range", "2s..8s", "--loop", "33"];
    assert!(inkrig(&folder, &convert).status.success());
    let laps = |times: &str| align(&folder, &["step.bvh", "--laps", times, "-o", "new.bvh"]);
    let (once, often) = (laps("1"), laps("6"));
    assert_eq!((&once["source_frames"], &often["source_frames"]), (&33.into(), &198.into()));
    assert_eq!((&often["parameters"]["laps"], &often["frames"]), (&6.into(), &120.into()));
    // What is no loop is used once, and said.
    let arguments =
        ["align", "person.bvh", "--laps", "2", "--curve", "circles.csv", "-o", "p.bvh", "--range", "3s..6s"];
    let output = inkrig(&folder, &arguments);
    assert!(text(&output.stdout).contains("person.bvh is no loop"), "{}", text(&output.stdout));
}
