//! Keyframes, from the command line and from files.

use crate::cli::AlignArgs;
use crate::error::CliError;
use crate::load;
use inkrig_align::{Key, Place};
use serde::Deserialize;

/// How near counts as the same moment where nothing was said, in mean distances of the clip's moments.
const RADIUS: f64 = 0.3;
/// Weight of a soft key where nothing was said.
const WEIGHT: f64 = 1.0;

/// All keys that were given.
pub(super) fn all(args: &AlignArgs) -> Result<Vec<Key>, CliError> {
    let mut keys = Vec::new();
    for text in &args.keys {
        keys.push(key(text).ok_or_else(|| CliError::Key {
            text: text.clone(),
            known: "0.5s=frame:120 (exactly), 0.5s~frame:120 or 0.3,-1~frame:120 (softly; *0.5 behind it is its weight)",
        })?);
    }
    for text in &args.nevers {
        keys.push(never(text).ok_or_else(|| CliError::Key {
            text: text.clone(),
            known: "frame:120, or frame:120~0.5 for a radius of 0.5",
        })?);
    }
    if let Some(path) = &args.key_file {
        let bytes = load::drawing(path)?;
        let listed: Vec<Listed> = serde_json::from_slice(&bytes)
            .map_err(|cause| CliError::KeyFile { path: path.clone(), cause: cause.to_string() })?;
        keys.extend(listed.into_iter().map(Listed::key));
    }
    Ok(keys)
}

/// Frames are counted in the file; the engine counts from where `--range` begins. With several clips they are counted
/// through what is left of all of them.
pub(super) fn count_from_range(keys: &mut [Key], args: &AlignArgs, rate: f64) -> Result<(), CliError> {
    let start = first_frame(args, rate);
    for key in keys {
        let (Key::Soft { frame, .. } | Key::Hard { frame, .. } | Key::Never { frame, .. }) = key;
        *frame = frame.checked_sub(start).ok_or_else(|| CliError::Key {
            text: format!("frame:{frame}"),
            known: "it lies before --range begins",
        })?;
    }
    Ok(())
}

/// The number of the first frame that the engine sees, as keys call it.
pub(super) fn first_frame(args: &AlignArgs, rate: f64) -> usize {
    match args.range.and_then(|range| range.start) {
        Some(start) if args.clips.len() == 1 => start.frames(rate),
        _ => 0,
    }
}

fn key(text: &str) -> Option<Key> {
    if let Some((place, moment)) = text.split_once('=') {
        let Place::Time(seconds) = place_of(place)? else { return None };
        return Some(Key::Hard { seconds, frame: frame(moment)? });
    }
    let (place, rest) = text.split_once('~')?;
    let (moment, weight) = match rest.split_once('*') {
        Some((moment, weight)) => (moment, number(weight)?),
        None => (rest, WEIGHT),
    };
    Some(Key::Soft { place: place_of(place)?, frame: frame(moment)?, weight })
}

fn never(text: &str) -> Option<Key> {
    let (moment, radius) = match text.split_once('~') {
        Some((moment, radius)) => (moment, number(radius)?),
        None => (text, RADIUS),
    };
    Some(Key::Never { frame: frame(moment)?, radius })
}

fn place_of(text: &str) -> Option<Place> {
    match text.trim().strip_suffix('s') {
        Some(seconds) => Some(Place::Time(number(seconds)?)),
        None => text.split(',').map(number).collect::<Option<_>>().map(Place::Value),
    }
}

fn frame(text: &str) -> Option<usize> {
    text.trim().strip_prefix("frame:")?.trim().parse().ok()
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// A key in a file: `{"time": 0.5, "frame": 120}` holds exactly; with a `weight`, or `at` instead of `time`, softly;
/// `{"never": 120}` forbids.
#[derive(Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum Listed {
    Never { never: usize, radius: Option<f64> },
    At { at: Vec<f64>, frame: usize, weight: Option<f64> },
    Time { time: f64, frame: usize, weight: Option<f64> },
}

impl Listed {
    fn key(self) -> Key {
        match self {
            Self::Never { never, radius } => Key::Never { frame: never, radius: radius.unwrap_or(RADIUS) },
            Self::At { at, frame, weight } => {
                Key::Soft { place: Place::Value(at), frame, weight: weight.unwrap_or(WEIGHT) }
            }
            Self::Time { time, frame, weight: None } => Key::Hard { seconds: time, frame },
            Self::Time { time, frame, weight: Some(weight) } => {
                Key::Soft { place: Place::Time(time), frame, weight }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read() {
        assert_eq!(key("0.5s=frame:120"), Some(Key::Hard { seconds: 0.5, frame: 120 }));
        let place = Place::Value(vec![0.3, -1.0]);
        assert_eq!(key("0.3,-1~frame:7*0.5"), Some(Key::Soft { place, frame: 7, weight: 0.5 }));
        let place = Place::Time(2.0);
        assert_eq!(key("2s ~ frame:7"), Some(Key::Soft { place, frame: 7, weight: WEIGHT }));
        assert_eq!(never("frame:9~0.1"), Some(Key::Never { frame: 9, radius: 0.1 }));
        for bad in
            ["", "0.5=frame:1", "0.5s=1", "a,b~frame:1", "0.5s=frame:-1", "nans=frame:1", "1s~frame:2*x"]
        {
            assert_eq!(key(bad), None, "{bad}");
        }
        assert_eq!(never("9"), None);
    }

    #[test]
    fn key_files_are_read() {
        let text = r#"[{"time": 1, "frame": 2}, {"time": 1, "frame": 2, "weight": 0.5}, {"at": [1, 2], "frame": 3}, {"never": 4}]"#;
        let keys: Vec<Key> =
            serde_json::from_str::<Vec<Listed>>(text).unwrap().into_iter().map(Listed::key).collect();
        assert_eq!(keys[0], Key::Hard { seconds: 1.0, frame: 2 });
        assert_eq!(keys[3], Key::Never { frame: 4, radius: RADIUS });
        assert!(serde_json::from_str::<Vec<Listed>>(r#"[{"time": 1, "fram": 2}]"#).is_err());
    }
}
