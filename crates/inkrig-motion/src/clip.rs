//! A motion: a skeleton, and for every frame a rotation for all joints and translations where present.

use crate::{MotionError, Skeleton};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The local translation of one joint over time. It takes the place of the joint's rest offset.
#[derive(Debug, Clone, PartialEq)]
pub struct TranslationTrack {
    /// Index of the joint.
    pub joint: usize,
    /// One value a frame, in the parent's space, metres.
    pub values: Vec<Vec3>,
}

/// A motion of one skeleton. Rotations are frames x joints, local to the parent, unit length.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    skeleton: Arc<Skeleton>,
    frame_rate: f64,
    rotations: Vec<Quat>,
    translations: Vec<TranslationTrack>,
}

impl Clip {
    /// Frame rates that a clip may have, frames a second.
    pub const FRAME_RATES: std::ops::RangeInclusive<f64> = 0.01..=100_000.0;

    /// Checks and keeps the parts. `rotations` is frames x joints, row by row; they are normalised here.
    /// Every track has one value a frame. The rotation of an end site is ignored by kinematics' users but present.
    ///
    /// # Errors
    /// When sizes disagree, a number is not finite, a quaternion is zero, a track is doubled, there is no frame,
    /// or the frame rate is outside [`Self::FRAME_RATES`].
    pub fn new(
        skeleton: Arc<Skeleton>,
        frame_rate: f64,
        mut rotations: Vec<Quat>,
        translations: Vec<TranslationTrack>,
    ) -> Result<Self, MotionError> {
        if !Self::FRAME_RATES.contains(&frame_rate) {
            return Err(MotionError::FrameRate(frame_rate));
        }
        let joints = skeleton.len();
        let frames = rotations.len() / joints;
        if frames * joints != rotations.len() {
            let expected = (frames + 1) * joints;
            return Err(MotionError::Length { what: "rotations", expected, got: rotations.len() });
        }
        if frames == 0 {
            return Err(MotionError::NoFrames);
        }
        for (index, rotation) in rotations.iter_mut().enumerate() {
            let (joint, frame) = (index % joints, index / joints);
            if !rotation.is_finite() {
                return Err(MotionError::NotFinite { what: "a rotation", joint, frame });
            }
            let length = rotation.length();
            if !length.is_normal() {
                return Err(MotionError::ZeroRotation { joint, frame });
            }
            *rotation = rotation.normalize();
        }
        check_tracks(&translations, joints, frames)?;
        Ok(Self { skeleton, frame_rate, rotations, translations })
    }

    /// The character.
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Frames a second.
    pub fn frame_rate(&self) -> f64 {
        self.frame_rate
    }

    /// Number of frames, at least 1.
    pub fn frames(&self) -> usize {
        self.rotations.len() / self.skeleton.len()
    }

    /// Seconds from the first frame to the last.
    pub fn duration(&self) -> f64 {
        (self.frames() - 1) as f64 / self.frame_rate
    }

    /// Local rotations of all joints at a frame.
    ///
    /// # Panics
    /// When `frame` is not below [`Self::frames`].
    pub fn rotations(&self, frame: usize) -> &[Quat] {
        let joints = self.skeleton.len();
        &self.rotations[frame * joints..(frame + 1) * joints]
    }

    /// All translation tracks.
    pub fn translations(&self) -> &[TranslationTrack] {
        &self.translations
    }

    /// The translation track of a joint, when it has one.
    pub fn track(&self, joint: usize) -> Option<&[Vec3]> {
        self.translations.iter().find(|track| track.joint == joint).map(|track| track.values.as_slice())
    }

    /// Writes the local translation of every joint at a frame: its track's value, or else its rest offset.
    ///
    /// # Panics
    /// When `out` is shorter than the skeleton or `frame` is not below [`Self::frames`].
    pub fn local_translations(&self, frame: usize, out: &mut [Vec3]) {
        for (slot, joint) in out.iter_mut().zip(self.skeleton.joints()) {
            *slot = joint.offset;
        }
        for track in &self.translations {
            out[track.joint] = track.values[frame];
        }
    }

    /// The joint that carries the character through the world: the first whose translation varies by more than a
    /// ten-thousandth of the character's size and that carries at least half of the joints of its tree, as a shoulder that
    /// is pulled out does not; the first root when none does.
    pub fn travel_joint(&self) -> usize {
        let threshold = 1e-4 * self.skeleton.extent();
        let joints = self.skeleton.joints();
        let mut carried = vec![1_usize; joints.len()];
        for (index, joint) in joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                carried[parent] += carried[index];
            }
        }
        let mut root: Vec<usize> = Vec::with_capacity(joints.len());
        for (index, joint) in joints.iter().enumerate() {
            root.push(joint.parent.map_or(index, |parent| root[parent]));
        }
        let carries = |joint: usize| 2 * carried[joint] >= carried[root[joint]];
        let mut moving: Vec<usize> = (self.translations.iter())
            .filter(|track| carries(track.joint) && variation(&track.values) > threshold)
            .map(|track| track.joint)
            .collect();
        moving.sort_unstable();
        moving.first().copied().or_else(|| self.skeleton.roots().next()).unwrap_or(0)
    }

    /// The same motion said to play at another frame rate; no frame is changed.
    ///
    /// # Errors
    /// When the rate is outside [`Self::FRAME_RATES`].
    pub fn with_frame_rate(mut self, frame_rate: f64) -> Result<Self, MotionError> {
        if !Self::FRAME_RATES.contains(&frame_rate) {
            return Err(MotionError::FrameRate(frame_rate));
        }
        self.frame_rate = frame_rate;
        Ok(self)
    }
}

/// How far a track's values spread: the longest side of their bounding box, metres.
pub(crate) fn variation(values: &[Vec3]) -> f32 {
    let low = values.iter().copied().fold(Vec3::MAX, Vec3::min);
    let high = values.iter().copied().fold(Vec3::MIN, Vec3::max);
    if values.is_empty() { 0.0 } else { (high - low).max_element() }
}

fn check_tracks(translations: &[TranslationTrack], joints: usize, frames: usize) -> Result<(), MotionError> {
    let mut seen = vec![false; joints];
    for track in translations {
        let joint = track.joint;
        match seen.get_mut(joint) {
            None => return Err(MotionError::Track { joint, why: "the skeleton has no such joint" }),
            Some(seen) if *seen => {
                return Err(MotionError::Track { joint, why: "the joint has two of them" });
            }
            Some(seen) => *seen = true,
        }
        if track.values.len() != frames {
            let got = track.values.len();
            return Err(MotionError::Length { what: "a translation track", expected: frames, got });
        }
        if let Some(frame) = track.values.iter().position(|value| !value.is_finite()) {
            return Err(MotionError::NotFinite { what: "a translation", joint, frame });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;

    fn two_joints() -> Arc<Skeleton> {
        Arc::new(
            Skeleton::new(vec![
                Joint::new("root", None, Vec3::ZERO),
                Joint::new("hips", Some(0), Vec3::Y),
                Joint::end("hips_end", 1, Vec3::Y),
            ])
            .unwrap(),
        )
    }

    #[test]
    fn travel_is_found_below_a_still_root() {
        let still = TranslationTrack { joint: 0, values: vec![Vec3::ZERO; 2] };
        let moving = TranslationTrack { joint: 1, values: vec![Vec3::Y, Vec3::new(0.0, 1.0, 3.0)] };
        let clip = Clip::new(two_joints(), 30.0, vec![Quat::IDENTITY; 6], vec![still, moving]).unwrap();
        assert_eq!(clip.travel_joint(), 1);
        assert_eq!(clip.frames(), 2);
    }

    #[test]
    fn a_shoulder_that_is_pulled_out_does_not_travel() {
        let joints =
            [("root", None), ("hips", Some(0)), ("arm", Some(1)), ("leg", Some(1)), ("foot", Some(3))];
        let joints = joints.map(|(name, parent)| Joint::new(name, parent, Vec3::Y));
        let skeleton = Arc::new(Skeleton::new(joints.to_vec()).unwrap());
        let moving = |joint| TranslationTrack { joint, values: vec![Vec3::Y, Vec3::new(0.0, 1.0, 3.0)] };
        let travels = |tracks| {
            Clip::new(skeleton.clone(), 30.0, vec![Quat::IDENTITY; 10], tracks).unwrap().travel_joint()
        };
        assert_eq!(travels(vec![moving(2)]), 0);
        assert_eq!(travels(vec![moving(1), moving(2)]), 1);
    }

    #[test]
    fn bad_parts_are_refused() {
        let skeleton = two_joints();
        let identity = vec![Quat::IDENTITY; 6];
        let track = |joint, values| vec![TranslationTrack { joint, values }];
        let new = |rate, rotations, tracks| Clip::new(skeleton.clone(), rate, rotations, tracks);
        assert!(matches!(new(0.0, identity.clone(), vec![]), Err(MotionError::FrameRate(_))));
        assert!(matches!(new(f64::NAN, identity.clone(), vec![]), Err(MotionError::FrameRate(_))));
        assert!(matches!(new(30.0, vec![], vec![]), Err(MotionError::NoFrames)));
        assert!(matches!(new(30.0, identity[..5].to_vec(), vec![]), Err(MotionError::Length { .. })));
        let zero = vec![Quat::from_xyzw(0.0, 0.0, 0.0, 0.0); 6];
        assert!(matches!(new(30.0, zero, vec![]), Err(MotionError::ZeroRotation { .. })));
        let nan = track(0, vec![Vec3::ZERO, Vec3::NAN]);
        assert!(matches!(new(30.0, identity.clone(), nan), Err(MotionError::NotFinite { frame: 1, .. })));
        assert!(matches!(new(30.0, identity, track(9, vec![])), Err(MotionError::Track { joint: 9, .. })));
    }
}
