//! What came out, in flat numbers with stable names.

use crate::coarse_to_fine::LevelRow;
use crate::{KeyRow, Layout, Options, Quality, SolverRow, SoundFit};
use inkrig_transport::Mat;
use serde::Serialize;

/// Numbers of one alignment. The names are stable: tools may read them from the report file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Pearson correlation of patch distances within the control and within the result, -1..=1.
    pub structure_pearson: f64,
    /// The same by ranks.
    pub structure_spearman: f64,
    /// What the clip alone gives, stretched evenly to the control's length: the baseline.
    pub structure_pearson_warp: f64,
    /// Mean distance of an output patch to its nearest source patch, in mean source distances.
    pub nearest_patch: f64,
    /// Share of the source's patches that the result comes near to, 0..=1.
    pub coverage: f64,
    /// Mean root-relative joint speed of the result over the source's.
    pub speed_mean_ratio: f64,
    /// 99.9th percentile of root-relative joint speed of the result over the source's: above 2 something jumps.
    pub jump_q999_ratio: f64,
    /// Mean third difference of the result over the source's.
    pub jerk_ratio: f64,
    /// Share of steps slower than a tenth of the source's mean speed, 0..=1.
    pub freeze: f64,
    /// The same of the source itself.
    pub freeze_source: f64,
    /// For a loop: the step from the last pose to the first over the median step. 1 cannot be told from any other step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_seam_ratio: Option<f64>,
    /// How nearly the control is a mirror image of itself, 0..=1. Above [`AMBIGUOUS`] there is another solution about as
    /// good, in which what is alike on both sides has changed places: [`Options::mirror`](crate::Options::mirror),
    /// [`alternatives`](crate::alternatives).
    pub mirror_symmetry: f64,
    /// For a sound: how the movement goes with it.
    #[serde(flatten)]
    pub sound: Option<SoundFit>,
    /// Solver gradients taken.
    pub gradients: usize,
    /// Wall seconds from features ready to final features: distances, all levels, polish.
    pub solve_seconds: f64,
    /// Wall seconds of everything: features, solving, putting the clip together, measuring.
    pub total_seconds: f64,
    /// Source frames at the matching rate.
    pub source_frames: usize,
    /// Control samples at the matching rate.
    pub control_frames: usize,
    /// Leading rest-pose frames (at the clip's own rate) that were left out.
    pub rest_pose_frames: usize,
    /// Share of the features' variance that matching saw, 0..=1.
    pub feature_energy: f64,
    /// For long motions: on how many patches, spread evenly, structure was measured. Absent when on all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_patches: Option<usize>,
    /// What solved the finest level.
    pub solver: SolverRow,
    /// The processor's instruction set that was used; results are the same bytes only on machines with the same one.
    pub instruction_set: &'static str,
    /// What a reader should know: too little material, jumps, freezing, frames left out.
    pub notes: Vec<String>,
    /// How well every key was met, in the order in which they were given.
    pub keys: Vec<KeyRow>,
    /// Wall time of every stage, in order.
    pub stages: Vec<StageRow>,
    /// One row a level.
    pub levels: Vec<LevelRow>,
}

/// Controls with a [`Report::mirror_symmetry`] of this or more are ambiguous.
pub const AMBIGUOUS: f64 = 0.85;

impl Report {
    /// The part of it that any motion can be measured by: see [`Comparison`](crate::Comparison).
    pub fn quality(&self) -> Quality {
        Quality {
            structure_pearson: self.structure_pearson,
            structure_spearman: self.structure_spearman,
            structure_pearson_warp: self.structure_pearson_warp,
            nearest_patch: self.nearest_patch,
            coverage: self.coverage,
            speed_mean_ratio: self.speed_mean_ratio,
            jump_q999_ratio: self.jump_q999_ratio,
            jerk_ratio: self.jerk_ratio,
            freeze: self.freeze,
            freeze_source: self.freeze_source,
            loop_seam_ratio: self.loop_seam_ratio,
        }
    }
}

/// What one stage of a run took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageRow {
    /// Its name.
    pub name: &'static str,
    /// Seconds of wall time.
    pub seconds: f64,
}

/// The step over the seam of a loop, in ordinary ones, above which it is seen.
const SEAM: f64 = 1.5;
/// Frames at the matching rate (four seconds) below which a sound is worth repeating.
const SHORT_SOUND: usize = 120;

/// Changes of a control within a piece, in its mean distances, above which no piece can follow: a wave of about one and a
/// half periods a piece.
const QUICK: f64 = 3.0;

/// How far a control goes within a patch, in the mean distance of two of its samples: 4.9 for a sine of one period a
/// patch.
pub(crate) fn quickness(control: &Mat<f32>, rows: &Layout) -> f64 {
    let count = rows.frames();
    let apart = |i: usize, j: usize| {
        let pairs = control.row(i).iter().zip(control.row(j % count));
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
    };
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, number) = values.fold((0.0, 0_usize), |(sum, number), value| (sum + value, number + 1));
        sum / number.max(1) as f64
    };
    let step = mean(&mut (1..count).map(|i| apart(i - 1, i)));
    // Every sample with another from anywhere.
    let size = mean(&mut (0..count).map(|i| apart(i, i.wrapping_mul(i).wrapping_mul(31) + 17 * i + 7)));
    if size > 0.0 { step * rows.patch() as f64 / size } else { 0.0 }
}

/// Notes on a result that a person would otherwise find out by looking. `control` and `rows` are at the matching rate,
/// `columns` are the clips.
pub(crate) fn notes(
    report: &Report,
    options: &Options,
    (control, rows): (&Mat<f32>, &Layout),
    columns: &Layout,
) -> Vec<String> {
    let mut notes = Vec::new();
    for clip in columns.without_patches() {
        notes.push(format!(
            "Clip {} is shorter than a piece ({} frames at {} a second) and is not used. A smaller --patch takes it in.",
            clip + 1,
            columns.patch(),
            options.matching_rate
        ));
    }
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    match report.rest_pose_frames {
        0 => {}
        1 => notes.push("The clip's first frame is a rest pose (T-pose) and was left out.".to_string()),
        count => {
            notes
                .push(format!("The clip's first {count} frames are a rest pose (T-pose) and were left out."));
        }
    }
    if report.speed_mean_ratio < 0.5 || report.freeze > report.freeze_source + 0.2 {
        let blurred = options.epsilon > 2.0 * Options::default().epsilon;
        let advice = if blurred {
            "Many poses are mixed into one: give a smaller --epsilon."
        } else if quickness(control, rows) > QUICK {
            "The control goes to and fro within a single piece of motion: give a slower one, a longer --length, or a \
             smaller --patch."
        } else {
            "The control asks for more variety than the clip has, or changes too slowly: give a longer or more varied \
             clip, a shorter --length, or a larger --lambda (0.3)."
        };
        notes.push(format!(
            "Too little material: the result stands nearly still for {} of the time (mean speed {:.2} of the clip's). \
             {advice}",
            percent(report.freeze),
            report.speed_mean_ratio
        ));
    }
    if report.speed_mean_ratio > 2.0 {
        notes.push(format!(
            "The body moves {:.1} times as fast as in the clip: the control asks for its liveliest parts only, or too \
             much in too little time. A longer --length slows it down.",
            report.speed_mean_ratio
        ));
    }
    if report.coverage < 0.1 {
        notes.push(format!(
            "Only {} of the clip is used. A larger --lambda uses more of it.",
            percent(report.coverage)
        ));
    }
    if report.jump_q999_ratio > 2.0 {
        notes.push(format!(
            "The fastest movements are {:.1} times faster than in the clip: look for jumps. A larger --smooth or --preset natural may help.",
            report.jump_q999_ratio
        ));
    }
    if report.structure_pearson < (report.structure_pearson_warp + 0.1).min(0.5) {
        notes.push(
            "The result follows the control little better than the clip stretched to its length: the two have little in common."
                .to_string(),
        );
    }
    if let Some(seam) = report.loop_seam_ratio.filter(|seam| *seam > SEAM) {
        notes.push(format!(
            "The loop is seen to end: the step to its beginning is {seam:.1} times an ordinary one. Keys near both ends \
             should ask for poses that are alike."
        ));
    }
    for key in &report.keys {
        match (key.kind, key.distance, key.asked, key.jump) {
            ("never", Some(near), Some(radius), _) if near < 0.9 * radius => notes.push(format!(
                "At {:.2} s the result, on its way between two other poses, is {near:.2} from {}, which must not appear \
                 within {radius:.2}: give a larger radius.",
                key.seconds, key.pose
            )),
            ("hard" | "fixed", _, _, Some(jump)) if jump > 2.0 => notes.push(format!(
                "At {:.2} s ({}) the body moves {jump:.1} times as fast as anywhere in the clip: move keys further apart, \
                 or give poses that are more alike.",
                key.seconds, key.pose
            )),
            _ => {}
        }
    }
    if report.sound.is_some() && report.structure_pearson < 0.75 && report.control_frames < SHORT_SOUND {
        notes.push(
            "The sound is so short that few of its moments can be compared. --repeat 3 follows it three times in a row, \
             and better."
                .to_string(),
        );
    }
    if report.nearest_patch > 0.4 {
        notes.push(
            "The result strays from the clip's own poses. --preset natural stays nearer to them.".to_string(),
        );
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_too_quick_when_it_goes_to_and_fro_within_a_piece() {
        let of = |period: f32| {
            let wave = Mat::from_fn(300, 1, |row, _| (row as f32 / period * std::f32::consts::TAU).sin());
            quickness(&wave, &Layout::open(300, 11))
        };
        assert!((of(11.0) - 4.9).abs() < 0.5, "{}", of(11.0));
        assert!(of(12.0) > QUICK && of(30.0) < QUICK && of(150.0) < 1.0);
    }
}
