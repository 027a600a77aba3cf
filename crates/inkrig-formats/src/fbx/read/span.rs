//! When the frames of a clip are.

use super::{bones::Bones, stacks::Stack};
use crate::{Finding, ImportOptions, fbx::TICKS, timing::Timing};
use inkrig_motion::Clip;
use ufbx::{Scene, TimeMode};

/// Spans beyond it are no time that anyone meant, seconds: three years.
const LONGEST: f64 = 1e8;

/// The frames of a clip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    start: f64,
    /// Frames a second.
    pub(super) rate: f64,
    /// How many frames; may be beyond any limit.
    pub(super) frames: f64,
}

impl Span {
    /// The stack's own span, and the file's rate; the rate of the keys where they stand on another.
    pub(super) fn of(
        scene: &Scene,
        stack: &Stack<'_>,
        bones: &Bones<'_>,
        options: &ImportOptions,
        findings: &mut Vec<Finding>,
    ) -> Self {
        let keys = || stack.curves(bones).filter(|curve| curve.keyframes.count > 0);
        let (mut start, mut end) = (stack.stack.time_begin, stack.stack.time_end);
        if !(start.abs() <= LONGEST && end.abs() <= LONGEST && end > start) {
            start = keys().map(|curve| curve.min_time).fold(f64::MAX, f64::min);
            end = keys().map(|curve| curve.max_time).fold(f64::MIN, f64::max);
            if start > end {
                (start, end) = (0.0, 0.0);
            }
        }
        let rate = options.frame_rate.unwrap_or_else(|| rate(scene, stack, bones, start, findings));
        let frames = ((end - start) * rate + 1e-3).floor() + 1.0;
        Self { start, rate, frames }
    }

    /// The time of a frame, seconds, exactly as `ufbx` reckons that of a key there.
    pub(super) fn time(&self, frame: usize) -> f64 {
        ((self.start + frame as f64 / self.rate) * TICKS).round() / TICKS
    }
}

fn rate(scene: &Scene, stack: &Stack<'_>, bones: &Bones<'_>, start: f64, findings: &mut Vec<Finding>) -> f64 {
    let said = match scene.settings.time_mode {
        // The format rounds them; frames are counted by the exact ones.
        TimeMode::NtscDropFrame | TimeMode::NtscFullFrame => 30_000.0 / 1001.0,
        TimeMode::FilmFullFrame => 24_000.0 / 1001.0,
        TimeMode::E5994Fps => 60_000.0 / 1001.0,
        _ => scene.settings.frames_per_second,
    };
    let said = if Clip::FRAME_RATES.contains(&said) { said } else { 30.0 };
    let mut keys = stack.curves(bones).flat_map(|curve| curve.keyframes.iter());
    let on_frame = |time: f64| {
        let place = (time - start) * said;
        (place - place.round()).abs() <= 0.01
    };
    if keys.all(|key| on_frame(key.time)) {
        return said;
    }
    let keys = stack.curves(bones).flat_map(|curve| curve.keyframes.iter());
    let mut times: Vec<f64> = keys.map(|key| key.time).filter(|time| time.is_finite()).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    let (found, _) = Timing::of(&times, None);
    // A rate that was only chosen is no better than the file's.
    if Timing::of(&times, None).1.is_none() {
        let message = format!(
            "the file says {said:.3} frames a second, its keys stand {:.3} a second; the latter is taken",
            found.rate
        );
        findings.push(Finding::info("fbx-rate", message));
        return found.rate;
    }
    let message = format!(
        "keys stand between frames; the clip is sampled at the file's {said:.3} frames a second, \
         `--source-fps` says another rate"
    );
    findings.push(Finding::info("fbx-sampled", message));
    said
}
