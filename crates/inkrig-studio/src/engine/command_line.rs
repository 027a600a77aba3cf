//! The line of a shell that makes the same result.

use crate::StudioError;
use crate::document::{Control, CurveTiming, Document, GroundPath, KeyKind, Place, Preset, RootMode};
use crate::engine::SourceMap;
use crate::engine::prepare::curve;
use inkrig_sketch::to_csv;
use std::fmt::Write as _;

/// The line, and files of the project's folder that it names.
///
/// # Errors
/// When nothing is arranged or followed.
pub(crate) fn command_line(
    document: &Document,
    map: &SourceMap,
) -> Result<(String, Vec<(String, String)>), StudioError> {
    let settings = &document.settings;
    let mut line = String::from("inkrig align");
    // What is drawn becomes a file, that the line can name it.
    let mut files = Vec::new();
    let file = |id: &str| document.clip(id).map(|clip| format!("clips/{}", clip.file));
    let path = |id: &str| {
        document.clip(id).map(|clip| {
            let take = clip.take.as_ref().map(|take| format!("#{take}")).unwrap_or_default();
            quoted(&format!("clips/{}{take}", clip.file))
        })
    };
    for id in &document.source.clips {
        let _ = write!(line, " {}", path(id).unwrap_or_default());
    }
    if document.source.clips.is_empty() {
        return Err(StudioError::NoSource);
    }
    let mut add = |text: String| {
        line.push(' ');
        line.push_str(&text);
    };
    match document.control.as_ref().ok_or(StudioError::NoControl)? {
        Control::Curve { strokes, timing, smooth } => {
            // Pen time tells the length, too, where it does not tell the speed.
            files.push(("drawing.csv".to_string(), to_csv(&curve(strokes)?)));
            add("--curve drawing.csv".into());
            if *timing == CurveTiming::Even {
                add("--uniform".into());
            }
            if let Some(smooth) = smooth {
                add(format!("--smooth {smooth}"));
            }
        }
        Control::Wave { expression } => add(format!("--wave {}", quoted(expression))),
        Control::DrawnWave { points } => {
            let rows: String = points.iter().map(|[t, value]| format!("{t},{value}\n")).collect();
            files.push(("wave.csv".to_string(), format!("t,value\n{rows}")));
            add("--wave wave.csv".into());
        }
        Control::Labels { segments } => {
            let one = |segment: &crate::document::LabelSegment| {
                let plain = segment.name.chars().all(char::is_alphanumeric) && !segment.name.is_empty();
                let name = if plain {
                    segment.name.clone()
                } else {
                    format!("\"{}\"", segment.name.replace('"', "\"\""))
                };
                format!("{name}:{}s", segment.seconds)
            };
            let text: Vec<String> = segments.iter().map(one).collect();
            add(format!("--labels {}", quoted(&text.join(" "))));
        }
        Control::Sound { sound, smooth, outline } => {
            let file = document.sound(sound).map(|sound| quoted(&format!("sounds/{}", sound.file)));
            add(format!("{} {}", if *outline { "--wave" } else { "--sound" }, file.unwrap_or_default()));
            if let Some(smooth) = smooth {
                add(format!("--smooth {smooth}"));
            }
        }
        Control::Motion { clip } => add(format!("--like {}", path(clip).unwrap_or_default())),
    }
    let mut option = |name: &str, value: Option<f64>| {
        if let Some(value) = value {
            add(format!("--{name} {value}"));
        }
    };
    option("alpha", settings.structure);
    option("lambda", settings.evenness);
    option("epsilon", settings.blend);
    option("fps", settings.fps);
    if let Some(seconds) = settings.length {
        add(format!("--length {seconds}s"));
    }
    if let Some([from, to]) = document.source.range {
        add(format!("--range {from}s..{to}s"));
    }
    let mut flag = |on: bool, text: String| {
        if on {
            add(text);
        }
    };
    flag(document.source.laps > 1, format!("--laps {}", document.source.laps));
    flag(settings.repeat > 1, format!("--repeat {}", settings.repeat));
    flag(settings.preset == Preset::Natural, "--preset natural".into());
    flag(settings.seed != 0, format!("--seed {}", settings.seed));
    flag(settings.mirror, "--mirror".into());
    flag(settings.cyclic, "--loop".into());
    flag(settings.solution > 0, format!("--solutions {}", settings.solution + 1));
    match settings.root {
        RootMode::Travel => {}
        RootMode::InPlace => add("--root in-place".into()),
        RootMode::Bone => add("--root bone".into()),
        RootMode::Hips => add("--root hips".into()),
    }
    match &settings.path {
        None => {}
        Some(GroundPath::Straight) => add("--path straight".into()),
        Some(GroundPath::Arc { degrees }) => add(format!("--path arc:{degrees}")),
        Some(GroundPath::Bend { degrees }) => add(format!("--path bend:{degrees}")),
        Some(GroundPath::Drawn { points, closed, metres_per_unit }) => {
            let again = points.first().filter(|_| *closed);
            let rows: String = points.iter().chain(again).map(|[x, y]| format!("{x},{y}\n")).collect();
            files.push(("path.csv".to_string(), format!("x,y\n{rows}")));
            add("--path path.csv".into());
            if let Some(metres) = metres_per_unit {
                add(format!("--path-scale {metres}"));
            }
        }
    }
    for key in document.keys.iter().filter(|key| key.enabled) {
        let pose = key.pose.as_ref().map(|pose| match map.to_takes(&pose.clip, pose.frame) {
            // Of one clip frames are those of its file, of several counted through all.
            Some(_) if document.source.clips.len() == 1 => format!("frame:{}", pose.frame),
            Some(frame) => format!("frame:{frame}"),
            None => format!("{}:{}", file(&pose.clip).unwrap_or_default(), pose.frame),
        });
        let place = key.place.as_ref().map(|place| match place {
            Place::Time { seconds } => format!("{seconds}s"),
            Place::Point { point: [x, y] } => format!("{x},{y}"),
            Place::Value { value } => format!("{value}"),
            Place::Label { label } => format!("label:{label}"),
        });
        match (key.kind, place, pose) {
            (KeyKind::Hard, Some(place), Some(pose)) => {
                add(format!("--key {}", quoted(&format!("{place}={pose}"))));
            }
            (KeyKind::Soft, Some(place), Some(pose)) => {
                let weight = key.weight.unwrap_or(0.5);
                add(format!("--key {}", quoted(&format!("{place}~{pose}*{weight}"))));
            }
            (KeyKind::Avoid, _, Some(pose)) => {
                let (distance, weight) = (key.distance.unwrap_or(1.0), key.weight.unwrap_or(1.0));
                add(format!("--avoid {}", quoted(&format!("{pose}~{distance}*{weight}"))));
            }
            (KeyKind::Never, _, Some(pose)) => {
                add(format!("--never {}", quoted(&format!("{pose}~{}", key.radius.unwrap_or(0.25)))));
            }
            (KeyKind::Fixed, _, _) => {
                if let Some(part) = &key.fixed {
                    let from = path(&part.clip).unwrap_or_default();
                    add(format!("--fix {}s..{}s --fix-from {from}", part.from, part.to));
                }
            }
            _ => {}
        }
    }
    line.push_str(" -o new.bvh");
    Ok((line, files))
}

/// For a shell: in quotes where anything in it means something there.
fn quoted(text: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./:=,@%+".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text.into()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}
