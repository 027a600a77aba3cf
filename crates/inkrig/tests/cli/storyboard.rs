//! `inkrig storyboard` on the command line.

use crate::{inkrig, text};

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
