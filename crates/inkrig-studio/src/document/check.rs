//! Limits of a document, and that it refers only to what is there.

use super::{Control, Document, GroundPath, Key, Place};
use crate::StudioError;

/// Most pen points of a control.
pub const MOST_POINTS: usize = 100_000;
const MOST_CLIPS: usize = 100;
const MOST_KEYS: usize = 500;
const MOST_TEXT: usize = 1000;
const MOST_PAGE_BYTES: usize = 256 << 10;
const MOST_MAGNITUDE: f64 = 1e6;
const MOST_REPEATS: usize = 1000;
const MOST_SOLUTIONS: usize = 8;

/// Whether a text can be an id: it becomes part of names of files.
pub fn is_id(text: &str) -> bool {
    (1..=64).contains(&text.len())
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_')
}

/// # Errors
/// Says what is too much, or refers to nothing.
pub(super) fn document(document: &Document) -> Result<(), StudioError> {
    let most = |what: &'static str, count: usize, most: usize| {
        if count > most { Err(StudioError::TooMuch { what, count, most }) } else { Ok(()) }
    };
    most("clips", document.clips.len(), MOST_CLIPS)?;
    most("sounds", document.sounds.len(), MOST_CLIPS)?;
    most("keys", document.keys.len(), MOST_KEYS)?;
    most("letters of a name", document.name.len(), MOST_TEXT)?;
    let names =
        document.clips.iter().map(|clip| &clip.name).chain(document.sounds.iter().map(|sound| &sound.name));
    for name in names {
        most("letters of a name", name.len(), MOST_TEXT)?;
    }
    if !document.page.is_object() {
        return Err(StudioError::Invalid { what: "the page's own part is no object".into() });
    }
    most("bytes of the page's own part", document.page.to_string().len(), MOST_PAGE_BYTES)?;
    for id in &document.source.clips {
        document.clip(id).ok_or_else(|| StudioError::unknown("clip", id))?;
    }
    if let Some([from, to]) = document.source.range
        && !(number(from) && number(to) && from < to && from >= 0.0)
    {
        return Err(StudioError::Invalid { what: format!("a range from {from} s to {to} s holds nothing") });
    }
    most("laps", document.source.laps, MOST_REPEATS)?;
    if let Some(control) = &document.control {
        check_control(document, control)?;
    }
    for key in &document.keys {
        check_key(document, key)?;
    }
    let settings = &document.settings;
    most("repeats", settings.repeat, MOST_REPEATS)?;
    most("solutions", settings.solution + 1, MOST_SOLUTIONS)?;
    if settings.repeat == 0 || document.source.laps == 0 {
        return Err(StudioError::Invalid { what: "nothing is repeated 0 times: give 1 or more".into() });
    }
    if let Some(GroundPath::Drawn { points, .. }) = &settings.path {
        most("points of a path", points.len(), MOST_POINTS)?;
    }
    Ok(())
}

fn check_control(document: &Document, control: &Control) -> Result<(), StudioError> {
    let (count, most) = (control.point_count(), MOST_POINTS);
    if count > most {
        return Err(StudioError::TooMuch { what: "points of a drawing", count, most });
    }
    match control {
        Control::Curve { strokes, .. } => {
            let good = |&(x, y, t, p): &(f64, f64, Option<f64>, Option<f64>)| {
                number(x) && number(y) && t.is_none_or(number) && p.is_none_or(|p| (0.0..=100.0).contains(&p))
            };
            if !strokes.iter().flatten().all(good) {
                return Err(StudioError::Invalid {
                    what: "a point of the drawing is beyond a million units".into(),
                });
            }
        }
        Control::DrawnWave { points } => {
            if !points.iter().all(|[t, v]| number(*t) && number(*v))
                || points.windows(2).any(|pair| pair[1][0] < pair[0][0])
            {
                return Err(StudioError::Invalid { what: "times of a wave must rise".into() });
            }
        }
        Control::Labels { segments } => {
            if !segments.iter().all(|segment| number(segment.seconds) && segment.seconds > 0.0) {
                return Err(StudioError::Invalid {
                    what: "a label without length: give each some time".into(),
                });
            }
        }
        Control::Wave { expression } => {
            let (count, most) = (expression.len(), 10_000);
            if count > most {
                return Err(StudioError::TooMuch { what: "letters of an expression", count, most });
            }
        }
        Control::Sound { sound, .. } => {
            document.sound(sound).ok_or_else(|| StudioError::unknown("sound", sound))?;
        }
        Control::Motion { clip } => {
            document.clip(clip).ok_or_else(|| StudioError::unknown("clip", clip))?;
        }
    }
    Ok(())
}

fn check_key(document: &Document, key: &Key) -> Result<(), StudioError> {
    if !is_id(&key.id) {
        let what = "a key's id has to be 1 to 64 letters, digits, - and _".to_string();
        return Err(StudioError::Invalid { what });
    }
    if document.keys.iter().filter(|other| other.id == key.id).count() > 1 {
        return Err(StudioError::Invalid { what: format!("two keys are called {}", key.id) });
    }
    let clips = key.pose.iter().map(|pose| &pose.clip).chain(key.fixed.iter().map(|fixed| &fixed.clip));
    for id in clips {
        document.clip(id).ok_or_else(|| StudioError::unknown("clip", id))?;
    }
    let place = match &key.place {
        Some(Place::Time { seconds }) => number(*seconds),
        Some(Place::Point { point: [x, y] }) => number(*x) && number(*y),
        Some(Place::Value { value }) => number(*value),
        Some(Place::Label { label }) => label.len() <= MOST_TEXT,
        None => true,
    };
    let fixed =
        key.fixed.as_ref().is_none_or(|part| number(part.from) && number(part.to) && part.from < part.to);
    if place && fixed {
        Ok(())
    } else {
        Err(StudioError::Invalid { what: format!("the place of key {} is none", key.id) })
    }
}

fn number(value: f64) -> bool {
    value.is_finite() && value.abs() <= MOST_MAGNITUDE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Command;

    #[test]
    fn ids_are_no_paths() {
        assert!(is_id("k-1_B"));
        for bad in ["", "..", "a/b", "a\\b", "ü", &"x".repeat(65)] {
            assert!(!is_id(bad), "{bad}");
        }
    }

    #[test]
    fn too_much_is_refused() {
        let strokes = vec![vec![(0.0, 0.0, None, None); MOST_POINTS + 1]];
        let control = Some(Control::Curve { strokes, timing: Default::default(), smooth: None });
        let error = Document::default().apply(Command::SetControl { control }).unwrap_err();
        assert!(error.to_string().contains("100001"), "{error}");
        let page = serde_json::json!({ "a": "x".repeat(300 << 10) });
        assert!(Document::default().apply(Command::SetPage { page }).is_err());
        let far = Some(Control::DrawnWave { points: vec![[0.0, 0.0], [1.0, 1e9]] });
        assert!(Document::default().apply(Command::SetControl { control: far }).is_err());
    }
}
