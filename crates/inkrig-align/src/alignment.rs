//! The whole job: a clip and a control in, a clip that follows the control out.

use crate::coarse_to_fine::{Buffers, Frames, solve};
use crate::control::Control;
use crate::measures::{Dynamics, Structure, nearness, structure};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::progress::Observer;
use crate::pyramid::{close_loop, resample_frames};
use crate::reconstruct::blend_clip;
use crate::report::{Report, notes};
use crate::{AlignError, Layout, Norm, Options, pca};
use inkrig_motion::{Clip, Features, Takes, frame_features, lead_in, time};
use inkrig_transport::{Isa, Mat, MatRef, Plan};
use std::time::Instant;

/// Frames at the matching rate that the dense solver takes: about 1 GB of tables.
pub const MOST_FRAMES: usize = 5000;

/// A motion that follows a control, and how it came about.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// The result, at the source's own frame rate.
    pub clip: Clip,
    /// The part of the source that was used: without rest-pose lead-ins.
    pub source: Takes,
    /// Which source patches (columns) every control patch (row) is made of.
    pub plan: Plan<f32>,
    /// For every control sample, the moment of [`Self::source`] that it uses most, seconds from the first take's
    /// beginning, takes played one after the other.
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
    source: &Takes,
    control: &Control,
    options: &Options,
    observer: Observer<'_>,
) -> Result<Alignment, AlignError> {
    options.validate()?;
    let begin = Instant::now();
    let (source, rest_pose_frames) = without_lead_ins(source)?;
    let matched = source.resample(options.matching_rate)?;
    let lengths: Vec<usize> = matched.ranges().map(|range| range.len()).collect();
    let columns = Layout::clips(&lengths, options.patch());
    let (drawn, rows) = at_rate(control, options);
    check_lengths(&columns, &rows, options)?;

    let features = frame_features(&matched, &options.features);
    let solving = Instant::now();
    let reduced = pca::reduce(table(&features)?, pca::FEATURE_ENERGY, options.threads)?;
    let mut buffers = Buffers::new(options.threads);
    let frames = Frames { table: reduced.frames.view(), layout: &columns };
    let matching =
        solve(frames, Frames { table: drawn.view(), layout: &rows }, options, &mut buffers, observer)?;
    let solve_seconds = solving.elapsed().as_secs_f64();

    let clip = blend_clip(&source, &matched, &matching.weights, control.cyclic, options.travel)?;
    let (best_source, confidence) = most_used(&matching.weights, options.matching_rate);
    let measured = Measured::of(&source, &clip, (&features, &columns), (&drawn, &rows), options)?;
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
        source_frames: columns.frames(),
        control_frames: rows.frames(),
        rest_pose_frames,
        feature_energy: reduced.energy,
        instruction_set: Isa::current().name(),
        loop_seam_ratio: control.cyclic.then(|| measured.result.seam(&clip)),
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
        source: &Takes,
        result: &Clip,
        (features, columns): (&Features, &Layout),
        (control, rows): (&Mat<f32>, &Layout),
        options: &Options,
    ) -> Result<Self, AlignError> {
        let threads = options.threads;
        let mut scratch = PatchScratch::new();
        let empty = Mat::<f32>::default;
        let (mut of_control, mut of_source, mut of_result, mut of_warp, mut cross) =
            (empty(), empty(), empty(), empty(), empty());
        normalised_self_distances(control.view(), rows, Norm::Mean, &mut scratch, &mut of_control, threads)?
            .ok_or(AlignError::StillControl)?;
        let frames = (table(features)?, columns);
        let scale =
            normalised_self_distances(frames.0, columns, Norm::Mean, &mut scratch, &mut of_source, threads)?
                .ok_or(AlignError::StillClip)?;
        // The result at the matching rate, one frame a control sample.
        let step = result.frame_rate() / options.matching_rate;
        let places: Vec<f64> = (0..rows.frames()).map(|sample| sample as f64 * step).collect();
        let matched = time::sample_at(result, &places, options.matching_rate)?;
        let own_features = frame_features(&matched.into(), &options.features);
        let mut own = table(&own_features)?.to_mat();
        close_loop(rows, &mut own);
        let own = (own.view(), rows);
        patch_distances(own, own, scale, &mut scratch, &mut of_result, threads)?;
        patch_distances(own, frames, scale, &mut scratch, &mut cross, threads)?;
        let mut stretched = Mat::zeros(0, 0);
        // The baseline knows neither cuts nor loops.
        let (all, even) =
            (Layout::open(columns.frames(), columns.patch()), Layout::open(rows.rows(), rows.patch()));
        resample_frames(frames.0, &all, &even, &mut stretched);
        let stretched = (stretched.view(), &even);
        patch_distances(stretched, stretched, scale, &mut scratch, &mut of_warp, threads)?;
        Ok(Self {
            structure: structure(&of_control, &of_result),
            warp: structure(&of_control, &of_warp),
            nearness: nearness(&cross, &of_source),
            result: Dynamics::of(result),
            original: Dynamics::of(source.clip()),
        })
    }
}

fn table(features: &Features) -> Result<MatRef<'_, f32>, AlignError> {
    Ok(MatRef::new(features.as_slice(), features.frames(), features.width())?)
}

/// The takes without the calibration poses at their beginnings, and how many frames that left out.
fn without_lead_ins(takes: &Takes) -> Result<(Takes, usize), AlignError> {
    let mut left_out = 0;
    let mut kept = Vec::with_capacity(takes.count());
    for range in takes.ranges() {
        let take = time::trim(takes.clip(), range)?;
        let lead_in = lead_in::rest_pose_frames(&take);
        left_out += lead_in;
        kept.push(time::trim(&take, lead_in..take.frames())?);
    }
    Ok((Takes::join(&kept)?, left_out))
}

/// The control's rows at the matching rate, and its layout.
fn at_rate(control: &Control, options: &Options) -> (Mat<f32>, Layout) {
    let features = &control.features;
    let frames = (features.frames() as f64 * options.matching_rate / control.rate).round().max(1.0) as usize;
    let frames = frames.min(MOST_FRAMES + 1);
    let layout = |frames| {
        if control.cyclic {
            Layout::cyclic(frames, options.patch())
        } else {
            Layout::open(frames, options.patch())
        }
    };
    let (from, to) = (layout(features.frames()), layout(frames));
    let mut table =
        Mat::from_fn(features.frames(), features.width(), |row, column| features.row(row)[column]);
    close_loop(&from, &mut table);
    let mut out = Mat::zeros(0, 0);
    resample_frames(table.view(), &from, &to, &mut out);
    (out, to)
}

fn check_lengths(source: &Layout, control: &Layout, options: &Options) -> Result<(), AlignError> {
    let patch = options.patch();
    let needed = 2 * patch;
    let longest = source.parts().iter().map(std::ops::Range::len).max().unwrap_or(0);
    if longest < needed {
        return Err(AlignError::ClipTooShort { frames: longest, rate: options.matching_rate, patch, needed });
    }
    if control.frames() < needed {
        return Err(AlignError::ControlTooShort { frames: control.frames(), patch, needed });
    }
    let limits = [("the clip", source.frames(), "--range"), ("the control", control.frames(), "--length")];
    for (what, frames, cut) in limits {
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
