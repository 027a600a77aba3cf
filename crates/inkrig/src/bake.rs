//! `--bake`: a finished motion as few keys, or with poses that are held.

use crate::cli::{BakeArgs, BakeMode, Hold, Tolerance};
use crate::error::CliError;
use crate::printable::{counted, fixed};
use inkrig_formats::{ExportOptions, Format, SourceInfo};
use inkrig_motion::Clip;
use inkrig_motion::keyframes::{KeyedClip, RotationForm, SparseOptions, deviation, sparse, stepped};
use serde::Serialize;
use std::path::Path;

/// A motion as it is written.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) clip: Clip,
    /// None with one key a frame.
    pub(crate) keys: Option<KeyedClip>,
    pub(crate) record: Option<BakeRecord>,
}

/// What was done; the names are stable.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct BakeRecord {
    mode: &'static str,
    /// Rotations and translations of joints that change; others have no keys here and there.
    channels: usize,
    /// Keys with one a frame for each of them, and as they were written: one key is all numbers of a rotation or of a
    /// translation.
    keys_before: usize,
    keys: usize,
    /// Frames that are keys because that was asked for.
    kept_frames: Vec<usize>,
    sparse: Option<SparseRecord>,
    /// Frames that a pose is held for.
    hold_frames: Option<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct SparseRecord {
    tolerance_mm: f64,
    tolerance_degrees: f64,
    /// The largest differences from the motion on any frame.
    largest_mm: f64,
    largest_degrees: f64,
    /// Keys whose curve has no corner.
    smooth_keys: usize,
}

/// Says early what does not go together.
///
/// # Errors
/// When an argument goes with another way to make keys.
pub(crate) fn check(args: &BakeArgs) -> Result<(), CliError> {
    let wrong = |flag, mode| Err(CliError::Bake { flag, mode });
    match args.bake {
        mode if mode != BakeMode::Sparse && args.tolerance.is_some() => wrong("--tolerance", "sparse"),
        mode if mode != BakeMode::Stepped && args.on.is_some() => wrong("--on", "stepped"),
        BakeMode::Dense if !args.keep_keys.is_empty() => wrong("--keep-key", "sparse or --bake stepped"),
        _ => Ok(()),
    }
}

/// Says early that a format has no curves between few keys.
///
/// # Errors
/// [`CliError::BakeFormat`] with the path of the result.
pub(crate) fn check_format(args: &BakeArgs, format: Format, path: &Path) -> Result<(), CliError> {
    match format {
        Format::Bvh | Format::Usda | Format::Vrma if args.bake == BakeMode::Sparse => {
            Err(CliError::BakeFormat { path: path.to_path_buf(), format: format.extension() })
        }
        _ => Ok(()),
    }
}

/// Makes the keys. `exact`: frames whose poses were asked for, and so are keys. The format and where the clip came from
/// say which numbers rotations are written in.
///
/// # Errors
/// When a frame that is to be kept lies outside of the motion.
pub(crate) fn bake(
    clip: Clip,
    args: &BakeArgs,
    exact: &[usize],
    (format, source): (Format, &SourceInfo),
) -> Result<Baked, CliError> {
    if args.bake == BakeMode::Dense {
        return Ok(Baked { clip, keys: None, record: None });
    }
    let (rate, frames) = (clip.frame_rate(), clip.frames());
    let mut kept = exact.to_vec();
    for time in &args.keep_keys {
        let frame = time.frames(rate);
        if frame >= frames {
            return Err(CliError::KeepKey { time: *time, frames, seconds: crate::span::seconds(&clip) });
        }
        kept.push(frame);
    }
    kept.retain(|&frame| frame < frames);
    kept.sort_unstable();
    kept.dedup();
    let Tolerance { metres, degrees } = args.tolerance.unwrap_or_default();
    let step = args.on.unwrap_or(Hold::Film(2)).frames(rate).max(1.0);
    let is_sparse = args.bake == BakeMode::Sparse;
    let keys = if is_sparse {
        let form = match format {
            Format::Fbx => {
                let up = ExportOptions::in_format(format, source).up;
                RotationForm::Angles { axes: up.clip_from_file_turn() }
            }
            _ => RotationForm::Quaternion,
        };
        sparse(&clip, &SparseOptions { metres, radians: degrees.to_radians(), given: kept.clone(), form })
    } else {
        stepped(&clip, step, &kept)
    };
    let baked = keys.clip()?;
    let count = keys.count();
    let apart = deviation(&clip, &baked)?;
    let record = BakeRecord {
        mode: if is_sparse { "sparse" } else { "stepped" },
        channels: count.channels,
        keys_before: count.dense,
        keys: count.keys,
        kept_frames: kept,
        sparse: is_sparse.then(|| SparseRecord {
            tolerance_mm: 1e3 * metres,
            tolerance_degrees: degrees,
            largest_mm: 1e3 * apart.metres,
            largest_degrees: apart.radians.to_degrees(),
            smooth_keys: count.smooth,
        }),
        hold_frames: (!is_sparse).then_some(step),
    };
    Ok(Baked { clip: baked, keys: Some(keys), record: Some(record) })
}

impl BakeRecord {
    /// What people are told.
    pub(crate) fn note(&self) -> String {
        let share = 100.0 * self.keys as f64 / self.keys_before.max(1) as f64;
        let keys = format!("{} of {} ({} %)", counted(self.keys, "key"), self.keys_before, fixed(share, 0));
        match (&self.sparse, self.hold_frames) {
            (Some(sparse), _) => format!(
                "{keys}; joints are within {} mm and {} degrees of the motion on every frame",
                fixed(sparse.largest_mm, 2),
                fixed(sparse.largest_degrees, 2)
            ),
            (None, hold) => {
                let hold = hold.unwrap_or(1.0);
                format!("{keys}; a pose is held for {} frames", (100.0 * hold).round() / 100.0)
            }
        }
    }
}
