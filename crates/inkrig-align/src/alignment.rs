//! The whole job: a clip and a control in, a clip that follows the control out.

use crate::coarse_to_fine::{Buffers, solve};
use crate::control::Control;
use crate::measures::{Dynamics, Structure, nearness, structure};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::progress::Observer;
use crate::pyramid::resample_rows;
use crate::reconstruct::blend_clip;
use crate::report::{Report, notes};
use crate::{AlignError, Options, pca};
use inkrig_motion::{Clip, Features, frame_features, lead_in, time};
use inkrig_transport::{Isa, Mat, MatRef, Plan};
use std::time::Instant;

/// Frames at the matching rate that the dense solver takes: about 1 GB of tables.
pub const MOST_FRAMES: usize = 5000;

/// A motion that follows a control, and how it came about.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// The result, at the source's own frame rate.
    pub clip: Clip,
    /// The part of the source that was used: without its rest-pose lead-in.
    pub source: Clip,
    /// Which source patches (columns) every control patch (row) is made of.
    pub plan: Plan<f32>,
    /// For every control sample, the moment of [`Self::source`] that it uses most, seconds.
    pub best_source: Vec<f32>,
    /// For every control sample, the share of its weight within a quarter second of that moment, 0..=1.
    pub confidence: Vec<f32>,
    /// The numbers.
    pub report: Report,
}

/// Arranges the motion of `source` so that it follows `control`.
///
/// # Errors
/// When an option is out of range, the clip or the control is too short, too long or does not move, or the observer
/// cancels.
pub fn align(
    source: &Clip,
    control: &Control,
    options: &Options,
    observer: Observer<'_>,
) -> Result<Alignment, AlignError> {
    options.validate()?;
    let begin = Instant::now();
    let rest_pose_frames = lead_in::rest_pose_frames(source);
    let source = time::trim(source, rest_pose_frames..source.frames())?;
    let matched = time::resample(&source, options.matching_rate)?;
    let drawn = at_rate(&control.features, control.rate, options.matching_rate);
    check_lengths(matched.frames(), drawn.rows(), options)?;

    let features = frame_features(&matched, &options.features);
    let solving = Instant::now();
    let reduced = pca::reduce(table(&features)?, pca::FEATURE_ENERGY, options.threads)?;
    let mut buffers = Buffers::new(options.threads);
    let matching = solve(reduced.frames.view(), drawn.view(), options, &mut buffers, observer)?;
    let solve_seconds = solving.elapsed().as_secs_f64();

    let clip = blend_clip(&source, &matching.weights, options.matching_rate, options.travel)?;
    let (best_source, confidence) = most_used(&matching.weights, options.matching_rate);
    let measured = Measured::of(&source, &clip, &features, &drawn, options)?;
    let mut report = Report {
        structure_pearson: measured.structure.pearson,
        structure_spearman: measured.structure.spearman,
        structure_pearson_warp: measured.warp.pearson,
        nearest_patch: measured.nearness.nearest_patch,
        coverage: measured.nearness.coverage,
        speed_mean_ratio: ratio(measured.result.speed_mean(), measured.original.speed_mean()),
        jump_q999_ratio: ratio(measured.result.speed_q999, measured.original.speed_q999),
        jerk_ratio: ratio(measured.result.jerk, measured.original.jerk),
        freeze: measured.result.slower_than(0.1 * measured.original.speed_mean()),
        freeze_source: measured.original.slower_than(0.1 * measured.original.speed_mean()),
        gradients: matching.gradients,
        solve_seconds,
        total_seconds: 0.0,
        source_frames: matched.frames(),
        control_frames: drawn.rows(),
        rest_pose_frames,
        feature_energy: reduced.energy,
        instruction_set: Isa::current().name(),
        notes: Vec::new(),
        levels: matching.levels,
    };
    report.notes = notes(&report);
    report.total_seconds = begin.elapsed().as_secs_f64();
    Ok(Alignment { clip, source, plan: matching.plan, best_source, confidence, report })
}

/// Results measured on the finished clip, not on the solver's own numbers.
struct Measured {
    structure: Structure,
    warp: Structure,
    nearness: crate::measures::Nearness,
    result: Dynamics,
    original: Dynamics,
}

impl Measured {
    fn of(
        source: &Clip,
        result: &Clip,
        source_features: &Features,
        control: &Mat<f32>,
        options: &Options,
    ) -> Result<Self, AlignError> {
        let (patch, threads) = (options.patch(), options.threads);
        let mut scratch = PatchScratch::new();
        let distances = Mat::<f32>::default;
        let (mut of_control, mut of_source, mut of_result, mut of_warp, mut cross) =
            (distances(), distances(), distances(), distances(), distances());
        normalised_self_distances(control.view(), patch, &mut scratch, &mut of_control, threads)?
            .ok_or(AlignError::StillControl)?;
        let frames = table(source_features)?;
        let scale = normalised_self_distances(frames, patch, &mut scratch, &mut of_source, threads)?
            .ok_or(AlignError::StillClip)?;
        // The result at the matching rate, one frame a control sample.
        let step = result.frame_rate() / options.matching_rate;
        let places: Vec<f64> = (0..control.rows()).map(|sample| sample as f64 * step).collect();
        let matched = time::sample_at(result, &places, options.matching_rate)?;
        let features = frame_features(&matched, &options.features);
        let own = table(&features)?;
        patch_distances(own, own, patch, scale, &mut scratch, &mut of_result, threads)?;
        patch_distances(own, frames, patch, scale, &mut scratch, &mut cross, threads)?;
        let mut stretched = Mat::zeros(0, 0);
        resample_rows(frames, control.rows(), &mut stretched);
        patch_distances(
            stretched.view(),
            stretched.view(),
            patch,
            scale,
            &mut scratch,
            &mut of_warp,
            threads,
        )?;
        Ok(Self {
            structure: structure(&of_control, &of_result),
            warp: structure(&of_control, &of_warp),
            nearness: nearness(&cross, &of_source),
            result: Dynamics::of(result),
            original: Dynamics::of(source),
        })
    }
}

fn table(features: &Features) -> Result<MatRef<'_, f32>, AlignError> {
    Ok(MatRef::new(features.as_slice(), features.frames(), features.width())?)
}

/// The control's rows at the matching rate.
fn at_rate(features: &Features, rate: f64, matching_rate: f64) -> Mat<f32> {
    let table = Mat::from_fn(features.frames(), features.width(), |row, column| features.row(row)[column]);
    let rows = ((features.frames() as f64) * matching_rate / rate).round().max(1.0) as usize;
    let mut out = Mat::zeros(0, 0);
    resample_rows(table.view(), rows.min(MOST_FRAMES + 1), &mut out);
    out
}

fn check_lengths(source: usize, control: usize, options: &Options) -> Result<(), AlignError> {
    let patch = options.patch();
    let needed = 2 * patch;
    if source < needed {
        return Err(AlignError::ClipTooShort { frames: source, rate: options.matching_rate, patch, needed });
    }
    if control < needed {
        return Err(AlignError::ControlTooShort { frames: control, patch, needed });
    }
    for (what, frames, cut) in [("the clip", source, "--range"), ("the control", control, "--length")] {
        if frames > MOST_FRAMES {
            return Err(AlignError::TooLong { what, frames, most: MOST_FRAMES, cut });
        }
    }
    Ok(())
}

/// For every row, the moment of the largest weight in seconds, and the share of the weight near it.
fn most_used(weights: &Mat<f32>, rate: f64) -> (Vec<f32>, Vec<f32>) {
    let reach = (0.25 * rate).round() as usize;
    (0..weights.rows())
        .map(|row| {
            let row = weights.row(row);
            let best = row.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index);
            let near = &row[best.saturating_sub(reach)..(best + reach + 1).min(row.len())];
            ((best as f64 / rate) as f32, near.iter().sum::<f32>().clamp(0.0, 1.0))
        })
        .unzip()
}

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}
