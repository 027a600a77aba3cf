//! How good a motion is that shall follow a control: measured on the finished clip, not on the solver's own numbers.

use crate::measures::{Dynamics, Nearness, Structure, nearness, structure};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::pyramid::{close_loop, resample_frames};
use crate::reconstruct::frames_per_sample;
use crate::{AlignError, Layout, Norm, Options, sampled};
use inkrig_motion::{Clip, FeatureLayout, Features, Takes, cycle, time};
use inkrig_transport::{Mat, MatRef};
use serde::Serialize;

/// What a motion is worth that shall follow a control and still be the clip. No number says it alone: structure can be
/// had by freezing or by jumping, nearness by repeating one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Quality {
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
    /// For a loop: the step from the last pose to the first over the median step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_seam_ratio: Option<f64>,
}

impl Quality {
    /// Measures a result against its source and its control, both without lead-ins; features and control are at the
    /// matching rate, the result at the source's own.
    pub(crate) fn of(
        source: &Takes,
        result: &Clip,
        layout: &FeatureLayout,
        (features, columns): (&Features, &Layout),
        (control, rows): (&Mat<f32>, &Layout),
        options: &Options,
    ) -> Result<Self, AlignError> {
        // Centred, so that squares of what all frames have in common do not eat the digits of what differs.
        let means = column_means(features);
        let frames = centred(features, &means);
        let own = result_frames(result, layout, rows, &means, options.matching_rate)?;
        let mut stretched = Mat::zeros(0, 0);
        // The baseline knows neither cuts nor loops.
        let (all, even) =
            (Layout::open(columns.frames(), columns.patch()), Layout::open(rows.rows(), rows.patch()));
        resample_frames(frames.view(), &all, &even, &mut stretched);
        let tables = [(control.view(), rows), (own.view(), rows), (stretched.view(), &even)];
        let [drawn, own, stretched] = tables;
        let measure = match sampled::sample(rows, columns) {
            Some(_) => sampled::measure,
            None => whole,
        };
        let (own, warp, near) = measure(drawn, own, stretched, (frames.view(), columns), options.threads)?;
        let travel = layout.travel_joint();
        let (moves, original) = (Dynamics::of(result, travel), Dynamics::of_takes(source, travel));
        let slow = 0.1 * original.speed_mean();
        Ok(Self {
            structure_pearson: own.pearson,
            structure_spearman: own.spearman,
            structure_pearson_warp: warp.pearson,
            nearest_patch: near.nearest_patch,
            coverage: near.coverage,
            speed_mean_ratio: ratio(moves.speed_mean(), original.speed_mean()),
            jump_q999_ratio: ratio(moves.speed_q999, original.speed_q999),
            jerk_ratio: ratio(moves.jerk, original.jerk),
            freeze: moves.slower_than(slow),
            freeze_source: original.slower_than(slow),
            loop_seam_ratio: if rows.is_cyclic() { Some(cycle::seam_ratio(result)?) } else { None },
        })
    }
}

/// As [`sampled::measure`], on all patches.
fn whole(
    control: Table<'_>,
    motion: Table<'_>,
    warped: Table<'_>,
    clip: Table<'_>,
    threads: usize,
) -> Result<(Structure, Structure, Nearness), AlignError> {
    let mut scratch = PatchScratch::new();
    let empty = Mat::<f32>::default;
    let (mut of_control, mut of_source, mut of_motion, mut of_warped, mut cross) =
        (empty(), empty(), empty(), empty(), empty());
    normalised_self_distances(control.0, control.1, Norm::Mean, &mut scratch, &mut of_control, threads)?
        .ok_or(AlignError::StillControl)?;
    let scale = normalised_self_distances(clip.0, clip.1, Norm::Mean, &mut scratch, &mut of_source, threads)?
        .ok_or(AlignError::StillClip)?;
    patch_distances(motion, motion, scale, &mut scratch, &mut of_motion, threads)?;
    patch_distances(motion, clip, scale, &mut scratch, &mut cross, threads)?;
    patch_distances(warped, warped, scale, &mut scratch, &mut of_warped, threads)?;
    let follows = |table| structure(&of_control, table, control.1.patch());
    Ok((follows(&of_motion), follows(&of_warped), nearness(&cross, &of_source, clip.1)))
}

/// A table of frames and where its patches stand.
type Table<'a> = (MatRef<'a, f32>, &'a Layout);

/// The frames of a result at the matching rate, one a control sample, less the source's `means`.
pub(crate) fn result_frames(
    result: &Clip,
    layout: &FeatureLayout,
    rows: &Layout,
    means: &[f32],
    rate: f64,
) -> Result<Mat<f32>, AlignError> {
    let step = frames_per_sample(result.frame_rate(), rate);
    let places: Vec<f64> = (0..rows.frames()).map(|sample| sample as f64 * step).collect();
    let matched = time::sample_at(result, &places, rate)?;
    let mut own = centred(&layout.features(&matched.into()), means);
    close_loop(rows, &mut own);
    Ok(own)
}

pub(crate) fn column_means(features: &Features) -> Vec<f32> {
    let mut sums = vec![0.0_f64; features.width()];
    for frame in 0..features.frames() {
        sums.iter_mut().zip(features.row(frame)).for_each(|(sum, &value)| *sum += f64::from(value));
    }
    sums.into_iter().map(|sum| (sum / features.frames() as f64) as f32).collect()
}

pub(crate) fn centred(features: &Features, means: &[f32]) -> Mat<f32> {
    Mat::from_fn(features.frames(), features.width(), |row, column| features.row(row)[column] - means[column])
}

/// 1 where the source has none of it: nothing was lost and nothing came up.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 1.0 }
}
