//! Several clips of one character, one after the other.

use crate::{Clip, MotionError, TranslationTrack, time};
use std::ops::Range;

/// One or more takes of one skeleton at one frame rate, joined without anything in between. Motion never runs on from
/// one take into the next: whoever looks at neighbouring frames has to look at [`Takes::ranges`].
#[derive(Debug, Clone, PartialEq)]
pub struct Takes {
    clip: Clip,
    starts: Vec<usize>,
}

impl From<Clip> for Takes {
    fn from(clip: Clip) -> Self {
        Self { clip, starts: vec![0] }
    }
}

impl Takes {
    /// Joins clips. All get the frame rate of the first; a translation track that only some have is filled with the
    /// rest offset in the others.
    ///
    /// # Errors
    /// When there is no clip, or a skeleton differs from the first's in its joints, their parents, or offsets by more
    /// than a hundredth of the character's size.
    pub fn join(clips: &[Clip]) -> Result<Self, MotionError> {
        let first = clips.first().ok_or(MotionError::NoFrames)?;
        let clips = clips.iter().map(|clip| same_rate(clip, first)).collect::<Result<Vec<_>, _>>()?;
        for (index, clip) in clips.iter().enumerate() {
            if let Some(what) = difference(first, clip) {
                return Err(MotionError::OtherSkeleton { clip: index, what });
            }
        }
        let mut starts = Vec::with_capacity(clips.len());
        let mut rotations = Vec::new();
        let mut frames = 0;
        for clip in &clips {
            starts.push(frames);
            frames += clip.frames();
            rotations.extend((0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied()));
        }
        let tracked =
            (0..first.skeleton().len()).filter(|&joint| clips.iter().any(|clip| clip.track(joint).is_some()));
        let translations = tracked
            .map(|joint| TranslationTrack {
                joint,
                values: (clips.iter())
                    .flat_map(|clip| match clip.track(joint) {
                        Some(values) => values.to_vec(),
                        None => vec![clip.skeleton().joints()[joint].offset; clip.frames()],
                    })
                    .collect(),
            })
            .collect();
        let clip = Clip::new(first.skeleton().clone(), first.frame_rate(), rotations, translations)?;
        Ok(Self { clip, starts })
    }

    /// All frames, take after take.
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    /// The frames of every take.
    pub fn ranges(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let ends = self.starts.iter().skip(1).copied().chain(std::iter::once(self.clip.frames()));
        self.starts.iter().copied().zip(ends).map(|(start, end)| start..end)
    }

    /// Number of takes, at least 1.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// The same takes at about another frame rate, each on its own: see [`time::decimate`].
    ///
    /// # Errors
    /// When the frame rate is not usable.
    pub fn decimate(&self, frame_rate: f64) -> Result<Self, MotionError> {
        let takes = self.ranges().map(|range| time::decimate(&time::trim(&self.clip, range)?, frame_rate));
        Self::join(&takes.collect::<Result<Vec<_>, _>>()?)
    }
}

fn same_rate(clip: &Clip, first: &Clip) -> Result<Clip, MotionError> {
    if clip.frame_rate() == first.frame_rate() {
        Ok(clip.clone())
    } else {
        time::resample(clip, first.frame_rate())
    }
}

/// What differs between the skeletons of two clips.
fn difference(a: &Clip, b: &Clip) -> Option<String> {
    let (a, b) = (a.skeleton(), b.skeleton());
    if a.len() != b.len() {
        return Some(format!("{} joints against {}", b.len(), a.len()));
    }
    let tolerance = 0.01 * a.extent();
    a.joints().iter().zip(b.joints()).find_map(|(a, b)| {
        if a.name != b.name || a.parent != b.parent {
            return Some(format!("joint `{}` against `{}`", b.name, a.name));
        }
        // A root's offset only places the figure.
        let apart = a.parent.is_some() && a.offset.distance(b.offset) > tolerance;
        apart.then(|| format!("joint `{}` hangs elsewhere", b.name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton};
    use glam::{Quat, Vec3};
    use std::sync::Arc;

    fn clip(frames: usize, rate: f64, bone: f32, tracked: bool) -> Clip {
        let joints = vec![Joint::new("a", None, Vec3::ZERO), Joint::new("b", Some(0), Vec3::Y * bone)];
        let track = TranslationTrack { joint: 0, values: vec![Vec3::X; frames] };
        let tracks = if tracked { vec![track] } else { vec![] };
        Clip::new(Arc::new(Skeleton::new(joints).unwrap()), rate, vec![Quat::IDENTITY; 2 * frames], tracks)
            .unwrap()
    }

    #[test]
    fn takes_are_joined_at_one_rate() {
        let takes = Takes::join(&[clip(31, 30.0, 1.0, true), clip(61, 60.0, 1.001, false)]).unwrap();
        assert_eq!(takes.ranges().collect::<Vec<_>>(), [0..31, 31..62]);
        assert_eq!(takes.clip().track(0).unwrap()[40], Vec3::ZERO);
        let slow = takes.decimate(10.0).unwrap();
        assert_eq!(slow.ranges().collect::<Vec<_>>(), [0..11, 11..22]);
    }

    #[test]
    fn another_skeleton_is_refused() {
        let error = Takes::join(&[clip(3, 30.0, 1.0, true), clip(3, 30.0, 2.0, true)]).unwrap_err();
        assert!(error.to_string().contains("joint `b` hangs elsewhere"), "{error}");
        assert!(Takes::join(&[]).is_err());
    }
}
