//! Simpler ways to make a motion of a clip's frames. Each gives weights of frames or a plan of patches, which is then
//! made a clip and measured like align's own result.

use inkrig_align::{Layout, measures, principal_axes};
use inkrig_transport::Mat;

/// Frames of a random piece: two seconds.
pub(super) const CHUNK: usize = 60;

/// Axes that the nearest patch is looked for along.
const AXES: usize = 3;
/// Rounds of power iteration for them; those of clips and drawings settle in far fewer.
const ROUNDS: usize = 40;

/// The clip from its first to its last frame, stretched evenly: weights of `columns` frames in each of `rows`.
pub(super) fn time_warp(rows: usize, columns: usize) -> Mat<f32> {
    let mut weights = Mat::zeros(rows, columns);
    let (last, steps) = (columns.saturating_sub(1), rows.saturating_sub(1).max(1));
    for row in 0..rows {
        let place = row as f64 * last as f64 / steps as f64;
        let low = (place as usize).min(last);
        let part = (place - low as f64) as f32;
        weights.row_mut(row)[low] += 1.0 - part;
        weights.row_mut(row)[(low + 1).min(last)] += part;
    }
    weights
}

/// Pieces of [`CHUNK`] frames from anywhere in the clips, one after the other, with hard cuts.
pub(super) fn random_chunks(rows: usize, columns: &Layout, seed: u64) -> Mat<f32> {
    let mut weights = Mat::zeros(rows, columns.frames());
    let mut random = SplitMix(seed);
    let mut row = 0;
    while row < rows {
        // Every frame is as likely to be in the clip that a piece is taken from.
        let any = random.below(columns.frames());
        let part =
            columns.parts().iter().find(|part| part.contains(&any)).cloned().unwrap_or(0..columns.frames());
        let chunk = CHUNK.min(part.len()).max(1);
        let start = part.start + random.below(part.len() - chunk + 1);
        for offset in 0..chunk.min(rows - row) {
            weights.row_mut(row + offset)[start + offset] = 1.0;
        }
        row += chunk;
    }
    weights
}

/// The nearest patch of the clip for each of the control's, along their principal axes, as a plan.
///
/// A drawing and a motion have no common space, so one is made: both sides' patches are laid out along their first
/// three principal axes, places along an axis are replaced by ranks (so that both sides fill the same range evenly),
/// and each axis counts as much as it does in the control. An axis has no sign, and the axes of one side may come in
/// another order than those of the other: of all 48 ways the one whose structure follows the control best is taken.
/// That is more help than a user could give it.
pub(super) fn nearest_patch(control: &Mat<f32>, source: &Mat<f32>, patch: usize) -> Mat<f32> {
    let axes = principal_axes(control, AXES, ROUNDS);
    let spreads: Vec<f64> = axes.iter().map(|axis| axis.iter().map(|place| place * place).sum()).collect();
    let total = spreads.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let ours: Vec<Vec<f64>> = (axes.iter().zip(&spreads))
        .map(|(axis, spread)| centred_ranks(axis).iter().map(|rank| rank * (spread / total).sqrt()).collect())
        .collect();
    let shares: Vec<f64> = ours.iter().map(|axis| axis.iter().copied().fold(0.0, f64::max) * 2.0).collect();
    let theirs: Vec<Vec<f64>> =
        principal_axes(source, AXES, ROUNDS).iter().map(|axis| centred_ranks(axis)).collect();
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for order in ORDERS {
        for signs in 0..1 << AXES {
            let axis = |index: usize| {
                let sign = if signs >> index & 1 == 1 { -1.0 } else { 1.0 };
                theirs[order[index]].iter().map(|rank| sign * shares[index] * rank).collect()
            };
            let laid_out: Vec<Vec<f64>> = (0..AXES).map(axis).collect();
            let chosen = nearest(&ours, &laid_out);
            let moved = Mat::from_fn(chosen.len(), chosen.len(), |i, j| source.row(chosen[i])[chosen[j]]);
            let structure = measures::structure(control, &moved, patch).pearson;
            if structure > best.0 {
                best = (structure, chosen);
            }
        }
    }
    let mut plan = Mat::zeros(control.rows(), source.rows());
    let mass = 1.0 / control.rows() as f32;
    best.1.iter().enumerate().for_each(|(row, &column)| plan.row_mut(row)[column] = mass);
    plan
}

/// Orders of three axes.
const ORDERS: [[usize; AXES]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// Ranks from -1/2 to 1/2.
fn centred_ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let last = (values.len().max(2) - 1) as f64;
    let mut ranks = vec![0.0; values.len()];
    order.iter().enumerate().for_each(|(rank, &index)| ranks[index] = rank as f64 / last - 0.5);
    ranks
}

/// For each point of `ours` the nearest of `theirs`; both are one row of coordinates an axis.
fn nearest(ours: &[Vec<f64>], theirs: &[Vec<f64>]) -> Vec<usize> {
    let (points, others) = (ours.first().map_or(0, Vec::len), theirs.first().map_or(0, Vec::len));
    let square = |i: usize, j: usize| -> f64 {
        ours.iter().zip(theirs).map(|(own, other)| (own[i] - other[j]).powi(2)).sum()
    };
    (0..points)
        .map(|i| (0..others).min_by(|&a, &b| square(i, a).total_cmp(&square(i, b))).unwrap_or(0))
        .collect()
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct SplitMix(u64);

impl SplitMix {
    /// A number below `bound`, which is at least 1.
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) % bound.max(1) as u64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warp_begins_and_ends_with_the_clip() {
        let weights = time_warp(5, 3);
        assert_eq!(weights.row(0), [1.0, 0.0, 0.0]);
        assert_eq!(weights.row(1), [0.5, 0.5, 0.0]);
        assert_eq!(weights.row(4), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn chunks_run_on_do_not_cross_cuts_and_follow_the_seed() {
        let columns = Layout::clips(&[100, 30, 90], 11);
        let weights = random_chunks(500, &columns, 7);
        let chosen: Vec<usize> =
            (0..500).map(|row| weights.row(row).iter().position(|&weight| weight == 1.0).unwrap()).collect();
        let jumps = chosen.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
        assert!((7..=16).contains(&jumps), "{jumps} cuts in 500 frames of pieces of 30 or 60");
        for pair in chosen.windows(2).filter(|pair| pair[1] == pair[0] + 1) {
            assert!(pair[1] != 100 && pair[1] != 130, "a piece goes over a cut");
        }
        assert_eq!(random_chunks(500, &columns, 7), weights);
        assert_ne!(random_chunks(500, &columns, 8), weights);
    }

    #[test]
    fn a_mirrored_copy_is_matched_point_by_point() {
        let place = |i: usize| (0.02 * i as f64 + (i as f64 * 0.11).sin(), 0.4 * (i as f64 * 0.07).cos());
        let distances = |mirror: f64| {
            Mat::from_fn(120, 120, |i, j| {
                let ((a, b), (c, d)) = (place(i), place(j));
                (mirror * (a - c)).hypot(b - d) as f32
            })
        };
        let plan = nearest_patch(&distances(1.0), &distances(-1.0), 5);
        let off = (0..120)
            .map(|i| plan.row(i).iter().position(|&mass| mass > 0.0).unwrap().abs_diff(i))
            .sum::<usize>();
        assert!(off < 12, "{off} places off in 120");
    }
}
