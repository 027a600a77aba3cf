//! A result at another frame rate, with its exact poses still in it.

use crate::error::CliError;
use inkrig_align::Alignment;
use inkrig_motion::{Clip, time};

/// Frames of the result over which time is moved a little around an exact pose.
const REACH: f64 = 4.0;

/// The clip of a result at another rate. Exact poses stay exact: each goes to the nearest new frame, and time around it
/// is moved by the rest, less than half a frame.
pub(super) fn at_rate(alignment: &Alignment, rate: f64) -> Result<Clip, CliError> {
    let clip = &alignment.clip;
    let plain = time::resample(clip, rate)?;
    let step = clip.frame_rate() / rate;
    // New frame, and by how much the pose is later than it, old frames.
    let mut moves: Vec<(f64, f64)> = (alignment.report.keys.iter().filter(|key| key.kind == "hard"))
        .map(|key| {
            let frame = (key.seconds * clip.frame_rate()).round();
            let nearest = (frame / step).round().min((plain.frames() - 1) as f64);
            (nearest, frame - nearest * step)
        })
        .collect();
    moves.sort_by(|a, b| a.0.total_cmp(&b.0));
    moves.dedup_by(|a, b| a.0 == b.0);
    if moves.iter().all(|(_, late)| late.abs() < 1e-6) {
        return Ok(plain);
    }
    let places: Vec<f64> = (0..plain.frames())
        .map(|frame| {
            let moved = moves.iter().enumerate().map(|(index, &(at, late))| {
                let gap =
                    |other: Option<&(f64, f64)>| other.map_or(REACH, |other| (other.0 - at).abs().min(REACH));
                let before = gap(index.checked_sub(1).and_then(|before| moves.get(before)));
                let offset = frame as f64 - at;
                let reach = if offset < 0.0 { before } else { gap(moves.get(index + 1)) };
                late * (0.5 * std::f64::consts::PI * (offset / reach).clamp(-1.0, 1.0)).cos().powi(2)
            });
            let place = frame as f64 * step + moved.sum::<f64>();
            // What rounding leaves would be interpolated.
            if (place - place.round()).abs() < 1e-6 { place.round() } else { place }
        })
        .collect();
    Ok(time::sample_at(clip, &places, rate)?)
}
