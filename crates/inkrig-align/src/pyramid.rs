//! Levels from coarse to fine (MAMM Sec. 3.2.5).

use inkrig_transport::{Mat, MatRef, Real};

/// Lengths of all levels, coarsest first, for a table of `full` frames: geometric from `full / ratio` to `full`, but
/// nowhere shorter than `floor` frames (or `full`, when that is shorter still).
pub fn level_lengths(full: usize, levels: usize, ratio: f64, floor: usize) -> Vec<usize> {
    let coarsest = (full as f64 / ratio).max(floor.min(full) as f64);
    let ratio = full as f64 / coarsest;
    let steps = levels.saturating_sub(1).max(1) as f64;
    (0..levels)
        .map(|level| {
            let remaining = (levels - 1 - level) as f64 / steps;
            ((full as f64 / ratio.powf(remaining)).round() as usize).clamp(1, full)
        })
        .collect()
}

/// The same table with another number of rows over the same time: linear interpolation, ends kept.
pub fn resample_rows<T: Real>(table: MatRef<'_, T>, rows: usize, out: &mut Mat<T>) {
    out.resize(rows, table.cols());
    let last = table.rows() - 1;
    let step = if rows > 1 { last as f64 / (rows - 1) as f64 } else { 0.0 };
    for row in 0..rows {
        let place = (row as f64 * step).min(last as f64);
        let low = place.floor() as usize;
        let part = T::from_f64(place - low as f64);
        let (from, to) = (table.row(low), table.row((low + 1).min(last)));
        for ((value, &a), &b) in out.row_mut(row).iter_mut().zip(from).zip(to) {
            *value = a + part * (b - a);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_grow_to_the_full_length_and_respect_the_floor() {
        assert_eq!(level_lengths(300, 6, 4.0, 55), [75, 99, 131, 172, 227, 300]);
        assert_eq!(level_lengths(100, 3, 4.0, 55), [55, 74, 100]);
        assert_eq!(level_lengths(40, 3, 4.0, 55), [40, 40, 40]);
        assert_eq!(level_lengths(300, 1, 4.0, 55), [300]);
    }

    #[test]
    fn rows_are_interpolated_and_ends_kept() {
        let table = Mat::from_vec(3, 1, vec![0.0_f64, 1.0, 4.0]).unwrap();
        let mut out = Mat::zeros(0, 0);
        resample_rows(table.view(), 5, &mut out);
        assert_eq!(out.as_slice(), [0.0, 0.5, 1.0, 2.5, 4.0]);
        resample_rows(table.view(), 1, &mut out);
        assert_eq!(out.as_slice(), [0.0]);
    }
}
