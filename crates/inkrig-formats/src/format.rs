//! The formats by name, so that a caller need not know which module reads what.

use crate::gltf::write_into_gltf;
use crate::{
    ExportOptions, FileSource, FormatError, Import, ImportOptions, Written, fbx::read_fbx_with,
    gltf::read_gltf_with, read_amc, read_bvh, read_deepmimic, read_fbx, read_gltf, write_bvh, write_fbx,
    write_glb, write_usda, write_vrma,
};
use inkrig_motion::Clip;

/// A motion file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Biovision hierarchy, text.
    Bvh,
    /// Acclaim motion: needs the ASF file of its skeleton. Read only.
    Amc,
    /// A motion of the DeepMimic project, JSON in a `.txt`: needs the file of its character. Read only.
    DeepMimic,
    /// Autodesk's exchange format: binary or text to read, binary to write.
    Fbx,
    /// USD as text, a skeleton with its animation. Write only.
    Usda,
    /// glTF 2.0 in one binary file.
    Glb,
    /// glTF 2.0 as text, with data inside or beside it.
    Gltf,
    /// A person as a GLB whose bones are known by name.
    Vrm,
    /// A motion for such persons.
    Vrma,
}

impl Format {
    /// The format of a file name extension, given with or without its dot, in upper or lower case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let extension = extension.strip_prefix('.').unwrap_or(extension);
        match extension.to_ascii_lowercase().as_str() {
            "bvh" => Some(Self::Bvh),
            "amc" => Some(Self::Amc),
            "txt" | "json" => Some(Self::DeepMimic),
            "fbx" => Some(Self::Fbx),
            "usda" => Some(Self::Usda),
            "glb" => Some(Self::Glb),
            "gltf" => Some(Self::Gltf),
            "vrm" => Some(Self::Vrm),
            "vrma" => Some(Self::Vrma),
            _ => None,
        }
    }

    /// Whether motions are written in it: .gltf and .vrm only into a file that was read.
    pub fn is_written(self) -> bool {
        !matches!(self, Self::Amc | Self::DeepMimic)
    }

    /// The usual extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Amc => "amc",
            Self::DeepMimic => "txt",
            Self::Fbx => "fbx",
            Self::Usda => "usda",
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Vrm => "vrm",
            Self::Vrma => "vrma",
        }
    }

    /// The name as people write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bvh => "BVH",
            Self::Amc => "AMC",
            Self::DeepMimic => "DeepMimic",
            Self::Fbx => "FBX",
            Self::Usda => "USD",
            Self::Glb => "GLB",
            Self::Gltf => "glTF",
            Self::Vrm => "VRM",
            Self::Vrma => "VRMA",
        }
    }
}

/// Reads a motion in a known format. `files` is asked for what lies beside the file, in the one format that spreads
/// over several (.gltf); [`no_files`](crate::no_files) has none.
///
/// # Errors
/// What the format's own reader says: see [`read_bvh`], [`read_amc`], [`read_deepmimic`], [`read_fbx`],
/// [`read_gltf`].
pub fn read_motion(
    bytes: &[u8],
    format: Format,
    options: &ImportOptions,
    files: FileSource<'_>,
) -> Result<Import, FormatError> {
    match format {
        Format::Bvh => read_bvh(bytes, options),
        Format::Amc => read_amc(bytes, options),
        Format::DeepMimic => read_deepmimic(bytes, options),
        Format::Fbx => read_fbx(bytes, options),
        Format::Usda => Err(FormatError::Options {
            what: "inkrig writes USD, but does not read it".into(),
            hint: "export the motion as BVH".into(),
        }),
        Format::Glb | Format::Gltf | Format::Vrm | Format::Vrma => read_gltf(bytes, options, files),
    }
}

/// The same, and all other clips of the file in their order: it is parsed once for all.
///
/// # Errors
/// As [`read_motion`]; one clip that cannot be read is enough. All clips together may have four times what one may.
pub fn read_motions(
    bytes: &[u8],
    format: Format,
    options: &ImportOptions,
    files: FileSource<'_>,
) -> Result<(Import, Vec<Clip>), FormatError> {
    let mut others = Vec::new();
    let import = match format {
        Format::Fbx => read_fbx_with(bytes, options, Some(&mut others)),
        Format::Glb | Format::Gltf | Format::Vrm | Format::Vrma => {
            read_gltf_with(bytes, options, files, Some(&mut others))
        }
        // These hold one.
        _ => read_motion(bytes, format, options, files),
    }?;
    Ok((import, others))
}

/// Writes a motion in a known format.
///
/// # Errors
/// What the format's own writer says: see [`write_bvh`], [`write_fbx`], [`write_usda`], [`write_glb`], [`write_vrma`].
/// Not every format can be written.
pub fn write_motion(clip: &Clip, format: Format, options: &ExportOptions) -> Result<Written, FormatError> {
    match format {
        Format::Bvh => write_bvh(clip, options),
        Format::Fbx => write_fbx(clip, options),
        Format::Usda => write_usda(clip, options),
        Format::Amc | Format::DeepMimic => Err(FormatError::Write {
            what: format!("inkrig does not write {} files", format.name()),
            hint: "write a .bvh instead".into(),
        }),
        Format::Glb => write_glb(clip, options),
        Format::Vrma => write_vrma(clip, options),
        Format::Gltf => write_into_gltf(clip, options),
        // A figure cannot be made here, but one that is there can get a clip.
        Format::Vrm if options.original.is_some() && !options.humanoid.is_empty() => write_glb(clip, options),
        Format::Vrm => Err(FormatError::Write {
            what: "inkrig writes .vrm files only into one that it has read".into(),
            hint: "write a .glb or a .vrma instead".into(),
        }),
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
