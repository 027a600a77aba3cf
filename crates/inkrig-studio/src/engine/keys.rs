//! The keys of a document as the engine takes them. One that cannot count as things are waits and says why, and the rest is
//! solved without it: a line that grows under the pen, or another control, must not leave nothing to see.

use super::media::Media;
use super::{Prepared, clip};
use crate::StudioError;
use crate::document::{Control as Drawn, Document, FixedPart, Key as Drafted, KeyKind, Place as At, PoseRef};
use crate::project::Folder;
use inkrig_align::{Key, Place, Pose};
use inkrig_motion::Skeleton;
use std::sync::Arc;

/// Keys that count, and keys that wait.
#[derive(Debug, Default)]
pub(super) struct WishedKeys {
    pub(super) keys: Vec<Key>,
    /// Their ids.
    pub(super) counting: Vec<String>,
    pub(super) waiting: Vec<Waiting>,
}

/// A key that cannot count as things are.
#[derive(Debug, Clone, PartialEq)]
pub struct Waiting {
    /// The key.
    pub id: String,
    /// Its kind, as the engine's report has it.
    pub kind: &'static str,
    /// Where it stands.
    pub seconds: f64,
    /// Why it waits.
    pub why: String,
}

/// A key, or why it waits.
type Wish = Result<Key, String>;

/// The keys in use, for a result of `seconds`.
///
/// # Errors
/// When a key lacks what its kind needs, or a clip cannot be read.
pub(super) fn wished_keys(
    document: &Document,
    control: &Drawn,
    seconds: f64,
    source: &Prepared,
    files: (&Folder, &Media),
) -> Result<WishedKeys, StudioError> {
    let context = Context { document, control, seconds, source, files };
    let mut wished = WishedKeys::default();
    let mut exact: Vec<(usize, usize)> = Vec::new();
    let mut kept: Vec<&FixedPart> = Vec::new();
    for key in document.keys.iter().filter(|key| key.enabled) {
        let wish = context.wish(key)?.and_then(|wish| match (&wish, &key.fixed) {
            (Key::Hard { seconds, frame }, _) => {
                let at = (seconds * source.takes.clip().frame_rate()).round() as usize;
                if exact.iter().any(|&(other, pose)| other == at && pose != *frame) {
                    return Err(format!("another exact key stands at {seconds:.2} s"));
                }
                exact.push((at, *frame));
                Ok(wish)
            }
            (Key::Fixed { .. }, Some(part)) => {
                if let Some(other) = kept.iter().find(|other| part.from < other.to && other.from < part.to) {
                    return Err(format!("another part that stays, {}, overlaps it", span(other)));
                }
                kept.push(part);
                Ok(wish)
            }
            _ => Ok(wish),
        });
        match wish {
            Ok(wish) => {
                wished.keys.push(wish);
                wished.counting.push(key.id.clone());
            }
            Err(why) => wished.waiting.push(Waiting {
                id: key.id.clone(),
                kind: name(key.kind),
                seconds: match &key.place {
                    Some(At::Time { seconds }) => *seconds,
                    _ => key.fixed.as_ref().map_or(0.0, |part| part.from),
                },
                why,
            }),
        }
    }
    Ok(wished)
}

struct Context<'a> {
    document: &'a Document,
    control: &'a Drawn,
    /// Length of the result.
    seconds: f64,
    source: &'a Prepared,
    files: (&'a Folder, &'a Media),
}

impl Context<'_> {
    fn wish(&self, key: &Drafted) -> Result<Wish, StudioError> {
        let lacks = |what: &str| StudioError::invalid(format!("key {} has no {what}", key.id));
        if key.kind == KeyKind::Fixed {
            return self.fixed(key.fixed.as_ref().ok_or_else(|| lacks("part that stays"))?);
        }
        let pose = match self.pose(key.pose.as_ref().ok_or_else(|| lacks("pose"))?)? {
            Ok(pose) => pose,
            Err(why) => return Ok(Err(why)),
        };
        Ok(match key.kind {
            KeyKind::Avoid => Ok(Key::Avoid {
                pose,
                distance: key.distance.unwrap_or(1.0),
                weight: key.weight.unwrap_or(1.0),
            }),
            KeyKind::Never => Ok(Key::Never { pose, radius: key.radius.unwrap_or(0.25) }),
            KeyKind::Hard => {
                let Some(At::Time { seconds }) = key.place else {
                    return Err(StudioError::invalid(format!("key {} is exact and needs a time", key.id)));
                };
                self.hard(seconds, &pose)
            }
            KeyKind::Soft | KeyKind::Fixed => {
                let place = key.place.as_ref().ok_or_else(|| lacks("place"))?;
                self.place(place).map(|place| Key::Soft { place, pose, weight: key.weight.unwrap_or(0.5) })
            }
        })
    }

    fn hard(&self, seconds: f64, pose: &Pose) -> Wish {
        self.within(seconds)?;
        let half_a_frame = 0.5 / self.source.takes.clip().frame_rate();
        let parts = self.document.keys.iter().filter(|key| key.enabled && key.kind == KeyKind::Fixed);
        let holds =
            |part: &&FixedPart| seconds > part.from - half_a_frame && seconds < part.to + half_a_frame;
        if let Some(part) = parts.filter_map(|key| key.fixed.as_ref()).find(holds) {
            return Err(format!("the part {} that stays as it is has another pose there", span(part)));
        }
        match pose {
            Pose::Frame(frame) => Ok(Key::Hard { seconds, frame: *frame }),
            Pose::Of { .. } => Err("its pose is not of a part of a clip that is arranged".into()),
        }
    }

    fn fixed(&self, part: &FixedPart) -> Result<Wish, StudioError> {
        let (folder, media) = self.files;
        let earlier = clip(self.document, folder, media, &part.clip)?;
        let rate = earlier.clip.frame_rate();
        let frame = |seconds: f64| (seconds * rate).round().max(0.0) as usize;
        let frames = frame(part.from)..(frame(part.to) + 1).min(earlier.clip.frames());
        if !same_joints(earlier.clip.skeleton(), self.source.takes.clip().skeleton()) {
            return Ok(Err("it is of another character".into()));
        }
        if (frames.end as f64 - 1.0) / rate > self.seconds {
            return Ok(Err(format!("the motion ends at {:.2} s", self.seconds)));
        }
        Ok(Ok(Key::Fixed { earlier: Arc::new(earlier.clip.clone()), frames }))
    }

    fn pose(&self, at: &PoseRef) -> Result<Result<Pose, String>, StudioError> {
        if let Some(frame) = self.source.map.to_takes(&at.clip, at.frame) {
            return Ok(Ok(Pose::Frame(frame)));
        }
        let (folder, media) = self.files;
        let import = clip(self.document, folder, media, &at.clip)?;
        if !same_joints(import.clip.skeleton(), self.source.takes.clip().skeleton()) {
            return Ok(Err("its pose is of another character".into()));
        }
        if at.frame >= import.clip.frames() {
            return Ok(Err(format!("its clip has {} frames", import.clip.frames())));
        }
        let name = self.document.clip(&at.clip).map(|clip| clip.name.clone()).unwrap_or_default();
        Ok(Ok(Pose::Of { name, clip: Arc::new(import.clip.clone()), frame: at.frame }))
    }

    fn place(&self, place: &At) -> Result<Place, String> {
        let other = || Err("its place is of another kind of control".to_string());
        match (place, self.control) {
            (At::Time { seconds }, _) => self.within(*seconds).map(|()| Place::Time(*seconds)),
            (At::Point { point }, Drawn::Curve { .. }) => Ok(Place::Value(point.to_vec())),
            (At::Value { value }, Drawn::Wave { .. } | Drawn::DrawnWave { .. }) => {
                Ok(Place::Value(vec![*value]))
            }
            (At::Label { label }, Drawn::Labels { segments }) => {
                if segments.iter().any(|segment| segment.name == *label) {
                    Ok(Place::Label(label.clone()))
                } else {
                    Err(format!("there is no label `{label}`"))
                }
            }
            _ => other(),
        }
    }

    fn within(&self, seconds: f64) -> Result<(), String> {
        if (0.0..=self.seconds).contains(&seconds) {
            Ok(())
        } else {
            Err(format!("the motion ends at {:.2} s", self.seconds))
        }
    }
}

fn same_joints(a: &Skeleton, b: &Skeleton) -> bool {
    a.len() == b.len() && a.joints().iter().zip(b.joints()).all(|(a, b)| a.name == b.name)
}

fn span(part: &FixedPart) -> String {
    format!("from {:.2} s to {:.2} s", part.from, part.to)
}

fn name(kind: KeyKind) -> &'static str {
    match kind {
        KeyKind::Soft => "soft",
        KeyKind::Hard => "hard",
        KeyKind::Avoid => "avoid",
        KeyKind::Never => "never",
        KeyKind::Fixed => "fixed",
    }
}
