//! The names of channels.

use crate::{Axis, Channel};

impl Channel {
    /// The channel of a name such as `Xposition` or `zRotation`.
    pub(super) fn from_bvh(name: &[u8]) -> Option<Self> {
        let (first, kind) = name.split_first()?;
        let axis = match first.to_ascii_lowercase() {
            b'x' => Axis::X,
            b'y' => Axis::Y,
            b'z' => Axis::Z,
            _ => return None,
        };
        let position = kind.eq_ignore_ascii_case(b"position");
        let rotation = kind.eq_ignore_ascii_case(b"rotation");
        if position { Some(Self::Position(axis)) } else { rotation.then_some(Self::Rotation(axis)) }
    }

    /// The channel's name as most files write it.
    pub(super) fn to_bvh(self) -> &'static str {
        match self {
            Self::Position(Axis::X) => "Xposition",
            Self::Position(Axis::Y) => "Yposition",
            Self::Position(Axis::Z) => "Zposition",
            Self::Rotation(Axis::X) => "Xrotation",
            Self::Rotation(Axis::Y) => "Yrotation",
            Self::Rotation(Axis::Z) => "Zrotation",
        }
    }
}
