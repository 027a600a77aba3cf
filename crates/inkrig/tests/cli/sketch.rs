//! `inkrig sketch`, `inkrig evaluate` and training of readers on the command line.

use crate::{inkrig, text};

/// A figure of a round head, a trunk, arms and legs.
const FIGURE: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 160 160' fill='none' stroke='black'>\
    <circle cx='80' cy='30' r='12'/><path d='M80 42 L80 90'/>\
    <path d='M40 48 L60 65 L80 52 L105 60 L120 35'/><path d='M55 145 L62 115 L80 90 L105 110 L110 145'/></svg>";

#[test]
fn a_figure_is_read_by_its_lines_as_lines_and_as_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("figure.svg"), FIGURE).unwrap();
    let arguments = ["sketch", "read", "figure.svg", "--lines", "-o", "joints.json", "--picture", "seen.png"];
    let output = inkrig(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("left_wrist"), "{}", text(&output.stdout));
    let joints: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("joints.json")).unwrap()).unwrap();
    let place = |name: &str| {
        let joint = joints["joints"].as_array().unwrap().iter().find(|joint| joint["name"] == name).unwrap();
        [joint["x"].as_f64().unwrap(), joint["y"].as_f64().unwrap()]
    };
    // Faces the viewer: its left hand is on the right. The page has another scale than the drawing.
    let (left, right, head, pelvis) =
        (place("left_wrist"), place("right_wrist"), place("head"), place("pelvis"));
    assert!(left[0] > head[0] && head[0] > right[0], "{left:?} {head:?} {right:?}");
    let unit = (pelvis[1] - head[1]) / 60.0;
    assert!(((left[0] - right[0]) / unit - 80.0).abs() < 8.0, "{left:?} {right:?}");
    assert_eq!(joints["read_by"], "lines");

    // The same again out of the picture, whose lines are grey and hold coloured joints.
    let output = inkrig(folder, &["sketch", "read", "seen.png", "--lines"]);
    assert!(
        output.status.success() || text(&output.stderr).contains("no figure"),
        "{}",
        text(&output.stderr)
    );
    let output = inkrig(folder, &arguments);
    assert_eq!(output.status.code(), Some(1), "files are not replaced");
}

#[test]
fn a_sheet_shows_what_was_found_on_marked_drawings() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let one = folder.join("marked").join("one");
    std::fs::create_dir_all(&one).unwrap();
    std::fs::write(folder.join("figure.svg"), FIGURE).unwrap();
    let drawn = inkrig(folder, &["sketch", "read", "figure.svg", "--picture", "marked/one/texture.png"]);
    assert!(drawn.status.success(), "{}", text(&drawn.stderr));
    let joint = |name: &str, x: f64, y: f64| format!("- loc:\n  - {x}\n  - {y}\n  name: {name}\n");
    let marks = joint("hip", 450.0, 500.0) + &joint("torso", 450.0, 300.0) + &joint("neck", 450.0, 170.0);
    std::fs::write(one.join("char_cfg.yaml"), marks).unwrap();
    let arguments = ["evaluate", "sketch", "--drawings", "marked", "--sheet", "seen.png"];
    let output = inkrig(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("of 2 marked joints"), "{}", text(&output.stdout));
    let sheet = std::fs::read(folder.join("seen.png")).unwrap();
    let size = |at: usize| u32::from_be_bytes(sheet[at..at + 4].try_into().unwrap());
    assert_eq!((&sheet[1..4], size(16), size(20)), (&b"PNG"[..], 220, 220));
    assert_eq!(inkrig(folder, &arguments).status.code(), Some(1), "files are not replaced");
    assert!(inkrig(folder, &[&arguments[..], &["--force"]].concat()).status.success());

    // Nothing to show is said, and no sheet is written.
    std::fs::create_dir(folder.join("empty")).unwrap();
    let output = inkrig(folder, &["evaluate", "sketch", "--drawings", "empty", "--sheet", "none.png"]);
    assert!(text(&output.stderr).contains("nothing was drawn"), "{}", text(&output.stderr));
    assert!(!folder.join("none.png").exists());
}

#[test]
fn what_cannot_be_read_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path stroke='black' d='M1 1 L8 8'/></svg>";
    std::fs::write(folder.join("line.svg"), line).unwrap();
    std::fs::write(folder.join("broken.png"), b"\x89PNG\r\n\x1a\n").unwrap();
    std::fs::write(folder.join("noise.png"), [0xc5; 99]).unwrap();
    std::fs::write(folder.join("weights.safetensors"), b"none").unwrap();
    std::fs::write(folder.join("photo.png"), b"\xff\xd8\xff\xe0 and so on").unwrap();
    std::fs::write(folder.join("huge.png"), b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\x01\0\0\0\x01\0\0").unwrap();
    for (arguments, said) in [
        (&["sketch", "read", "line.svg", "--lines"][..], "shows no figure"),
        (&["sketch", "read", "broken.png", "--lines"], "no PNG"),
        (&["sketch", "read", "noise.png", "--lines"], "does not begin like one"),
        (&["sketch", "read", "photo.png", "--lines"], "is no PNG but a JPEG"),
        (&["sketch", "read", "huge.png", "--lines"], "more pixels than 8192 x 8192"),
        (&["sketch", "read", "line.svg", "--picture", "seen.jpg"], "a picture is written as .png"),
        (&["sketch", "read", "figure.bvh", "--lines"], "known drawings"),
        (&["sketch", "read", "line.svg", "--weights", "weights.safetensors"], "weights.safetensors"),
        (&["train", "word", "--fonts", ".", "-o", "run"], "no font of Latin letters"),
        (&["train", "sketch", "--corpus", "nowhere", "-o", "run"], "nowhere"),
        (&["evaluate", "sketch", "--corpus", "nowhere", "--lines"], "nowhere"),
        (&["evaluate", "reconstruction", "--corpus", "nowhere"], "nowhere"),
        (&["evaluate", "control", "--corpus", "nowhere", "--steps", "2"], "nowhere"),
    ] {
        let output = inkrig(folder, arguments);
        let error = text(&output.stderr).replace(['\n', '│', ' '], "");
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
        assert!(error.contains(&said.replace(' ', "")), "{arguments:?}: {error}");
    }
    assert!(!folder.join("run").exists());
}
