//! What helps to understand a result and to change it: frames as the files have them, candidates, the map.

use crate::preview::{Guide, Part, Spot};
use inkrig_align::{
    AlignError, Alignment, Candidate, Explanation, Moment, Moments, MotionMap, Options, candidates,
};
use inkrig_motion::Takes;
use serde::Serialize;
use std::path::PathBuf;

/// How many poses are suggested where nothing was said.
pub(crate) const CANDIDATES: usize = 8;

/// What is asked for keyframes of a source.
#[derive(Debug)]
pub(crate) struct Suggestions {
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) map: MotionMap,
}

/// Where what is arranged begins in its files.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    /// The number of the first frame, as `--key` counts it: of a single clip in its file, of several through what is
    /// left of all of them.
    pub(crate) first_frame: usize,
    /// Seconds of every file before what is used of it.
    starts: Vec<f64>,
}

impl Origin {
    /// `parts` has path, frames a second and first frame that is used of every clip.
    pub(crate) fn of(parts: &[(PathBuf, f64, usize)]) -> Self {
        let first_frame = if let [(_, _, start)] = parts { *start } else { 0 };
        Self { first_frame, starts: parts.iter().map(|(_, rate, start)| *start as f64 / rate).collect() }
    }

    /// Seconds of the file of a moment.
    fn seconds(&self, moment: Moment) -> f64 {
        moment.seconds + self.starts.get(moment.take).copied().unwrap_or(0.0)
    }
}

impl Suggestions {
    /// Of a source. The map and what is on it are the same whatever else is asked for, so that a drawing over it means
    /// the same moments: features and patches are the default ones.
    pub(crate) fn of(source: &Takes, threads: usize, count: usize) -> Result<Self, AlignError> {
        let moments = Moments::of(source, &Options { threads, ..Options::default() })?;
        Ok(Self { candidates: candidates(&moments, count)?, map: MotionMap::of(&moments)? })
    }

    /// The place of a candidate on the map.
    pub(crate) fn place(&self, candidate: &Candidate) -> [f64; 2] {
        self.map.place_of(candidate.moment.frame).unwrap_or_default()
    }

    /// The candidates as data.
    pub(crate) fn facts(&self, origin: &Origin) -> Vec<CandidateFacts> {
        let facts = |candidate: &Candidate| {
            let [x, y] = self.place(candidate);
            let Moment { frame, take, .. } = candidate.moment;
            CandidateFacts {
                frame: frame + origin.first_frame,
                clip: take,
                seconds: round(origin.seconds(candidate.moment), 4),
                share: round(candidate.share, 4),
                radius: round(candidate.radius, 4),
                x: round(x, 4),
                y: round(y, 4),
            }
        };
        self.candidates.iter().map(facts).collect()
    }
}

/// A pose worth a keyframe; the names are stable.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CandidateFacts {
    /// Frame as `--key` takes it.
    pub(crate) frame: usize,
    /// Clip, from 0 in the order given.
    pub(crate) clip: usize,
    /// Seconds of that clip's file.
    pub(crate) seconds: f64,
    /// Share of the source that it stands for, 0..=1.
    pub(crate) share: f64,
    /// How far the farthest of that share is, in mean distances.
    pub(crate) radius: f64,
    /// Its place on the map.
    pub(crate) x: f64,
    pub(crate) y: f64,
}

/// What the page tells of a result. Frames are counted from `first_frame`; `names` are those of the clips.
pub(crate) fn guide(
    alignment: &Alignment,
    suggestions: &Suggestions,
    options: &Options,
    names: &[String],
    first_frame: usize,
) -> Guide {
    let clock = PageClock::of(alignment);
    let spot = |moment: Moment, place| Spot {
        frame: moment.frame + first_frame,
        seconds: clock.seconds(moment),
        place,
    };
    let explanation = Explanation::of(alignment, options);
    let starts = alignment.source.ranges().map(|range| range.start as f64 / clock.rate);
    let candidates = suggestions.candidates.iter();
    Guide {
        rate: explanation.rate,
        frames: explanation.frame.iter().map(|frame| frame + first_frame).collect(),
        clips: (starts.zip(names)).map(|(seconds, name)| Part { name: name.clone(), seconds }).collect(),
        map: suggestions.map.frames.iter().map(|at| spot(at.moment, at.place)).collect(),
        stress: suggestions.map.stress,
        candidates: candidates.map(|c| (spot(c.moment, suggestions.place(c)), c.share)).collect(),
    }
}

/// Brings moments of the source as it was given to seconds of the one that is shown, which has no lead-ins.
struct PageClock {
    /// Frames left out up to and with each take.
    left_out: Vec<usize>,
    rate: f64,
}

impl PageClock {
    fn of(alignment: &Alignment) -> Self {
        let sums = alignment.lead_ins.iter().scan(0, |sum, &frames| {
            *sum += frames;
            Some(*sum)
        });
        Self { left_out: sums.collect(), rate: alignment.source.clip().frame_rate() }
    }

    fn seconds(&self, moment: Moment) -> f64 {
        let left_out = self.left_out.get(moment.take).copied().unwrap_or(0);
        moment.frame.saturating_sub(left_out) as f64 / self.rate
    }
}

pub(crate) fn round(value: f64, places: i32) -> f64 {
    let scale = 10_f64.powi(places);
    (value * scale).round() / scale
}
