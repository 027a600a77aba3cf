//! The algorithm itself (MAMM Alg. 1): a first plan from structure alone at the coarsest level, then rounds of
//! matching and blending at every level, each starting from the motion of the level before.

use crate::blend::{Window, frame_weights};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::progress::{self, Observer, Progress};
use crate::pyramid::{level_lengths, resample_rows};
use crate::{AlignError, Options};
use inkrig_transport::{
    Mat, MatRef, MmSinkhorn, Params, Plan, Problem, Start, Workspace, matmul, row_softmax,
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
    polished: Mat<f32>,
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
            polished: empty(),
            weights: empty(),
        }
    }
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

/// Matches the frames of a control (m x k) with those of a source (n x r) at the same rate. Lengths and options are
/// checked by the caller: both have more frames than a patch.
///
/// # Errors
/// When nothing moves in the source or the control, the solver refuses, or the observer cancels.
pub fn solve(
    source: MatRef<'_, f32>,
    control: MatRef<'_, f32>,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Matching, AlignError> {
    let (patch, threads) = (options.patch(), options.threads);
    let lengths = |full| level_lengths(full, options.levels, options.ratio, 5 * patch);
    let (source_lengths, control_lengths) = (lengths(source.rows()), lengths(control.rows()));
    let total = options.gradients();
    let (mut gradients, mut levels) = (0, Vec::with_capacity(options.levels));
    let mut scale = 1.0;
    for (level, (&n, &m)) in source_lengths.iter().zip(&control_lengths).enumerate() {
        let begin = Instant::now();
        let before = gradients;
        let b = &mut *buffers;
        resample_rows(source, n, &mut b.source);
        resample_rows(control, m, &mut b.control);
        scale = normalised_self_distances(
            b.source.view(),
            patch,
            &mut b.scratch,
            &mut b.source_distances,
            threads,
        )?
        .ok_or(AlignError::StillClip)?;
        normalised_self_distances(
            b.control.view(),
            patch,
            &mut b.scratch,
            &mut b.control_distances,
            threads,
        )?
        .ok_or(AlignError::StillControl)?;
        let weights = |alpha| Params { alpha, lambda: options.lambda, epsilon: options.epsilon };
        let tell = |done| Progress { level: level + 1, levels: options.levels, done, total };
        if level == 0 {
            let structure = Problem::new_unchecked_values(
                b.control_distances.view(),
                b.source_distances.view(),
                None,
                weights(1.0),
            )?;
            gradients += first_plan(&structure, options, &mut b.transport)?;
            blend(b.transport.plan().dense(), patch, &b.source, &mut b.weights, &mut b.blended, threads)?;
        } else {
            std::mem::swap(&mut b.blended, &mut b.coarser);
            resample_rows(b.coarser.view(), m, &mut b.blended);
        }
        progress::report(observer, tell(gradients))?;
        for round in 0..options.rounds {
            let (out, scratch) = (&mut b.cost, &mut b.scratch);
            patch_distances(b.blended.view(), b.source.view(), patch, scale, scratch, out, threads)?;
            let problem = Problem::new_unchecked_values(
                b.control_distances.view(),
                b.source_distances.view(),
                Some(b.cost.view()),
                weights(options.alpha),
            )?;
            let first = level > 0 && round == 0;
            let start = if first { Start::Perturbed(options.seed) } else { Start::Continue };
            let solver = MmSinkhorn { iterations: options.iterations, start, ..MmSinkhorn::default() };
            solver.solve(&problem, &mut b.transport)?;
            gradients += options.iterations;
            blend(b.transport.plan().dense(), patch, &b.source, &mut b.weights, &mut b.blended, threads)?;
            progress::report(observer, tell(gradients))?;
        }
        levels.push(LevelRow {
            level: level + 1,
            control_frames: m,
            source_frames: n,
            gradients: gradients - before,
            seconds: begin.elapsed().as_secs_f64(),
        });
    }
    let plan = polish(options, scale, buffers)?;
    frame_weights(plan.dense(), patch, Window::Hann, &mut buffers.weights);
    Ok(Matching { plan, weights: std::mem::take(&mut buffers.weights), levels, gradients })
}

/// Solves the first problem, structure alone, and leaves the plan in the workspace; returns the gradients taken. The
/// independent plan is close to a saddle of the objective, and which way a run leaves it is chance: several starts
/// are scouted, the best goes on.
fn first_plan(
    problem: &Problem<'_, f32>,
    options: &Options,
    transport: &mut Workspace<f32>,
) -> Result<usize, AlignError> {
    let starts = options.starts as u64;
    let mut best: Option<(f64, Plan<f32>)> = None;
    for start in 0..starts {
        // Seed 0 is the independent plan itself; other seeds look elsewhere.
        let start = Start::Perturbed(options.seed.wrapping_mul(starts).wrapping_add(start));
        let scout =
            MmSinkhorn { iterations: options.scouting, start, trace: usize::MAX, ..MmSinkhorn::default() };
        let trace = scout.solve(problem, transport)?;
        let objective = trace.last().map_or(f64::INFINITY, |terms| terms.objective);
        if best.as_ref().is_none_or(|(least, _)| objective < *least) {
            best = Some((objective, transport.take_plan()));
        }
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
fn polish(options: &Options, scale: f32, buffers: &mut Buffers) -> Result<Plan<f32>, AlignError> {
    let (patch, threads) = (options.patch(), options.threads);
    let b = buffers;
    if options.polish == 0 {
        return Ok(b.transport.take_plan());
    }
    for _ in 0..options.polish {
        patch_distances(
            b.blended.view(),
            b.source.view(),
            patch,
            scale,
            &mut b.scratch,
            &mut b.cost,
            threads,
        )?;
        row_softmax(b.cost.view(), POLISH_TEMPERATURE, &mut b.polished)?;
        let mass = 1.0 / b.polished.rows() as f32;
        b.polished.as_mut_slice().iter_mut().for_each(|value| *value *= mass);
        blend(b.polished.view(), patch, &b.source, &mut b.weights, &mut b.blended, threads)?;
    }
    Ok(Plan::from_mat(std::mem::take(&mut b.polished)))
}

fn blend(
    plan: MatRef<'_, f32>,
    patch: usize,
    source: &Mat<f32>,
    weights: &mut Mat<f32>,
    blended: &mut Mat<f32>,
    threads: usize,
) -> Result<(), AlignError> {
    frame_weights(plan, patch, Window::Box, weights);
    Ok(matmul(weights.view(), source.view(), blended, threads)?)
}
