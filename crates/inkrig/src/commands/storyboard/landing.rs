//! Motions that land on a character: of all that are sampled for a frame, the best need not be the one that a body of other build can do.

use super::making::GoOn;
use super::onto::Character;
use super::{Asked, Made, Next, Takes, Workshop, poses};
use crate::error::CliError;
use inkrig_sketch::storyboard::Frame;
use inkrig_storyboard::{Generated, StoryboardError, misses};

/// So many animations are tried at most, and so many frames of them.
const MOST: usize = 32;
const MOST_FRAMES: usize = 4000;
/// What follows the drawing less well by more than that in the mean is no other way to do it, metres.
const FARTHER: f32 = 0.01;

impl Workshop<'_> {
    /// Makes one animation, as [`Workshop::make_near`] does. Where that is beyond a limit on the character, other motions of its frames
    /// are tried, until the whole keeps all limits and is as near to the drawing; where none does, the best of each frame stay. A frame
    /// that says a take keeps it, and one whose path others go along keeps its motion; so do all where joints were put in space, which
    /// was said of motions that somebody saw.
    ///
    /// # Errors
    /// As [`Workshop::make`], and where the character is none that a person's motion goes onto.
    pub(super) fn make_on(
        &self,
        character: Option<&Character>,
        asked: &[Asked<'_>],
        near: &[Generated],
        watch: &mut dyn FnMut(Next) -> GoOn,
    ) -> Result<Made, CliError> {
        let mut takes = Takes::default();
        let best = self.make_near(asked, near, &mut takes, watch)?;
        let Some(character) = character else { return Ok(best) };
        let first = character.beyond(&best.animation.clip)?;
        if asked.iter().any(|asked| !asked.frame.edits.is_empty()) {
            return Ok(best);
        }
        let leads = |number| asked.iter().any(|other| other.read.plan.path_of(other.number) == Some(number));
        let free = |asked: &Asked<'_>| asked.frame.take == 0 && !leads(asked.number);
        let counts: Vec<usize> = asked
            .iter()
            .zip(&best.ranked)
            .map(|(asked, ranked)| if free(asked) { ranked.len() } else { 1 })
            .collect();
        let most = MOST.min(MOST_FRAMES / best.animation.clip.frames().max(1));
        let near_enough = off(&best) + FARTHER;
        let mut last = None;
        let landed = search(first, &counts, most, &mut |chosen| {
            let chosen = asked.iter().zip(chosen).map(|(asked, chosen)| {
                let take = if *chosen > 0 { *chosen as u32 } else { asked.frame.take };
                Frame { take, ..asked.frame.clone() }
            });
            let frames: Vec<Frame> = chosen.collect();
            let other: Vec<Asked<'_>> =
                asked.iter().zip(&frames).map(|(asked, frame)| Asked { frame, ..*asked }).collect();
            let other = match self.make_near(&other, near, &mut takes, &mut |_| watch(Next::Character)) {
                Ok(other) => other,
                Err(CliError::Storyboard { path, cause }) if matches!(*cause, StoryboardError::Stopped) => {
                    return Err(CliError::Storyboard { path, cause });
                }
                // What cannot be made with this motion is no other way.
                Err(_) => return Ok(f64::INFINITY),
            };
            let beyond = if off(&other) > near_enough {
                f64::INFINITY
            } else {
                character.beyond(&other.animation.clip).unwrap_or(f64::INFINITY)
            };
            last = Some(other);
            Ok(beyond)
        })?;
        Ok(last.filter(|_| landed).unwrap_or(best))
    }
}

/// How far an animation is from all that was asked for, in the mean.
fn off(made: &Made) -> f32 {
    let [mean, _] = misses(&poses(&made.animation.clip), &made.animation.goals.concat());
    mean
}

/// Looks for takes that nothing is wrong with, beginning with the first of each: the second of every frame, then the third, and so on,
/// `most` tries in all. What is better than before stays while others are tried. Gives whether the last try had nothing wrong.
fn search<E>(
    first: f64,
    counts: &[usize],
    most: usize,
    wrong: &mut dyn FnMut(&[usize]) -> Result<f64, E>,
) -> Result<bool, E> {
    let (mut least, mut chosen) = (first, vec![0; counts.len()]);
    if least <= 0.0 {
        return Ok(false);
    }
    let takes = counts.iter().copied().max().unwrap_or(1);
    let tries = (1..takes).flat_map(|take| (0..counts.len()).map(move |at| (at, take)));
    for (at, take) in tries.filter(|(at, take)| *take < counts[*at]).take(most) {
        let before = std::mem::replace(&mut chosen[at], take);
        let own = wrong(&chosen)?;
        if own <= 0.0 {
            return Ok(true);
        }
        if own < least {
            least = own;
        } else {
            chosen[at] = before;
        }
    }
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is tried when each try is as wrong as a table says, and whether it ends well.
    fn tried(counts: &[usize], most: usize, wrong: impl Fn(&[usize]) -> f64) -> (Vec<Vec<usize>>, bool) {
        let mut tried = Vec::new();
        let landed = search(wrong(&vec![0; counts.len()]), counts, most, &mut |chosen| {
            tried.push(chosen.to_vec());
            Ok::<_, ()>(wrong(chosen))
        });
        (tried, landed.unwrap())
    }

    #[test]
    fn other_motions_are_tried_until_one_lands() {
        // The second frame's third take takes the most away, the first frame's second take the rest.
        let (all, landed) = tried(&[3, 3], 9, |chosen| {
            3.0 - f64::from(u8::from(chosen[0] == 1)) - 2.0 * f64::from(u8::from(chosen[1] == 2))
        });
        assert_eq!((all, landed), (vec![vec![1, 0], vec![1, 1], vec![2, 0], vec![1, 2]], true));
    }

    #[test]
    fn what_makes_nothing_better_is_taken_back_and_tries_have_an_end() {
        let worse = |chosen: &[usize]| 1.0 + chosen.iter().sum::<usize>() as f64;
        let (all, landed) = tried(&[2, 1, 3], 9, worse);
        assert_eq!((all, landed), (vec![vec![1, 0, 0], vec![0, 0, 1], vec![0, 0, 2]], false));
        let (all, landed) = tried(&[64; 5], 7, worse);
        assert!(all.len() == 7 && !landed, "{all:?}");
        assert_eq!(tried(&[4, 4], 9, |_| 0.0), (Vec::new(), false), "nothing was wrong");
        assert_eq!(tried(&[], 9, |_| 1.0), (Vec::new(), false));
        assert_eq!(tried(&[2], 9, |_| f64::INFINITY), (vec![vec![1]], false));
        let stopped = search(1.0, &[2], 9, &mut |_| Err("stopped"));
        assert_eq!(stopped, Err("stopped"));
    }
}
