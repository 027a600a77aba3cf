//! Frame features: what two frames are compared by (MAMM, SIGGRAPH 2025, Sec. 3.1).

use crate::{MotionError, Takes, clip::variation, root::RootMotion, rotation::to_6d};
use glam::Quat;

/// A table of numbers, frames x width, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Features {
    values: Vec<f32>,
    width: usize,
}

impl Features {
    /// Checks and keeps `values`, one row of `width` numbers a frame.
    ///
    /// # Errors
    /// When the width is 0, the table is empty or ragged, or a number is not finite.
    pub fn new(values: Vec<f32>, width: usize) -> Result<Self, MotionError> {
        if values.is_empty() || width == 0 {
            return Err(MotionError::NoFrames);
        }
        if !values.len().is_multiple_of(width) {
            let expected = (values.len() / width + 1) * width;
            return Err(MotionError::Length { what: "features", expected, got: values.len() });
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(MotionError::NotFinite {
                what: "a feature",
                joint: index % width,
                frame: index / width,
            });
        }
        Ok(Self { values, width })
    }

    /// For tables whose shape is right by construction.
    pub(crate) fn from_parts(values: Vec<f32>, width: usize) -> Self {
        Self { values, width }
    }

    /// Numbers per frame.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of frames, at least 1.
    pub fn frames(&self) -> usize {
        self.values.len() / self.width
    }

    /// The numbers of one frame.
    ///
    /// # Panics
    /// When `frame` is not below [`Self::frames`].
    pub fn row(&self, frame: usize) -> &[f32] {
        &self.values[frame * self.width..(frame + 1) * self.width]
    }

    /// All numbers, frame after frame.
    pub fn as_slice(&self) -> &[f32] {
        &self.values
    }

    /// The numbers themselves.
    pub fn into_vec(self) -> Vec<f32> {
        self.values
    }
}

/// In which space a joint's rotation is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RotationSpace {
    /// Relative to the parent joint (as GenMM does).
    Local,
    /// Relative to the root joint: rotations accumulated along the chain (the paper's words).
    #[default]
    Root,
}

/// In which frame the root's velocity and rotation are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VelocityFrame {
    /// World axes: walking north and walking east are different motions.
    World,
    /// Relative to where the character is headed, with the rate of turning: walking is walking.
    #[default]
    Heading,
}

/// What goes into the features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FeatureOptions {
    /// Space of the joints' rotations.
    pub rotation_space: RotationSpace,
    /// Frame of the root's velocity.
    pub velocity_frame: VelocityFrame,
}

/// What the features of a character are made of, decided once from a source so that every motion of that character
/// gets the same columns: `[V | yaw rate | T | R]`.
///
/// V (3): displacement of the travelling joint since the frame before, divided by the character's size; yaw rate (1,
/// heading frame only): radians a frame; T (3 each): other translations that vary in the source, divided by the size,
/// those of other roots relative to the travelling joint; R (6 each): the first two columns of every rotation matrix
/// but those of end sites. Width 3 + 6 J for an ordinary skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureLayout {
    options: FeatureOptions,
    travel_joint: usize,
    above: Vec<bool>,
    tracks: Vec<usize>,
    size: f32,
}

impl FeatureLayout {
    /// The layout for a source.
    pub fn of(takes: &Takes, options: &FeatureOptions) -> Self {
        let clip = takes.clip();
        let travel_joint = clip.travel_joint();
        let extent = clip.skeleton().extent();
        // A figure without size is as large as its way.
        let way = clip.track(travel_joint).map_or(0.0, variation);
        let size = [extent, way, 1.0].into_iter().find(|size| *size > 1e-6).unwrap_or(1.0);
        let tracks = (clip.translations().iter())
            .filter(|track| track.joint != travel_joint && variation(&track.values) > 1e-4 * size)
            .map(|track| track.joint)
            .collect();
        let above = clip.skeleton().ancestors(travel_joint);
        Self { options: *options, travel_joint, above, tracks, size }
    }

    /// The joint that carries the character through the world.
    pub fn travel_joint(&self) -> usize {
        self.travel_joint
    }

    /// Features of every frame of a motion of that character.
    ///
    /// # Panics
    /// When the motion's skeleton has fewer joints than the source's.
    pub fn features(&self, takes: &Takes) -> Features {
        let clip = takes.clip();
        let joints = clip.skeleton().joints();
        let root = RootMotion::of_joint(takes, self.travel_joint);
        let (velocities, yaw_rates) = (root.velocities(), root.yaw_rates());
        let heading_frame = self.options.velocity_frame == VelocityFrame::Heading;
        let other_root = |joint: usize| joints[joint].parent.is_none() && !self.above[joint];
        let mut values = Vec::new();
        let mut rotations = vec![Quat::IDENTITY; joints.len()];
        for frame in 0..clip.frames() {
            let facing =
                if heading_frame { Quat::from_rotation_y(-root.headings[frame]) } else { Quat::IDENTITY };
            values.extend_from_slice(&(facing * velocities[frame] / self.size).to_array());
            if heading_frame {
                values.push(yaw_rates[frame]);
            }
            for &joint in &self.tracks {
                let value = clip.track(joint).map_or(joints[joint].offset, |track| track[frame]);
                let seen = if other_root(joint) { facing * (value - root.places[frame]) } else { value };
                values.extend_from_slice(&(seen / self.size).to_array());
            }
            let local = clip.rotations(frame);
            for (index, joint) in joints.iter().enumerate() {
                let own = if other_root(index) { facing * local[index] } else { local[index] };
                rotations[index] = match (joint.parent, self.options.rotation_space) {
                    _ if index == self.travel_joint => Quat::IDENTITY,
                    (Some(parent), RotationSpace::Root) => (rotations[parent] * own).normalize(),
                    _ => own,
                };
                if index == self.travel_joint {
                    values.extend_from_slice(&to_6d(facing * root.rotations[frame]));
                } else if !joint.end_site {
                    values.extend_from_slice(&to_6d(rotations[index]));
                }
            }
        }
        let width = values.len() / clip.frames();
        Features::from_parts(values, width)
    }
}

/// Features of every frame of takes that stand for themselves: see [`FeatureLayout`].
pub fn frame_features(takes: &Takes, options: &FeatureOptions) -> Features {
    FeatureLayout::of(takes, options).features(takes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Clip, Joint, Skeleton, TranslationTrack};
    use glam::Vec3;
    use std::sync::Arc;

    /// Walks straight ahead, headed to `yaw`, with a swinging arm of two joints.
    fn walk(yaw: f32) -> Clip {
        let skeleton = Arc::new(
            Skeleton::new(vec![
                Joint::new("root", None, Vec3::ZERO),
                Joint::new("arm", Some(0), Vec3::Y),
                Joint::new("hand", Some(1), Vec3::Y),
                Joint::end("hand_end", 2, Vec3::Y),
            ])
            .unwrap(),
        );
        let turn = Quat::from_rotation_y(yaw);
        let rotations = (0..20)
            .flat_map(|f| {
                let swing = Quat::from_rotation_x((0.3 * f as f32).sin());
                [turn, swing, swing, Quat::IDENTITY]
            })
            .collect();
        let values = (0..20).map(|f| turn * (Vec3::Z * 0.03 * f as f32)).collect();
        Clip::new(skeleton, 30.0, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap()
    }

    #[test]
    fn width_and_scale() {
        let options = FeatureOptions { velocity_frame: VelocityFrame::World, ..Default::default() };
        let features = frame_features(&walk(0.0).into(), &options);
        assert_eq!((features.frames(), features.width()), (20, 3 + 6 * 3));
        assert!((features.row(0)[2] - 0.01).abs() < 1e-6, "0.03 m a frame over a size of 3 m");
    }

    #[test]
    fn the_heading_frame_does_not_see_the_direction_of_walking() {
        let options = FeatureOptions::default();
        // Heading counts from the first frame, so the turn happens before the part that is compared.
        let after_turn = |yaw: f32| {
            let (straight, turned) = (walk(0.0), walk(yaw));
            let rotations: Vec<Quat> = [&straight, &turned]
                .iter()
                .flat_map(|clip| (0..20).flat_map(|frame| clip.rotations(frame).to_vec()))
                .collect();
            let values =
                [&straight, &turned].iter().flat_map(|clip| clip.track(0).unwrap().to_vec()).collect();
            let tracks = vec![TranslationTrack { joint: 0, values }];
            let clip = Clip::new(straight.skeleton().clone(), 30.0, rotations, tracks).unwrap();
            frame_features(&clip.into(), &options)
        };
        let (north, east) = (after_turn(0.0), after_turn(1.2));
        for frame in 21..40 {
            for (a, b) in north.row(frame).iter().zip(east.row(frame)) {
                assert!((a - b).abs() < 1e-5);
            }
        }
        assert_eq!(north.width(), 4 + 6 * 3);
    }

    #[test]
    fn root_space_accumulates() {
        let options =
            FeatureOptions { rotation_space: RotationSpace::Root, velocity_frame: VelocityFrame::World };
        let features = frame_features(&walk(0.0).into(), &options);
        let swing = 0.9_f32.sin();
        let hand = to_6d(Quat::from_rotation_x(2.0 * swing));
        for (got, expected) in features.row(3)[3 + 12..].iter().zip(hand) {
            assert!((got - expected).abs() < 1e-5);
        }
    }

    #[test]
    fn tables_are_checked() {
        assert!(Features::new(vec![], 3).is_err());
        assert!(Features::new(vec![1.0; 7], 3).is_err());
        assert!(Features::new(vec![1.0, f32::NAN], 2).is_err());
    }
}
