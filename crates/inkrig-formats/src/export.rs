//! How a motion is written.

use crate::{Channel, Finding, Format, FormatError, HumanBone, Original, SourceInfo, UpAxis};
use inkrig_motion::keyframes::{Interpolation, KeyedClip, RotationForm};

/// How to write a motion. The default suits most programs: centimetres, y up, the format's usual channels.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// Length of one unit of the file in metres, 1e-9 to 1e9. Default: 0.01.
    pub metres_per_unit: f64,
    /// The axis that points up in the file. Default: y.
    pub up: UpAxis,
    /// The channels of each joint of the skeleton, in file order. Empty (the default): positions x, y, z on roots and
    /// on joints with a translation track, then rotations z, y, x on all but end sites.
    pub channels: Vec<Vec<Channel>>,
    /// Seconds from frame to frame as the source said it; used when the clip still has that rate, so that a rounded
    /// value such as .0083333 comes back unchanged. Default: none.
    pub frame_time: Option<f64>,
    /// What the clip is called, in formats that name their clips. Default: `motion`.
    pub name: Option<String>,
    /// The file that the clip is put into, mesh, skin and materials untouched: a glTF file of the clip's own skeleton, whose
    /// unit and axes are [`Self::metres_per_unit`] and [`Self::up`]. Default: none.
    pub original: Option<Original>,
    /// Whether a clip of the same name in [`Self::original`] is taken out; else the new one gets a number behind its
    /// name. Default: no.
    pub replace: bool,
    /// Which joints are which bones of a person, for VRMA. Default: none.
    pub humanoid: Vec<HumanBone>,
    /// Rows of an earlier BVH file that are written as they stand there, in order of their frames; other formats do not
    /// look at them. The angles around them are chosen to run on into them.
    pub kept: Vec<KeptRow>,
    /// The motion as few keys, for formats that have them: glTF takes quaternions, FBX angles about its own axes. The clip
    /// that is written must be its [`KeyedClip::clip`]. Default: none, one key a frame.
    pub keys: Option<KeyedClip>,
}

/// A row of a BVH file: see [`bvh_rows`](crate::bvh_rows).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeptRow {
    /// Its frame, here and there.
    pub frame: usize,
    /// Its text without the line end.
    pub text: Vec<u8>,
}

/// A motion that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What could not be kept, and what was chosen.
    pub findings: Vec<Finding>,
}

impl ExportOptions {
    /// The units, axes, channel order and frame time of a source; into the source's own file where that can be.
    pub fn like(source: &SourceInfo) -> Self {
        Self {
            metres_per_unit: source.metres_per_unit,
            up: source.up,
            channels: source.channels.clone(),
            frame_time: source.frame_time,
            original: source.original.clone(),
            humanoid: source.humanoid.clone(),
            ..Self::default()
        }
    }

    /// As [`Self::like`], for a file of a format. What comes from elsewhere becomes an FBX in centimetres and y up: many
    /// programs take no notice of what an FBX says of itself.
    pub fn in_format(format: Format, source: &SourceInfo) -> Self {
        let like = Self::like(source);
        if format == Format::Fbx && source.format != Format::Fbx {
            let Self { metres_per_unit, up, .. } = Self::default();
            return Self { metres_per_unit, up, ..like };
        }
        like
    }

    /// Refuses curves between few keys for a format that has one pose a frame. Poses that are held need no keys there: the
    /// frames repeat them.
    pub(crate) fn check_no_curves(&self, format: &str) -> Result<(), FormatError> {
        match &self.keys {
            Some(keys) if keys.interpolation == Interpolation::Spline => Err(FormatError::Write {
                what: format!("{format} files hold a pose a frame, not few keys with curves between them"),
                hint: "write a .glb or .fbx, or one key a frame (--bake dense)".into(),
            }),
            _ => Ok(()),
        }
    }

    /// Refuses curves of other numbers than a format has.
    pub(crate) fn check_curves(&self, format: &str, form: RotationForm) -> Result<(), FormatError> {
        match &self.keys {
            Some(keys) if keys.interpolation == Interpolation::Spline && keys.form != form => {
                Err(FormatError::Write {
                    what: format!("the keys of rotations are not the numbers that {format} files have"),
                    hint: "fit them in the form of the file that is written".into(),
                })
            }
            _ => Ok(()),
        }
    }
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            metres_per_unit: 0.01,
            up: UpAxis::Y,
            channels: Vec::new(),
            frame_time: None,
            name: None,
            original: None,
            replace: false,
            humanoid: Vec::new(),
            kept: Vec::new(),
            keys: None,
        }
    }
}
