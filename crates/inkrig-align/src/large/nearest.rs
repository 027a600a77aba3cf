//! Looking for the source patches that a row of a plan needs, over all of the source, a block of rows at a time.

use super::side::Side;
use crate::keys::{LevelKeys, Moved};
use crate::layout::Run;
use crate::patches::{PatchScratch, patch_distances};
use crate::{AlignError, Layout};
use inkrig_transport::{GradientRows, Mat, MatRef, Search, Support};

/// What makes a source patch a good one for an output patch: the less, the better.
pub(crate) struct Scores<'a> {
    /// The motion so far, in the rows of the control's layout.
    pub(crate) motion: &'a Mat<f32>,
    /// Where it has its patches.
    pub(crate) rows: &'a Layout,
    pub(crate) source: &'a Side,
    /// What the distance between them counts.
    pub(crate) weight: f32,
    /// What the solver would have, and the weight of structure for what keys cost; without it they cost nothing.
    pub(crate) gradient: Option<(&'a GradientRows<'a, f32>, f64)>,
    pub(crate) asked: &'a LevelKeys,
    /// Rows that are matched from elsewhere.
    pub(crate) moved: &'a Moved,
}

impl Scores<'_> {
    /// The support of the least scores. Closed columns have no entry, settled rows have their own.
    pub(crate) fn search(&self, search: Search) -> Result<Support, AlignError> {
        let columns = self.source.layout.patches();
        let runs: Vec<Run> = self.rows.runs().collect();
        Ok(search.run(self.rows.patches(), columns, |first, out: &mut [f32]| {
            match self.gradient {
                Some((gradient, alpha)) => {
                    gradient.write(first, out);
                    for (row, out) in out.chunks_exact_mut(columns).enumerate() {
                        self.asked.add_costs(first + row, alpha, out);
                    }
                }
                None => out.fill(0.0),
            }
            self.add_distances(&runs, first, out);
            if self.gradient.is_none() {
                self.steer(first, out);
            }
            self.asked.close(first, columns, out);
        })?)
    }

    /// Rows that are matched from elsewhere, and what poses to keep away from cost.
    fn steer(&self, first: usize, out: &mut [f32]) {
        let columns = self.source.layout.patches();
        let rows = first..first + out.len() / columns;
        let clip = (self.source.frames.view(), &self.source.layout);
        for row in self.moved.rows().filter(|row| rows.contains(row)) {
            if let Some(distances) = self.moved.distances(row, clip, self.source.scale) {
                out[(row - first) * columns..][..columns].copy_from_slice(&distances);
            }
        }
        let avoided = self.asked.avoided();
        for out in out.chunks_exact_mut(columns).filter(|_| !avoided.is_empty()) {
            out.iter_mut().zip(avoided).for_each(|(score, avoid)| *score += avoid);
        }
    }

    fn add_distances(&self, runs: &[Run], first: usize, out: &mut [f32]) {
        let columns = self.source.layout.patches();
        let (end, patch) = (first + out.len() / columns, self.rows.patch());
        let (mut scratch, mut block) = (PatchScratch::new(), Mat::default());
        for run in runs {
            let (from, to) = (first.max(run.patch), end.min(run.patch + run.count));
            if from >= to {
                continue;
            }
            let frame = run.frame + from - run.patch;
            let (frames, width) = (to - from + patch - 1, self.motion.cols());
            let rows = &self.motion.as_slice()[frame * width..(frame + frames) * width];
            let clip = (self.source.frames.view(), &self.source.layout);
            let done = MatRef::new(rows, frames, width).and_then(|rows| {
                let rows = (rows, &Layout::open(frames, patch));
                patch_distances(rows, clip, self.source.scale, &mut scratch, &mut block, 1)
            });
            // The tables are as wide as each other by construction; if not, nothing is found, which is said.
            let factor = if done.is_ok() { self.weight } else { f32::NAN };
            let out = &mut out[(from - first) * columns..(to - first) * columns];
            out.iter_mut().zip(block.as_slice()).for_each(|(score, distance)| *score += factor * distance);
        }
    }
}
