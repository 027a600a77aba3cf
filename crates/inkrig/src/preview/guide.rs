//! What the page says of why: which frames are used, which poses may be asked for, and where they are on a map.

use super::encode::{decimals, shorten};
use serde::Serialize;

/// What helps to understand a result and to change it. Frames are numbered as keyframes call them; seconds are those of
/// the preview's source clip.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Guide {
    /// Samples a second of `frames`, and of the preview's `best_source` and `confidence`.
    pub rate: f64,
    /// For every sample the frame of the source that it uses most.
    pub frames: Vec<usize>,
    /// The clips of the source, in order.
    pub clips: Vec<Part>,
    /// Every moment of the source on a plane where what is alike is near; in order of time.
    pub map: Vec<Spot>,
    /// How much of the distances the plane does not show, 0 is all.
    pub stress: f64,
    /// Poses worth a keyframe, the most telling first, each with the share of the source that it stands for, 0..=1.
    pub candidates: Vec<(Spot, f64)>,
}

/// One of the clips of a source.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// What it is called; any text.
    pub name: String,
    /// Where it begins, seconds.
    pub seconds: f64,
}

/// A moment of the source and its place on the map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spot {
    /// Its frame.
    pub frame: usize,
    /// Its time, seconds.
    pub seconds: f64,
    /// Where on the map, x to the right, y up.
    pub place: [f64; 2],
}

/// The most moments of the map that are sent.
const MOST_SPOTS: usize = 4000;
/// The most clips and candidates that are sent.
const MOST_LINES: usize = 64;

#[derive(Debug, Serialize)]
pub(super) struct GuideData {
    frames: Vec<usize>,
    clips: Vec<(String, f64)>,
    map: Vec<SpotData>,
    stress: f64,
    candidates: Vec<(SpotData, f64)>,
}

/// Frame, seconds, x, y.
type SpotData = (usize, f64, f64, f64);

impl GuideData {
    /// Every `step`th frame used, and everything else cut to a size that a page shows well.
    pub(super) fn of(guide: &Guide, step: usize) -> Self {
        let stride = guide.map.len().div_ceil(MOST_SPOTS).max(1);
        let clips = guide.clips.iter().take(MOST_LINES);
        let candidates = guide.candidates.iter().take(MOST_LINES);
        Self {
            frames: guide.frames.iter().step_by(step).copied().collect(),
            clips: clips.map(|part| (shorten(&part.name, 64), decimals(part.seconds, 4))).collect(),
            map: guide.map.iter().step_by(stride).map(spot).collect(),
            stress: decimals(guide.stress, 3),
            candidates: candidates.map(|(at, share)| (spot(at), decimals(*share, 4))).collect(),
        }
    }
}

fn spot(spot: &Spot) -> SpotData {
    (spot.frame, decimals(spot.seconds, 4), decimals(spot.place[0], 4), decimals(spot.place[1], 4))
}
