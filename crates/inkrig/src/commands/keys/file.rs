//! Keys in a JSON file: see docs/keys.md.

use super::{At, DISTANCE, Named, RADIUS, WEIGHT, Wish, text};
use crate::error::CliError;
use crate::output::folder_of;
use crate::span::Span;
use inkrig_align::Place;
use serde::Deserialize;
use std::path::{Component, Path, PathBuf};

/// One key; which fields go together is said in [`Listed::wish`].
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct Listed {
    time: Option<f64>,
    control_frame: Option<usize>,
    sound: Option<f64>,
    label: Option<String>,
    at: Option<Vec<f64>>,
    frame: Option<usize>,
    pose: Option<String>,
    weight: Option<f64>,
    avoid: Option<FrameOrPose>,
    distance: Option<f64>,
    never: Option<FrameOrPose>,
    radius: Option<f64>,
    fix: Option<String>,
    from: Option<String>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum FrameOrPose {
    Frame(usize),
    Pose(String),
}

/// Reads a list of keys. Files that it names lie in its own folder or below.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Vec<Wish>, CliError> {
    let refuse = |cause: String| CliError::KeyFile { path: path.to_path_buf(), cause };
    let listed: Vec<Listed> = serde_json::from_slice(bytes).map_err(|cause| refuse(cause.to_string()))?;
    let folder = folder_of(path);
    let numbered = listed.into_iter().zip(1..);
    numbered
        .map(|(key, number)| key.wish(folder).map_err(|cause| refuse(format!("key {number}: {cause}"))))
        .collect()
}

impl Listed {
    fn wish(self, folder: &Path) -> Result<Wish, String> {
        let place = self.place()?;
        let named = |pose: FrameOrPose| named(pose, folder);
        let pose = match (self.frame, self.pose) {
            (Some(_), Some(_)) => {
                return Err("`frame` and `pose` are two poses: leave one of them out".into());
            }
            (Some(frame), None) => Some(FrameOrPose::Frame(frame)),
            (None, pose) => pose.map(FrameOrPose::Pose),
        };
        let kinds = [
            place.is_some() || pose.is_some(),
            self.avoid.is_some(),
            self.never.is_some(),
            self.fix.is_some(),
        ];
        if kinds.iter().filter(|kind| **kind).count() != 1 {
            return Err("give one of: a place with a pose, `avoid`, `never`, `fix`".into());
        }
        if let Some(avoid) = self.avoid {
            let (distance, weight) = (self.distance.unwrap_or(DISTANCE), self.weight.unwrap_or(WEIGHT));
            return Ok(Wish::Avoid { pose: named(avoid)?, distance, weight });
        }
        if let Some(never) = self.never {
            return Ok(Wish::Never { pose: named(never)?, radius: self.radius.unwrap_or(RADIUS) });
        }
        if let Some(span) = self.fix {
            let span: Span = span.parse().map_err(|error: crate::span::SpanError| error.to_string())?;
            let from = self.from.ok_or("`fix` needs `from`, the earlier result")?;
            return Ok(Wish::Fix { span, from: inside(folder, &from)? });
        }
        let (Some(at), Some(pose)) = (place, pose) else {
            return Err("a place needs a pose (`frame` or `pose`), and a pose a place".into());
        };
        let timed = !matches!(at, At::Place(Place::Value(_) | Place::Label(_)));
        Ok(match self.weight {
            None if timed => Wish::Hard { at, pose: named(pose)? },
            weight => Wish::Soft { at, pose: named(pose)?, weight: weight.unwrap_or(WEIGHT) },
        })
    }

    fn place(&self) -> Result<Option<At>, String> {
        let mut places = [
            self.time.map(|time| At::Place(Place::Time(time))),
            self.control_frame.map(|row| At::Place(Place::Row(row))),
            self.sound.map(At::Sound),
            self.label.clone().map(|label| At::Place(Place::Label(label))),
            self.at.clone().map(|at| At::Place(Place::Value(at))),
        ]
        .into_iter()
        .flatten();
        match (places.next(), places.next()) {
            (place, None) => Ok(place),
            _ => {
                Err("`time`, `control_frame`, `sound`, `label` and `at` are places: give one of them".into())
            }
        }
    }
}

fn named(pose: FrameOrPose, folder: &Path) -> Result<Named, String> {
    let text = match pose {
        FrameOrPose::Frame(frame) => return Ok(Named { file: None, frame }),
        FrameOrPose::Pose(text) => text,
    };
    let named = text::pose(&text).ok_or_else(|| format!("`{text}` is no pose such as `other.bvh#120`"))?;
    let file = named.file.map(|file| inside(folder, &file.to_string_lossy())).transpose()?;
    Ok(Named { file, ..named })
}

/// A path that a file names: nothing outside of the file's folder is opened.
fn inside(folder: &Path, file: &str) -> Result<PathBuf, String> {
    let path = Path::new(file);
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !stays || file.is_empty() {
        return Err(format!(
            "`{file}` does not lie in the folder of this file: name one that does, or use the flags"
        ));
    }
    Ok(if folder == Path::new(".") { path.to_path_buf() } else { folder.join(path) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(text: &str) -> Result<Vec<Wish>, String> {
        read(text.as_bytes(), Path::new("some/keys.json")).map_err(|error| error.to_string())
    }

    #[test]
    fn key_files_are_read() {
        let text = r#"[{"time": 1, "frame": 2}, {"time": 1, "frame": 2, "weight": 0.5}, {"at": [1, 2], "frame": 3},
            {"never": 4}, {"avoid": "sub/a.bvh#5", "distance": 2}, {"label": "walk", "pose": "b.bvh#1"},
            {"sound": 1.5, "frame": 2}, {"control_frame": 7, "frame": 2, "weight": 1}, {"fix": "2s..4s", "from": "e.bvh"}]"#;
        let keys = keys(text).unwrap();
        let of = |frame| Named { file: None, frame };
        assert_eq!(keys[0], Wish::Hard { at: At::Place(Place::Time(1.0)), pose: of(2) });
        assert_eq!(keys[3], Wish::Never { pose: of(4), radius: RADIUS });
        let pose = Named { file: Some("some/sub/a.bvh".into()), frame: 5 };
        assert_eq!(keys[4], Wish::Avoid { pose, distance: 2.0, weight: WEIGHT });
        assert!(matches!(&keys[5], Wish::Soft { at: At::Place(Place::Label(label)), .. } if label == "walk"));
        assert_eq!(keys[6], Wish::Hard { at: At::Sound(1.5), pose: of(2) });
        assert!(matches!(&keys[8], Wish::Fix { from, .. } if from == Path::new("some/e.bvh")));
        assert_eq!(keys.len(), 9);
    }

    #[test]
    fn mistakes_say_which_key_and_what_is_wrong() {
        for (text, says) in [
            (r#"[{"time": 1, "fram": 2}]"#, "fram"),
            (r#"[{"never": 1}, {"time": 1}]"#, "key 2: a place needs a pose"),
            (r#"[{"time": 1, "at": [1], "frame": 2}]"#, "give one of them"),
            (r#"[{"time": 1, "frame": 2, "never": 3}]"#, "give one of: a place with a pose"),
            (r#"[{"fix": "2s..4s"}]"#, "`fix` needs `from`"),
            (r#"[{"fix": "2", "from": "a.bvh"}]"#, "2s..10s"),
            (r#"[{"never": "../a.bvh#1"}]"#, "does not lie in the folder"),
            (r#"[{"never": "/etc/a.bvh#1"}]"#, "does not lie in the folder"),
            (r#"[{"never": "a.bvh"}]"#, "is no pose"),
        ] {
            let said = keys(text).unwrap_err();
            assert!(said.contains(says), "{text}: {said}");
        }
    }
}
