//! The BVH writer.

use super::{
    ByAxis, FRAME_TIMES,
    outline::{Outline, Step},
};
use crate::{Channel, ExportOptions, Finding, FormatError, KeptRow, Limits, Written, finding::shown, import};
use crate::{euler::EulerSolver, lexer::LARGEST_NUMBER, numbers::push_decimal};
use inkrig_motion::{Clip, Joint, glam::Vec3};
use std::io::Write;

/// Deeper joints are not indented further: indentation alone would else grow with the square of the depth.
const DEEPEST_INDENT: usize = 64;

/// Writes a clip as a BVH file: one row a frame, `\n` at line ends.
///
/// Positions come back within 1e-5 of the figure's size and rotations within 0.01 degree when the file is read again.
/// Angles run on from frame to frame without jumps of a turn. Channels that cannot hold the motion are added to, with
/// a finding. Joints are written depth first.
///
/// # Errors
/// [`FormatError::Options`] when a unit is out of range, [`FormatError::Write`] when a number or the frame rate is
/// beyond what a BVH can hold.
pub fn write_bvh(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    import::check_metres_per_unit(options.metres_per_unit)?;
    options.check_no_curves("BVH")?;
    let frame_time = frame_time(clip, options)?;
    let outline = Outline::of(clip, options);
    let mut writer = Writer { clip, options, digits: Digits::of(clip, options), out: Vec::new(), renamed: 0 };
    writer.hierarchy(&outline)?;
    // Writing to memory does not fail.
    let _ = writeln!(writer.out, "MOTION\nFrames: {}", clip.frames());
    writer.out.extend_from_slice(b"Frame Time: ");
    writer.out.extend_from_slice(frame_time.as_bytes());
    writer.out.push(b'\n');
    writer.rows(&outline)?;
    let Writer { out, renamed, .. } = writer;
    let mut findings = outline.findings;
    if renamed > 0 {
        let message =
            format!("{renamed} joint names cannot stand in a BVH as they are; they are written changed");
        findings.push(Finding::warning("bvh-renamed", message));
    }
    Ok(Written { bytes: out, findings })
}

struct Writer<'w> {
    clip: &'w Clip,
    options: &'w ExportOptions,
    digits: Digits,
    out: Vec<u8>,
    renamed: usize,
}

/// Decimals that keep what is promised.
struct Digits {
    position: u32,
    rotation: u32,
}

impl Digits {
    /// Errors add up along a chain, so deep figures get more: at the tip of the deepest chain, positions and rotations
    /// may each do 3e-6 of the figure's size, and what f32 does comes on top. More decimals would write f32's noise.
    fn of(clip: &Clip, options: &ExportOptions) -> Self {
        let depth = clip.skeleton().depths().into_iter().max().unwrap_or(0) as f64 + 1.0;
        let size = f64::from(clip.skeleton().extent()) / options.metres_per_unit;
        // Half of the last decimal is the largest error of one number.
        let decimals = |error: f64| (0.5 / error).log10().ceil();
        let position = if size > 0.0 { decimals(3e-6 * size / depth).clamp(0.0, 12.0) } else { 6.0 };
        let rotation = decimals(3e-6_f64.to_degrees() / depth).clamp(5.0, 9.0);
        Self { position: position as u32, rotation: rotation as u32 }
    }
}

/// The fewest decimals that bring back the very same f32 of metres.
fn exact_decimals(value: f64, metres_per_unit: f64) -> u32 {
    let metres = (value * metres_per_unit) as f32;
    let same = |decimals: &u32| {
        let scale = 10_f64.powi(*decimals as i32);
        ((value * scale).round() / scale * metres_per_unit) as f32 == metres
    };
    (0..12).find(same).unwrap_or(12)
}

impl Writer<'_> {
    fn hierarchy(&mut self, outline: &Outline<'_>) -> Result<(), FormatError> {
        self.out.extend_from_slice(b"HIERARCHY\n");
        let joints = self.clip.skeleton().joints();
        let mut depth = 0;
        for &step in &outline.steps {
            match step {
                Step::Close => {
                    depth -= 1;
                    self.indent(depth);
                    self.out.extend_from_slice(b"}\n");
                }
                Step::OpenJoint(index) => {
                    let Some(joint) = joints.get(index) else { continue };
                    self.indent(depth);
                    let keyword = if joint.parent.is_none() { "ROOT " } else { "JOINT " };
                    self.out.extend_from_slice(keyword.as_bytes());
                    self.name(&joint.name);
                    self.open(joint, depth)?;
                    depth += 1;
                    self.channels(outline.channels.get(index).map_or(&[], Vec::as_slice), depth);
                }
                Step::OpenEndSite(index) => {
                    let Some(joint) = joints.get(index) else { continue };
                    self.indent(depth);
                    self.out.extend_from_slice(b"End Site\n");
                    self.open(joint, depth)?;
                    depth += 1;
                }
            }
        }
        Ok(())
    }

    fn open(&mut self, joint: &Joint, depth: usize) -> Result<(), FormatError> {
        self.indent(depth);
        self.out.extend_from_slice(b"{\n");
        self.indent(depth + 1);
        self.out.extend_from_slice(b"OFFSET");
        let offset = self.options.up.file_from_clip(joint.offset.as_dvec3()) / self.options.metres_per_unit;
        for value in offset.to_array() {
            let value = in_range(value, &joint.name, None)?;
            self.out.push(b' ');
            push_decimal(&mut self.out, value, exact_decimals(value, self.options.metres_per_unit));
        }
        self.out.push(b'\n');
        Ok(())
    }

    fn channels(&mut self, channels: &[Channel], depth: usize) {
        self.indent(depth);
        let _ = write!(self.out, "CHANNELS {}", channels.len());
        for channel in channels {
            let _ = write!(self.out, " {}", channel.to_bvh());
        }
        self.out.push(b'\n');
    }

    fn name(&mut self, name: &str) {
        let ends_name = |c: char| matches!(c, '{' | '\n' | '\r');
        let mut written = name.replace(ends_name, "_");
        while written.len() > Limits::default().name_bytes {
            written.pop();
        }
        let written = written.trim_matches([' ', '\t', '\u{b}', '\u{c}']);
        self.renamed += usize::from(written != name);
        self.out.extend_from_slice(written.as_bytes());
        self.out.push(b'\n');
    }

    fn indent(&mut self, depth: usize) {
        self.out.extend(std::iter::repeat_n(b'\t', depth.min(DEEPEST_INDENT)));
    }

    fn rows(&mut self, outline: &Outline<'_>) -> Result<(), FormatError> {
        let joints = self.clip.skeleton().joints();
        let mut columns: Vec<Column<'_>> = (outline.columns())
            .filter_map(|index| {
                let channels = outline.channels.get(index)?.as_slice();
                let track = outline.tracks.get(index).copied().flatten();
                Some(Column {
                    index,
                    joint: joints.get(index)?,
                    channels,
                    track,
                    solver: EulerSolver::new(channels),
                })
            })
            .filter(|column| !column.channels.is_empty())
            .collect();
        if let Some(first) = self.options.kept.first() {
            self.lead_up_to(first, &mut columns)?;
        }
        let mut kept = self.options.kept.iter().peekable();
        for frame in 0..self.clip.frames() {
            if let Some(row) = kept.next_if(|row| row.frame == frame) {
                resume(&mut columns, row)?;
                self.out.extend_from_slice(&row.text);
                self.out.push(b'\n');
                continue;
            }
            for column in &mut columns {
                self.joint(column, frame)?;
            }
            // Each number has a space behind it; the last one's becomes the line end.
            if let Some(last) = self.out.last_mut() {
                *last = b'\n';
            }
        }
        Ok(())
    }

    /// Finds the angles of the first frame from which they run on into a row that is given.
    fn lead_up_to(&self, row: &KeptRow, columns: &mut [Column<'_>]) -> Result<(), FormatError> {
        resume(columns, row)?;
        for frame in (0..row.frame.min(self.clip.frames())).rev() {
            for column in columns.iter_mut() {
                if let Some(rotation) = self.clip.rotations(frame).get(column.index) {
                    column.solver.next(self.options.up.file_from_clip_rotation(rotation.as_dquat()));
                }
            }
        }
        Ok(())
    }

    fn joint(&mut self, column: &mut Column<'_>, frame: usize) -> Result<(), FormatError> {
        let up = self.options.up;
        if let Some(rotation) = self.clip.rotations(frame).get(column.index) {
            column.solver.next(up.file_from_clip_rotation(rotation.as_dquat()));
        }
        let place = column.track.and_then(|values| values.get(frame)).unwrap_or(&column.joint.offset);
        let place = up.file_from_clip(place.as_dvec3()) / self.options.metres_per_unit;
        let mut angles = column.solver.degrees();
        for channel in column.channels {
            match channel {
                Channel::Rotation(_) => {
                    push_decimal(&mut self.out, angles.next().unwrap_or(0.0), self.digits.rotation);
                }
                Channel::Position(axis) => {
                    let value = in_range(place.get(*axis), &column.joint.name, Some(frame))?;
                    push_decimal(&mut self.out, value, self.digits.position);
                }
            }
            self.out.push(b' ');
        }
        Ok(())
    }
}

/// The numbers of one joint in each row.
struct Column<'w> {
    index: usize,
    joint: &'w Joint,
    channels: &'w [Channel],
    track: Option<&'w [Vec3]>,
    solver: EulerSolver,
}

/// Goes on from the angles of a row that is given.
fn resume(columns: &mut [Column<'_>], row: &KeptRow) -> Result<(), FormatError> {
    let mut numbers = row.numbers();
    for column in columns {
        let own: Vec<f64> = numbers.by_ref().take(column.channels.len()).collect();
        if own.len() < column.channels.len() {
            return Err(not_this_file(row));
        }
        let turns =
            column.channels.iter().zip(own).filter(|(channel, _)| matches!(channel, Channel::Rotation(_)));
        column.solver.resume(turns.map(|(_, degrees)| degrees));
    }
    if numbers.next().is_some() { Err(not_this_file(row)) } else { Ok(()) }
}

fn not_this_file(row: &KeptRow) -> FormatError {
    FormatError::Write {
        what: format!(
            "frame {} has to stay as it is in another file, which has other channels",
            row.frame + 1
        ),
        hint: "keep frames of a file that was written with the same channels".into(),
    }
}

/// The value as it can be written. Its rounding to f32 may have brought it beyond what readers take.
fn in_range(value: f64, joint: &str, frame: Option<usize>) -> Result<f64, FormatError> {
    if value.abs() <= LARGEST_NUMBER * (1.0 + 1e-6) {
        return Ok(value.clamp(-LARGEST_NUMBER, LARGEST_NUMBER));
    }
    let place = frame.map_or("its OFFSET".into(), |frame| format!("frame {}", frame + 1));
    let what =
        format!("joint `{}` is {value:e} units away in {place}, and a BVH holds up to 1e12", shown(joint));
    Err(FormatError::Write {
        what,
        hint: "write in a larger unit, or bring the motion nearer to the origin".into(),
    })
}

fn frame_time(clip: &Clip, options: &ExportOptions) -> Result<String, FormatError> {
    let time = 1.0 / clip.frame_rate();
    if !FRAME_TIMES.contains(&time) {
        return Err(FormatError::Write {
            what: format!("{} frames a second is not a rate that BVH readers accept", clip.frame_rate()),
            hint: "resample the motion to a rate between 0.1 and 100000".into(),
        });
    }
    let same = |source: &f64| (source / time - 1.0).abs() < 1e-9;
    if let Some(source) = options.frame_time.filter(same) {
        return Ok(source.to_string());
    }
    // Ten digits: 1/30 s comes back as 30 frames a second to nine.
    let decimals = (9.0 - time.log10().floor()) as usize;
    let text = format!("{time:.decimals$}");
    Ok(text.trim_end_matches('0').trim_end_matches('.').into())
}
