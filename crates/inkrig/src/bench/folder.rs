//! Cases of somebody's own clips.

use super::own_cases::{CHIRP, FOUR_LABELS, circles};
use super::{Case, ControlSpec};
use crate::cli::ImportArgs;
use crate::error::CliError;
use crate::load;
use inkrig_motion::{Clip, Takes, time};
use std::path::{Path, PathBuf};

/// A case takes no more than the beginning of a clip, so that a benchmark of many takes minutes, not hours. Seconds.
pub const SECONDS_OF_A_CLIP: f64 = 20.0;

/// Every BVH file of a folder (not of the folders in it), by name, each with a drawing, a wave, labels and a sound to
/// follow; and the files that cannot be used, with the reason.
///
/// # Errors
/// When the folder cannot be read.
pub fn folder_cases(folder: &Path, import: &ImportArgs) -> Result<(Vec<Case>, Vec<CliError>), CliError> {
    let (mut cases, mut refused) = (Vec::new(), Vec::new());
    for path in clips(folder)? {
        match load::motion(&path, import).and_then(|import| of_clip(&path, &import.clip)) {
            Ok(more) => cases.extend(more),
            Err(error) => refused.push(error),
        }
    }
    Ok((cases, refused))
}

fn clips(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let refused = |cause| CliError::Read { path: folder.to_path_buf(), cause };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refused)? {
        let path = entry.map_err(refused)?.path();
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if ending.eq_ignore_ascii_case("bvh") && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn of_clip(path: &Path, clip: &Clip) -> Result<Vec<Case>, CliError> {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let end = ((SECONDS_OF_A_CLIP * clip.frame_rate()) as usize).clamp(1, clip.frames());
    let source: Takes = time::trim(clip, 0..end)?.into();
    let controls = [
        ("circles", ControlSpec::Curve(circles()?)),
        ("chirp", ControlSpec::Wave(CHIRP)),
        ("labels", ControlSpec::Labels(FOUR_LABELS)),
        ("sound", ControlSpec::Sound),
    ];
    controls
        .iter()
        .map(|(name, follow)| Ok(Case::new(format!("{name} to {stem}"), source.clone(), follow)?))
        .collect()
}
