//! What comes out of a file, and how it was understood.

use crate::{Finding, Format, FormatError, HumanBone, Limits, Original};
use inkrig_motion::{
    Clip,
    glam::{DQuat, DVec3, Quat},
    ground::SkeletonChange,
};

/// A motion that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The motion: metres, y up.
    pub clip: Clip,
    /// How the file said it, so that it can be written the same way.
    pub source: SourceInfo,
    /// All clips of a file that names them, in its order; empty for formats of one clip.
    pub clips: Vec<ClipInfo>,
    /// Which of [`Self::clips`] was read.
    pub clip_index: Option<usize>,
    /// What there is to know about the file.
    pub findings: Vec<Finding>,
}

/// One of the clips of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClipInfo {
    /// Its name; `clip_` and its number when it has none. Names may repeat.
    pub name: String,
    /// How many properties of joints and other things it moves.
    pub channels: usize,
}

/// Which clip of a file to read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ClipChoice {
    /// By name. When there is none of exactly this name, case does not matter; then neither does a prefix that ends
    /// with `|`.
    Name(String),
    /// By its place in the file, from 1.
    Number(usize),
}

/// How to read a file. The default asks the file, and guesses what the file does not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportOptions {
    /// Length of one unit of the file in metres, 1e-9 to 1e9; overrides the file and the guess.
    pub metres_per_unit: Option<f64>,
    /// The axis that points up in the file; overrides the file and the format's custom.
    pub up: Option<UpAxis>,
    /// Frames a second; overrides what the file says. A format whose keys have times is sampled at this rate instead.
    pub frame_rate: Option<f64>,
    /// The skeleton file, for formats that keep it apart from the motion: ASF for AMC, a character for DeepMimic.
    pub skeleton: Option<Vec<u8>>,
    /// Which clip of a file that has several. Default: the first. Formats of one clip do not look at it.
    pub clip: Option<ClipChoice>,
    /// How much the file may ask for.
    pub limits: Limits,
}

/// How a file said what it says.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceInfo {
    /// The file's format.
    pub format: Format,
    /// Length of one unit of the file in metres.
    pub metres_per_unit: f64,
    /// How [`Self::metres_per_unit`] is known.
    pub unit_evidence: Evidence,
    /// The axis that points up in the file.
    pub up: UpAxis,
    /// How [`Self::up`] is known.
    pub up_evidence: Evidence,
    /// The channels of each joint of the skeleton in file order; none for end sites. Empty for formats without
    /// channels.
    pub channels: Vec<Vec<Channel>>,
    /// Seconds from frame to frame, exactly as read; `None` when the file holds no usable value.
    pub frame_time: Option<f64>,
    /// Which joints are which bones of a person, where the file says it (VRM, VRMA), in the order of
    /// [`HUMAN_BONES`](crate::HUMAN_BONES).
    pub humanoid: Vec<HumanBone>,
    /// The file itself, where a new clip can be put into it (glTF and VRM).
    pub original: Option<Original>,
}

impl SourceInfo {
    /// Makes room for what is known of a joint that came, or takes out that of one that went. A new joint is written as the
    /// one that had its place.
    pub fn follow(&mut self, change: SkeletonChange) {
        match change {
            SkeletonChange::Kept(_) => {}
            SkeletonChange::Inserted(joint) => {
                if let Some(channels) = self.channels.get(joint).cloned() {
                    self.channels.insert(joint, channels);
                }
                for bone in &mut self.humanoid {
                    bone.joint += usize::from(bone.joint >= joint);
                }
            }
            SkeletonChange::Removed(joint) => {
                if joint < self.channels.len() {
                    self.channels.remove(joint);
                }
                self.humanoid.retain(|bone| bone.joint != joint);
                for bone in &mut self.humanoid {
                    bone.joint -= usize::from(bone.joint > joint);
                }
            }
        }
    }
}

/// How a property of a file is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evidence {
    /// The file says it.
    Declared,
    /// The caller said it.
    Given,
    /// Concluded from the data: may be wrong.
    Guessed,
    /// The custom of the format: may be wrong.
    Assumed,
}

/// One axis of a coordinate system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

/// One column of numbers that moves a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Translation along an axis of the parent.
    Position(Axis),
    /// Rotation about an axis that the channels before it have already turned.
    Rotation(Axis),
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// y up, as in a [`Clip`].
    #[default]
    Y,
    /// z up; y then points away from a viewer who looks along it, x to the right.
    Z,
}

impl UpAxis {
    /// The turn that brings the axes of a file to those of a clip.
    pub fn clip_from_file_turn(self) -> Quat {
        match self {
            Self::Y => Quat::IDENTITY,
            Self::Z => Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2),
        }
    }

    /// A vector of the file with the axes of a clip. No number changes but in sign.
    pub(crate) fn clip_from_file(self, v: DVec3) -> DVec3 {
        match self {
            Self::Y => v,
            Self::Z => DVec3::new(v.x, v.z, -v.y),
        }
    }

    /// The inverse of [`Self::clip_from_file`].
    pub(crate) fn file_from_clip(self, v: DVec3) -> DVec3 {
        match self {
            Self::Y => v,
            Self::Z => DVec3::new(v.x, -v.z, v.y),
        }
    }

    /// A rotation of the file with the axes of a clip: its axis is turned like any vector.
    pub(crate) fn clip_from_file_rotation(self, q: DQuat) -> DQuat {
        quat(self.clip_from_file(q.xyz()), q.w)
    }

    /// The inverse of [`Self::clip_from_file_rotation`].
    pub(crate) fn file_from_clip_rotation(self, q: DQuat) -> DQuat {
        quat(self.file_from_clip(q.xyz()), q.w)
    }
}

impl Import {
    /// Of a format that holds one clip a file.
    pub(crate) fn new(clip: Clip, source: SourceInfo, findings: Vec<Finding>) -> Self {
        Self { clip, source, clips: Vec::new(), clip_index: None, findings }
    }
}

impl ImportOptions {
    pub(crate) fn check(&self) -> Result<(), FormatError> {
        check_metres_per_unit(self.metres_per_unit.unwrap_or(1.0))?;
        let rates = Clip::FRAME_RATES;
        match self.frame_rate.filter(|rate| !rates.contains(rate)) {
            None => Ok(()),
            Some(rate) => Err(FormatError::Options {
                what: format!("the frame rate given is {rate}"),
                hint: format!("give one from {} to {} frames a second", rates.start(), rates.end()),
            }),
        }
    }
}

/// Lengths of a unit that make sense: a nanometre to the size of a planet.
pub(crate) fn check_metres_per_unit(metres_per_unit: f64) -> Result<(), FormatError> {
    if (1e-9..=1e9).contains(&metres_per_unit) {
        return Ok(());
    }
    Err(FormatError::Options {
        what: format!("the unit given is {metres_per_unit} m long"),
        hint: "give the metres of one unit, such as 0.01 for centimetres".into(),
    })
}

fn quat(xyz: DVec3, w: f64) -> DQuat {
    DQuat::from_xyzw(xyz.x, xyz.y, xyz.z, w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn z_up_becomes_y_up_and_comes_back() {
        assert_eq!(UpAxis::Z.clip_from_file(DVec3::Z), DVec3::Y);
        let v = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(UpAxis::Z.file_from_clip(UpAxis::Z.clip_from_file(v)), v);
        let turn = DQuat::from_rotation_z(FRAC_PI_2);
        let turned = UpAxis::Z.clip_from_file(turn * v);
        let same = UpAxis::Z.clip_from_file_rotation(turn) * UpAxis::Z.clip_from_file(v);
        assert!(turned.distance(same) < 1e-12);
        assert_eq!(UpAxis::Z.file_from_clip_rotation(UpAxis::Z.clip_from_file_rotation(turn)), turn);
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let unit = ImportOptions { metres_per_unit: Some(0.0), ..Default::default() };
        let expected =
            "the unit given is 0 m long; give the metres of one unit, such as 0.01 for centimetres";
        assert_eq!(unit.check().unwrap_err().to_string(), expected);
        let rate = ImportOptions { frame_rate: Some(f64::NAN), ..Default::default() };
        let expected = "the frame rate given is NaN; give one from 0.01 to 100000 frames a second";
        assert_eq!(rate.check().unwrap_err().to_string(), expected);
    }
}
