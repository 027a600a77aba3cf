//! Suggestions, maps, and other solutions, on the command line.

use super::{align, desk, inkrig, text};
use serde_json::Value;

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

#[test]
fn the_report_says_what_is_used_and_suggests_poses() {
    let (_keep, folder) = desk();
    let output = align(&folder, &["--range", "60..500", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report = json(&output.stdout);
    let used = &report["used"];
    let frames = used["frame"].as_array().unwrap();
    assert_eq!((frames.len(), used["confidence"].as_array().unwrap().len()), (120, 120));
    assert!(frames.iter().all(|frame| (60..500).contains(&frame.as_u64().unwrap())), "counted in the file");
    assert!(used["clip"].is_null(), "there is one clip only");
    let candidates = report["candidates"].as_array().unwrap();
    assert_eq!(candidates.len(), 8);
    assert!((60..500).contains(&candidates[0]["frame"].as_u64().unwrap()));
    assert!(report["ambiguous"].is_boolean() && report["mirror_symmetry"].is_f64());
    // A suggested pose can be asked for as it is written there.
    let key = format!("0.5s~frame:{}", candidates[1]["frame"]);
    let output = align(&folder, &["--range", "60..500", "--key", &key, "--force"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn poses_are_suggested_and_the_clip_is_mapped() {
    let (_keep, folder) = desk();
    let output = inkrig(&folder, &["suggest", "person.bvh", "--map", "map.json", "--sheet", "poses.png"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout).matches("~frame:").count(), 8);
    assert!(std::fs::read(folder.join("poses.png")).unwrap().starts_with(b"\x89PNG"));
    let map = json(&std::fs::read(folder.join("map.json")).unwrap());
    let points = map["moments"].as_array().unwrap();
    assert_eq!(points.len(), 721);
    assert_eq!(points[9][0], 9);

    // A line over the map, from one pose to another and back: as numbers, and over the picture.
    let place = |index: usize| ["x", "y"].map(|axis| map["candidates"][index][axis].as_f64().unwrap());
    let (from, to) = (place(1), place(2));
    let way = (0..180).map(|i| {
        let part = 0.5 - 0.5 * (f64::from(i) / 30.0).cos();
        [0, 1].map(|axis: usize| from[axis] + part * (to[axis] - from[axis]))
    });
    let line: Vec<[f64; 2]> = way.collect();
    std::fs::write(folder.join("line.json"), serde_json::to_string(&line).unwrap()).unwrap();
    let on_map = |curve: &str| {
        let arguments =
            ["align", "person.bvh", "--curve", curve, "--on-map", "-o", "new.bvh", "--force", "--json"];
        let output = inkrig(&folder, &arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        json(&output.stdout)
    };
    let used = on_map("line.json")["used"]["frame"].clone();
    let far = |sample: usize, goal: [f64; 2]| {
        let at = &points[used[sample].as_u64().unwrap() as usize];
        (at[1].as_f64().unwrap() - goal[0]).hypot(at[2].as_f64().unwrap() - goal[1])
    };
    let apart = (from[0] - to[0]).hypot(from[1] - to[1]);
    assert!(
        far(0, from) < 0.4 * apart && far(94, to) < 0.4 * apart,
        "{} {} of {apart}",
        far(0, from),
        far(94, to)
    );

    let output = inkrig(&folder, &["suggest", "person.bvh", "--map", "map.svg"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let svg = text(&std::fs::read(folder.join("map.svg")).unwrap());
    let drawn = svg.replace("</svg>", "<path d='M200 300 L500 400 L300 300'/></svg>");
    std::fs::write(folder.join("drawn.svg"), drawn).unwrap();
    on_map("drawn.svg");
    // The map is the same whatever the alignment looks at, and no drawing.
    let looked = ["--patch", "0.6", "--rotations", "root", "--velocity", "world"];
    let plain =
        ["align", "person.bvh", "--curve", "line.json", "--on-map", "-o", "new.bvh", "--force", "--json"];
    let otherwise = json(&inkrig(&folder, &[&plain[..], &looked].concat()).stdout);
    assert_eq!(otherwise["candidates"], map["candidates"]);
    assert_eq!(otherwise["keys"][1]["pose"], format!("frame {}", map["candidates"][1]["frame"]));
    let said = inkrig(&folder, &["align", "person.bvh", "--curve", "map.json", "-o", "never.bvh"]);
    assert!(
        text(&said.stderr).replace(['\n', '│', ' '], "").contains("aclip'smap"),
        "{}",
        text(&said.stderr)
    );
    // Frames and seconds of a part are those of the file.
    let part = inkrig(&folder, &["suggest", "person.bvh", "--range", "10s..20s", "--json"]);
    for pose in json(&part.stdout)["candidates"].as_array().unwrap() {
        let (frame, seconds) = (pose["frame"].as_f64().unwrap(), pose["seconds"].as_f64().unwrap());
        assert!((10.0..20.0).contains(&seconds) && (seconds - frame / 30.0).abs() < 1e-3, "{pose}");
    }
    let wrong = inkrig(&folder, &["suggest", "person.bvh", "--map", "map.txt"]);
    assert!(text(&wrong.stderr).contains(".svg"), "{}", text(&wrong.stderr));
}

#[test]
fn other_solutions_are_written_beside_the_first() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("spiral.json"), inkrig::samples::find("spiral").unwrap().bytes).unwrap();
    let align = |more: &[&str]| {
        inkrig(&folder, &[&["align", "person.bvh", "--curve", "spiral.json", "-o", "new.bvh"], more].concat())
    };
    let output = align(&["--solutions", "3", "--preview", "p.html", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report = json(&output.stdout);
    let solutions = report["solutions"].as_array().unwrap();
    assert!(solutions.len() > 1, "{report}");
    assert_eq!(solutions[1]["motion"], "new-2.bvh");
    assert!(solutions[1]["distance"].as_f64().unwrap() >= 0.5);
    let first = std::fs::read(folder.join("new.bvh")).unwrap();
    assert_ne!(first, std::fs::read(folder.join("new-2.bvh")).unwrap());
    assert!(folder.join("p-2.html").exists());
    // Every report names its own files.
    assert!(align(&["--force", "--solutions", "2", "--report", "r.json"]).status.success());
    let outputs = |name: &str| json(&std::fs::read(folder.join(name)).unwrap())["outputs"].clone();
    assert_eq!(outputs("r.json"), serde_json::json!(["new.bvh", "r.json"]));
    assert_eq!(outputs("r-2.json"), serde_json::json!(["new-2.bvh", "r-2.json"]));
    // The first is the one without the flag; the mirrored one is another.
    assert!(align(&["--force"]).status.success());
    assert!(first == std::fs::read(folder.join("new.bvh")).unwrap());
    assert!(align(&["--force", "--mirror"]).status.success());
    assert!(first != std::fs::read(folder.join("new.bvh")).unwrap());
    // A file that would be replaced is told before any work.
    assert!(!align(&["--solutions", "2"]).status.success());
}
