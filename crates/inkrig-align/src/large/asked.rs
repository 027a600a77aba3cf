//! What keys ask, without a table.

use crate::keys::LevelKeys;
use inkrig_transport::Real;

impl LevelKeys {
    /// Adds what a row costs at weight alpha.
    pub(super) fn add_costs(&self, _row: usize, _alpha: f64, _out: &mut [f32]) {}

    /// Puts closed columns, and all but its own column for a settled row, beyond any other score. `out` are rows from `first`
    /// on.
    pub(super) fn close(&self, first: usize, columns: usize, out: &mut [f32]) {
        for row in out.chunks_exact_mut(columns) {
            self.mask.columns.iter().for_each(|&column| row[column] = f32::HUGE);
        }
        for &(row, column) in &self.mask.rows {
            let Some(out) = row.checked_sub(first).and_then(|row| out.chunks_exact_mut(columns).nth(row))
            else {
                continue;
            };
            out.fill(f32::HUGE);
            out[column] = 0.0;
        }
    }
}
