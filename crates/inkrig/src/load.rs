//! Files in: motion and drawings, with limits.

use crate::cli::{ImportArgs, Up};
use crate::clip_path;
use crate::error::CliError;
use crate::inputs;
use crate::printable;
use inkrig_formats::{
    ClipChoice, FileSource, Finding, Format, FormatError, Import, ImportOptions, Severity, UpAxis,
    companion_beside, read_in_folder, read_motion, read_motions,
};
use inkrig_motion::Clip;
use inkrig_sketch::{Curve, Drawing, read_curve, read_drawing};
use inkrig_sound::Sound;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a motion file, or the clip of it that is named as in `wolf.glb#Gallop`.
///
/// # Errors
/// When it is not there, too large, of an unknown kind, or not understood.
pub fn motion(path: &Path, args: &ImportArgs) -> Result<Import, CliError> {
    opened(path, args, read_motion)
}

/// Reads a character: which of its clips is read is of no matter, and is not said.
///
/// # Errors
/// As [`motion`].
pub(crate) fn character(path: &Path) -> Result<Import, CliError> {
    let mut import = motion(path, &ImportArgs::default())?;
    import.findings.retain(|finding| finding.code != "several-clips");
    Ok(import)
}

/// The same, and all other clips of the file in their order.
///
/// # Errors
/// As [`motion`].
pub(crate) fn motions(path: &Path, args: &ImportArgs) -> Result<(Import, Vec<Clip>), CliError> {
    opened(path, args, read_motions)
}

/// What somebody reads of a motion file.
fn opened<T>(
    path: &Path,
    args: &ImportArgs,
    read: impl FnOnce(&[u8], Format, &ImportOptions, FileSource<'_>) -> Result<T, FormatError>,
) -> Result<T, CliError> {
    let (path, clip) = clip_path::split(path);
    let (path, clip) = (path.as_path(), clip.as_ref().or(args.clip.as_ref()));
    let known = "known motion files: .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .amc (with its .asf), DeepMimic's .txt or .json";
    let format = extension(path)
        .and_then(|extension| Format::from_extension(&extension))
        .ok_or_else(|| CliError::Kind { path: path.to_path_buf(), known })?;
    let companion = match format {
        Format::Amc | Format::DeepMimic => args.skeleton.clone().or_else(|| companion_beside(path, format)),
        _ => None,
    };
    let most = ImportOptions::default().limits.bytes;
    let options = ImportOptions {
        metres_per_unit: args.unit,
        up: args.up.map(|up| match up {
            Up::Y => UpAxis::Y,
            Up::Z => UpAxis::Z,
        }),
        frame_rate: args.source_fps,
        skeleton: companion.map(|path| bytes(&path, most)).transpose()?,
        clip: clip.map(|clip| clip_choice(clip)),
        ..ImportOptions::default()
    };
    let bytes = bytes(path, options.limits.bytes)?;
    // A .gltf may name files beside it.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = |name: &str, most: usize| {
        let bytes = read_in_folder(folder, name, most)?;
        inputs::note(&folder.join(name), &bytes).map_err(std::io::Error::other)?;
        Ok(bytes)
    };
    read(&bytes, format, &options, &files)
        .map_err(|error| CliError::Format { path: path.to_path_buf(), cause: Box::new(error) })
}

/// A number counts the clips of a file from 1; anything else is a name.
fn clip_choice(text: &str) -> ClipChoice {
    text.parse().map_or_else(|_| ClipChoice::Name(text.into()), ClipChoice::Number)
}

/// The bytes of a motion file.
///
/// # Errors
/// When it is not there or too large.
pub fn motion_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    bytes(path, ImportOptions::default().limits.bytes)
}

/// Reads a drawn curve.
///
/// # Errors
/// When it is not there, too large, of an unknown kind, or not understood.
pub fn curve(path: &Path) -> Result<Curve, CliError> {
    let known = "known drawings: .json, .csv, .svg";
    let format = inkrig_sketch::Format::from_path(path)
        .ok_or_else(|| CliError::Kind { path: path.to_path_buf(), known })?;
    let bytes = drawing(path)?;
    read_curve(&bytes, format)
        .map_err(|error| CliError::Curve { path: path.to_path_buf(), cause: Box::new(error) })
}

/// Reads a drawing, in the plane or of more dimensions, and says what had to be guessed.
///
/// # Errors
/// As for [`curve`].
pub fn drawn(path: &Path) -> Result<(Drawing, Option<String>), CliError> {
    let known = "known drawings: .json, .csv, .svg";
    let format = inkrig_sketch::Format::from_path(path)
        .ok_or_else(|| CliError::Kind { path: path.to_path_buf(), known })?;
    let (drawing, note) = read_drawing(&drawing(path)?, format)
        .map_err(|error| CliError::Curve { path: path.to_path_buf(), cause: Box::new(error) })?;
    Ok((drawing, note.map(|note| format!("{}: {note}", printable::path(path)))))
}

/// Reads a sound, and says what was odd in it, one line each.
///
/// # Errors
/// When it is not there, too large or not understood.
pub fn sound(path: &Path) -> Result<(Sound, Vec<String>), CliError> {
    let bytes = bytes(path, inkrig_sound::MAX_BYTES)?;
    let decoded = inkrig_sound::decode(&bytes, &extension(path).unwrap_or_default())
        .map_err(|error| CliError::Sound { path: path.to_path_buf(), cause: Box::new(error) })?;
    let findings = decoded.findings.iter();
    let odd = findings.map(|finding| format!("{}: {}", printable::path(path), printable::text(finding)));
    Ok((decoded.sound, odd.collect()))
}

/// The bytes of a drawing, a wave, labels or keys.
///
/// # Errors
/// When the file is not there or too large.
pub fn drawing(path: &Path) -> Result<Vec<u8>, CliError> {
    bytes(path, inkrig_sketch::limits::MAX_BYTES)
}

/// What was odd in a file that was read or written, one line each, without mere remarks: `inkrig inspect` has those.
pub fn warnings(findings: &[Finding], path: &Path) -> Vec<String> {
    let warnings = findings.iter().filter(|finding| finding.severity == Severity::Warning);
    warnings.map(|finding| format!("{}: {}", printable::path(path), printable::text(finding))).collect()
}

pub(crate) fn extension(path: &Path) -> Option<String> {
    path.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase)
}

/// The whole file, if it is no larger than `most`.
fn bytes(path: &Path, most: usize) -> Result<Vec<u8>, CliError> {
    let read = |cause| CliError::Read { path: path.to_path_buf(), cause };
    let file = File::open(path).map_err(read)?;
    let mut bytes = Vec::new();
    // One more than allowed tells a file that is too large from one that just fits.
    file.take(most as u64 + 1).read_to_end(&mut bytes).map_err(read)?;
    if bytes.len() > most {
        return Err(CliError::TooLarge { path: path.to_path_buf(), most });
    }
    inputs::note(path, &bytes)?;
    Ok(bytes)
}
