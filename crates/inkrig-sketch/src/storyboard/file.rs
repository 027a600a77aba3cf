//! The file: JSON with a version.

use super::{Frame, STORYBOARD_VERSION, Storyboard};
use crate::SketchError;
use crate::limits::{MAX_BYTES, MAX_STORYBOARD_LISTS, MAX_STORYBOARD_OBJECTS};
use crate::read::utf8;
use serde::Deserialize;

/// The whole file; its first key says what it is.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "inkrig_storyboard")]
    _version: u32,
    #[serde(default)]
    title: String,
    frames: Vec<Frame>,
}

/// Reads a storyboard from the bytes of its file. A byte order mark is skipped.
///
/// # Errors
/// Any [`SketchError`] that says where and what: too large, no UTF-8, no JSON, an unknown key, another version, or what
/// [`Storyboard::check`] finds.
pub fn read_storyboard(bytes: &[u8]) -> Result<Storyboard, SketchError> {
    if bytes.len() > MAX_BYTES {
        return Err(SketchError::FileTooLarge { what: "storyboard", bytes: bytes.len() });
    }
    let text = utf8(bytes).map_err(|line| SketchError::FileNotText { what: "storyboard", line })?;
    // Every list and object costs memory of its own, however few bytes it has: they are counted before any is made.
    let count = |bracket: u8| text.bytes().filter(|byte| *byte == bracket).count();
    for (number, limit, what) in [
        (count(b'['), MAX_STORYBOARD_LISTS, "points and lists"),
        (count(b'{'), MAX_STORYBOARD_OBJECTS, "frames, trajectories and pins"),
    ] {
        if number > limit {
            let problem = format!("it has {number} {what}; at most {limit} are read. Draw it simpler");
            return Err(SketchError::Storyboard { place: "the file".into(), problem });
        }
    }
    let wrong = |error: &serde_json::Error| {
        let message = error.to_string();
        let problem = message.rsplit_once(" at line ").map_or(message.as_str(), |(problem, _)| problem);
        let place = format!("line {}, column {}", error.line(), error.column());
        SketchError::Storyboard { place, problem: problem.to_owned() }
    };
    // A later form may have other keys, so its version is looked at first.
    if let Ok(Version { inkrig_storyboard: version }) = serde_json::from_str(text)
        && version != STORYBOARD_VERSION
    {
        let problem = format!(
            "it is of form {version}, and this program knows form {STORYBOARD_VERSION}. Use the inkrig that it was made with"
        );
        return Err(SketchError::Storyboard { place: "inkrig_storyboard".into(), problem });
    }
    let file: File = serde_json::from_str(text).map_err(|error| wrong(&error))?;
    let board = Storyboard { title: file.title, frames: file.frames };
    board.check()?;
    Ok(board)
}

#[derive(Deserialize)]
struct Version {
    inkrig_storyboard: u32,
}

/// The bytes of a storyboard's file: what [`read_storyboard`] reads back as the same. Numbers keep all their digits.
///
/// # Errors
/// As [`Storyboard::check`].
pub fn write_storyboard(board: &Storyboard) -> Result<String, SketchError> {
    board.check()?;
    let value = |part: serde_json::Result<serde_json::Value>| {
        part.map_err(|error| SketchError::Storyboard { place: "the file".into(), problem: error.to_string() })
    };
    let mut out = format!("{{\n \"inkrig_storyboard\": {STORYBOARD_VERSION},");
    if !board.title.is_empty() {
        out += &format!("\n \"title\": {},", serde_json::Value::String(board.title.clone()));
    }
    out.push_str("\n \"frames\": ");
    print(&value(serde_json::to_value(&board.frames))?, 1, &mut out);
    out.push_str("\n}\n");
    Ok(out)
}

/// Objects and lists of them on lines of their own, a stroke on one line.
fn print(value: &serde_json::Value, depth: usize, out: &mut String) {
    use serde_json::Value;
    let indent = |out: &mut String, depth: usize| {
        out.push('\n');
        (0..depth).for_each(|_| out.push(' '));
    };
    match value {
        Value::Object(fields) if fields.values().any(|field| field.is_array() || field.is_object()) => {
            out.push('{');
            for (number, (key, field)) in fields.iter().enumerate() {
                out.push_str(if number > 0 { "," } else { "" });
                indent(out, depth + 1);
                out.push_str(&Value::String(key.clone()).to_string());
                out.push_str(": ");
                print(field, depth + 1, out);
            }
            indent(out, depth);
            out.push('}');
        }
        Value::Array(items) if items.iter().any(|item| item.is_object() || is_stroke(item)) => {
            out.push('[');
            for (number, item) in items.iter().enumerate() {
                out.push_str(if number > 0 { "," } else { "" });
                indent(out, depth + 1);
                print(item, depth + 1, out);
            }
            indent(out, depth);
            out.push(']');
        }
        other => out.push_str(&other.to_string()),
    }
}

fn is_stroke(value: &serde_json::Value) -> bool {
    value.as_array().is_some_and(|rows| rows.first().is_some_and(serde_json::Value::is_array))
}

#[cfg(test)]
mod tests {
    use super::super::{
        Constraint, Edit, End, FrameCamera, FramePath, Pin, SideChoice, Sides, Stroke, Trajectory,
    };
    use super::*;

    fn board() -> Storyboard {
        let line = Stroke::new(vec![[0.0, 0.1], [1.0, 2.0]]);
        let timed = Stroke {
            points: vec![[0.25, 0.0], [1.0, 1e-9]],
            seconds: Some(vec![0.0, 0.1]),
            pressure: Some(vec![0.5, 1.0]),
        };
        let way = Trajectory { points: timed, joint: Some("left_foot".into()), figure: Some(End::End) };
        let frame = Frame {
            sides: Sides { arms: SideChoice::Swapped, legs: SideChoice::Read },
            word: "kick".into(),
            lettering: vec![line.clone()],
            path: Some(FramePath::Of(3)),
            body: vec![line.clone(), line.clone()],
            trajectories: vec![way, Trajectory { points: line.clone(), ..Trajectory::default() }],
            speed_lines: vec![line.clone()],
            scene: vec![line],
            pins: vec![Pin { joint: "head".into(), at: [3.0, 4.0] }],
            edits: vec![Edit { joint: "right_wrist".into(), frame: 12, at: [0.25, 1.5, -0.125] }],
            lock_ends: true,
            constraints: constraints(),
            camera: FrameCamera { pitch_degrees: 10.0, yaw_degrees: -30.0 },
            seconds: Some(1.5),
            take: 2,
            number: Some(7),
            notes: "a \"note\"\n".into(),
        };
        Storyboard {
            title: "two".into(),
            frames: vec![frame, Frame { word: "walk".into(), ..Frame::default() }],
        }
    }

    fn constraints() -> Vec<Constraint> {
        let name = || "left_wrist".to_owned();
        let plane = |height, normal, through| Constraint::Plane {
            joint: name(),
            height,
            normal,
            through,
            scene: None,
            frames: Some([3, 9]),
        };
        vec![
            Constraint::Distance { joints: [name(), "right_wrist".into()], metres: Some(0.5), frames: None },
            Constraint::Distance { joints: [name(), "head".into()], metres: None, frames: Some([0, 0]) },
            plane(Some(0.0), None, None),
            plane(None, Some([0.0, 0.0, 1.0]), Some([0.0, 0.0, 0.5])),
            Constraint::Box {
                joint: name(),
                from: Some([0.0; 3]),
                to: Some([0.5, 0.75, -1.0]),
                scene: None,
                thickness: None,
                frames: None,
            },
            Constraint::Balance { frames: None },
        ]
    }

    #[test]
    fn what_is_written_is_read_back() {
        let text = write_storyboard(&board()).unwrap();
        assert_eq!(read_storyboard(text.as_bytes()).unwrap(), board());
        assert!(
            text.lines().any(|line| line.trim() == "[[0.0,0.1],[1.0,2.0]]"),
            "a stroke is a line: {text}"
        );
        let short = br#"{"inkrig_storyboard": 1, "frames": [{"word": "run"}]}"#;
        let read = read_storyboard(short).unwrap();
        assert_eq!(read.frames[0].camera, FrameCamera { pitch_degrees: 20.0, yaw_degrees: 30.0 });
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let frame = |inside: &str| format!(r#"{{"inkrig_storyboard": 1, "frames": [{{{inside}}}]}}"#);
        for (text, part) in [
            (String::new(), "line 1, column 0"),
            ("[]".into(), "line 1"),
            (r#"{"frames": []}"#.into(), "missing field `inkrig_storyboard`"),
            (r#"{"inkrig_storyboard": 2, "panels": []}"#.into(), "form 2, and this program knows form 1"),
            (r#"{"inkrig_storyboard": 1, "frames": []}"#.into(), "there is no frame"),
            (frame(r#""bodi": []"#), "unknown field `bodi`"),
            (frame(r#""body": [[[0, 0], [1]]]"#), "two to four numbers"),
            (frame(r#""body": [[[0, 0, 0, 0, 0]]]"#), "two to four numbers"),
            (frame(r#""body": [[[0, 0], [1, 1, 1]]]"#), "as many numbers as its first"),
            (frame(r#""body": [[[0, 0]], []]"#), "frame 1, body 2, point 0: the stroke has no point"),
            (
                frame(r#""scene": [[[0, 0], [1e16, 0]]]"#),
                "frame 1, scene 1, point 1: 10000000000000000 is no",
            ),
            (
                frame(r#""trajectories": [{"points": [[0,0,1],[1,1,0]]}]"#),
                "trajectory 1, point 1: time goes back",
            ),
            (frame(r#""trajectories": [{"points": [[0,0,0,-1]]}]"#), "trajectory 1, point 0"),
            (
                frame(r#""trajectories": [{"points": [[0,0]], "figure": "middle"}]"#),
                "unknown variant `middle`",
            ),
            (frame(r#""seconds": 0"#), "frame 1, seconds: 0 is not 0.1 to 60"),
            (frame(r#""take": 64"#), "frame 1, take: 64 is not 0 (the best) to 63"),
            (frame(r#""number": 0"#), "frame 1, number: 0 is not 1 to 1000000"),
            (frame(r#""camera": {"pitch_degrees": 100}"#), "frame 1, camera: pitch 100 and yaw 30"),
            (frame(r#""pins": [{"joint": "head", "at": [0, 1e99]}]"#), "pin of head"),
            (
                frame(r#""edits": [{"joint": "head", "frame": 2, "at": [0, 1e9, 0]}]"#),
                "frame 1, edit of head at frame 2: 1000000000 is no place",
            ),
            (
                frame(r#""seconds": 1, "edits": [{"joint": "head", "frame": 20, "at": [0, 1, 0]}]"#),
                "edit of head at frame 20: the clip has frames 0 to 19",
            ),
            (
                frame(
                    r#""edits": [{"joint": "head", "frame": 2, "at": [0, 1, 0]}, {"joint": "head", "frame": 2, "at": [0, 2, 0]}]"#,
                ),
                "it is at [0.0, 1.0, 0.0] and at [0.0, 2.0, 0.0]",
            ),
            (frame(r#""edits": [{"joint": "head", "frame": -1, "at": [0, 1, 0]}]"#), "invalid value"),
            (frame(r#""constraints": [{"kind": "rope"}]"#), "unknown variant `rope`"),
            (frame(r#""constraints": [{"kind": "balance", "joint": "head"}]"#), "unknown field `joint`"),
            (frame(r#""constraints": [{"kind": "plane", "joint": "head"}]"#), "it needs \"height\", or"),
            (
                frame(
                    r#""constraints": [{"kind": "plane", "joint": "head", "normal": [0, 0, 0], "through": [0, 0, 0]}]"#,
                ),
                "says no direction",
            ),
            (
                frame(
                    r#""constraints": [{"kind": "box", "joint": "head", "from": [0, 0, 0], "to": [1, 0, 1]}]"#,
                ),
                "constraint 1 (box): the box from",
            ),
            (
                frame(r#""constraints": [{"kind": "box", "joint": "head", "scene": 0}]"#),
                "the scene has no stroke 0: there are 0",
            ),
            (
                frame(r#""constraints": [{"kind": "box", "joint": "head"}]"#),
                "it needs \"from\" and \"to\", or",
            ),
            (
                frame(r#""constraints": [{"kind": "distance", "joints": ["left_wrist", "left_wrist"]}]"#),
                "Name two",
            ),
            (
                frame(
                    r#""constraints": [{"kind": "distance", "joints": ["left_wrist", "head"], "metres": 9}]"#,
                ),
                "9 m is not a distance",
            ),
            (
                frame(r#""constraints": [{"kind": "balance", "frames": [9, 3]}]"#),
                "it begins at frame 9, behind its last, 3",
            ),
            (
                frame(r#""seconds": 1, "constraints": [{"kind": "balance", "frames": [0, 30]}]"#),
                "it ends at frame 30; the clip has frames 0 to 19",
            ),
            (frame(&format!(r#""word": "{}""#, "a".repeat(5000))), "frame 1, word: 5000 bytes"),
            ("[".repeat(3_000_000), "at most 1000000 are read"),
            ("{".repeat(100_000), "at most 50000 are read"),
        ] {
            let said = read_storyboard(text.as_bytes()).unwrap_err().to_string();
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(matches!(read_storyboard(b"\xFF"), Err(SketchError::FileNotText { .. })));
        let half = Stroke { points: vec![[0.0; 2]], seconds: None, pressure: Some(vec![1.0]) };
        let board = Storyboard { frames: vec![Frame { body: vec![half], ..Frame::default() }], ..board() };
        assert!(write_storyboard(&board).is_err(), "what could not be read back is not written");
    }
}
