//! The algorithm itself (MAMM Alg. 1): a first plan from structure alone at the coarsest level, then rounds of
//! matching and blending at every level, each starting from the motion of the level before.

use crate::blend::{Window, frame_weights};
use crate::keys::{Keys, LevelKeys};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::progress::{self, Observer, Progress};
use crate::pyramid::{close_loop, level_lengths, resample_frames};
use crate::{AlignError, Layout, Norm, Options};
use inkrig_transport::{
    Mat, MatRef, MmSinkhorn, Params, Plan, Problem, Start, Workspace, matmul, matmul_transposed, row_softmax,
};
use serde::Serialize;
use std::time::Instant;

/// Temperature of the polish steps, in units of the mean patch distance.
const POLISH_TEMPERATURE: f64 = 0.02;

/// Buffers of a run, kept for the next one.
#[derive(Debug)]
pub struct Buffers {
    transport: Workspace<f32>,
    scratch: PatchScratch<f32>,
    source: Mat<f32>,
    control: Mat<f32>,
    blended: Mat<f32>,
    coarser: Mat<f32>,
    source_distances: Mat<f32>,
    control_distances: Mat<f32>,
    cost: Mat<f32>,
    weights: Mat<f32>,
}

impl Buffers {
    /// Empty buffers for `threads` threads; they grow as needed.
    pub fn new(threads: usize) -> Self {
        let empty = || Mat::zeros(0, 0);
        Self {
            transport: Workspace::new(threads),
            scratch: PatchScratch::new(),
            source: empty(),
            control: empty(),
            blended: empty(),
            coarser: empty(),
            source_distances: empty(),
            control_distances: empty(),
            cost: empty(),
            weights: empty(),
        }
    }

    /// The blended motion of the plan in the workspace.
    fn blend(&mut self, layouts: (&Layout, &Layout), threads: usize) -> Result<(), AlignError> {
        let Self { transport, source, weights, blended, .. } = self;
        blend(transport.plan().dense(), layouts, source, weights, blended, threads)
    }

    /// Scales the control's distances by the factor that minimises the Gromov-Wasserstein term at the plan in the
    /// workspace: sum of Dy (T Dx T^T) over sum of Dy^2 p p^T. Held within a factor of 4 of where it was, since a bad
    /// plan can ask for anything.
    fn learn_scale(&mut self, threads: usize) -> Result<(), AlignError> {
        let plan = self.transport.plan().dense();
        let (mut moved, mut carried) = (Mat::default(), Mat::default());
        matmul(plan, self.source_distances.view(), &mut moved, threads)?;
        matmul_transposed(moved.view(), plan, &mut carried, threads)?;
        let mass = 1.0 / (plan.rows() as f64).powi(2);
        let (mut both, mut own) = (0.0, 0.0);
        for (&control, &carried) in self.control_distances.as_slice().iter().zip(carried.as_slice()) {
            both += f64::from(control) * f64::from(carried);
            own += f64::from(control).powi(2) * mass;
        }
        let factor = (both / own).clamp(0.25, 4.0) as f32;
        if factor.is_finite() {
            self.control_distances.as_mut_slice().iter_mut().for_each(|distance| *distance *= factor);
        }
        Ok(())
    }
}

/// The motion that a plan makes of the source's frames, with the rows of the control's layout.
fn blend(
    plan: MatRef<'_, f32>,
    (rows, columns): (&Layout, &Layout),
    source: &Mat<f32>,
    weights: &mut Mat<f32>,
    blended: &mut Mat<f32>,
    threads: usize,
) -> Result<(), AlignError> {
    frame_weights(plan, (rows, columns), Window::Box, weights);
    matmul(weights.view(), source.view(), blended, threads)?;
    close_loop(rows, blended);
    Ok(())
}

/// What one level did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelRow {
    /// 1 is the coarsest.
    pub level: usize,
    /// Frames of the control.
    pub control_frames: usize,
    /// Frames of the source.
    pub source_frames: usize,
    /// Gradients taken.
    pub gradients: usize,
    /// Seconds of wall time.
    pub seconds: f64,
}

/// The solution at the finest level.
#[derive(Debug, Clone)]
pub struct Matching {
    /// Plan between control patches (N rows of mass 1/N) and source patches (M columns), after polish.
    pub plan: Plan<f32>,
    /// control frames x source frames, rows sum to 1: which source frames an output frame is made of.
    pub weights: Mat<f32>,
    /// One row a level.
    pub levels: Vec<LevelRow>,
    /// Gradients taken in all.
    pub gradients: usize,
}

/// A table of frames and where its patches stand.
#[derive(Debug, Clone, Copy)]
pub struct Frames<'a> {
    /// One row a frame, as many as [`Layout::rows`] says.
    pub table: MatRef<'a, f32>,
    /// The clips, or the loop, that the frames are.
    pub layout: &'a Layout,
}

/// Matches the frames of a control with those of a source at the same rate. Lengths and options are checked by the
/// caller: both have more frames than a patch.
///
/// # Errors
/// When nothing moves in the source or the control, the solver refuses, or the observer cancels.
pub fn solve(
    source: Frames<'_>,
    control: Frames<'_>,
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Matching, AlignError> {
    let threads = options.threads;
    let source_layouts = level_layouts(source.layout, options);
    let control_layouts = level_layouts(control.layout, options);
    let total = options.gradients();
    let (mut gradients, mut levels) = (0, Vec::with_capacity(options.levels));
    let (mut scale, mut asked) = (1.0, LevelKeys::default());
    for (level, (columns, rows)) in source_layouts.iter().zip(&control_layouts).enumerate() {
        let begin = Instant::now();
        let before = gradients;
        let b = &mut *buffers;
        resample_frames(source.table, source.layout, columns, &mut b.source);
        resample_frames(control.table, control.layout, rows, &mut b.control);
        scale = normalised_self_distances(
            b.source.view(),
            columns,
            options.source_norm,
            &mut b.scratch,
            &mut b.source_distances,
            threads,
        )?
        .ok_or(AlignError::StillClip)?;
        let control_scale = normalised_self_distances(
            b.control.view(),
            rows,
            options.control_norm,
            &mut b.scratch,
            &mut b.control_distances,
            threads,
        )?
        .ok_or(AlignError::StillControl)?;
        asked = keys.at_level(
            (control.layout, source.layout),
            (rows, columns),
            b.source_distances.view(),
            (b.control.view(), control_scale),
            b.control_distances.view(),
        )?;
        let bias = |alpha| asked.cost(b.source_distances.view(), rows.patches(), alpha);
        let (first_bias, bias) = (bias(1.0), bias(options.alpha));
        let weights = |alpha| Params { alpha, lambda: options.lambda, epsilon: options.epsilon };
        let tell = |done| Progress { level: level + 1, levels: options.levels, done, total };
        if level == 0 {
            let structure = Problem::new_unchecked_values(
                b.control_distances.view(),
                b.source_distances.view(),
                None,
                weights(1.0),
            )?;
            let structure = asked.bind(structure, first_bias.as_ref())?;
            gradients += first_plan(&structure, options, &mut b.transport, |done| {
                progress::report(observer, tell(done))
            })?;
            b.blend((rows, columns), threads)?;
        } else {
            std::mem::swap(&mut b.blended, &mut b.coarser);
            resample_frames(b.coarser.view(), &control_layouts[level - 1], rows, &mut b.blended);
        }
        progress::report(observer, tell(gradients))?;
        for round in 0..options.rounds {
            let (motion, clip) = ((b.blended.view(), rows), (b.source.view(), columns));
            patch_distances(motion, clip, scale, &mut b.scratch, &mut b.cost, threads)?;
            let problem = Problem::new_unchecked_values(
                b.control_distances.view(),
                b.source_distances.view(),
                Some(b.cost.view()),
                weights(options.alpha),
            )?;
            let problem = asked.bind(problem, bias.as_ref())?;
            let first = level > 0 && round == 0;
            let start = if first { Start::Perturbed(options.seed) } else { Start::Continue };
            let solver = MmSinkhorn { iterations: options.iterations, start, ..MmSinkhorn::default() };
            solver.solve(&problem, &mut b.transport)?;
            gradients += options.iterations;
            b.blend((rows, columns), threads)?;
            if options.control_norm == Norm::Learned {
                b.learn_scale(threads)?;
            }
            progress::report(observer, tell(gradients))?;
        }
        levels.push(LevelRow {
            level: level + 1,
            control_frames: rows.frames(),
            source_frames: columns.frames(),
            gradients: gradients - before,
            seconds: begin.elapsed().as_secs_f64(),
        });
    }
    let plan = polish((control.layout, source.layout), scale, &asked, options, buffers, || {
        progress::report(
            observer,
            Progress { level: options.levels, levels: options.levels, done: total, total },
        )
    })?;
    frame_weights(plan.dense(), (control.layout, source.layout), Window::Hann, &mut buffers.weights);
    Ok(Matching { plan, weights: std::mem::take(&mut buffers.weights), levels, gradients })
}

/// The layouts of all levels, coarsest first. The longest clip keeps at least five patches' length, or its own.
fn level_layouts(layout: &Layout, options: &Options) -> Vec<Layout> {
    let (full, floor) = (layout.frames(), 5 * options.patch());
    let longest = layout.parts().iter().map(std::ops::Range::len).max().unwrap_or(full).max(1);
    let floor = (floor as f64 * full as f64 / longest as f64).ceil() as usize;
    let lengths = level_lengths(full, options.levels, options.ratio, floor);
    lengths.into_iter().map(|length| layout.resampled(length)).collect()
}

/// Solves the first problem, structure alone, and leaves the plan in the workspace; returns the gradients taken. The
/// independent plan is close to a saddle of the objective, and which way a run leaves it is chance: several starts
/// are scouted, the best goes on.
fn first_plan(
    problem: &Problem<'_, f32>,
    options: &Options,
    transport: &mut Workspace<f32>,
    mut tell: impl FnMut(usize) -> Result<(), AlignError>,
) -> Result<usize, AlignError> {
    let starts = options.starts as u64;
    let mut best: Option<(f64, Plan<f32>)> = None;
    for number in 0..starts {
        // Seed 0 is the independent plan itself; other seeds look elsewhere.
        let start = Start::Perturbed(options.seed.wrapping_mul(starts).wrapping_add(number));
        let scout =
            MmSinkhorn { iterations: options.scouting, start, trace: usize::MAX, ..MmSinkhorn::default() };
        let trace = scout.solve(problem, transport)?;
        let objective = trace.last().map_or(f64::INFINITY, |terms| terms.objective);
        if best.as_ref().is_none_or(|(least, _)| objective < *least) {
            best = Some((objective, transport.take_plan()));
        }
        tell((number as usize + 1) * options.scouting)?;
    }
    if let Some((_, plan)) = best {
        transport.resume(&plan);
    }
    let iterations = options.first_iterations;
    MmSinkhorn { iterations, start: Start::Continue, ..MmSinkhorn::default() }.solve(problem, transport)?;
    Ok(options.starts * options.scouting + iterations)
}

/// Match-and-blend steps that look only at nearness: every output patch is drawn to the source patches that it is
/// most like, which takes out what averaging has blurred.
fn polish(
    (rows, columns): (&Layout, &Layout),
    scale: f32,
    asked: &LevelKeys,
    options: &Options,
    buffers: &mut Buffers,
    mut go_on: impl FnMut() -> Result<(), AlignError>,
) -> Result<Plan<f32>, AlignError> {
    let b = buffers;
    let mut plan = b.transport.take_plan();
    let layouts = (rows, columns);
    for _ in 0..options.polish {
        go_on()?;
        let (motion, clip) = ((b.blended.view(), rows), (b.source.view(), columns));
        patch_distances(motion, clip, scale, &mut b.scratch, &mut b.cost, options.threads)?;
        let mut nearest = plan.into_mat();
        row_softmax(b.cost.view(), POLISH_TEMPERATURE, &mut nearest)?;
        let mass = 1.0 / nearest.rows() as f32;
        nearest.as_mut_slice().iter_mut().for_each(|value| *value *= mass);
        asked.impose(&mut nearest, b.cost.view());
        plan = Plan::from_mat(nearest);
        blend(plan.dense(), layouts, &b.source, &mut b.weights, &mut b.blended, options.threads)?;
    }
    Ok(plan)
}
