//! The formats by name, so that a caller need not know which module reads what.

use crate::{ExportOptions, FormatError, Import, ImportOptions, Written, read_bvh, write_bvh};
use inkrig_motion::Clip;

/// A motion file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Biovision hierarchy, text.
    Bvh,
}

impl Format {
    /// The format of a file name extension, given with or without its dot, in upper or lower case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let extension = extension.strip_prefix('.').unwrap_or(extension);
        extension.eq_ignore_ascii_case("bvh").then_some(Self::Bvh)
    }

    /// The usual extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
        }
    }

    /// The name as people write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bvh => "BVH",
        }
    }
}

/// Reads a motion in a known format.
///
/// # Errors
/// What the format's own reader says: see [`read_bvh`].
pub fn read_motion(bytes: &[u8], format: Format, options: &ImportOptions) -> Result<Import, FormatError> {
    match format {
        Format::Bvh => read_bvh(bytes, options),
    }
}

/// Writes a motion in a known format.
///
/// # Errors
/// What the format's own writer says: see [`write_bvh`].
pub fn write_motion(clip: &Clip, format: Format, options: &ExportOptions) -> Result<Written, FormatError> {
    match format {
        Format::Bvh => write_bvh(clip, options),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extension_names_its_format() {
        assert_eq!(Format::from_extension("bvh"), Some(Format::Bvh));
        assert_eq!(Format::from_extension(".BVH"), Some(Format::Bvh));
        assert_eq!(Format::from_extension("bv"), None);
        assert_eq!(Format::from_extension(Format::Bvh.extension()), Some(Format::Bvh));
    }
}
