//! The code that makes the samples. The same code gives the same files, on every machine to within rounding.

pub mod curves;
pub mod ease;
pub mod figure;
pub mod gait;
pub mod limb_ik;
pub mod person;
pub mod quadruped;
pub mod snake;
pub mod storyboards;

use inkrig_formats::{Axis, Channel, ExportOptions, FormatError, write_bvh};
use inkrig_motion::{Clip, MotionError};
use inkrig_sketch::SketchError;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Why a sample could not be made or stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MakeError {
    /// A generator computed something that is no motion.
    #[error("the motion sample is not usable: {0}")]
    Motion(#[from] MotionError),
    /// A motion could not be written as BVH.
    #[error("the motion sample cannot be written: {0}")]
    Format(#[from] FormatError),
    /// A shape was refused.
    #[error("the curve sample is not usable: {0}")]
    Curve(#[from] SketchError),
    /// A file could not be stored.
    #[error("{path} cannot be written ({source}): give a folder that can be written to")]
    Store {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// All samples, made anew: path inside of the samples folder (with `/`) and bytes.
///
/// # Errors
/// When a generator computes something that is not finite. Never in practice.
pub fn make_all() -> Result<Vec<(String, Vec<u8>)>, MakeError> {
    let motions = [
        ("motions/person.bvh", person::clip()?),
        ("motions/quadruped.bvh", quadruped::clip()?),
        ("motions/snake.bvh", snake::clip()?),
    ];
    let mut files = Vec::new();
    for (path, clip) in motions {
        files.push((path.to_owned(), write_bvh(&clip, &options(&clip))?.bytes));
    }
    for (name, text) in curves::files()? {
        files.push((format!("curves/{name}"), text.into_bytes()));
    }
    for (name, bytes) in storyboards::files()? {
        files.push((format!("storyboards/{name}"), bytes));
    }
    Ok(files)
}

/// Makes all samples and writes them below `folder` (the folder of this crate), over what is there. Returns the
/// files written.
///
/// # Errors
/// As [`make_all`], and when a file cannot be written.
pub fn write_all(folder: &Path) -> Result<Vec<PathBuf>, MakeError> {
    let mut written = Vec::new();
    for (path, bytes) in make_all()? {
        let path = folder.join(path);
        let store = || {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::write(&path, &bytes)
        };
        store().map_err(|source| MakeError::Store { path: path.clone(), source })?;
        written.push(path);
    }
    Ok(written)
}

/// Centimetres. The turn about the vertical comes first, so that a full turn of the body passes no gimbal lock.
fn options(clip: &Clip) -> ExportOptions {
    let rotations = [Channel::Rotation(Axis::Y), Channel::Rotation(Axis::X), Channel::Rotation(Axis::Z)];
    let positions = [Channel::Position(Axis::X), Channel::Position(Axis::Y), Channel::Position(Axis::Z)];
    let channels = clip.skeleton().joints().iter().map(|joint| match joint {
        joint if joint.end_site => Vec::new(),
        joint if joint.parent.is_none() => [positions, rotations].concat(),
        _ => rotations.to_vec(),
    });
    ExportOptions { channels: channels.collect(), ..ExportOptions::default() }
}
