//! Poses that are met exactly, and times that are asked for twice.

use super::Keys;
use super::resolve::Context;
use crate::{AlignError, Layout};

/// A pose at a time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hard {
    /// As it was given.
    pub(super) seconds: f64,
    /// Frame of the control at the matching rate.
    pub(super) row: usize,
    /// Frame of the result at the source's own rate.
    pub(super) out: usize,
    /// Matched frame of the source.
    pub(super) matched: usize,
    /// Frame of the source at its own rate, without lead-ins.
    pub(super) own: usize,
    /// Frame of the source as it was given.
    pub(super) given: usize,
}

impl Hard {
    /// The row and the column of the plan that are settled at a level: patches that hold the frames at the same place,
    /// as near to their middles as the ends of control and clip allow. `None` at a coarse level where the clip is shorter
    /// than a patch.
    pub(super) fn patches(
        &self,
        (full_rows, full_columns): (&Layout, &Layout),
        (rows, columns): (&Layout, &Layout),
    ) -> Option<(usize, usize)> {
        let (at, frame) = (full_rows.frame_in(rows, self.row), full_columns.frame_in(columns, self.matched));
        let (over, under) = (rows.covering(at), columns.covering(frame));
        let pairs = over.iter().flat_map(|&(row, offset)| {
            let same = under.iter().filter(move |(_, place)| *place == offset);
            same.map(move |&(column, _)| (offset.abs_diff(rows.patch() / 2), row, column))
        });
        match pairs.min() {
            Some((_, row, column)) => Some((row, column)),
            None => Some((rows.patch_around(at)?, columns.patch_around(frame)?)),
        }
    }
}

/// Says which keys ask for two things at one time.
pub(super) fn check_times(keys: &Keys, context: &Context<'_>) -> Result<(), AlignError> {
    let refuse = |what: String| Err(AlignError::Key { what });
    let hards: Vec<&Hard> = keys.hards().collect();
    for (index, hard) in hards.iter().enumerate() {
        if let Some(other) =
            hards[..index].iter().find(|other| other.out == hard.out && other.own != hard.own)
        {
            return refuse(format!(
                "at {} s both frame {} and frame {} are asked for: drop one of them, or move it to another time",
                hard.seconds, other.given, hard.given
            ));
        }
        if let Some(fixed) = keys.fixeds().find(|fixed| fixed.out.contains(&hard.out)) {
            return refuse(format!(
                "frame {} is asked for at {} s, inside of the part from {} that stays as it is: drop the key, or keep \
                 another part",
                hard.given,
                hard.seconds,
                fixed.span(context)
            ));
        }
    }
    let mut fixeds: Vec<_> = keys.fixeds().collect();
    fixeds.sort_by_key(|fixed| fixed.out.start);
    for pair in fixeds.windows(2) {
        if pair[0].out.end > pair[1].out.start {
            return refuse(format!(
                "the parts that stay as they are, from {} and from {}, overlap: give one part over both",
                pair[0].span(context),
                pair[1].span(context)
            ));
        }
    }
    let kept: usize = fixeds.iter().map(|fixed| fixed.out.len()).sum();
    let frames = (context.rows.frames() as f64 * context.step()).round() as usize;
    if !fixeds.is_empty() && kept >= frames {
        let what = "all of the result stays as it is, so nothing is left to make: keep a shorter part";
        return refuse(what.to_string());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_hold_the_frames_at_the_same_place() {
        let (rows, columns) = (Layout::open(40, 11), Layout::open(60, 11));
        let hard = |row, matched| Hard { seconds: 0.0, row, out: 0, matched, own: 0, given: 0 };
        let patches = |row, matched| hard(row, matched).patches((&rows, &columns), (&rows, &columns));
        assert_eq!(patches(20, 30), Some((15, 25)), "both in the middle");
        assert_eq!(patches(2, 30), Some((0, 28)), "at the control's beginning");
        assert_eq!(patches(20, 58), Some((11, 49)), "at the clip's end");
        assert_eq!(patches(0, 59), Some((0, 49)), "nothing in common");
        let ring = Layout::cyclic(40, 11);
        assert_eq!(hard(0, 30).patches((&ring, &columns), (&ring, &columns)), Some((35, 25)));
        // Of two clips the second has no patch at the coarse level.
        let (full, coarse) = (Layout::clips(&[80, 20], 11), Layout::clips(&[40, 10], 11));
        assert_eq!(hard(20, 90).patches((&rows, &full), (&rows, &coarse)), None);
        assert!(hard(20, 90).patches((&rows, &full), (&rows, &full)).is_some_and(|(_, column)| column >= 70));
    }
}
