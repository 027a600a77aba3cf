//! Which source frames an output frame is made of.

use crate::blend::Window;
use crate::reconstruct::LEAST_WEIGHT;
use crate::{AlignError, Layout};
use inkrig_transport::{Mat, MatRef, Plan, Support};

/// Weights of source frames, a sparse row for each output frame; rows sum to 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameWeights {
    support: Support,
    values: Vec<f32>,
}

impl FrameWeights {
    /// Keeps what is more than rounding of a table of output frames x source frames.
    ///
    /// # Errors
    /// When the table is empty or a row has nothing in it.
    pub fn from_mat(table: MatRef<'_, f32>) -> Result<Self, AlignError> {
        let mut values = Vec::new();
        let support = Support::from_rows(table.rows(), table.cols(), |row, out| {
            let kept = table.row(row).iter().enumerate().filter(|(_, weight)| **weight > LEAST_WEIGHT);
            for (column, &weight) in kept {
                out.push(column);
                values.push(weight);
            }
        })?;
        Ok(Self { support, values })
    }

    /// Spreads a plan between the patches of two layouts, dense or sparse, into weights of their frames: what
    /// [`frame_weights`](crate::blend::frame_weights) does in a table, without the table.
    ///
    /// # Errors
    /// When the plan is empty or a row has no mass.
    pub fn of_plan(
        plan: &Plan<f32>,
        (rows, columns): (&Layout, &Layout),
        window: Window,
    ) -> Result<Self, AlignError> {
        let (patch, patches) = (rows.patch(), plan.rows() as f64);
        let starts = columns.first_frames();
        let mut line = Line::new(columns.frames());
        let mut values = Vec::new();
        let support = Support::from_rows(rows.frames(), columns.frames(), |frame, out| {
            let covering = rows.covering(frame);
            let total: f64 = covering.iter().map(|&(_, offset)| window.weight(offset, patch)).sum();
            for (i, offset) in covering {
                let share = (window.weight(offset, patch) * patches / total) as f32;
                for (j, mass) in plan.entries(i) {
                    line.add(starts[j] + offset, share * mass);
                }
            }
            line.take(|column, weight| {
                if weight > LEAST_WEIGHT {
                    out.push(column);
                    values.push(weight);
                }
            });
        })?;
        Ok(Self { support, values })
    }

    /// Number of output frames.
    pub fn rows(&self) -> usize {
        self.support.rows()
    }

    /// Number of source frames.
    pub fn cols(&self) -> usize {
        self.support.cols()
    }

    /// Weights that are kept.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The source frames of an output frame with their weights, in order; none when there is no such frame.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let values = &self.values[self.support.range(row)];
        self.support.row(row).iter().zip(values).map(|(&column, &weight)| (column as usize, weight))
    }

    /// A row with its zeros; empty when there is no such frame.
    pub(crate) fn full_row(&self, row: usize) -> Vec<f32> {
        let mut out = vec![0.0; if row < self.rows() { self.cols() } else { 0 }];
        self.row(row).for_each(|(column, weight)| out[column] = weight);
        out
    }

    /// The blended frames: each the sum of the source's rows by its weights. `out` becomes output frames x width.
    ///
    /// # Errors
    /// When the source has another number of frames.
    pub fn blend(
        &self,
        source: MatRef<'_, f32>,
        threads: usize,
        out: &mut Mat<f32>,
    ) -> Result<(), AlignError> {
        Ok(self.support.product(&self.values, source, threads, out)?)
    }

    /// For every row the moment of the largest weight, seconds, and the share of the weight within a quarter second of it.
    pub(crate) fn most_used(&self, rate: f64) -> (Vec<f32>, Vec<f32>) {
        let reach = (0.25 * rate).round() as usize;
        (0..self.rows())
            .map(|row| {
                // The last of equals, as the maximum of a table's row is.
                let best = self.row(row).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(column, _)| column);
                let near = self.row(row).filter(|(column, _)| column.abs_diff(best) <= reach);
                let share: f32 = near.map(|(_, weight)| weight).sum();
                ((best as f64 / rate) as f32, share.clamp(0.0, 1.0))
            })
            .unzip()
    }
}

/// A row that is written anywhere and read in order, in the time of what was written.
struct Line {
    values: Vec<f32>,
    /// A bit for each value that was written.
    used: Vec<u64>,
}

impl Line {
    fn new(len: usize) -> Self {
        Self { values: vec![0.0; len], used: vec![0; len.div_ceil(64)] }
    }

    fn add(&mut self, at: usize, value: f32) {
        self.values[at] += value;
        self.used[at / 64] |= 1 << (at % 64);
    }

    /// Hands out what was written and forgets it.
    fn take(&mut self, mut give: impl FnMut(usize, f32)) {
        for (word, used) in self.used.iter_mut().enumerate() {
            while *used != 0 {
                let at = 64 * word + used.trailing_zeros() as usize;
                *used &= *used - 1;
                give(at, std::mem::take(&mut self.values[at]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blend::frame_weights;

    #[test]
    fn sparse_weights_are_those_of_the_table() {
        let (rows, columns) = (Layout::cyclic(40, 7), Layout::clips(&[50, 5, 30], 7));
        let support = Support::from_rows(rows.patches(), columns.patches(), |i, out| {
            out.extend([i, (i * 3 + 10) % 60, (i * 11) % columns.patches()]);
        })
        .unwrap();
        let mass: Vec<f32> = (0..rows.patches())
            .flat_map(|i| {
                let count = support.row(i).len();
                let sum: usize = (1..=count).sum();
                (1..=count).map(move |k| k as f32 / (40 * sum) as f32)
            })
            .collect();
        let plan = Plan::from_support(support, mass).unwrap();
        let table = Mat::from_fn(columns.rows(), 3, |row, column| ((row * 7 + column * 5) % 13) as f32);
        for window in [Window::Box, Window::Hann] {
            let sparse = FrameWeights::of_plan(&plan, (&rows, &columns), window).unwrap();
            let mut dense = Mat::default();
            frame_weights(plan.clone().into_mat().view(), (&rows, &columns), window, &mut dense, 1);
            assert_eq!(sparse, FrameWeights::from_mat(dense.view()).unwrap());
            assert_eq!((sparse.rows(), sparse.cols()), (40, 85));
            let mut out = Mat::default();
            sparse.blend(table.view(), 2, &mut out).unwrap();
            for row in 0..40 {
                let sum: f32 = sparse.row(row).map(|(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-4);
                let want: f32 = (0..85).map(|at| dense.row(row)[at] * table.row(at)[1]).sum();
                assert!((out.row(row)[1] - want).abs() < 1e-4);
            }
        }
        assert!(FrameWeights::from_mat(Mat::zeros(2, 2).view()).is_err());
    }

    #[test]
    fn the_moment_used_most_is_found() {
        let table = Mat::from_vec(1, 40, (0..40).map(|j| if j == 30 { 0.4 } else { 0.6 / 39.0 }).collect());
        let (best, share) = FrameWeights::from_mat(table.unwrap().view()).unwrap().most_used(30.0);
        assert_eq!(best, [1.0]);
        assert!((share[0] - (0.4 + 16.0 * 0.6 / 39.0)).abs() < 1e-5);
    }
}
