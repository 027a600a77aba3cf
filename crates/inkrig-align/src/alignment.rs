//! The whole job: a clip and a control in, a clip that follows the control out.

use crate::coarse_to_fine::{Buffers, Frames, solve};
use crate::control::Control;
use crate::prepared_clip::{PreparedClip, check_clip};
use crate::progress::Observer;
use crate::pyramid::{close_loop, resample_frames};
use crate::quality::Quality;
use crate::reconstruct::{Ends, Rules, blend_clip};
use crate::report::{Report, StageRow, notes};
use crate::suggest::{Moment, places};
use crate::{AlignError, Layout, Options, SoundFit, pca, sampled};
use inkrig_motion::{Clip, Features, Takes, lead_in, time};
use inkrig_transport::{Isa, Mat, MatRef, Plan};
use std::time::Instant;

/// Frames x joints that a result may have.
const MOST_CELLS: f64 = 1e8;

/// A motion that follows a control, and how it came about.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// The result, at the source's own frame rate.
    pub clip: Clip,
    /// The part of the source that was used: without rest-pose lead-ins.
    pub source: Takes,
    /// Which source patches (columns) every control patch (row) is made of.
    pub plan: Plan<f32>,
    /// For every row of the plan, the control sample in the middle of its patch.
    pub plan_rows: Vec<usize>,
    /// For every column of the plan, the frame of the source as it was given in the middle of its patch.
    pub plan_columns: Vec<Moment>,
    /// For every control sample, the moment of [`Self::source`] that it uses most, seconds from the first take's
    /// beginning, takes played one after the other.
    pub best_source: Vec<f32>,
    /// For every control sample, the share of its weight within a quarter second of that moment, 0..=1.
    pub confidence: Vec<f32>,
    /// For every control sample, the frame of the source as it was given that it uses most.
    pub used: Vec<Moment>,
    /// Rest-pose frames that were left out at the beginning of each take.
    pub lead_ins: Vec<usize>,
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
    align_with(source, control, options, &mut Buffers::new(options.threads), observer)
}

/// As [`align`], with buffers that may hold a first plan, or be asked for others.
pub(crate) fn align_with(
    source: &Takes,
    control: &Control,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Alignment, AlignError> {
    options.validate()?;
    control.validate()?;
    let mut clock = Clock::start();
    let prepared = PreparedClip::new(source, options)?;
    check_control(&prepared.source, control, options)?;
    let (drawn, rows) = at_rate(control, options);
    clock.stage("features");

    let reduced = pca::reduce(table(&prepared.features)?, pca::FEATURE_ENERGY, options.threads)?;
    let keys = prepared.keys(&reduced.subspace, control, &rows, options)?;
    let PreparedClip { given, lead_ins, source, matched, columns, layout, features } = prepared;
    clock.stage("principal subspace");
    let frames = Frames { table: reduced.frames.view(), layout: &columns };
    let drawing = Frames { table: drawn.view(), layout: &rows };
    buffers.first.measure = true;
    let matching = solve(frames, drawing, &keys, options, buffers, observer)?;
    clock.stage("matching");
    let solve_seconds = clock.since("features");

    let ring = if control.cyclic { Ends::Loop } else { Ends::Open };
    let anchors = keys.anchors();
    let rules = Rules { ends: ring, anchors: &anchors, forbidden: &matching.forbidden };
    let clip = blend_clip(&source, &matched, &matching.weights, rules, options)?;
    let (best_source, confidence) = matching.weights.most_used(options.matching_rate);
    let places = places(&given, &lead_ins, &matched);
    let place = |seconds: &f32| (f64::from(*seconds) * options.matching_rate).round() as usize;
    let used = best_source.iter().filter_map(|seconds| places.get(place(seconds)).copied()).collect();
    let middle = |layout: &Layout, first: usize| first + layout.patch() / 2;
    let plan_rows =
        rows.first_frames().into_iter().map(|first| middle(&rows, first) % rows.frames().max(1)).collect();
    let plan_columns = columns
        .first_frames()
        .into_iter()
        .filter_map(|first| places.get(middle(&columns, first)).copied())
        .collect();
    clock.stage("reconstruction");
    let quality = Quality::of(&source, &clip, &layout, (&features, &columns), (&drawn, &rows), options)?;
    let heard = control.heard.as_ref().map(|heard| -> Result<SoundFit, AlignError> {
        let plain = Control { features: heard.plain.clone(), ..control.clone() };
        let pair = (&at_rate(&plain, options).0, &rows);
        let unsmoothed = Quality::of(&source, &clip, &layout, (&features, &columns), pair, options)?;
        let moving = SoundFit::of((&clip, source.clip()), layout.travel_joint(), heard, control.rate)?;
        Ok(SoundFit { structure_pearson_unsmoothed: unsmoothed.structure_pearson, ..moving })
    });
    let sound = heard.transpose()?;
    let keys = keys.met((&source, &clip), &layout, (&features, &columns), (&drawn, &rows), options)?;
    clock.stage("measuring");
    let mut report = Report {
        structure_pearson: quality.structure_pearson,
        structure_spearman: quality.structure_spearman,
        structure_pearson_warp: quality.structure_pearson_warp,
        nearest_patch: quality.nearest_patch,
        coverage: quality.coverage,
        speed_mean_ratio: quality.speed_mean_ratio,
        jump_q999_ratio: quality.jump_q999_ratio,
        jerk_ratio: quality.jerk_ratio,
        freeze: quality.freeze,
        freeze_source: quality.freeze_source,
        loop_seam_ratio: quality.loop_seam_ratio,
        mirror_symmetry: buffers.first.symmetry.take().unwrap_or(0.0),
        sound,
        gradients: matching.gradients,
        solve_seconds,
        total_seconds: clock.total(),
        source_frames: columns.frames(),
        control_frames: rows.frames(),
        rest_pose_frames: lead_ins.iter().sum(),
        feature_energy: reduced.energy,
        measured_patches: sampled::sample(&rows, &columns),
        solver: matching.solver,
        instruction_set: Isa::current().name(),
        notes: Vec::new(),
        keys,
        stages: clock.stages,
        levels: matching.levels,
    };
    report.notes = notes(&report, options, (&drawn, &rows), &columns);
    let plan = matching.plan;
    Ok(Alignment {
        clip,
        source,
        plan,
        plan_rows,
        plan_columns,
        best_source,
        confidence,
        used,
        lead_ins,
        report,
    })
}

/// Wall time of the stages of a run.
struct Clock {
    begin: Instant,
    stages: Vec<StageRow>,
}

impl Clock {
    fn start() -> Self {
        Self { begin: Instant::now(), stages: Vec::new() }
    }

    /// Ends a stage that began where the one before it ended.
    fn stage(&mut self, name: &'static str) {
        let before: f64 = self.stages.iter().map(|stage| stage.seconds).sum();
        self.stages.push(StageRow { name, seconds: self.total() - before });
    }

    /// Seconds of the stages after a named one.
    fn since(&self, name: &str) -> f64 {
        let after = self.stages.iter().skip_while(|stage| stage.name != name).skip(1);
        after.map(|stage| stage.seconds).sum()
    }

    fn total(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }
}

pub(crate) fn table(features: &Features) -> Result<MatRef<'_, f32>, AlignError> {
    Ok(MatRef::new(features.as_slice(), features.frames(), features.width())?)
}

/// The takes without the calibration poses at their beginnings, and how many frames of each that left out.
pub(crate) fn without_lead_ins(takes: &Takes) -> Result<(Takes, Vec<usize>), AlignError> {
    let mut left_out = Vec::with_capacity(takes.count());
    let mut kept = Vec::with_capacity(takes.count());
    for range in takes.ranges() {
        let take = time::trim(takes.clip(), range)?;
        let lead_in = lead_in::rest_pose_frames(&take);
        left_out.push(lead_in);
        kept.push(time::trim(&take, lead_in..take.frames())?);
    }
    Ok((Takes::join(&kept)?, left_out))
}

/// The control's rows at the matching rate, and its layout.
pub(crate) fn at_rate(control: &Control, options: &Options) -> (Mat<f32>, Layout) {
    let features = &control.features;
    let layout = |frames| {
        if control.cyclic {
            Layout::cyclic(frames, options.patch())
        } else {
            Layout::open(frames, options.patch())
        }
    };
    let (from, to) = (layout(features.frames()), layout(control.frames(options.matching_rate)));
    let mut table =
        Mat::from_fn(features.frames(), features.width(), |row, column| features.row(row)[column]);
    close_loop(&from, &mut table);
    let mut out = Mat::zeros(0, 0);
    resample_frames(table.view(), &from, &to, &mut out);
    (out, to)
}

/// Says what is too short or too long before anything is made of that length.
pub(crate) fn check_lengths(source: &Takes, control: &Control, options: &Options) -> Result<(), AlignError> {
    check_clip(source, options)?;
    check_control(source, control, options)
}

/// The same of a control, for a clip that was found good.
pub(crate) fn check_control(source: &Takes, control: &Control, options: &Options) -> Result<(), AlignError> {
    let (patch, rate, clip_rate) = (options.patch(), options.matching_rate, source.clip().frame_rate());
    let (needed, frames) = (2 * patch, control.frames(rate));
    if frames < needed {
        return Err(AlignError::ControlTooShort { frames, patch, needed });
    }
    let most = options.solver.most_frames();
    if frames > most {
        return Err(AlignError::TooLong { what: "the control", frames, most, cut: "--length" });
    }
    let cells = (frames as f64 * clip_rate / rate) * source.clip().skeleton().len() as f64;
    if cells > MOST_CELLS {
        return Err(AlignError::TooFine { rate: clip_rate, joints: source.clip().skeleton().len() });
    }
    Ok(())
}
