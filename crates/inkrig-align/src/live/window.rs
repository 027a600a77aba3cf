//! The end of a stream that is looked at, and the plan for it.

use super::stream::StreamOptions;
use crate::blend;
use crate::coarse_to_fine::{Buffers, Frames, LevelTable, Prepared, solve_prepared};
use crate::keys::{Keys, LevelKeys};
use crate::level::Level;
use crate::patches::{PatchScratch, normalise, patch_distances};
use crate::polish::polish;
use crate::reconstruct::{SparseRow, kept};
use crate::{AlignError, Layout, Norm};
use inkrig_transport::{Mat, MatRef, Plan, Start, matmul};
use std::ops::ControlFlow;

/// How much of the size that distances are measured by is kept from hop to hop: a control that rests for a moment does
/// not make its tremble a dance.
const KEEP: f64 = 0.995;

/// The frame of the source in which the body waits for a control that has not moved yet.
const WAITING: usize = 0;

/// The last samples, and what was made of them.
#[derive(Debug)]
pub(super) struct Window {
    /// Samples, oldest first.
    samples: Vec<f32>,
    /// The first sample ever: values are taken from there, so that their digits go to what differs.
    origin: Vec<f32>,
    /// Number of the oldest sample.
    first: usize,
    /// Samples whose rows were given out, counted from the stream's beginning.
    given: usize,
    /// For every sample of the window, its frames' weights: what was given out, then what is foreseen.
    foreseen: Vec<Vec<f32>>,
    /// Plan of the window's patches; none before the first solve.
    plan: Mat<f32>,
    /// The mean distance that counts as one.
    size: f64,
    buffers: Buffers,
}

impl Window {
    pub(super) fn new(options: &StreamOptions) -> Self {
        Self {
            samples: Vec::new(),
            origin: Vec::new(),
            first: 0,
            given: 0,
            foreseen: Vec::new(),
            plan: Mat::default(),
            size: 0.0,
            buffers: Buffers::new(options.align.threads),
        }
    }

    pub(super) fn given(&self) -> usize {
        self.given
    }

    pub(super) fn samples(&self, width: usize) -> usize {
        self.samples.len() / width.max(1)
    }

    /// Takes samples in and returns the rows that are settled by them; at the stream's `end`, all.
    pub(super) fn take_in(
        &mut self,
        samples: &[f32],
        width: usize,
        source: &Prepared,
        options: &StreamOptions,
        end: bool,
    ) -> Result<Vec<SparseRow>, AlignError> {
        if self.origin.is_empty() {
            self.origin = samples.iter().copied().take(width).collect();
        }
        let origin = &self.origin;
        self.samples
            .extend(samples.chunks_exact(width).flat_map(|row| row.iter().zip(origin).map(|(v, o)| v - o)));
        let count = self.samples.len() / width.max(1);
        let begun = self.plan.rows() > 0;
        if !begun && (count < options.warm_up && !end) {
            return Ok(Vec::new());
        }
        if !begun {
            match self.begin(width, source, options) {
                // Nothing has moved yet: what is older than the window will not matter.
                Err(AlignError::StillControl) if !end => return Ok(self.rest(width, options)),
                other => other?,
            }
        } else if !samples.is_empty() {
            self.go_on(width, source, options)?;
        }
        let total = self.first + self.foreseen.len();
        let settled = if end { total } else { total.saturating_sub(options.look_ahead) };
        let rows = self.foreseen[self.given - self.first..settled.max(self.given) - self.first].iter();
        let rows = rows.map(|row| kept(row)).collect();
        self.given = self.given.max(settled);
        Ok(rows)
    }

    /// Holds no more than a window of a control that has not moved yet. For what is older the body waits in the clip's
    /// first pose.
    fn rest(&mut self, width: usize, options: &StreamOptions) -> Vec<SparseRow> {
        let count = self.samples.len() / width;
        let old = count.saturating_sub(options.window.max(options.warm_up));
        self.samples.drain(..old * width);
        self.first += old;
        self.given = self.first;
        vec![vec![(WAITING, 1.0)]; old]
    }

    /// The first solve, coarse to fine.
    fn begin(&mut self, width: usize, source: &Prepared, options: &StreamOptions) -> Result<(), AlignError> {
        let align = &options.align;
        let (frames, patch) = (self.samples.len() / width.max(1), align.patch());
        let needed = 2 * patch;
        if frames < needed {
            return Err(AlignError::ControlTooShort { frames, patch, needed });
        }
        let layout = Layout::open(frames, patch);
        let table = MatRef::new(&self.samples, frames, width)?;
        let control = Prepared::control(Frames { table, layout: &layout }, align)?;
        let go_on = &mut |_| ControlFlow::Continue(());
        let matching = solve_prepared(source, &control, &Keys::default(), align, &mut self.buffers, go_on)?;
        self.size = control.levels().last().map_or(0.0, |level| 1.0 / f64::from(level.scale));
        self.plan = matching.plan.into_mat();
        self.foreseen = (0..frames).map(|frame| matching.weights.full_row(frame)).collect();
        if self.first > 0 {
            // From the pose of waiting into the motion.
            for (frame, weights) in self.foreseen.iter_mut().enumerate() {
                let share = rising(frame, 2 * options.look_ahead);
                weights.iter_mut().for_each(|weight| *weight *= share);
                if let Some(weight) = weights.get_mut(WAITING) {
                    *weight += 1.0 - share;
                }
            }
        }
        Ok(())
    }

    /// A solve that goes on from the last one. Plan and motion of what was given out stay as they were.
    fn go_on(&mut self, width: usize, source: &Prepared, options: &StreamOptions) -> Result<(), AlignError> {
        let Some(source) = source.levels().last() else { return Ok(()) };
        let align = &options.align;
        let patch = align.patch();
        self.drop_old(width, options);
        let frames = self.samples.len() / width;
        let table = MatRef::new(&self.samples, frames, width)?;
        let control = distances(table, patch, &mut self.size, align)?;
        let known = self.foreseen.len();
        self.continue_plan(&control.layout, &source.layout);
        let start = self.plan.clone();
        let given = self.given - self.first;
        let settled = (given + 1).saturating_sub(patch).min(start.rows());
        let level = Level { source, control: &control, asked: LevelKeys::default() };
        let b = &mut self.buffers;
        // The motion to begin with: what was given out and foreseen, and what the plan's going on makes of the rest.
        blend::frame_weights(
            start.view(),
            level.layouts(),
            blend::Window::Hann,
            &mut b.weights,
            align.threads,
        );
        for (row, weights) in self.foreseen.iter().enumerate() {
            b.weights.row_mut(row).copy_from_slice(weights);
        }
        matmul(b.weights.view(), source.frames.view(), &mut b.blended, align.threads)?;
        let past = b.blended.as_slice()[..given * b.blended.cols()].to_vec();
        let one = crate::Options { rounds: 1, ..align.clone() };
        b.transport.resume(&Plan::from_mat(start.clone()));
        for _ in 0..options.rounds {
            level.rounds(Start::Continue, &one, b, |_| Ok(()))?;
            let mut plan = b.transport.take_plan().into_mat();
            keep_rows(&mut plan, &start, settled);
            b.transport.resume(&Plan::from_mat(plan));
            b.blended.as_mut_slice()[..past.len()].copy_from_slice(&past);
        }
        self.plan = b.transport.plan().dense().to_mat();
        let polished = polish(&level, align, b, || Ok(()))?.into_mat();
        blend::frame_weights(
            polished.view(),
            level.layouts(),
            blend::Window::Hann,
            &mut b.weights,
            align.threads,
        );
        self.take_over(known, given, options);
        Ok(())
    }

    /// Lets go of samples that are older than the window and were given out.
    fn drop_old(&mut self, width: usize, options: &StreamOptions) {
        let frames = self.samples.len() / width;
        let old = frames.saturating_sub(options.window).min(self.given - self.first);
        self.samples.drain(..old * width);
        self.foreseen.drain(..old.min(self.foreseen.len()));
        self.first += old;
        let (rows, columns) = (self.plan.rows(), self.plan.cols());
        let kept = self.plan.as_slice()[(old.min(rows) * columns)..].to_vec();
        self.plan = Mat::from_vec(rows - old.min(rows), columns, kept).unwrap_or_default();
    }

    /// Rows for patches that are new: the clip plays on from where the last row is. All rows have their share of mass.
    fn continue_plan(&mut self, rows: &Layout, columns: &Layout) {
        let count = rows.patches();
        let mut plan = Mat::zeros(count, self.plan.cols());
        let mass = 1.0 / count as f32;
        for row in 0..count {
            if row < self.plan.rows() {
                plan.row_mut(row).copy_from_slice(self.plan.row(row));
            } else if row > 0 {
                let before = plan.row(row - 1).to_vec();
                let next = plan.row_mut(row);
                for run in columns.runs() {
                    let (from, to) = (run.patch, run.patch + run.count);
                    next[from + 1..to].copy_from_slice(&before[from..to - 1]);
                    // A clip's last patch has none after it.
                    next[to - 1] += before[to - 1];
                }
            }
            let row = plan.row_mut(row);
            let total: f32 = row.iter().sum();
            row.iter_mut().for_each(|value| *value *= mass / total);
        }
        self.plan = plan;
    }

    /// New weights take over from those foreseen before: nothing where the last piece ended, all where the control ends.
    fn take_over(&mut self, known: usize, given: usize, options: &StreamOptions) {
        let weights = &self.buffers.weights;
        for frame in given..weights.rows() {
            let new = weights.row(frame);
            if frame >= known {
                self.foreseen.push(new.to_vec());
                continue;
            }
            let share = rising(frame - given, options.look_ahead);
            let old = self.foreseen[frame].iter_mut();
            old.zip(new).for_each(|(old, &new)| *old += share * (new - *old));
        }
    }
}

/// From none to all over the look-ahead, smooth.
fn rising(frame: usize, look_ahead: usize) -> f32 {
    let place = ((frame + 1) as f32 / (look_ahead + 1) as f32).min(1.0);
    place.powi(2) * (3.0 - 2.0 * place)
}

/// The window as one level; what counts as one is the largest mean of late.
fn distances(
    table: MatRef<'_, f32>,
    patch: usize,
    size: &mut f64,
    options: &crate::Options,
) -> Result<LevelTable, AlignError> {
    let layout = Layout::open(table.rows(), patch);
    let (mut scratch, mut distances) = (PatchScratch::new(), Mat::default());
    patch_distances((table, &layout), (table, &layout), 1.0, &mut scratch, &mut distances, options.threads)?;
    (0..distances.rows()).for_each(|row| distances.row_mut(row)[row] = 0.0);
    let norm = if options.control_norm == Norm::Learned { Norm::Mean } else { options.control_norm };
    let squares = (0..table.rows()).map(|row| table.row(row).iter().map(|v| v * v).sum::<f32>());
    let found = normalise(&mut distances, norm, squares);
    let now = found.map_or(0.0, |scale| 1.0 / f64::from(scale));
    *size = now.max(KEEP * *size);
    let scale = (1.0 / *size) as f32;
    // Without a scale of its own the window rests: its distances are as they are.
    let factor = found.map_or(scale, |found| scale / found);
    distances.as_mut_slice().iter_mut().for_each(|distance| *distance *= factor);
    Ok(LevelTable { layout, frames: table.to_mat(), distances, scale, factors: None })
}

fn keep_rows(plan: &mut Mat<f32>, from: &Mat<f32>, count: usize) {
    let values = count * plan.cols();
    plan.as_mut_slice()[..values].copy_from_slice(&from.as_slice()[..values]);
}
