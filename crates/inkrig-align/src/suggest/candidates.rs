//! Poses worth a keyframe: moments of the clip that are far from each other, and stand for what is near to them.

use super::moments::{Moment, Moments};
use crate::AlignError;
use inkrig_transport::Mat;

/// Moments among which the most ordinary one is looked for.
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
/// that is farthest from those before it. There are fewer when nothing else is left: all others are alike.
///
/// # Errors
/// When distances cannot be computed, which does not happen for [`Moments`] that could be made.
pub fn candidates(moments: &Moments, count: usize) -> Result<Vec<Candidate>, AlignError> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut nearest = vec![(0_usize, f32::INFINITY); moments.count()];
    let mut next = medoid(moments)?;
    while chosen.len() < count {
        for (slot, &distance) in nearest.iter_mut().zip(&moments.distances_from(next)?) {
            if distance < slot.1 {
                *slot = (chosen.len(), distance);
            }
        }
        chosen.push(next);
        let (patch, distance) = farthest(&nearest);
        if distance < ALIKE {
            break;
        }
        next = patch;
    }
    let all = moments.count() as f64;
    let found = chosen.iter().enumerate().map(|(index, &patch)| {
        let own = || nearest.iter().filter(|(owner, _)| *owner == index);
        Candidate {
            patch,
            moment: moments.middle(patch),
            share: own().count() as f64 / all,
            radius: f64::from(own().map(|(_, distance)| *distance).fold(0.0, f32::max)),
        }
    });
    Ok(found.collect())
}

/// The patch whose distances to the others sum to least, among evenly spread ones.
fn medoid(moments: &Moments) -> Result<usize, AlignError> {
    let spread = moments.spread(SAMPLE);
    let distances: Mat<f32> = moments.distances_of(&spread)?;
    let sum = |row: usize| distances.row(row).iter().map(|&distance| f64::from(distance)).sum::<f64>();
    let sums: Vec<f64> = (0..spread.len()).map(sum).collect();
    let best = (0..spread.len()).min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    Ok(best.map_or(0, |index| spread[index]))
}

/// The first of the patches that are farthest from their nearest candidate.
fn farthest(nearest: &[(usize, f32)]) -> (usize, f32) {
    nearest.iter().enumerate().fold(
        (0, 0.0),
        |best, (patch, &(_, distance))| {
            if distance > best.1 { (patch, distance) } else { best }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use crate::testing::swinging;

    #[test]
    fn candidates_are_far_apart_and_stand_for_the_whole_clip() {
        let moments = Moments::of(&swinging(6.0, 30.0).into(), &Options::default()).unwrap();
        let found = candidates(&moments, 5).unwrap();
        assert_eq!(found.len(), 5);
        assert!((found.iter().map(|c| c.share).sum::<f64>() - 1.0).abs() < 1e-12);
        let reach = found.iter().map(|c| c.radius).fold(0.0, f64::max);
        for (index, candidate) in found.iter().enumerate() {
            let distances = moments.distances_from(candidate.patch).unwrap();
            for other in &found[..index] {
                assert!(f64::from(distances[other.patch]) >= reach, "farthest first");
            }
        }
        // More of them stand for less each.
        let more = candidates(&moments, 10).unwrap();
        assert_eq!(
            more[..5].iter().map(|c| c.patch).collect::<Vec<_>>(),
            found.iter().map(|c| c.patch).collect::<Vec<_>>()
        );
        assert!(more.iter().map(|c| c.radius).fold(0.0, f64::max) < reach);
    }

    #[test]
    fn what_repeats_is_not_suggested_twice() {
        let once = swinging(2.0, 30.0);
        let takes = inkrig_motion::Takes::join(&[once.clone(), once]).unwrap();
        let moments = Moments::of(&takes, &Options::default()).unwrap();
        let found = candidates(&moments, 1000).unwrap();
        assert!(found.len() < 60, "{}", found.len());
        assert!(found.last().unwrap().radius < 0.25);
    }
}
