//! Keys that an animator can edit: few, on whole frames, with tangents, or held.
//!
//! A [`KeyedClip`] is plain data that writers take. [`sparse`] fits one to a clip within a tolerance, [`stepped`] holds
//! poses, [`KeyedClip::clip`] gives the frames back, [`deviation`] says how far two motions are apart.

mod angles;
mod block;
mod body;
mod deviation;
mod fit;
mod reference;
mod refine;
mod sparse;
mod spline;
mod stepped;

pub use deviation::{Deviation, deviation};
pub use sparse::{SparseOptions, sparse};
pub use stepped::stepped;

use crate::{Clip, MotionError, Skeleton, TranslationTrack};
use fit::hermite;
use glam::{Quat, Vec3};
use std::sync::Arc;

/// What a motion does between two keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of a key stays until the next one.
    Step,
    /// A cubic Hermite spline of each number; rotations are brought to unit length afterwards, as in glTF's CUBICSPLINE
    /// (glTF 2.0, appendix C.5).
    Spline,
}

/// The numbers of a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotationForm {
    /// x, y, z and w of a quaternion of unit length, as in glTF.
    Quaternion,
    /// Angles about x, y and z, radians, and 0: about x first, then y, then z, axes that stay where they are, as in FBX. The
    /// angles run on; they are not brought into any range.
    Angles {
        /// The turn that brings those axes to the clip's.
        axes: Quat,
    },
}

/// A value at a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key<const N: usize> {
    /// The frame that it stands on, from 0.
    pub frame: usize,
    /// A rotation as [`KeyedClip::form`] says, or a translation in metres.
    pub value: [f32; N],
    /// What the value changes by in a second just before the key. Nothing for [`Interpolation::Step`].
    pub slope_in: [f32; N],
    /// The same just after it; another than before where the curve has a corner.
    pub slope_out: [f32; N],
}

/// The keys of one joint: of its rotation (4 numbers) or its translation (3).
#[derive(Debug, Clone, PartialEq)]
pub struct Track<const N: usize> {
    /// Index of the joint.
    pub joint: usize,
    /// At least one, frames rising. Of a track that moves the first stands on the first frame and the last on the last.
    pub keys: Vec<Key<N>>,
}

/// A motion as keys. Rotations are local to the parent; neighbouring keys have the signs that lie nearer.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyedClip {
    /// The character.
    pub skeleton: Arc<Skeleton>,
    /// Frames a second, by which keys are placed.
    pub frame_rate: f64,
    /// Frames from the first to the last, both counted; at least 1.
    pub frames: usize,
    /// What happens between keys.
    pub interpolation: Interpolation,
    /// What the numbers of rotations are.
    pub form: RotationForm,
    /// One track for each joint, in order. One key where the joint never turns.
    pub rotations: Vec<Track<4>>,
    /// Of joints with a translation. One key where it never changes.
    pub translations: Vec<Track<3>>,
}

/// How many keys there are: one of each is a rotation or a translation of one joint. Channels that never change are
/// left out on both sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyCount {
    /// Rotations and translations that change.
    pub channels: usize,
    /// One key a frame for each of them.
    pub dense: usize,
    /// Keys that they have.
    pub keys: usize,
    /// Of those the ones where the curve goes on as it came, ends included.
    pub smooth: usize,
}

impl RotationForm {
    fn rotation(self, value: [f32; 4]) -> Quat {
        let turned = match self {
            Self::Quaternion => Quat::from_array(value),
            Self::Angles { axes } => {
                let axes = axes.as_dquat();
                (axes * angles::rotation(value.map(f64::from)) * axes.inverse()).as_quat()
            }
        };
        // A spline may pass through zero.
        if turned.length_squared() > 1e-24 { turned.normalize() } else { Quat::IDENTITY }
    }
}

impl KeyCount {
    fn add<const N: usize>(&mut self, keys: &[Key<N>], frames: usize) {
        if keys.len() > 1 {
            self.channels += 1;
            self.dense += frames;
            self.keys += keys.len();
            self.smooth += keys.iter().filter(|key| key.slope_in == key.slope_out).count();
        }
    }
}

impl KeyedClip {
    /// Keys of the channels that change, and how many they would be with one a frame.
    pub fn count(&self) -> KeyCount {
        let mut count = KeyCount { channels: 0, dense: 0, keys: 0, smooth: 0 };
        self.rotations.iter().for_each(|track| count.add(&track.keys, self.frames));
        self.translations.iter().for_each(|track| count.add(&track.keys, self.frames));
        count
    }

    /// The motion at every frame.
    ///
    /// # Errors
    /// When the parts do not fit together: see [`Clip::new`].
    pub fn clip(&self) -> Result<Clip, MotionError> {
        self.sampled(1)
    }

    /// The motion at `per_frame` moments a frame, the last frame's own last.
    ///
    /// # Errors
    /// As [`Self::clip`].
    pub fn sampled(&self, per_frame: usize) -> Result<Clip, MotionError> {
        let (per_frame, joints) = (per_frame.max(1), self.skeleton.len());
        let samples = (self.frames.max(1) - 1) * per_frame + 1;
        let mut rotations = vec![Quat::IDENTITY; samples * joints];
        for track in &self.rotations {
            for (sample, value) in self.values(track, per_frame, samples).into_iter().enumerate() {
                let slot = rotations.get_mut(sample * joints + track.joint);
                let turned = self.form.rotation(value);
                if let (Some(slot), true) = (slot, track.joint < joints) {
                    *slot = turned;
                }
            }
        }
        let translations = self.translations.iter().map(|track| TranslationTrack {
            joint: track.joint,
            values: self.values(track, per_frame, samples).into_iter().map(Vec3::from_array).collect(),
        });
        let rate = self.frame_rate * per_frame as f64;
        Clip::new(self.skeleton.clone(), rate, rotations, translations.collect())
    }

    fn values<const N: usize>(&self, track: &Track<N>, per_frame: usize, samples: usize) -> Vec<[f32; N]> {
        let mut key = 0;
        let at = |sample: usize| {
            let place = sample as f64 / per_frame as f64;
            while track.keys.get(key + 1).is_some_and(|next| next.frame as f64 <= place) {
                key += 1;
            }
            let Some(from) = track.keys.get(key) else { return [0.0; N] };
            let to = track.keys.get(key + 1);
            match (self.interpolation, to) {
                (Interpolation::Spline, Some(to)) if place > from.frame as f64 => {
                    let length = (to.frame - from.frame) as f64;
                    let [a, m, b, n] = hermite((place - from.frame as f64) / length);
                    let step = length / self.frame_rate;
                    std::array::from_fn(|i| {
                        let ends = a * f64::from(from.value[i]) + b * f64::from(to.value[i]);
                        (ends + step * (m * f64::from(from.slope_out[i]) + n * f64::from(to.slope_in[i])))
                            as f32
                    })
                }
                _ => from.value,
            }
        };
        (0..samples).map(at).collect()
    }
}
