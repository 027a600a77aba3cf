//! What keys ask of a level whose tables are never there as a whole: the same as for full ones, a row or an entry at a time.

use super::level::LevelKeys;
use super::moment::KeyPatch;
use crate::{AlignError, Layout};
use inkrig_transport::{MatRef, Real, SparseProblem, Support};

/// A table of frames and where its patches stand.
type Table<'a> = (MatRef<'a, f32>, &'a Layout);

/// Rows that are matched from elsewhere than where they lie, since that is near to what must not appear.
#[derive(Debug, Default)]
pub(crate) struct Moved(Vec<(usize, KeyPatch)>);

impl Moved {
    /// The rows.
    pub(crate) fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().map(|(row, _)| *row)
    }

    /// Distances times `scale` of all columns to a row, where that is one of them. Of several places the last counts.
    pub(crate) fn distances(&self, row: usize, (source, columns): Table<'_>, scale: f32) -> Option<Vec<f32>> {
        let (_, patch) = self.0.iter().rev().find(|(moved, _)| *moved == row)?;
        Some(patch.distances(source, columns, scale))
    }
}

impl LevelKeys {
    /// Whether anything costs something.
    pub(crate) fn has_costs(&self) -> bool {
        !(self.soft.is_empty() && self.avoid.is_empty())
    }

    /// Adds what a row costs at weight alpha: see [`cost`](Self::cost).
    pub(crate) fn add_costs(&self, row: usize, alpha: f64, out: &mut [f32]) {
        out.iter_mut().zip(&self.avoid).for_each(|(value, &avoid)| *value += alpha as f32 * avoid);
        for soft in &self.soft {
            let (factor, control) = (self.factor(soft.weight, alpha), soft.rows[row]);
            for (value, &source) in out.iter_mut().zip(&soft.columns) {
                *value += factor * (control - source) * (control - source);
            }
        }
    }

    /// The same at the entries of a support; none when nothing costs anything.
    pub(crate) fn costs_at(&self, support: &Support, alpha: f64) -> Option<Vec<f32>> {
        let at = |row: usize, column: usize| {
            let avoid = self.avoid.get(column).map_or(0.0, |&avoid| alpha as f32 * avoid);
            let soft = self.soft.iter().map(|soft| {
                self.factor(soft.weight, alpha) * (soft.rows[row] - soft.columns[column]).powi(2)
            });
            avoid + soft.sum::<f32>()
        };
        let rows = 0..support.rows();
        let entries = rows.flat_map(|row| support.row(row).iter().map(move |&column| (row, column as usize)));
        self.has_costs().then(|| entries.map(|(row, column)| at(row, column)).collect())
    }

    /// What poses to keep away from cost by themselves, a number for every column; empty without them.
    pub(crate) fn avoided(&self) -> &[f32] {
        &self.avoid
    }

    /// The rows of a motion that [`steer`](Self::steer) moves.
    pub(crate) fn moved(&self, motion: Table<'_>, scale: f32) -> Moved {
        Moved(self.away(motion, scale))
    }

    /// Puts closed columns, and all but its own column for a settled row, beyond any other score. `out` are whole rows from
    /// `first` on.
    pub(crate) fn close(&self, first: usize, columns: usize, out: &mut [f32]) {
        for row in out.chunks_exact_mut(columns) {
            self.mask.columns.iter().for_each(|&column| row[column] = f32::HUGE);
        }
        for &(row, column) in &self.mask.rows {
            let Some(place) = row.checked_sub(first) else { continue };
            if let Some(out) = out.chunks_exact_mut(columns).nth(place) {
                out.fill(f32::HUGE);
                out[column] = 0.0;
            }
        }
    }

    /// A support without closed columns, settled rows with their own; a row that loses all gets the open columns around
    /// its first.
    pub(crate) fn opened(&self, support: Support) -> Result<Support, AlignError> {
        if self.mask.rows.is_empty() && self.mask.columns.is_empty() {
            return Ok(support);
        }
        let columns = support.cols();
        let open = |column: &usize| self.mask.columns.binary_search(column).is_err();
        let mut settled = vec![None; support.rows()];
        self.mask.rows.iter().for_each(|&(row, column)| settled[row] = Some(column));
        Ok(Support::from_rows(support.rows(), columns, |row, out| {
            if let Some(column) = settled[row] {
                out.push(column);
                return;
            }
            out.extend(support.row(row).iter().map(|&column| column as usize).filter(open));
            if out.is_empty() {
                let place = support.row(row).first().map_or(0, |&column| column as usize);
                out.extend((0..place).rev().find(open));
                out.extend((place..columns).find(open));
            }
        })?)
    }

    /// The problem with what is asked; `costs` are those of [`costs_at`](Self::costs_at).
    pub(crate) fn bind_sparse<'a>(
        &'a self,
        problem: SparseProblem<'a, f32>,
        costs: Option<&'a [f32]>,
    ) -> Result<SparseProblem<'a, f32>, AlignError> {
        let problem = match costs {
            Some(costs) => problem.with_linear(costs)?,
            None => problem,
        };
        let masked = !(self.mask.rows.is_empty() && self.mask.columns.is_empty());
        Ok(if masked { problem.with_mask(&self.mask)? } else { problem })
    }

    fn factor(&self, weight: f64, alpha: f64) -> f32 {
        (2.0 * alpha / self.soft.len().max(1) as f64 * weight) as f32
    }
}
