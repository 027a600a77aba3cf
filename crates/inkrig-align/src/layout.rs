//! Where patches may stand in a table of frames: windows of equal length, one a frame, that do not cross a cut.

use std::ops::Range;

/// The patches of a table of frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    patch: usize,
    /// Frames of every clip, one after the other without gaps.
    parts: Vec<Range<usize>>,
    cyclic: bool,
}

/// Consecutive patches that stand on consecutive frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// Number of the first patch.
    pub patch: usize,
    /// Its first frame.
    pub frame: usize,
    /// How many patches there are.
    pub count: usize,
}

impl Layout {
    /// One clip of `frames` frames, patches of `patch` frames.
    pub fn open(frames: usize, patch: usize) -> Self {
        Self::clips(&[frames], patch)
    }

    /// Several clips after each other; no patch crosses from one to the next.
    pub fn clips(lengths: &[usize], patch: usize) -> Self {
        let mut end = 0;
        let parts = lengths.iter().map(|&length| {
            end += length;
            end - length..end
        });
        Self { patch, parts: parts.collect(), cyclic: false }
    }

    /// A loop of `frames` frames: the last frame is followed by the first, so there are as many patches as frames.
    pub fn cyclic(frames: usize, patch: usize) -> Self {
        Self { patch, parts: std::iter::once(0..frames).collect(), cyclic: true }
    }

    /// Frames of a patch.
    pub fn patch(&self) -> usize {
        self.patch
    }

    /// Whether the table is a loop.
    pub fn is_cyclic(&self) -> bool {
        self.cyclic
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.parts.last().map_or(0, |part| part.end)
    }

    /// Rows of a table that holds these frames: a loop repeats its first `patch - 1` frames at its end, so that every
    /// patch is a plain window.
    pub fn rows(&self) -> usize {
        self.frames() + if self.cyclic { self.patch - 1 } else { 0 }
    }

    /// Number of patches.
    pub fn patches(&self) -> usize {
        self.runs().map(|run| run.count).sum()
    }

    /// The patches of every clip, in order; clips shorter than a patch have none.
    pub fn runs(&self) -> impl Iterator<Item = Run> + '_ {
        let mut patch = 0;
        self.parts.iter().filter_map(move |part| {
            let count = if self.cyclic { part.len() } else { (part.len() + 1).saturating_sub(self.patch) };
            let run = Run { patch, frame: part.start, count };
            patch += count;
            (count > 0).then_some(run)
        })
    }

    /// The first frame of every patch.
    pub fn first_frames(&self) -> Vec<usize> {
        self.runs().flat_map(|run| run.frame..run.frame + run.count).collect()
    }

    /// The patches that hold a frame, each with the place of the frame in it.
    pub fn covering(&self, frame: usize) -> Vec<(usize, usize)> {
        if self.cyclic {
            let frames = self.frames();
            return (0..self.patch)
                .map(|offset| ((frame + self.patch * frames - offset) % frames, offset))
                .collect();
        }
        let covers =
            self.runs().filter(|run| (run.frame..run.frame + run.count + self.patch - 1).contains(&frame));
        covers
            .flat_map(|run| {
                let place = frame - run.frame;
                ((place + 1).saturating_sub(self.patch)..=place.min(run.count - 1))
                    .map(move |patch| (run.patch + patch, place - patch))
            })
            .collect()
    }

    /// The same layout with another number of frames: every clip scaled alike, cuts and loops kept.
    pub fn resampled(&self, frames: usize) -> Self {
        let scale = frames as f64 / self.frames().max(1) as f64;
        let mut start = 0;
        let parts = self.parts.iter().map(|part| {
            let end = (part.end as f64 * scale).round() as usize;
            let range = start..end;
            start = end;
            range
        });
        Self { patch: self.patch, parts: parts.collect(), cyclic: self.cyclic }
    }

    /// Where a frame of this layout is in the same clips at another length.
    pub fn frame_in(&self, other: &Self, frame: usize) -> usize {
        for (own, new) in self.parts.iter().zip(&other.parts) {
            if own.contains(&frame) && new.is_empty() {
                return new.start.min(other.frames().saturating_sub(1));
            }
            if own.contains(&frame) {
                let place = (frame - own.start) as f64 / (own.len() - 1).max(1) as f64;
                return new.start + (place * (new.len() - 1) as f64).round() as usize;
            }
        }
        frame.min(other.frames().saturating_sub(1))
    }

    /// Frames of every clip.
    pub fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    /// The patches that the next one follows in the same clip.
    pub fn followed(&self) -> Vec<usize> {
        self.runs().flat_map(|run| run.patch..run.patch + run.count - 1).collect()
    }

    /// Numbers of the clips, from 0, that are shorter than a patch and so have none.
    pub fn without_patches(&self) -> impl Iterator<Item = usize> + '_ {
        let short = |part: &Range<usize>| !self.cyclic && part.len() < self.patch;
        self.parts.iter().enumerate().filter(move |(_, part)| short(part)).map(|(clip, _)| clip)
    }

    /// The frames of the clip that a frame is of.
    pub fn part_of(&self, frame: usize) -> Option<Range<usize>> {
        self.parts.iter().find(|part| part.contains(&frame)).cloned()
    }

    /// The patch of the frame's own clip whose middle frame is nearest to it; `None` where that clip has no patch.
    pub fn patch_around(&self, frame: usize) -> Option<usize> {
        if self.cyclic {
            return self.nearest_patch(frame);
        }
        let run =
            self.runs().find(|run| (run.frame..run.frame + run.count + self.patch - 1).contains(&frame))?;
        let first = frame.saturating_sub(self.patch / 2).clamp(run.frame, run.frame + run.count - 1);
        Some(run.patch + first - run.frame)
    }

    /// The patch whose middle frame is nearest to a frame, of whatever clip, if there is any patch.
    pub fn nearest_patch(&self, frame: usize) -> Option<usize> {
        let half = self.patch / 2;
        if self.cyclic {
            let frames = self.frames();
            return (frames > 0).then(|| (frame + self.patch * frames - half) % frames);
        }
        let distance = |run: &Run, place: usize| (run.frame + place + half).abs_diff(frame);
        (self.runs())
            .map(|run| {
                (frame.saturating_sub(half).clamp(run.frame, run.frame + run.count - 1) - run.frame, run)
            })
            .min_by_key(|(place, run)| distance(run, *place))
            .map(|(place, run)| run.patch + place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_do_not_cross_cuts() {
        let layout = Layout::clips(&[6, 2, 5], 3);
        assert_eq!((layout.frames(), layout.rows(), layout.patches()), (13, 13, 7));
        let runs: Vec<Run> = layout.runs().collect();
        assert_eq!(runs[0], Run { patch: 0, frame: 0, count: 4 });
        assert_eq!(runs[1], Run { patch: 4, frame: 8, count: 3 });
        assert_eq!(layout.covering(5), [(3, 2)]);
        assert_eq!(layout.covering(7), []);
        assert_eq!(layout.covering(10), [(4, 2), (5, 1), (6, 0)]);
        assert_eq!(layout.patch_around(2), Some(1));
        assert_eq!(layout.patch_around(7), None, "a clip shorter than a patch has none");
        assert_eq!(layout.nearest_patch(7), Some(4));
        assert_eq!(layout.patch_around(8), Some(4));
        assert_eq!((layout.part_of(7), layout.part_of(13)), (Some(6..8), None));
        assert_eq!(layout.without_patches().collect::<Vec<_>>(), [1]);
        assert_eq!(layout.followed(), [0, 1, 2, 4, 5]);
        assert_eq!(layout.patch_around(12), Some(6));
    }

    #[test]
    fn a_loop_has_a_patch_for_every_frame() {
        let layout = Layout::cyclic(5, 3);
        assert_eq!((layout.frames(), layout.rows(), layout.patches()), (5, 7, 5));
        assert_eq!(layout.covering(0), [(0, 0), (4, 1), (3, 2)]);
        assert_eq!(layout.patch_around(0), Some(4));
    }

    #[test]
    fn scaling_keeps_the_cuts_in_place() {
        let layout = Layout::clips(&[60, 20, 40], 11).resampled(60);
        assert_eq!(layout.parts(), [0..30, 30..40, 40..60]);
    }
}
