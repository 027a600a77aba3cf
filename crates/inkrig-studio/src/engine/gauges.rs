//! A report as a few gauges with a verdict each, and the frames behind them.

use super::results::Verdict;
use inkrig_align::Alignment;
use inkrig_align::measures::Dynamics;
use inkrig_motion::ground::Contacts;
use inkrig_motion::{Clip, kinematics};
use serde::Serialize;
use utoipa::ToSchema;

/// One number with what it means.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Gauge {
    /// Its stable name.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// What merely stretching the clip, or the clip itself, has.
    pub baseline: Option<f64>,
    /// The value from which on it is good.
    pub good: f64,
    /// In a word.
    pub verdict: Verdict,
    /// In a sentence.
    pub text: String,
}

/// Frames at which something is wrong, rising.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct BadFrames {
    /// A joint moves faster than it does anywhere in the clip, by half as much again.
    pub jump: Vec<usize>,
    /// A foot that stands slides.
    pub slide: Vec<usize>,
    /// The body stands still where the clip does not.
    pub freeze: Vec<usize>,
}

/// A standing foot that goes farther than this from frame to frame slides, metres.
const SLIDES: f32 = 0.005;
/// Still frames in a row that are seen as freezing, seconds.
const FREEZES: f64 = 0.5;

pub(super) fn gauges(alignment: &Alignment, clip: &Clip) -> (Vec<Gauge>, BadFrames) {
    let report = &alignment.report;
    let mut all = Vec::new();
    let mut add = |name, value: f64, baseline, (good, poor): (f64, f64), text: String| {
        let beyond = |limit: f64| if good > poor { value >= limit } else { value <= limit };
        let verdict = match (beyond(good), beyond(poor)) {
            (true, _) => Verdict::Good,
            (_, true) => Verdict::Fair,
            _ => Verdict::Poor,
        };
        all.push(Gauge { name, value, baseline, good, verdict, text });
    };
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let (structure, warp) = (report.structure_pearson, report.structure_pearson_warp);
    let text =
        format!("follows the control {}; stretching the clip would {}", percent(structure), percent(warp));
    add("structure", structure, Some(warp), (0.7, 0.45), text);
    let text = format!("{:.2} of a mean distance from the clip's own poses", report.nearest_patch);
    add("nearness", report.nearest_patch, None, (0.3, 0.45), text);
    let text = format!("comes near to {} of the clip", percent(report.coverage));
    add("coverage", report.coverage, None, (0.5, 0.2), text);
    let frozen = report.freeze - report.freeze_source;
    let text = format!(
        "still for {} of the time, the clip for {}",
        percent(report.freeze),
        percent(report.freeze_source)
    );
    add("freeze", frozen.max(0.0), Some(report.freeze_source), (0.1, 0.3), text);
    let text = format!("the fastest movements are {:.1} times the clip's", report.jump_q999_ratio);
    add("jumps", report.jump_q999_ratio, Some(1.0), (1.5, 2.0), text);
    let text = format!("moves {:.2} times as fast as the clip", report.speed_mean_ratio);
    add("speed", (report.speed_mean_ratio.max(1e-6)).ln().abs(), None, (0.4, 0.8), text);
    let text = format!("{:.1} times as jerky as the clip", report.jerk_ratio);
    add("jerk", report.jerk_ratio, Some(1.0), (2.0, 4.0), text);
    let slide = Contacts::of(clip).slide(clip);
    if let Some(slide) = slide {
        let own = Contacts::of(alignment.source.clip()).slide(alignment.source.clip());
        let text = match own {
            Some(own) => format!(
                "standing feet slide {:.1} mm a frame, the clip's {:.1} mm",
                slide.mean_step_mm, own.mean_step_mm
            ),
            None => format!("standing feet slide {:.1} mm a frame", slide.mean_step_mm),
        };
        add("slide", slide.mean_step_mm, own.map(|own| own.mean_step_mm), (3.0, 6.0), text);
    }
    if let Some(seam) = report.loop_seam_ratio {
        let text = format!("the step over the seam is {seam:.1} ordinary ones");
        add("seam", seam, Some(1.0), (1.5, 3.0), text);
    }
    (all, bad_frames(alignment, clip))
}

fn bad_frames(alignment: &Alignment, clip: &Clip) -> BadFrames {
    let source = alignment.source.clip();
    let joint = clip.travel_joint();
    let own = Dynamics::of_takes(&alignment.source, source.travel_joint());
    let positions = kinematics::positions(clip);
    let relative = positions.relative_to(joint);
    let rate = clip.frame_rate() as f32;
    let fastest = |frame: usize| {
        let pairs = relative.frame(frame).iter().zip(relative.frame(frame - 1));
        pairs.map(|(to, from)| to.distance(*from) * rate).fold(0.0_f32, f32::max)
    };
    let too_fast = 1.5 * own.speed_q999 as f32;
    let jump = (1..clip.frames()).filter(|&frame| too_fast > 0.0 && fastest(frame) > too_fast).collect();
    let mut slide: Vec<usize> = Vec::new();
    for (joint, first, last) in Contacts::of(clip).spans {
        slide.extend((first + 1..=last.min(clip.frames() - 1)).filter(|&frame| {
            let place = |frame: usize| positions.frame(frame).get(joint).copied().unwrap_or_default();
            (place(frame) - place(frame - 1)).with_y(0.0).length() > SLIDES
        }));
    }
    slide.sort_unstable();
    slide.dedup();
    let still: Vec<bool> = Dynamics::of(clip, joint)
        .speeds
        .iter()
        .map(|&speed| f64::from(speed) < 0.1 * own.speed_mean())
        .collect();
    let least = (FREEZES * clip.frame_rate()).ceil() as usize;
    let mut freeze = Vec::new();
    for run in still.chunk_by(|a, b| a == b).scan(0, |at, run| {
        let begin = *at;
        *at += run.len();
        Some((begin, run))
    }) {
        if run.1.first() == Some(&true) && run.1.len() >= least {
            freeze.extend(run.0 + 1..=run.0 + run.1.len());
        }
    }
    BadFrames { jump, slide, freeze }
}
