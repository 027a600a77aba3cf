//! The rows of a MOTION: one number for every channel, one row a frame.

use super::{ByAxis, hierarchy::Hierarchy};
use crate::{Channel, Finding, FormatError, UpAxis};
use crate::{
    euler,
    lexer::{Lexer, NotANumber, Word},
};
use inkrig_motion::{
    TranslationTrack,
    glam::{DQuat, DVec3, Quat, Vec3},
};

/// From the file's units and axes to metres and y up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    pub(super) metres_per_unit: f64,
    pub(super) up: UpAxis,
}

impl Scale {
    pub(super) fn metres(self, v: DVec3) -> Vec3 {
        (self.up.clip_from_file(v) * self.metres_per_unit).as_vec3()
    }
}

/// How the rows lie in the text.
pub(super) struct Shape {
    /// At most this many rows: no header has a say in it.
    pub(super) rows: usize,
    /// Lines and frames do not end together, but the numbers make exactly the announced frames.
    pub(super) wrapped: bool,
}

/// Looks how the rows ahead lie. `announced` is the number of frames that the header gives.
pub(super) fn shape(lexer: &Lexer<'_>, width: usize, announced: Option<f64>) -> Shape {
    let rest = lexer.rest();
    let mut first_line = lexer.clone();
    let in_first_line =
        std::iter::from_fn(|| Some(first_line.word_in_line()).filter(|word| !word.text.is_empty()));
    if in_first_line.count() != width {
        let numbers = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count();
        let frames = numbers / width;
        if frames * width == numbers && announced == Some(frames as f64) {
            return Shape { rows: frames, wrapped: true };
        }
    }
    let lines = rest.split(|&byte| byte == b'\n' || byte == b'\r').filter(|line| !line.is_empty()).count();
    // Each number takes a digit and a space.
    Shape { rows: lines.min(rest.len() / (2 * width) + 1), wrapped: false }
}

/// The rows read so far, as the parts of a clip.
pub(super) struct Rows<'h> {
    hierarchy: &'h Hierarchy,
    scale: Scale,
    row: Vec<f64>,
    pub(super) count: usize,
    pub(super) rotations: Vec<Quat>,
    pub(super) translations: Vec<TranslationTrack>,
}

/// A row that the end of the file cuts short.
struct CutOff;

impl<'h> Rows<'h> {
    pub(super) fn new(hierarchy: &'h Hierarchy, scale: Scale, rows: usize) -> Self {
        let moves = |channel: &Channel| matches!(channel, Channel::Position(_));
        let moving =
            hierarchy.joints.iter().enumerate().filter(|(_, joint)| joint.channels.iter().any(moves));
        let track = |(joint, _)| TranslationTrack { joint, values: Vec::with_capacity(rows) };
        Self {
            hierarchy,
            scale,
            row: vec![0.0; hierarchy.width()],
            count: 0,
            rotations: Vec::with_capacity(rows * hierarchy.joints.len()),
            translations: moving.map(track).collect(),
        }
    }

    /// Reads all that is ahead.
    pub(super) fn read(
        &mut self,
        lexer: &mut Lexer<'_>,
        wrapped: bool,
        findings: &mut Vec<Finding>,
    ) -> Result<(), FormatError> {
        let mut row = std::mem::take(&mut self.row);
        while lexer.skip_space() {
            let start = lexer.peek();
            if self.read_row(lexer, wrapped, &mut row)?.is_err() {
                let message =
                    format!("the last row is cut off and left out; frames before it: {}", self.count);
                findings.push(Finding::warning("bvh-cut-row", message).at(lexer.place(&start, None)));
                break;
            }
            self.push(&row);
            self.count += 1;
        }
        findings.extend(self.zero_positions());
        Ok(())
    }

    fn read_row(
        &self,
        lexer: &mut Lexer<'_>,
        wrapped: bool,
        row: &mut [f64],
    ) -> Result<Result<(), CutOff>, FormatError> {
        for (index, slot) in row.iter_mut().enumerate() {
            let word = if wrapped { lexer.word() } else { lexer.word_in_line() };
            if word.text.is_empty() {
                let at_end = !lexer.skip_space();
                if at_end && self.count > 0 {
                    return Ok(Err(CutOff));
                }
                return Err(self.short_row(lexer, &word, index));
            }
            match word.number() {
                Ok(value) => *slot = value,
                Err(_) if self.count > 0 && lexer.is_last(&word) && is_begun_number(word.text) => {
                    return Ok(Err(CutOff));
                }
                Err(error) => return Err(self.bad_number(lexer, &word, index, error)),
            }
        }
        let extra =
            if wrapped { None } else { Some(lexer.word_in_line()).filter(|word| !word.text.is_empty()) };
        match extra {
            None => Ok(Ok(())),
            Some(word) => Err(self.long_row(lexer, &word)),
        }
    }

    fn push(&mut self, row: &[f64]) {
        let mut values = row.iter();
        let mut tracks = self.translations.iter_mut();
        for joint in &self.hierarchy.joints {
            let (mut rotation, mut place, mut moves) = (DQuat::IDENTITY, joint.offset, false);
            // The channels come first in the zip: no value is taken that belongs to the next joint.
            for (&channel, &value) in joint.channels.iter().zip(values.by_ref()) {
                match channel {
                    Channel::Rotation(axis) => rotation *= euler::rotation(axis, value),
                    Channel::Position(axis) => {
                        place.set(axis, value);
                        moves = true;
                    }
                }
            }
            self.rotations.push(self.scale.up.clip_from_file_rotation(rotation).as_quat());
            if let Some(track) = moves.then(|| tracks.next()).flatten() {
                track.values.push(self.scale.metres(place));
            }
        }
    }

    /// Some programs write positions that are meant to be added to the OFFSET. Nothing in the file says so, but a
    /// joint that never leaves its parent though it has an offset gives it away.
    fn zero_positions(&self) -> Option<Finding> {
        let flat = |track: &&TranslationTrack| {
            let joint = self.hierarchy.joints.get(track.joint);
            let placed = joint.is_some_and(|joint| joint.parent.is_some() && joint.offset != DVec3::ZERO);
            placed && track.values.iter().all(|&value| value == Vec3::ZERO)
        };
        let count = self.translations.iter().filter(flat).count();
        let message = format!(
            "joints with an OFFSET whose positions are zero throughout: {count}; they lie on their parents. If the \
             figure collapses, take the position channels out of them"
        );
        (count > 0).then(|| Finding::warning("bvh-zero-positions", message))
    }

    fn bad_number(&self, lexer: &Lexer<'_>, word: &Word<'_>, index: usize, error: NotANumber) -> FormatError {
        if word.is("HIERARCHY") || word.is("MOTION") {
            let hint = "keep one HIERARCHY and one MOTION a file";
            return lexer.error(
                "bvh-second-motion",
                word,
                None,
                format!("{} a second time", word.shown()),
                hint,
            );
        }
        let (joint, channel) = self.owner(index);
        let what =
            format!("frame {}: expected a number for {channel}, found {}", self.count + 1, word.shown());
        lexer.error("bvh-number", word, joint, what, error.hint())
    }

    fn short_row(&self, lexer: &Lexer<'_>, word: &Word<'_>, index: usize) -> FormatError {
        let (joint, channel) = self.owner(index);
        let (frame, width) = (self.count + 1, self.hierarchy.width());
        let what = format!("frame {frame} has {index} of {width} numbers: {channel} is missing");
        lexer.error(
            "bvh-row-length",
            word,
            joint,
            what,
            "write one frame a line, with a number for every channel",
        )
    }

    fn long_row(&self, lexer: &Lexer<'_>, word: &Word<'_>) -> FormatError {
        let width = self.hierarchy.width();
        let (joint, channel) = self.owner(width.saturating_sub(1));
        let what = format!(
            "frame {} has more than {width} numbers: {} comes after {channel}, the last channel",
            self.count + 1,
            word.shown()
        );
        lexer.error(
            "bvh-row-length",
            word,
            joint,
            what,
            "write one frame a line, with a number for every channel",
        )
    }

    fn owner(&self, index: usize) -> (Option<&str>, &'static str) {
        let owner = self.hierarchy.owner(index);
        owner.map_or((None, "a channel"), |(joint, channel)| (Some(joint.name.as_str()), channel.to_bvh()))
    }
}

/// What is left of a number when a file is cut within it, and is no number.
fn is_begun_number(text: &[u8]) -> bool {
    let (last, front) = match text.split_last() {
        Some((last, front)) => (*last, front),
        None => return false,
    };
    let digits =
        |text: &[u8]| text.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'+' | b'.'));
    match last {
        b'-' | b'+' | b'.' => front.is_empty() || matches!(front, b"-" | b"+") || front.ends_with(b"e"),
        b'e' | b'E' => !front.is_empty() && digits(front),
        _ => false,
    }
}
