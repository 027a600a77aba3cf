//! The motion file: a frame's number on a line, then one line for every bone that moves.

use super::angles::{Order, sorted};
use super::bone::Dof;
use super::skeleton_file::Asf;
use super::{Scale, error};
use crate::lexer::{Lexer, Word};
use crate::{Finding, FormatError, Limits};
use inkrig_motion::glam::{DQuat, Quat, Vec3};
use inkrig_motion::{Skeleton, TranslationTrack};
use std::collections::HashMap;

/// All frames as the parts of a clip.
pub(super) struct Rows {
    /// Frames x joints.
    pub(super) rotations: Vec<Quat>,
    /// Of the root.
    pub(super) translation: TranslationTrack,
}

/// Something that a line of a frame can name.
struct Mover<'a> {
    joint: usize,
    dofs: &'a [Dof],
    order: Order,
    frame: DQuat,
}

/// Reads all frames. What a frame does not say stays as it was in the frame before.
pub(super) fn read(
    lexer: &mut Lexer<'_>,
    asf: &Asf,
    skeleton: &Skeleton,
    scale: Scale,
    limits: &Limits,
    findings: &mut Vec<Finding>,
) -> Result<Rows, FormatError> {
    let movers = movers(asf);
    let (joints, most) = (skeleton.len(), limits.cells_for(lexer.len()));
    let mut pose = vec![Quat::IDENTITY; joints];
    let rest = skeleton.joints().first().map_or(Vec3::ZERO, |root| root.offset);
    let mut place = rest;
    let mut rows =
        Rows { rotations: Vec::new(), translation: TranslationTrack { joint: 0, values: Vec::new() } };
    let (mut degrees_per_unit, mut open, mut missing) = (1.0, false, 0_usize);
    let mut said = vec![0_usize; joints];
    let mut values = Vec::new();
    while lexer.skip_space() {
        let word = lexer.word_in_line();
        match word.text {
            [b'#', ..] => drop(lexer.line()),
            [b':', keyword @ ..] => {
                if keyword.to_ascii_lowercase().starts_with(b"rad") {
                    degrees_per_unit = 1.0_f64.to_degrees();
                }
                lexer.line();
            }
            text if text.iter().all(u8::is_ascii_digit) => {
                if open {
                    rows.push(&pose, place);
                }
                open = true;
                if rows.rotations.len().saturating_add(joints) > most {
                    return Err(FormatError::Limit {
                        what: format!("{} frames of {joints} joints", rows.translation.values.len() + 1),
                        limit: most,
                        place: Some(lexer.place(&word, None)),
                        hint: "cut the motion into shorter ones".into(),
                    });
                }
                lexer.line();
            }
            _ if !open => {
                let what = format!("expected the number of the first frame, found {}", word.shown());
                let hint = "an AMC file begins with :FULLY-SPECIFIED, :DEGREES and then frame 1";
                return Err(error("amc-frame", lexer.place(&word, None), what, hint));
            }
            name => {
                let Some(mover) = movers.get(name) else {
                    let what = format!("the skeleton file has no bone {} that moves", word.shown());
                    let hint = "give the .asf file that belongs to this motion";
                    return Err(error("amc-bone", lexer.place(&word, None), what, hint));
                };
                numbers(lexer, &word, mover.dofs.len(), &mut values)?;
                let (angles, translation) = sorted(mover.dofs, &values, degrees_per_unit);
                let turned = mover.frame * mover.order.rotation(angles) * mover.frame.conjugate();
                if let Some(slot) = pose.get_mut(mover.joint) {
                    *slot = scale.up.clip_from_file_rotation(turned).normalize().as_quat();
                }
                if mover.joint == 0 {
                    place = rest + scale.metres(translation);
                }
                if let Some(count) = said.get_mut(mover.joint) {
                    *count += 1;
                }
            }
        }
    }
    if !open {
        let end = lexer.word();
        return Err(error(
            "amc-no-frames",
            lexer.place(&end, None),
            "there are no frames",
            "export the motion again",
        ));
    }
    rows.push(&pose, place);
    let frames = rows.translation.values.len();
    for mover in movers.values() {
        missing += usize::from(said.get(mover.joint).is_none_or(|&count| count < frames));
    }
    if missing > 0 {
        let message = format!("{missing} bones are not said in every frame; there they stay as they were");
        findings.push(Finding::warning("amc-missing", message));
    }
    Ok(rows)
}

fn movers(asf: &Asf) -> HashMap<&[u8], Mover<'_>> {
    let root = Mover { joint: 0, dofs: &asf.root.dofs, order: asf.root.order, frame: asf.root.frame };
    let bones = asf.bones.iter().filter(|bone| !bone.dofs.is_empty()).map(|bone| {
        let mover = Mover { joint: bone.joint, dofs: &bone.dofs, order: bone.order, frame: bone.frame };
        (bone.name.as_bytes(), mover)
    });
    std::iter::once((&b"root"[..], root)).chain(bones).collect()
}

/// Exactly `count` numbers to the end of the line.
fn numbers(
    lexer: &mut Lexer<'_>,
    bone: &Word<'_>,
    count: usize,
    values: &mut Vec<f64>,
) -> Result<(), FormatError> {
    values.clear();
    let name = String::from_utf8_lossy(bone.text.get(..64).unwrap_or(bone.text)).into_owned();
    loop {
        let word = lexer.word_in_line();
        if word.text.is_empty() && values.len() == count {
            return Ok(());
        }
        if word.text.is_empty() || values.len() == count {
            let found = if word.text.is_empty() { values.len().to_string() } else { "more".into() };
            let what = format!("the bone has {count} numbers in the skeleton file, {found} here");
            let hint = "give the .asf file that belongs to this motion";
            return Err(error("amc-count", lexer.place(&word, Some(&name)), what, hint));
        }
        values.push(word.number().map_err(|problem| {
            let what = format!("expected a number, found {}", word.shown());
            error("amc-number", lexer.place(&word, Some(&name)), what, problem.hint())
        })?);
    }
}

impl Rows {
    fn push(&mut self, pose: &[Quat], place: Vec3) {
        self.rotations.extend_from_slice(pose);
        self.translation.values.push(place);
    }
}
