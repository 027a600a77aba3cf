//! What makes a clip unfit to learn from.

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, Joints, PARENTS};
use std::fmt;

/// Farther than this no pelvis gets in a twentieth of a second, metres: 16 m/s.
const JUMP: f32 = 0.8;
/// Bones that should keep their lengths: shins, feet's backs, lower arms and hands.
const BONES: [usize; 8] = [4, 5, 7, 8, 18, 19, 20, 21];
/// Most change of a bone's length, as standard deviation over mean.
const STRETCH: f32 = 0.15;
/// A clip in which every joint stays within this box holds a single pose, metres.
const STILL: f32 = 0.02;
/// The lowest point of the clip may lie so far below where the lowest joints usually are, metres.
const SINK: f32 = 0.35;

/// Why a clip was left out.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Rejected {
    /// The file could not be read.
    Unreadable(String),
    /// It has no human body.
    NoBody(String),
    /// So many frames at 20 a second are too few.
    Short {
        /// How many there are.
        frames: usize,
        /// How many there must be.
        least: usize,
    },
    /// The body leaps from one frame to the next.
    Jump {
        /// Metres.
        metres: f32,
        /// Second of the clip.
        seconds: f64,
    },
    /// Bones change their lengths.
    Stretch {
        /// The joint at the bone's end, by its number of the 22.
        joint: usize,
        /// Standard deviation over mean.
        share: f32,
    },
    /// Nothing moves.
    Still,
    /// Some frame lies far below all others.
    Sinks {
        /// How far, metres.
        metres: f32,
    },
    /// Its numbers cannot be computed.
    Broken(String),
    /// The index says so, by this word.
    SetAside(String),
}

impl fmt::Display for Rejected {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(why) => write!(out, "cannot be read: {why}"),
            Self::NoBody(why) => write!(out, "no human body: {why}"),
            Self::Short { frames, least } => {
                write!(out, "too short: {frames} frames at 20 a second, {least} are needed")
            }
            Self::Jump { metres, seconds } => {
                write!(out, "leaps {metres:.1} m within a frame at {seconds:.1} s")
            }
            Self::Stretch { joint, share } => {
                write!(out, "the bone to joint {joint} changes its length by {:.0} %", 100.0 * share)
            }
            Self::Still => write!(out, "a single pose: nothing moves"),
            Self::Sinks { metres } => write!(out, "some frame lies {metres:.2} m below the others"),
            Self::Broken(why) => write!(out, "its numbers cannot be computed: {why}"),
            Self::SetAside(word) => write!(out, "marked in the index: {word}"),
        }
    }
}

impl Rejected {
    /// The reason without its figures, to count by.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Unreadable(_) => "cannot be read",
            Self::NoBody(_) => "no human body",
            Self::Short { .. } => "too short",
            Self::Jump { .. } => "leaps",
            Self::Stretch { .. } => "bones change length",
            Self::Still => "a single pose",
            Self::Sinks { .. } => "sinks below its floor",
            Self::Broken(_) => "cannot be computed",
            Self::SetAside(_) => "marked in the index",
        }
    }
}

/// Looks at the joints of a clip at 20 frames a second, in metres.
pub(super) fn check(frames: &[Joints], least: usize) -> Result<(), Rejected> {
    if frames.len() < least {
        return Err(Rejected::Short { frames: frames.len(), least });
    }
    if let Some(frame) = frames.iter().position(|pose| !pose.iter().all(|place| place.is_finite())) {
        return Err(Rejected::Broken(format!("a place is no number at {:.2} s", frame as f64 / FRAME_RATE)));
    }
    let ways = frames.windows(2).map(|pair| pair[0][0].distance(pair[1][0]));
    if let Some((frame, metres)) = ways.enumerate().find(|&(_, way)| way > JUMP) {
        return Err(Rejected::Jump { metres, seconds: frame as f64 / FRAME_RATE });
    }
    for joint in BONES {
        let share = spread(frames.iter().map(|pose| pose[joint].distance(pose[PARENTS[joint]])));
        if share > STRETCH {
            return Err(Rejected::Stretch { joint, share });
        }
    }
    let still = (0..frames[0].len()).all(|joint| {
        let places = || frames.iter().map(|pose| pose[joint]);
        let (Some(low), Some(high)) = (places().reduce(Vec3::min), places().reduce(Vec3::max)) else {
            return true;
        };
        (high - low).max_element() < STILL
    });
    if still {
        return Err(Rejected::Still);
    }
    let mut lowest: Vec<f32> =
        frames.iter().map(|pose| pose.iter().map(|place| place.y).fold(f32::MAX, f32::min)).collect();
    lowest.sort_by(f32::total_cmp);
    let metres = lowest[lowest.len() / 20] - lowest[0];
    if metres > SINK { Err(Rejected::Sinks { metres }) } else { Ok(()) }
}

/// Standard deviation over mean; 0 for lengths of nothing.
fn spread(lengths: impl Iterator<Item = f32> + Clone) -> f32 {
    let count = lengths.clone().count().max(1) as f32;
    let mean = lengths.clone().sum::<f32>() / count;
    if mean < 1e-4 {
        return 0.0;
    }
    (lengths.map(|length| (length - mean).powi(2)).sum::<f32>() / count).sqrt() / mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::{JOINTS, RAW_DIRECTIONS};

    fn walker(frames: usize) -> Vec<Joints> {
        let mut pose = [Vec3::Y; JOINTS];
        for joint in 1..JOINTS {
            pose[joint] = pose[PARENTS[joint]] + 0.2 * RAW_DIRECTIONS[joint];
        }
        (0..frames).map(|frame| pose.map(|place| place + frame as f32 * 0.05 * Vec3::Z)).collect()
    }

    #[test]
    fn every_reason_is_found_and_said() {
        let says = |change: &dyn Fn(&mut Vec<Joints>)| {
            let mut frames = walker(60);
            change(&mut frames);
            let error = check(&frames, 41).unwrap_err();
            format!("{} / {error}", error.kind())
        };
        assert_eq!(check(&walker(60), 41), Ok(()));
        assert!(says(&|frames| frames.truncate(20)).starts_with("too short / too short: 20 frames"));
        assert!(says(&|frames| frames[30][3].x = f32::NAN).contains("no number at 1.50 s"));
        assert!(
            says(&|frames| frames[30..].iter_mut().flatten().for_each(|place| place.x += 2.0))
                .contains("leaps 2.0 m")
        );
        assert!(
            says(&|frames| frames.iter_mut().step_by(2).for_each(|pose| pose[20].x += 0.3))
                .contains("joint 20")
        );
        assert!(
            says(&|frames| {
                let first = frames[0];
                frames.fill(first);
            })
            .contains("nothing moves")
        );
        assert!(
            says(&|frames| frames[10].iter_mut().for_each(|place| place.y -= 0.5)).contains("0.50 m below")
        );
    }
}
