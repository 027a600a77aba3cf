//! A result at another frame rate, with its exact poses still in it.

use crate::{KeyRow, pose_errors};
use inkrig_motion::{Clip, MotionError, cycle, time};

/// Frames of the result over which time is moved a little around an exact pose.
const REACH: f64 = 4.0;

/// An exact pose that goes to another frame.
struct Move {
    /// The new frame.
    at: usize,
    /// The frame that shall stand there.
    frame: usize,
    /// By how many old frames that is later.
    late: f64,
}

/// A result at another rate, a loop with the nearest whole number of frames. Exact poses stay exact: each goes to the
/// nearest new frame, and time around it is moved by the rest, about half a frame. How well they were met is measured
/// again, and stands in `keys` with the time of the new frame. Keys are those of the result as `clip` has it.
///
/// # Errors
/// When the rate is not usable.
pub fn at_frame_rate(clip: &Clip, keys: &mut [KeyRow], rate: f64, cyclic: bool) -> Result<Clip, MotionError> {
    let plain = if cyclic { cycle::resample_loop(clip, rate)? } else { time::resample(clip, rate)? };
    let frames = plain.frames();
    let step = if cyclic { clip.frames() as f64 / frames.max(1) as f64 } else { clip.frame_rate() / rate };
    let moved = |key: &KeyRow| {
        let frame = (key.seconds * clip.frame_rate()).round();
        let at = (frame / step).round().min((frames - 1) as f64);
        Move { at: at as usize, frame: frame as usize, late: frame - at * step }
    };
    let exact = |key: &&mut KeyRow| key.kind == "hard";
    let mut moves: Vec<Move> = keys.iter().filter(|key| key.kind == "hard").map(moved).collect();
    moves.sort_by_key(|one| one.at);
    moves.dedup_by_key(|one| one.at);
    let out = if moves.iter().all(|one| one.late.abs() < 1e-6) {
        plain
    } else {
        let last = if cyclic { clip.frames() } else { clip.frames() - 1 } as f64;
        let places: Vec<f64> = (0..frames)
            .map(|frame| {
                let place = frame as f64 * step + late(&moves, frame, cyclic.then_some(frames));
                // What rounding leaves would be interpolated.
                let place = if (place - place.round()).abs() < 1e-6 { place.round() } else { place };
                place.clamp(0.0, last)
            })
            .collect();
        if cyclic { cycle::sample_loop(clip, &places, rate)? } else { time::sample_at(clip, &places, rate)? }
    };
    for key in keys.iter_mut().filter(exact) {
        let Move { at, frame, .. } = moved(key);
        measure(key, (clip, frame), (&out, at));
    }
    Ok(out)
}

/// Frames of a result that hold exact poses.
pub fn exact_frames(clip: &Clip, keys: &[KeyRow]) -> Vec<usize> {
    let hard = keys.iter().filter(|key| key.kind == "hard");
    hard.map(|key| (key.seconds * clip.frame_rate()).round() as usize).collect()
}

/// By how many old frames time is moved at a new frame. `ring`: the frames of a loop.
fn late(moves: &[Move], frame: usize, ring: Option<usize>) -> f64 {
    let count = moves.len();
    let moved = moves.iter().enumerate().map(|(index, one)| {
        let gap = |other: Option<usize>| {
            let apart = |other: usize| match ring {
                // From a key to the next around the loop; to itself it is all of it.
                Some(frames) => {
                    let way = moves[other].at.abs_diff(one.at);
                    if index == other { frames } else { way.min(frames - way).max(1) }
                }
                None => moves[other].at.abs_diff(one.at),
            };
            other.map_or(REACH, |other| (apart(other) as f64).min(REACH))
        };
        let (before, after) = match ring {
            Some(_) => (Some((index + count - 1) % count), Some((index + 1) % count)),
            None => (index.checked_sub(1), (index + 1 < count).then_some(index + 1)),
        };
        let mut offset = frame as f64 - one.at as f64;
        if let Some(frames) = ring {
            let frames = frames as f64;
            offset -= (offset / frames).round() * frames;
        }
        let reach = gap(if offset < 0.0 { before } else { after });
        one.late * (0.5 * std::f64::consts::PI * (offset / reach).clamp(-1.0, 1.0)).cos().powi(2)
    });
    moved.sum()
}

/// How far the pose that is written lies from the one that was there.
fn measure(key: &mut KeyRow, (clip, frame): (&Clip, usize), (out, at): (&Clip, usize)) {
    let root = clip.travel_joint();
    let (turned, apart) = pose_errors((out, at), (clip, frame.min(clip.frames() - 1)), root);
    key.rotation_error = key.rotation_error.map(|error| error.max(turned));
    key.position_error = key.position_error.map(|error| error.max(apart));
    key.seconds = at as f64 / out.frame_rate();
}
