//! Levels from coarse to fine (MAMM Sec. 3.2.5).

use crate::Layout;
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

/// The same frames over the same time in another layout: linear interpolation, within every clip from its first frame
/// to its last, around a loop without end. `table` has the rows of layout `from`, `out` gets those of layout `to`.
pub fn resample_frames<T: Real>(table: MatRef<'_, T>, from: &Layout, to: &Layout, out: &mut Mat<T>) {
    out.resize(to.rows(), table.cols());
    for (old, new) in from.parts().iter().zip(to.parts()) {
        let (last, steps) = (old.len().saturating_sub(1), new.len().saturating_sub(1).max(1));
        let step =
            if from.is_cyclic() { old.len() as f64 / new.len() as f64 } else { last as f64 / steps as f64 };
        for frame in 0..new.len() {
            let place = frame as f64 * step;
            let low = (place.floor() as usize).min(last);
            let high = if from.is_cyclic() { (low + 1) % old.len() } else { (low + 1).min(last) };
            let part = T::from_f64((place - low as f64).clamp(0.0, 1.0));
            let (a, b) = (table.row(old.start + low), table.row(old.start + high));
            for ((value, &a), &b) in out.row_mut(new.start + frame).iter_mut().zip(a).zip(b) {
                *value = a + part * (b - a);
            }
        }
    }
    close_loop(to, out);
}

/// Gives a table of a layout's frames the rows that [`Layout::rows`] asks for: a loop repeats its first frames.
pub fn close_loop<T: Real>(layout: &Layout, table: &mut Mat<T>) {
    let (frames, width) = (layout.frames(), table.cols());
    if !layout.is_cyclic() || frames == 0 {
        return;
    }
    if table.rows() != layout.rows() {
        let mut values = std::mem::take(table).into_vec();
        values.resize(layout.rows() * width, T::ZERO);
        *table = Mat::from_vec(layout.rows(), width, values).unwrap_or_default();
    }
    for row in frames..layout.rows() {
        let from = (row % frames) * width;
        table.as_mut_slice().copy_within(from..from + width, row * width);
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
        resample_frames(table.view(), &Layout::open(3, 2), &Layout::open(5, 2), &mut out);
        assert_eq!(out.as_slice(), [0.0, 0.5, 1.0, 2.5, 4.0]);
        resample_frames(table.view(), &Layout::open(3, 2), &Layout::open(1, 2), &mut out);
        assert_eq!(out.as_slice(), [0.0]);
    }

    #[test]
    fn loops_and_cuts_are_kept() {
        let mut out = Mat::zeros(0, 0);
        let ring = Mat::from_vec(3, 1, vec![0.0_f64, 2.0, 0.0]).unwrap();
        resample_frames(ring.view(), &Layout::cyclic(2, 2), &Layout::cyclic(4, 2), &mut out);
        assert_eq!(out.as_slice(), [0.0, 1.0, 2.0, 1.0, 0.0]);
        let clips = Mat::from_vec(5, 1, vec![0.0_f64, 1.0, 9.0, 8.0, 7.0]).unwrap();
        resample_frames(clips.view(), &Layout::clips(&[2, 3], 2), &Layout::clips(&[3, 2], 2), &mut out);
        assert_eq!(out.as_slice(), [0.0, 0.5, 1.0, 9.0, 7.0]);
    }
}
