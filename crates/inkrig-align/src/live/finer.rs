//! Weights of a coarse level as weights of all frames, to be seen before the finer levels are there.

use crate::Layout;
use inkrig_transport::Mat;

/// `weights` has the frames of a level's two layouts; the result those of the full ones, rows of sum 1. A frame between
/// two coarse ones mixes their rows, each moved on (or back) in the source by what lies between.
pub(super) fn at_full_length(
    weights: &Mat<f32>,
    (rows, columns): (&Layout, &Layout),
    (full_rows, full_columns): (&Layout, &Layout),
) -> Mat<f32> {
    let mut out = Mat::zeros(full_rows.frames(), full_columns.frames());
    let kept: Vec<Vec<(usize, f32)>> =
        (0..weights.rows()).map(|row| crate::reconstruct::kept(weights.row(row))).collect();
    let (coarse, full) = (rows.frames(), full_rows.frames());
    let step = if rows.is_cyclic() {
        coarse as f64 / full as f64
    } else {
        (coarse - 1) as f64 / (full - 1).max(1) as f64
    };
    for frame in 0..full {
        let place = frame as f64 * step;
        let low = (place.floor() as usize).min(coarse - 1);
        let high = if rows.is_cyclic() { (low + 1) % coarse } else { (low + 1).min(coarse - 1) };
        let part = place - low as f64;
        let row = out.row_mut(frame);
        spread(&kept[low], 1.0 - part, part, (columns, full_columns), row);
        spread(&kept[high], part, part - 1.0, (columns, full_columns), row);
        let total: f32 = row.iter().sum();
        row.iter_mut().for_each(|weight| *weight /= total);
    }
    out
}

/// Adds coarse weights, moved by `shift` coarse frames; what would leave a clip falls on its first or last frame.
fn spread(
    weights: &[(usize, f32)],
    factor: f64,
    shift: f64,
    (columns, full): (&Layout, &Layout),
    out: &mut [f32],
) {
    let mut parts = columns.parts().iter().zip(full.parts());
    let Some(mut part) = parts.next() else { return };
    for &(column, weight) in weights {
        while column >= part.0.end {
            let Some(next) = parts.next() else { return };
            part = next;
        }
        let (coarse, full) = part;
        let step = (full.len() - 1) as f64 / (coarse.len() - 1).max(1) as f64;
        let place = (((column - coarse.start) as f64 + shift) * step).clamp(0.0, (full.len() - 1) as f64);
        let low = place.floor() as usize;
        let (upper, weight) = ((place - low as f64) as f32, factor as f32 * weight);
        out[full.start + low] += weight * (1.0 - upper);
        out[full.start + (low + 1).min(full.len() - 1)] += weight * upper;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_run_stays_one() {
        let (coarse, full) = (Layout::open(31, 5), Layout::open(121, 5));
        let weights = Mat::from_fn(31, 31, |row, column| f32::from(u8::from(row == column)));
        let fine = at_full_length(&weights, (&coarse, &coarse), (&full, &full));
        for row in 0..121 {
            assert!((fine.row(row)[row] - 1.0).abs() < 1e-5, "row {row}");
        }
    }

    #[test]
    fn clips_keep_to_themselves() {
        let (coarse, full) = (Layout::clips(&[10, 20], 3), Layout::clips(&[40, 80], 3));
        let weights = Mat::from_fn(30, 30, |row, column| f32::from(u8::from(row == column)));
        let fine = at_full_length(&weights, (&coarse, &coarse), (&full, &full));
        for row in 0..120 {
            assert!((fine.row(row).iter().sum::<f32>() - 1.0).abs() < 1e-5);
        }
        assert!(fine.row(30)[40..].iter().all(|&weight| weight == 0.0));
    }
}
