//! From keys as they were written to keys of the engine: clips are read, frames counted where the engine counts them.

use super::{At, Named, Wish};
use crate::error::CliError;
use crate::load;
use crate::printable;
use crate::span;
use inkrig_align::{Control, ControlKind, Key, Place, Pose};
use inkrig_formats::{Format, Import, KeptRow, SourceInfo, bvh_rows};
use inkrig_motion::{Clip, Takes};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The clips that are arranged, as the program cut them.
pub(in crate::commands) struct Clips<'a> {
    pub(in crate::commands) takes: &'a Takes,
    /// Path, frames a second and first frame that is used of every clip.
    pub(in crate::commands) parts: &'a [(PathBuf, f64, usize)],
    /// Frames a second of the result.
    pub(in crate::commands) rate: f64,
}

/// What of an earlier result is written again as it stands there.
pub(in crate::commands) struct Kept {
    pub(in crate::commands) rows: Vec<KeptRow>,
    /// How that file was written, and so how the result is.
    pub(in crate::commands) source: SourceInfo,
}

/// The keys, and what is kept of an earlier result. `read` reads a motion.
pub(in crate::commands) fn resolve(
    wishes: &[Wish],
    clips: &Clips<'_>,
    control: &Control,
    mut read: impl FnMut(&Path) -> Result<Import, CliError>,
) -> Result<(Vec<Key>, Option<Kept>), CliError> {
    let mut files = Files { clips, read: BTreeMap::new() };
    let (mut keys, mut kept) = (Vec::with_capacity(wishes.len()), None);
    for wish in wishes {
        keys.push(match wish {
            Wish::Soft { at, pose, weight } => {
                Key::Soft { place: place(at, control)?, pose: files.pose(pose, &mut read)?, weight: *weight }
            }
            Wish::Avoid { pose, distance, weight } => {
                Key::Avoid { pose: files.pose(pose, &mut read)?, distance: *distance, weight: *weight }
            }
            Wish::Never { pose, radius } => {
                Key::Never { pose: files.pose(pose, &mut read)?, radius: *radius }
            }
            Wish::Hard { at, pose } => {
                let seconds = match place(at, control)? {
                    Place::Time(seconds) => seconds,
                    Place::Row(row) => row as f64 / control.rate,
                    // The readers let no other through.
                    Place::Value(_) | Place::Label(_) => 0.0,
                };
                Key::Hard { seconds, frame: files.own_frame(pose)? }
            }
            Wish::Fix { span, from } => files.fix(*span, from, &mut kept, &mut read)?,
        });
    }
    if let Some(kept) = &mut kept {
        kept.rows.sort_by_key(|row| row.frame);
    }
    Ok((keys, kept))
}

fn place(at: &At, control: &Control) -> Result<Place, CliError> {
    match at {
        At::Place(place) => Ok(place.clone()),
        At::Sound(seconds) if control.kind == ControlKind::Sound => {
            Ok(Place::Row((seconds * inkrig_sound::FRAME_RATE_HZ).round() as usize))
        }
        At::Sound(seconds) => Err(CliError::Key {
            text: format!("sound:{seconds}s"),
            known: "a time of a sound goes with --sound; a time of the result is 1.5s",
        }),
    }
}

/// Clips that keys name, each read once.
struct Files<'a> {
    clips: &'a Clips<'a>,
    read: BTreeMap<PathBuf, (Arc<Clip>, SourceInfo)>,
}

impl Files<'_> {
    fn pose(
        &mut self,
        named: &Named,
        read: &mut impl FnMut(&Path) -> Result<Import, CliError>,
    ) -> Result<Pose, CliError> {
        let Some(file) = named.file.as_ref().filter(|file| !self.is_arranged(file)) else {
            return Ok(Pose::Frame(self.own_frame(named)?));
        };
        let name = printable::path(file);
        Ok(Pose::Of { name, clip: self.clip(file, read)?.0.clone(), frame: named.frame })
    }

    fn is_arranged(&self, file: &Path) -> bool {
        self.clips.parts.iter().any(|(path, ..)| path == file)
    }

    /// The frame of the clips that are arranged. Frames are counted in the file, the engine counts from where `--range`
    /// begins. Without a file's name, frames of several clips are counted through what is left of all of them.
    fn own_frame(&self, named: &Named) -> Result<usize, CliError> {
        let text = |file: &Path| format!("{}:{}", file.display(), named.frame);
        let (index, text) = match &named.file {
            None if self.clips.parts.len() > 1 => return Ok(named.frame),
            None => (0, format!("frame:{}", named.frame)),
            Some(file) => match self.clips.parts.iter().position(|(path, ..)| path == file) {
                Some(index) => (index, text(file)),
                None => {
                    let known = "an exact pose is one of the clips that are arranged: name this file among them, or make \
                                 the key a soft one (~)";
                    return Err(CliError::Key { text: text(file), known });
                }
            },
        };
        let (Some((_, rate, start)), Some(range)) =
            (self.clips.parts.get(index), self.clips.takes.ranges().nth(index))
        else {
            return Ok(named.frame);
        };
        let Some(frame) = named.frame.checked_sub(*start) else {
            return Err(CliError::Key { text, known: "it lies before --range begins" });
        };
        let own_rate = self.clips.takes.clip().frame_rate();
        let place = if *rate == own_rate { frame } else { (frame as f64 * own_rate / rate).round() as usize };
        if place >= range.len() && self.clips.parts.len() > 1 {
            return Err(CliError::Key { text, known: "that clip ends, or --range ends, before it" });
        }
        Ok(range.start.saturating_add(place))
    }

    fn clip(
        &mut self,
        file: &Path,
        read: &mut impl FnMut(&Path) -> Result<Import, CliError>,
    ) -> Result<&(Arc<Clip>, SourceInfo), CliError> {
        if !self.read.contains_key(file) {
            let import = read(file)?;
            self.read.insert(file.to_path_buf(), (Arc::new(import.clip), import.source));
        }
        self.read.get(file).ok_or_else(|| CliError::Kind { path: file.to_path_buf(), known: "a motion" })
    }

    fn fix(
        &mut self,
        span: span::Span,
        from: &Path,
        kept: &mut Option<Kept>,
        read: &mut impl FnMut(&Path) -> Result<Import, CliError>,
    ) -> Result<Key, CliError> {
        let result_rate = self.clips.rate;
        let (clip, source) = self.clip(from, read)?;
        let refuse = |cause: String| CliError::Fix { path: from.to_path_buf(), cause };
        let rate = clip.frame_rate();
        if source.format != Format::Bvh {
            return Err(refuse(
                "parts can stay as they are in BVH files only: give the .bvh that was written".into(),
            ));
        }
        if (rate / result_rate - 1.0).abs() > 1e-6 {
            let rate = printable::fixed(rate, 3);
            return Err(refuse(format!(
                "it has {rate} frames a second and the result {}: give --fps {rate}",
                printable::fixed(result_rate, 3)
            )));
        }
        let frames = span.frames(rate, clip.frames());
        if frames.is_empty() {
            let seconds = printable::fixed(span::seconds(clip), 2);
            return Err(refuse(format!(
                "--fix {span} holds nothing of it; it ends at {seconds} s: give a part within"
            )));
        }
        let rows = bvh_rows(&load::motion_bytes(from)?, frames.clone())
            .map_err(|error| CliError::Format { path: from.to_path_buf(), cause: Box::new(error) })?;
        let (earlier, source) = (clip.clone(), source.clone());
        kept.get_or_insert_with(|| Kept { rows: Vec::new(), source }).rows.extend(rows);
        Ok(Key::Fixed { earlier, frames })
    }
}
