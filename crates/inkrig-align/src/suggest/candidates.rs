//! Poses worth a keyframe: moments of the clip that are far from each other, and stand for what is near to them.

use super::moments::{Moment, Moments};
use crate::AlignError;
use inkrig_transport::Mat;

/// Moments among which candidates are looked for; with clips longer than this many patches every few.
const SAMPLE: usize = 512;

/// Moments nearer than this to one that is suggested already are no other movement; in mean distances.
const ALIKE: f32 = 0.25;

/// A moment that is suggested as a keyframe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Its patch.
    pub patch: usize,
    /// The pose in the middle of it.
    pub moment: Moment,
    /// Share of the clip's moments that are nearer to it than to the others, 0..=1. All shares sum to 1.
    pub share: f64,
    /// How far the farthest of these is from it, in mean distances of the clip's moments.
    pub radius: f64,
}

/// At most `count` moments of the clip: first the one that is nearest to all (the medoid), then again and again the one
/// that leaves the least sum of squared distances to the nearest. Unlike the farthest point, that is no odd moment at
/// the rim, but the middle of a movement that was not there yet. There are fewer when all others are alike.
///
/// # Errors
/// When distances cannot be computed, which does not happen for [`Moments`] that could be made.
pub fn candidates(moments: &Moments, count: usize) -> Result<Vec<Candidate>, AlignError> {
    let spread = moments.spread(SAMPLE);
    let distances = moments.distances_of(&spread)?;
    let mut chosen: Vec<usize> = Vec::new();
    let mut nearest = vec![f32::INFINITY; moments.count()];
    while chosen.len() < count {
        let Some(row) = best_addition(&distances, &spread, &nearest) else { break };
        chosen.push(row);
        for (slot, &distance) in nearest.iter_mut().zip(distances.row(row)) {
            *slot = slot.min(distance);
        }
    }
    let all = moments.count() as f64;
    let mut owned = vec![(0_usize, 0.0_f32); chosen.len()];
    for patch in 0..moments.count() {
        let to = |index: usize| distances.row(chosen[index])[patch];
        if let Some(owner) = (0..chosen.len()).min_by(|&a, &b| to(a).total_cmp(&to(b))) {
            owned[owner] = (owned[owner].0 + 1, owned[owner].1.max(to(owner)));
        }
    }
    let found = chosen.iter().zip(owned).map(|(&row, (own, farthest))| Candidate {
        patch: spread[row],
        moment: moments.middle(spread[row]),
        share: own as f64 / all,
        radius: f64::from(farthest),
    });
    Ok(found.collect())
}

/// The sampled moment that leaves the least sum of squared distances to the nearest chosen one; `None` when all of them
/// are like one that is chosen already.
fn best_addition(distances: &Mat<f32>, spread: &[usize], nearest: &[f32]) -> Option<usize> {
    let left = |row: usize| -> f64 {
        distances.row(row).iter().zip(nearest).map(|(a, &b)| f64::from(a.min(b)).powi(2)).sum()
    };
    let open = (0..spread.len()).filter(|&row| nearest[spread[row]] >= ALIKE);
    open.map(|row| (row, left(row))).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use crate::testing::swinging;

    #[test]
    fn candidates_differ_and_stand_for_the_whole_clip() {
        let moments = Moments::of(&swinging(6.0, 30.0).into(), &Options::default()).unwrap();
        let found = candidates(&moments, 5).unwrap();
        assert_eq!(found.len(), 5);
        assert!((found.iter().map(|c| c.share).sum::<f64>() - 1.0).abs() < 1e-12);
        let sum = |patch: usize| moments.distances_from(patch).unwrap().iter().map(|d| d * d).sum::<f32>();
        assert!(
            (0..moments.count()).all(|patch| sum(patch) >= 0.999 * sum(found[0].patch)),
            "a medoid first"
        );
        for (index, candidate) in found.iter().enumerate() {
            let distances = moments.distances_from(candidate.patch).unwrap();
            assert!(found[..index].iter().all(|other| distances[other.patch] >= ALIKE));
        }
        // The order does not depend on how many are asked for.
        let more = candidates(&moments, 10).unwrap();
        let patches = |found: &[Candidate]| found.iter().map(|c| c.patch).collect::<Vec<_>>();
        assert_eq!(patches(&more[..5]), patches(&found));
    }

    #[test]
    fn what_repeats_is_not_suggested_twice() {
        let once = swinging(2.0, 30.0);
        let takes = inkrig_motion::Takes::join(&[once.clone(), once]).unwrap();
        let moments = Moments::of(&takes, &Options::default()).unwrap();
        let found = candidates(&moments, 1000).unwrap();
        assert!(found.len() > 3 && found.len() < 60, "{}", found.len());
        assert!(found.iter().all(|candidate| candidate.radius < 2.0 * f64::from(ALIKE)));
    }
}
