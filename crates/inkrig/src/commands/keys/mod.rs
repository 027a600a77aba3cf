//! Keyframes, from the command line and from files.

mod file;
mod poses;
mod text;

pub(super) use poses::{Clips, Kept, resolve};

use crate::cli::AlignArgs;
use crate::error::CliError;
use crate::load;
use crate::span::Span;
use inkrig_align::Place;
use std::path::PathBuf;

/// How near counts as the same moment where nothing was said, in mean distances of the clip's moments.
const RADIUS: f64 = 0.3;
/// How far to keep away where nothing was said: an ordinary distance.
const DISTANCE: f64 = 1.0;
/// Weight where nothing was said.
const WEIGHT: f64 = 1.0;

/// A key as it was written, before its clips are read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Wish {
    Soft { at: At, pose: Named, weight: f64 },
    Hard { at: At, pose: Named },
    Avoid { pose: Named, distance: f64, weight: f64 },
    Never { pose: Named, radius: f64 },
    Fix { span: Span, from: PathBuf },
}

/// A place of the control.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum At {
    /// A time of the result, a point, a value, a label or a frame of the control.
    Place(Place),
    /// A time of the sound, seconds.
    Sound(f64),
}

/// A frame of a file: of the clips that are arranged where no file is named.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Named {
    pub(super) file: Option<PathBuf>,
    pub(super) frame: usize,
}

/// All keys that were given.
pub(super) fn all(args: &AlignArgs) -> Result<Vec<Wish>, CliError> {
    let wrong = |text: &String, known| CliError::Key { text: text.clone(), known };
    let mut wishes = Vec::new();
    for text in &args.keys {
        wishes.push(text::key(text).ok_or_else(|| wrong(text, text::KEYS))?);
    }
    for text in &args.avoids {
        wishes.push(text::avoid(text).ok_or_else(|| wrong(text, text::AVOIDS))?);
    }
    for text in &args.nevers {
        wishes.push(text::never(text).ok_or_else(|| wrong(text, text::NEVERS))?);
    }
    if let Some(from) = &args.fix_from {
        wishes.extend(args.fixes.iter().map(|&span| Wish::Fix { span, from: from.clone() }));
    }
    if let Some(path) = &args.key_file {
        wishes.extend(file::read(&load::drawing(path)?, path)?);
    }
    Ok(wishes)
}

/// The files that keys name, each once, without those that are arranged.
pub(super) fn files(wishes: &[Wish], args: &AlignArgs) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for wish in wishes {
        let file = match wish {
            Wish::Soft { pose, .. }
            | Wish::Hard { pose, .. }
            | Wish::Avoid { pose, .. }
            | Wish::Never { pose, .. } => pose.file.as_ref(),
            Wish::Fix { from, .. } => Some(from),
        };
        files.extend(file.filter(|file| !args.clips.contains(file) && !files.contains(file)).cloned());
    }
    files
}
