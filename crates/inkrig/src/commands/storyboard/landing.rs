//! Motions that land on a character: of all that are sampled for a frame, the best need not be the one that a body of other build can do.

use super::making::GoOn;
use super::onto::Character;
use super::{Asked, Made, Next, Takes, Workshop};
use crate::error::CliError;
use inkrig_sketch::storyboard::Frame;
use inkrig_storyboard::Generated;

/// So many animations are tried at most.
const MOST: usize = 32;

impl Workshop<'_> {
    /// Makes one animation, as [`Workshop::make_near`] does. Where that is beyond a limit on the character, the other motions of one frame
    /// after the other are tried, of frames that say no take, until the whole keeps all limits; what is beyond them by less stays.
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
        let mut best = self.make_near(asked, near, &mut takes, watch)?;
        let Some(character) = character else { return Ok(best) };
        let mut least = character.beyond(&best.animation.clip)?;
        let mut frames: Vec<Frame> = asked.iter().map(|asked| asked.frame.clone()).collect();
        let tries =
            asked.iter().zip(&best.ranked).enumerate().filter(|(_, (asked, _))| asked.frame.take == 0);
        let tries = tries.flat_map(|(at, (_, ranked))| (1..ranked.len() as u32).map(move |take| (at, take)));
        for (at, take) in tries.take(MOST).collect::<Vec<_>>() {
            if least <= 0.0 {
                break;
            }
            let kept = std::mem::replace(&mut frames[at].take, take);
            let other: Vec<Asked<'_>> =
                asked.iter().zip(&frames).map(|(asked, frame)| Asked { frame, ..*asked }).collect();
            let other = self.make_near(&other, near, &mut takes, &mut |_| watch(Next::Character))?;
            let beyond = character.beyond(&other.animation.clip)?;
            if beyond < least {
                (best, least) = (other, beyond);
            } else {
                frames[at].take = kept;
            }
        }
        Ok(best)
    }
}
