//! Long inputs: the algorithm of [`coarse_to_fine`](crate::coarse_to_fine) without any table of control x source, control
//! x control or source x source beyond the coarse levels.
//!
//! Coarse levels have plans of all entries. Every finer one has a sparse plan, and distances by factors: it begins with what
//! the coarser plan suggests; then its support is chosen anew by the gradient at all entries, which is looked at a block of
//! rows at a time, so that it may leave what the coarser level thought of.

mod nearest;
mod refine;
mod side;
mod sparse_level;

use crate::blend::Window;
use crate::coarse_to_fine::{Buffers, Full, LevelRow, Matching, full_levels};
use crate::keys::Keys;
use crate::prepared::Prepared;
use crate::progress::{self, Observer, Progress};
use crate::pyramid::resample_frames;
use crate::solver::{Levels, Pair};
use crate::{AlignError, FrameWeights, Frames, Layout, Options, SolverRow};
use inkrig_transport::{Mat, SparseWorkspace, Support};
use refine::refine;
use sparse_level::{Found, SparseLevel};
use std::time::Instant;

/// Matches the frames of a control with those of a source at the given levels, the last of which have sparse plans.
pub(crate) fn solve(
    source: Frames<'_>,
    control: Frames<'_>,
    levels: &Levels,
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    observer: Observer<'_>,
) -> Result<Matching, AlignError> {
    if let (true, Some(pair)) = (keys.forbid(), levels.sparse.last()) {
        // What cannot be met in full is said before any work.
        SparseLevel::new(source, control, pair, keys, options)?;
    }
    let (count, total) = (levels.count(), levels.gradients(options));
    let mut tell = |level, done| progress::report(observer, Progress { level, levels: count, done, total });
    let (mut found, mut layouts, mut rows, mut gradients) =
        coarse(source, control, &levels.full, keys, options, buffers, &mut tell)?;
    let mut workspace = SparseWorkspace::new(options.threads);
    let mut finest = None;
    for (index, pair) in (levels.full.len() + 1..).zip(&levels.sparse) {
        let begin = Instant::now();
        let level = SparseLevel::new(source, control, pair, keys, options)?;
        let fine = level.layouts();
        let mut motion = Mat::default();
        resample_frames(found.motion.view(), &layouts.0, fine.0, &mut motion);
        let plan = refine(&found.plan, (&layouts.0, &layouts.1), fine, level.taken_over())?;
        let before = gradients;
        found = level.rounds(Found { plan, motion }, &mut workspace, |done| tell(index, before + done))?;
        gradients += options.rounds * options.iterations;
        rows.push(LevelRow {
            level: index,
            control_frames: fine.0.frames(),
            source_frames: fine.1.frames(),
            gradients: gradients - before,
            seconds: begin.elapsed().as_secs_f64(),
        });
        layouts = pair.clone();
        finest = Some(level);
    }
    drop(workspace);
    let Some(level) = finest else { return Err(AlignError::NoCoarseLevel) };
    let solver = SolverRow {
        name: "sparse",
        ranks: level.ranks().map(Some),
        entries_per_row: found.plan.support().map_or(0, Support::len) / found.plan.rows().max(1),
    };
    let found = level.polish(found, || tell(count, total))?;
    let weights = FrameWeights::of_plan(&found.plan, level.layouts(), Window::Hann)?;
    let forbidden = level.forbidden_frames();
    Ok(Matching { plan: found.plan, weights, forbidden, solver, levels: rows, gradients })
}

/// The coarse levels: the last plan and its motion, its layouts, what was done, gradients taken.
fn coarse(
    source: Frames<'_>,
    control: Frames<'_>,
    levels: &[Pair],
    keys: &Keys,
    options: &Options,
    buffers: &mut Buffers,
    tell: &mut dyn FnMut(usize, usize) -> Result<(), AlignError>,
) -> Result<(Found, Pair, Vec<LevelRow>, usize), AlignError> {
    let (rows, columns): (Vec<Layout>, Vec<Layout>) = levels.iter().cloned().unzip();
    let clip = Prepared::at(source, &columns, options.source_norm, options)?.ok_or(AlignError::StillClip)?;
    let drawn =
        Prepared::at(control, &rows, options.control_norm, options)?.ok_or(AlignError::StillControl)?;
    let Full { level, levels, gradients } = full_levels(&clip, &drawn, keys, options, buffers, tell)?;
    let (rows, columns) = level.layouts();
    let found = Found { plan: buffers.transport.take_plan(), motion: std::mem::take(&mut buffers.blended) };
    let layouts = (rows.clone(), columns.clone());
    // Its tables are not needed any more, and are the largest there are.
    buffers.clear();
    Ok((found, layouts, levels, gradients))
}
