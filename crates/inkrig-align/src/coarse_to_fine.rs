//! The algorithm itself (MAMM Alg. 1): a first plan from structure alone at the coarsest level, then rounds of
//! matching and blending at every level, each starting from the motion of the level before.

use crate::blend::{Window, frame_weights};
use crate::explain::FirstPlans;
use crate::keys::Keys;
use crate::large;
use crate::level::Level;
use crate::patches::PatchScratch;
use crate::polish::polish;
pub use crate::prepared::{Frames, LevelTable, Prepared};
use crate::progress::{self, Observer, Progress};
use crate::pyramid::resample_frames;
use crate::solver::Levels;
use crate::{AlignError, FrameWeights, Options, SolverRow};
use inkrig_transport::{Mat, Plan, Start, Workspace, with_threads};
use serde::Serialize;
use std::time::Instant;

/// Buffers of a run, kept for the next one.
#[derive(Debug)]
pub struct Buffers {
    pub(crate) transport: Workspace<f32>,
    pub(crate) scouts: Vec<Workspace<f32>>,
    pub(crate) scratch: PatchScratch<f32>,
    pub(crate) blended: Mat<f32>,
    pub(crate) coarser: Mat<f32>,
    pub(crate) cost: Mat<f32>,
    pub(crate) weights: Mat<f32>,
    pub(crate) first: FirstPlans,
}

impl Buffers {
    /// Empty buffers for `threads` threads; they grow as needed.
    pub fn new(threads: usize) -> Self {
        Self {
            transport: Workspace::new(threads),
            scouts: Vec::new(),
            scratch: PatchScratch::new(),
            blended: Mat::default(),
            coarser: Mat::default(),
            cost: Mat::default(),
            weights: Mat::default(),
            first: FirstPlans::default(),
        }
    }
}

impl Buffers {
    /// Gives the memory of the last run back.
    pub(crate) fn clear(&mut self) {
        let first = std::mem::take(&mut self.first);
        *self = Self { first, ..Self::new(self.transport.threads()) };
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
    /// Which source frames an output frame is made of: control frames x source frames.
    pub weights: FrameWeights,
    /// What solved the finest level.
    pub solver: SolverRow,
    /// Source frames that may not appear, in ascending order.
    pub forbidden: Vec<usize>,
    /// One row a level.
    pub levels: Vec<LevelRow>,
    /// Gradients taken in all.
    pub gradients: usize,
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
    let levels = Levels::new((control.layout, source.layout), options)?;
    if !levels.sparse.is_empty() {
        return large::solve(source, control, &levels, keys, options, buffers, observer);
    }
    with_threads(options.threads, || {
        let source = Prepared::source(source, options)?;
        let control = Prepared::control(control, options)?;
        solve_prepared(&source, &control, keys, options, buffers, observer)
    })
}

/// As [`solve`], for sides that were prepared with the same options.
///
/// # Errors
/// As for [`solve`].
pub fn solve_prepared(
    source: &Prepared,
    control: &Prepared,
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Matching, AlignError> {
    with_threads(options.threads, || solve_levels(source, control, keys, options, buffers, observer))
}

fn solve_levels(
    source: &Prepared,
    control: &Prepared,
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Matching, AlignError> {
    let total = options.gradients();
    let count = source.levels().len().min(control.levels().len());
    let mut tell = |level, done| progress::report(observer, Progress { level, levels: count, done, total });
    let Full { level, levels, gradients } = full_levels(source, control, keys, options, buffers, &mut tell)?;
    let plan = polish(&level, options, buffers, || tell(count, total))?;
    frame_weights(plan.dense(), level.layouts(), Window::Hann, &mut buffers.weights, options.threads);
    let weights = FrameWeights::from_mat(buffers.weights.view())?;
    let ranks = [level.control, level.source].map(|side| side.factors.as_ref().map(|low| low.rank()));
    let name = if ranks == [None, None] { "dense" } else { "low_rank" };
    let solver = SolverRow { name, ranks, entries_per_row: plan.cols() };
    let forbidden = level.asked.forbidden_frames(level.layouts().1);
    Ok(Matching { plan, weights, forbidden, solver, levels, gradients })
}

/// Levels whose plans have all entries: the last plan is in the workspace, its motion in the buffers.
pub(crate) struct Full<'a> {
    /// The last of them.
    pub(crate) level: Level<'a>,
    pub(crate) levels: Vec<LevelRow>,
    pub(crate) gradients: usize,
}

/// Goes through all levels of two sides; `tell` hears the level, from 1, and the gradients done so far.
pub(crate) fn full_levels<'a>(
    source: &'a Prepared,
    control: &'a Prepared,
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    tell: &mut dyn FnMut(usize, usize) -> Result<(), AlignError>,
) -> Result<Full<'a>, AlignError> {
    let (mut gradients, mut levels) = (0, Vec::with_capacity(options.levels));
    let count = source.levels().len().min(control.levels().len());
    if keys.forbid() && count > 0 {
        // What cannot be met in full is said before any work.
        Level::new(source, control, count - 1, keys)?;
    }
    let mut level = Level::new(source, control, 0, keys)?;
    for index in 0..count {
        let begin = Instant::now();
        let before = gradients;
        let mut tell = |done| tell(index + 1, before + done);
        let b = &mut *buffers;
        let start = if index == 0 {
            gradients += level.begin(options, b, &mut tell)?;
            Start::Continue
        } else {
            let coarser = level.layouts().0;
            std::mem::swap(&mut b.blended, &mut b.coarser);
            let finer = &control.levels()[index].layout;
            resample_frames(b.coarser.view(), coarser, finer, &mut b.blended);
            level = Level::new(source, control, index, keys)?;
            Start::Perturbed(options.seed)
        };
        let first = gradients - before;
        tell(first)?;
        gradients += level.rounds(start, options, b, |done| tell(first + done))?;
        levels.push(LevelRow {
            level: index + 1,
            control_frames: level.control.layout.frames(),
            source_frames: level.source.layout.frames(),
            gradients: gradients - before,
            seconds: begin.elapsed().as_secs_f64(),
        });
    }
    Ok(Full { level, levels, gradients })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Layout;
    use std::ops::ControlFlow;

    #[test]
    fn a_prepared_source_serves_any_number_of_controls() {
        let options = Options { threads: 1, ..Options::default() };
        let wave = |frames: usize, speed: f32| {
            Mat::from_fn(frames, 2, |row, column| ((row + 40 * column) as f32 * speed).sin() * row as f32)
        };
        let (clip, layout) = (wave(140, 0.11), Layout::open(140, 11));
        let source = Frames { table: clip.view(), layout: &layout };
        let prepared = Prepared::source(source, &options).unwrap();
        let go_on = &mut |_| ControlFlow::Continue(());
        let mut used = Buffers::new(1);
        for (frames, speed) in [(120, 0.2), (90, 0.1), (120, 0.2)] {
            let (drawn, layout) = (wave(frames, speed), Layout::open(frames, 11));
            let control = Frames { table: drawn.view(), layout: &layout };
            let fresh =
                solve(source, control, &Keys::default(), &options, &mut Buffers::new(1), go_on).unwrap();
            let control = Prepared::control(control, &options).unwrap();
            let again =
                solve_prepared(&prepared, &control, &Keys::default(), &options, &mut used, go_on).unwrap();
            assert_eq!((fresh.plan, fresh.weights), (again.plan, again.weights));
        }
    }
}
