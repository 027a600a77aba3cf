//! DeepMimic: a motion in one JSON file, its character in another.
//!
//! A frame is a row of numbers: seconds until the next frame, the root's position (3) and rotation (w, x, y, z), then
//! every joint of the character in order: four numbers for a spherical joint, one angle about z for a revolute one,
//! none for a fixed one. Metres, y up.

mod character;
mod frames;

use crate::{Evidence, Finding, Format, FormatError, Import, ImportOptions, Place, SourceInfo, UpAxis};
use character::Character;
use inkrig_motion::{Clip, Skeleton};
use std::sync::Arc;

/// Reads a DeepMimic motion with the file of its character, given as [`ImportOptions::skeleton`].
///
/// # Errors
/// [`FormatError::Options`] without a character or for an option out of range, [`FormatError::Read`] with line and
/// column when one of the two texts cannot be understood or they do not belong together, [`FormatError::Limit`] when
/// they ask for too much.
pub fn read_deepmimic(bytes: &[u8], options: &ImportOptions) -> Result<Import, FormatError> {
    options.check()?;
    let Some(skeleton) = &options.skeleton else {
        return Err(FormatError::Options {
            what: "a DeepMimic motion holds no skeleton".into(),
            hint: "give the file of its character (such as humanoid3d.txt) with --skeleton".into(),
        });
    };
    for text in [bytes, skeleton] {
        options.limits.check_bytes(text)?;
    }
    let mut findings = Vec::new();
    let up = options.up.unwrap_or_default();
    let metres_per_unit = options.metres_per_unit.unwrap_or(1.0);
    let scale = Scale { metres_per_unit, up };
    let character =
        Character::parse(skeleton, scale, &options.limits).map_err(|error| error.in_file("character"))?;
    let joints = Arc::new(Skeleton::new(character.joints.clone())?);
    let motion = frames::read(bytes, &character, scale, &options.limits, &mut findings)?;
    let frame_rate = options.frame_rate.unwrap_or(motion.frame_rate);
    let clip = Clip::new(joints, frame_rate, motion.rotations, vec![motion.translation])?;
    let given = |given| if given { Evidence::Given } else { Evidence::Assumed };
    let source = SourceInfo {
        format: Format::DeepMimic,
        metres_per_unit,
        unit_evidence: given(options.metres_per_unit.is_some()),
        up,
        up_evidence: given(options.up.is_some()),
        channels: Vec::new(),
        frame_time: motion.frame_time,
        humanoid: Vec::new(),
        original: None,
    };
    Ok(Import::new(clip, source, findings))
}

/// From the file's units and axes to metres and y up.
#[derive(Debug, Clone, Copy)]
struct Scale {
    metres_per_unit: f64,
    up: UpAxis,
}

/// What serde says of a text, with its place.
fn unreadable(code: &'static str, cause: &serde_json::Error, hint: &str) -> FormatError {
    let place = Place { line: cause.line().max(1), column: cause.column().max(1), joint: None };
    let said = cause.to_string();
    // The place stands before the message already.
    let what = said.split(" at line ").next().unwrap_or(&said).to_string();
    FormatError::Read { code, place, what, hint: hint.into() }
}

/// An error of something that JSON gives no place for.
fn error(code: &'static str, joint: Option<&str>, what: String, hint: &str) -> FormatError {
    let place = Place { line: 1, column: 1, joint: joint.map(crate::finding::shown) };
    FormatError::Read { code, place, what, hint: hint.into() }
}

fn warning(code: &'static str, message: String) -> Finding {
    Finding::warning(code, message)
}
