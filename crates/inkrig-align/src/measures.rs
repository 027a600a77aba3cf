//! How good an alignment is, in numbers that cannot all be gamed at once: structure alone can be had by freezing or
//! by jumping, nearness alone by repeating one moment.

use crate::Layout;
use inkrig_motion::{Clip, Takes, kinematics};
use inkrig_transport::Mat;
use std::ops::Range;

/// Correlation of two distance tables of equal size over pairs of patches that share no frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Structure {
    /// Pearson's coefficient, -1..=1.
    pub pearson: f64,
    /// Spearman's rank coefficient, -1..=1.
    pub spearman: f64,
}

/// How well the distances within a motion follow those within its control. Both tables are N x N, of patches of
/// `patch` frames; 0 when one of them is constant or there is no pair far enough apart.
pub fn structure(control: &Mat<f32>, motion: &Mat<f32>, patch: usize) -> Structure {
    let pairs = |table: &Mat<f32>| -> Vec<f32> {
        (0..table.rows()).flat_map(|i| table.row(i).iter().skip(i + patch).copied()).collect()
    };
    let (a, b) = (pairs(control), pairs(motion));
    Structure { pearson: pearson(&a, &b), spearman: pearson(&ranks(&a), &ranks(&b)) }
}

/// Pearson's correlation of two rows of equal length.
pub fn pearson(a: &[f32], b: &[f32]) -> f64 {
    let count = a.len().min(b.len()) as f64;
    let mean = |row: &[f32]| row.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (&x, &y) in a.iter().zip(b) {
        let (x, y) = (f64::from(x) - mean_a, f64::from(y) - mean_b);
        ab += x * y;
        aa += x * x;
        bb += y * y;
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// Ranks from 0, ties share the mean of theirs.
fn ranks(values: &[f32]) -> Vec<f32> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut begin = 0;
    while begin < order.len() {
        let value = values[order[begin]];
        let end = begin + order[begin..].iter().take_while(|&&index| values[index] == value).count();
        let rank = (begin + end - 1) as f32 / 2.0;
        order[begin..end.max(begin + 1)].iter().for_each(|&index| ranks[index] = rank);
        begin = end.max(begin + 1);
    }
    ranks
}

/// Nearness of a motion to the clip that it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearness {
    /// Mean distance of an output patch to its nearest source patch, in mean source distances. 0 is a copy.
    pub nearest_patch: f64,
    /// Share of source patches that have an output patch nearer than max(2 a, 0.1), where a is the mean distance of
    /// consecutive source patches; in mean source distances. 1 when everything in the clip is used.
    pub coverage: f64,
}

/// Nearness from the distances between output and source patches (N x M) and within the source (M x M), both
/// divided by the source's mean; `columns` says where the source is cut.
pub fn nearness(cross: &Mat<f32>, source: &Mat<f32>, columns: &Layout) -> Nearness {
    let steps: Vec<f64> =
        columns.followed().into_iter().map(|patch| f64::from(source.row(patch)[patch + 1])).collect();
    let adjacent = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let reach = (2.0 * adjacent).max(0.1) as f32;
    let mut nearest_of_column = vec![f32::INFINITY; cross.cols()];
    let mut total = 0.0;
    for i in 0..cross.rows() {
        let row = cross.row(i);
        total += f64::from(row.iter().copied().fold(f32::INFINITY, f32::min));
        for (nearest, &distance) in nearest_of_column.iter_mut().zip(row) {
            *nearest = nearest.min(distance);
        }
    }
    let covered = nearest_of_column.iter().filter(|&&distance| distance < reach).count();
    Nearness {
        nearest_patch: total / cross.rows().max(1) as f64,
        coverage: covered as f64 / cross.cols().max(1) as f64,
    }
}

/// How a body moves, without where it goes: joint positions relative to the travelling joint, world axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    /// Mean speed of the joints in every step from frame to frame, metres a second (frames - 1 values).
    pub speeds: Vec<f32>,
    /// The 99.9th percentile of a single joint's speed, metres a second: jumps show here.
    pub speed_q999: f64,
    /// Mean size of the third difference, metres a second cubed.
    pub jerk: f64,
}

impl Dynamics {
    /// Dynamics of a clip, relative to its travelling joint; zeros when it is too short to have any.
    ///
    /// # Panics
    /// When there is no such joint.
    pub fn of(clip: &Clip, travel_joint: usize) -> Self {
        Self::of_parts(clip, std::iter::once(0..clip.frames()), travel_joint)
    }

    /// The same of several clips: nothing moves from one to the next.
    ///
    /// # Panics
    /// As for [`Self::of`].
    pub fn of_takes(takes: &Takes, travel_joint: usize) -> Self {
        Self::of_parts(takes.clip(), takes.ranges(), travel_joint)
    }

    fn of_parts(clip: &Clip, parts: impl Iterator<Item = Range<usize>>, travel_joint: usize) -> Self {
        let parts: Vec<Range<usize>> = parts.collect();
        let positions = kinematics::positions(clip).relative_to(travel_joint);
        let rate = clip.frame_rate() as f32;
        let joints = positions.joints() as f32;
        let mut speeds = Vec::new();
        let mut single = Vec::new();
        for frame in parts.iter().cloned().flat_map(|part| part.skip(1)) {
            let begin = single.len();
            let pairs = positions.frame(frame).iter().zip(positions.frame(frame - 1));
            single.extend(pairs.map(|(to, from)| to.distance(*from) * rate));
            speeds.push(single[begin..].iter().sum::<f32>() / joints);
        }
        let speed_q999 = f64::from(quantile(&mut single, 0.999));
        let (mut jerk, mut count) = (0.0, 0);
        for frame in parts.into_iter().flat_map(|part| part.skip(3)) {
            let [a, b, c, d] = std::array::from_fn(|back| positions.frame(frame - back));
            for joint in 0..positions.joints() {
                let third = a[joint] - 3.0 * b[joint] + 3.0 * c[joint] - d[joint];
                jerk += f64::from(third.length());
                count += 1;
            }
        }
        let jerk = jerk / f64::from(count.max(1)) * clip.frame_rate().powi(3);
        Self { speeds, speed_q999, jerk }
    }

    /// Mean speed of the joints, metres a second.
    pub fn speed_mean(&self) -> f64 {
        self.speeds.iter().map(|&speed| f64::from(speed)).sum::<f64>() / self.speeds.len().max(1) as f64
    }

    /// Share of steps slower than `speed` metres a second.
    pub fn slower_than(&self, speed: f64) -> f64 {
        let slow = self.speeds.iter().filter(|&&own| f64::from(own) < speed).count();
        slow as f64 / self.speeds.len().max(1) as f64
    }
}

/// The value below which a share of `values` lies; 0 for none. Reorders them.
fn quantile(values: &mut [f32], share: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(rank, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;

    #[test]
    fn correlation_is_that_of_the_textbook() {
        assert!((pearson(&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.1]) - 0.999_86).abs() < 1e-4);
        assert_eq!(pearson(&[1.0, 1.0], &[1.0, 2.0]), 0.0);
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [2.5, 0.0, 2.5, 1.0]);
    }

    #[test]
    fn structure_sees_only_pairs_far_apart() {
        let near = |i: usize, j: usize| i.abs_diff(j) <= 10;
        let a = Mat::from_fn(30, 30, |i, j| i.abs_diff(j) as f32);
        let b = Mat::from_fn(30, 30, |i, j| if near(i, j) { -100.0 } else { (i.abs_diff(j) as f32).powi(3) });
        let structure = structure(&a, &b, 11);
        assert!((structure.spearman - 1.0).abs() < 1e-9);
        assert!(structure.pearson > 0.9 && structure.pearson < 1.0);
    }

    #[test]
    fn a_copy_is_near_and_covers_all() {
        let line = Mat::from_fn(20, 20, |i, j| 0.06 * i.abs_diff(j) as f32);
        let all = Layout::open(20, 1);
        let whole = nearness(&line, &line, &all);
        assert_eq!((whole.nearest_patch, whole.coverage), (0.0, 1.0));
        let first = Mat::from_fn(5, 20, |_, j| line.row(0)[j]);
        assert_eq!(nearness(&first, &line, &all).coverage, 0.1, "only what is less than 0.12 away");
        // Two clips that are far apart: the way from one to the other is no step of either.
        let place = |i: usize| 0.06 * i as f32 + if i < 10 { 0.0 } else { 50.0 };
        let two = Mat::from_fn(20, 20, |i, j| (place(i) - place(j)).abs());
        let first = Mat::from_fn(5, 20, |_, j| two.row(0)[j]);
        let coverage = nearness(&first, &two, &Layout::clips(&[10, 10], 1)).coverage;
        assert!(coverage < 0.16, "{coverage}: 0.5 if the way between them counts");
    }

    #[test]
    fn nothing_moves_from_one_clip_to_the_next() {
        let (one, other) = (swinging(4.0, 30.0), swinging(2.5, 30.0));
        let takes = Takes::join(&[one.clone(), other.clone(), one.clone()]).unwrap();
        let (all, alone) = (Dynamics::of_takes(&takes, 0), Dynamics::of(&one, 0));
        assert_eq!(all.speeds.len(), 2 * (one.frames() - 1) + other.frames() - 1);
        assert!((all.jerk / alone.jerk - 1.0).abs() < 0.1, "{} {}", all.jerk, alone.jerk);
        assert!(all.speed_q999 <= 1.001 * alone.speed_q999);
        assert!(Dynamics::of(takes.clip(), 0).jerk > 1.5 * alone.jerk, "a cut is seen where there is one");
    }

    #[test]
    fn dynamics_do_not_depend_on_the_rate_and_see_a_freeze() {
        let (slow, fast) = (Dynamics::of(&swinging(4.0, 30.0), 0), Dynamics::of(&swinging(4.0, 120.0), 0));
        assert!((slow.speed_mean() / fast.speed_mean() - 1.0).abs() < 0.02);
        assert!((slow.jerk / fast.jerk - 1.0).abs() < 0.1);
        let still = inkrig_motion::time::sample_at(&swinging(4.0, 30.0), &[7.0; 50], 30.0).unwrap();
        assert_eq!(Dynamics::of(&still, 0).slower_than(0.01), 1.0);
    }
}
