//! Frames as the page counts them, clip by clip, and as the engine does, through all that is arranged.

use inkrig_motion::{Clip, Takes};
use std::ops::Range;

/// Which frames of the project's clips the arranged takes are made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SourceMap {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq)]
struct Part {
    clip: String,
    /// Frames of the whole clip.
    frames: usize,
    /// Its first frame that is used.
    start: usize,
    /// How many of its frames are used.
    used: usize,
    /// Its frames to one of the takes.
    step: f64,
    /// Frames of one lap, in frames of the clip.
    lap: usize,
    /// Where it begins in the takes, and how long it is there.
    at: usize,
    length: usize,
    /// Where it begins, all clips counted through.
    base: usize,
}

impl SourceMap {
    /// `clips` has id, the whole clip, its frames that are used, and the length of one lap of these.
    pub(super) fn new(clips: &[(String, Clip, Range<usize>, usize)], takes: &Takes) -> Self {
        let rate = takes.clip().frame_rate();
        let mut base = 0;
        let parts = clips.iter().zip(takes.ranges()).map(|((id, clip, used, lap), range)| {
            let part = Part {
                clip: id.clone(),
                frames: clip.frames(),
                start: used.start,
                used: used.len(),
                step: clip.frame_rate() / rate,
                lap: (*lap).max(1),
                at: range.start,
                length: range.len(),
                base,
            };
            base += clip.frames();
            part
        });
        Self { parts: parts.collect() }
    }

    /// The clip and its frame that a frame of the takes is; `None` beyond them.
    pub fn to_clip(&self, frame: usize) -> Option<(&str, usize)> {
        let part = self.parts.iter().rev().find(|part| part.at <= frame)?;
        let within = ((frame - part.at) as f64 * part.step).round() as usize % part.lap;
        Some((&part.clip, (part.start + within).min(part.frames.saturating_sub(1))))
    }

    /// The frame of the takes that is a frame of a clip; `None` where it is not arranged.
    pub fn to_takes(&self, clip: &str, frame: usize) -> Option<usize> {
        self.parts.iter().filter(|part| part.clip == clip).find_map(|part| {
            let within = frame.checked_sub(part.start)?;
            // Of a clip that was brought to a lower rate the last frames lie beyond the last one that was kept.
            let last = part.length.checked_sub(1)?;
            let place = (within as f64 / part.step).round() as usize;
            (within < part.used).then_some(part.at + place.min(last))
        })
    }

    /// Frames of all clips, whole ones.
    pub fn frames(&self) -> usize {
        self.parts.last().map_or(0, |part| part.base + part.frames)
    }

    /// The frame counted through all clips, whole ones.
    pub fn counted_through(&self, frame: usize) -> Option<usize> {
        let (clip, within) = self.to_clip(frame)?;
        let part = self.parts.iter().find(|part| part.clip == clip)?;
        Some(part.base + within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::glam::{Quat, Vec3};
    use inkrig_motion::{Joint, Skeleton, time};
    use std::sync::Arc;

    #[test]
    fn frames_go_there_and_back() {
        let skeleton = Arc::new(Skeleton::new(vec![Joint::new("root", None, Vec3::ZERO)]).unwrap());
        let clip = |frames: usize, rate| {
            Clip::new(skeleton.clone(), rate, vec![Quat::IDENTITY; frames], vec![]).unwrap()
        };
        let (a, b) = (clip(100, 30.0), clip(120, 60.0));
        let used = time::trim(&a, 20..80).unwrap();
        let takes = Takes::join(&[used, b.clone()]).unwrap();
        let map = SourceMap::new(&[("a".into(), a, 20..80, 60), ("b".into(), b, 0..120, 120)], &takes);
        assert_eq!(map.to_clip(0), Some(("a", 20)));
        assert_eq!(map.to_clip(59), Some(("a", 79)));
        assert_eq!(map.to_clip(60), Some(("b", 0)));
        assert_eq!(map.to_clip(90), Some(("b", 60)));
        assert_eq!(map.counted_through(90), Some(160));
        assert_eq!(map.to_takes("a", 25), Some(5));
        assert_eq!(map.to_takes("a", 10), None);
        assert_eq!(map.to_takes("a", 85), None);
        assert_eq!(map.to_takes("b", 60), Some(90));
        // Every frame that is arranged is found, the last ones too, which fell between two that were kept.
        assert!((0..120).all(|frame| map.to_takes("b", frame).is_some()));
        assert_eq!((map.to_takes("b", 119), map.to_takes("b", 120)), (Some(119), None));
        assert_eq!(map.to_takes("c", 0), None);
        assert_eq!(map.frames(), 220);
    }
}
