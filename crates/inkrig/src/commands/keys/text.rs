//! Keys as they are typed.

use super::{At, DISTANCE, Named, RADIUS, WEIGHT, Wish};
use inkrig_align::Place;
use std::path::PathBuf;

pub(super) const KEYS: &str = "PLACE=POSE is exact, PLACE~POSE soft (*0.5 behind it is its weight); a place is 0.5s, \
    frame:45 or sound:1.5s, for soft keys also 0.3,-1 or label:walk; a pose is frame:120 or other.bvh:120; such as \
    0.5s=frame:120";
pub(super) const AVOIDS: &str =
    "frame:120 or other.bvh:120; ~0.5 behind it is the distance to keep, *0.5 the weight";
pub(super) const NEVERS: &str = "frame:120 or other.bvh:120, or frame:120~0.5 for a radius of 0.5";

/// `PLACE=POSE` or `PLACE~POSE*WEIGHT`.
pub(super) fn key(text: &str) -> Option<Wish> {
    let split = text.find(['=', '~'])?;
    let (place, rest) = (text.get(..split)?, text.get(split + 1..)?);
    let at = at(place)?;
    if text.get(split..=split) == Some("=") {
        let timed = matches!(at, At::Place(Place::Time(_) | Place::Row(_)) | At::Sound(_));
        return timed.then_some(Wish::Hard { at, pose: pose(rest)? });
    }
    let (rest, weight) = weight(rest)?;
    Some(Wish::Soft { at, pose: pose(rest)?, weight })
}

/// `POSE~DISTANCE*WEIGHT`.
pub(super) fn avoid(text: &str) -> Option<Wish> {
    let (rest, weight) = weight(text)?;
    let (pose, distance) = with_number(rest, '~', DISTANCE)?;
    Some(Wish::Avoid { pose: self::pose(pose)?, distance, weight })
}

/// `POSE~RADIUS`.
pub(super) fn never(text: &str) -> Option<Wish> {
    let (pose, radius) = with_number(text, '~', RADIUS)?;
    Some(Wish::Never { pose: self::pose(pose)?, radius })
}

/// `frame:120`, `other.bvh:120` or `other.bvh#120`.
pub(super) fn pose(text: &str) -> Option<Named> {
    let (file, frame) = text.trim().rsplit_once([':', '#'])?;
    let frame = frame.trim().parse().ok()?;
    let file = file.trim();
    let file = (file != "frame").then(|| PathBuf::from(file));
    // Without an ending it is no file, but a slip.
    let known = file.as_ref().is_none_or(|file| file.extension().is_some());
    known.then_some(Named { file, frame })
}

fn at(text: &str) -> Option<At> {
    let text = text.trim();
    if let Some(row) = text.strip_prefix("frame:") {
        return Some(At::Place(Place::Row(row.trim().parse().ok()?)));
    }
    if let Some(time) = text.strip_prefix("sound:") {
        return Some(At::Sound(number(time.trim().strip_suffix('s')?)?));
    }
    if let Some(label) = text.strip_prefix("label:") {
        return Some(At::Place(Place::Label(label.to_string())));
    }
    if let Some(seconds) = text.strip_suffix('s').and_then(number) {
        return Some(At::Place(Place::Time(seconds)));
    }
    text.split(',').map(number).collect::<Option<_>>().map(|values| At::Place(Place::Value(values)))
}

fn weight(text: &str) -> Option<(&str, f64)> {
    with_number(text, '*', WEIGHT)
}

/// What stands before a sign and the number behind it.
fn with_number(text: &str, sign: char, usual: f64) -> Option<(&str, f64)> {
    match text.rsplit_once(sign) {
        Some((rest, value)) => Some((rest, number(value)?)),
        None => Some((text, usual)),
    }
}

pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(frame: usize) -> Named {
        Named { file: None, frame }
    }

    #[test]
    fn keys_are_read() {
        let time = |seconds| At::Place(Place::Time(seconds));
        assert_eq!(key("0.5s=frame:120"), Some(Wish::Hard { at: time(0.5), pose: of(120) }));
        let at = At::Place(Place::Value(vec![0.3, -1.0]));
        assert_eq!(key("0.3,-1~frame:7*0.5"), Some(Wish::Soft { at, pose: of(7), weight: 0.5 }));
        assert_eq!(key("2s ~ frame:7"), Some(Wish::Soft { at: time(2.0), pose: of(7), weight: WEIGHT }));
        let pose = Named { file: Some("a b/c.bvh".into()), frame: 3 };
        let at = At::Place(Place::Label("wave left".to_string()));
        assert_eq!(
            key("label:wave left~a b/c.bvh:3"),
            Some(Wish::Soft { at, pose: pose.clone(), weight: WEIGHT })
        );
        let at = At::Place(Place::Row(45));
        assert_eq!(key("frame:45~a b/c.bvh#3"), Some(Wish::Soft { at, pose: pose.clone(), weight: WEIGHT }));
        assert_eq!(key("sound:1.5s=frame:1"), Some(Wish::Hard { at: At::Sound(1.5), pose: of(1) }));
        assert_eq!(never("frame:9~0.1"), Some(Wish::Never { pose: of(9), radius: 0.1 }));
        assert_eq!(avoid("frame:9~0.1*2"), Some(Wish::Avoid { pose: of(9), distance: 0.1, weight: 2.0 }));
        assert_eq!(avoid("a b/c.bvh:3"), Some(Wish::Avoid { pose, distance: DISTANCE, weight: WEIGHT }));
        let bad = "|0.5=frame:1|0.5s=1|a,b~frame:1|0.5s=frame:-1|nans=frame:1|1s~frame:2*x|1,2=frame:3|label:a=frame:3";
        for bad in bad.split('|') {
            assert_eq!(key(bad), None, "{bad}");
        }
        assert_eq!((never("9"), never("walk:9"), avoid("frame:9~x")), (None, None, None));
    }
}
