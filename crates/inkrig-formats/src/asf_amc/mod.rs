//! ASF and AMC: a skeleton in one file, its motions in others (Acclaim, as kept by the CMU motion library).
//!
//! A bone's `axis` says how its own frame lies in the world of the rest pose; its angles turn it within that frame. A
//! clip's joints stand at the beginnings of the bones and their rest frames are the world's, so a local rotation is
//! C M C^-1 with C from `axis` and M from the angles of the frame. The last bone of a chain gets an end site.

mod angles;
mod bone;
mod rows;
mod skeleton_file;
mod tree;

use crate::lexer::Lexer;
use crate::{Evidence, Finding, Format, FormatError, Import, ImportOptions, Place, SourceInfo, UpAxis, unit};
use inkrig_motion::glam::DVec3;
use inkrig_motion::{Clip, Joint, Skeleton};
use skeleton_file::Asf;
use std::sync::Arc;

/// An inch, in metres: the unit of a skeleton file whose `length` is not 1.
const INCH: f64 = 0.0254;

/// Frames a second of the CMU library as it was captured. An AMC file says nothing of it.
const USUAL_RATE: f64 = 120.0;

/// Reads an AMC file with the ASF file of its skeleton, given as [`ImportOptions::skeleton`].
///
/// # Errors
/// [`FormatError::Options`] without a skeleton or for an option out of range, [`FormatError::Read`] with line, column
/// and bone when one of the two texts cannot be understood or they do not belong together, [`FormatError::Limit`]
/// when they ask for too much.
pub fn read_amc(bytes: &[u8], options: &ImportOptions) -> Result<Import, FormatError> {
    options.check()?;
    let Some(skeleton) = &options.skeleton else {
        return Err(FormatError::Options {
            what: "an AMC file holds no skeleton".into(),
            hint: "give the ASF file that belongs to it with --skeleton".into(),
        });
    };
    for text in [bytes, skeleton] {
        options.limits.check_bytes(text)?;
    }
    let mut findings = Vec::new();
    let asf = skeleton_file::parse(&mut Lexer::new(skeleton), &options.limits, &mut findings)
        .map_err(|error| error.in_file("skeleton"))?;
    let up = options.up.unwrap_or_default();
    let (metres_per_unit, unit_evidence) = unit(&asf, options, &mut findings)?;
    let scale = Scale { metres_per_unit, up };
    let skeleton = Arc::new(Skeleton::new(joints(&asf, scale))?);
    let rows = rows::read(&mut Lexer::new(bytes), &asf, &skeleton, scale, &options.limits, &mut findings)?;
    let frame_rate = options.frame_rate.unwrap_or_else(|| {
        let message = format!(
            "an AMC file does not say its frame rate, so it is taken as {USUAL_RATE} frames a second; `--source-fps` sets another"
        );
        findings.push(Finding::warning("amc-frame-rate", message));
        USUAL_RATE
    });
    let clip = Clip::new(skeleton, frame_rate, rows.rotations, vec![rows.translation])?;
    let source = SourceInfo {
        format: Format::Amc,
        metres_per_unit,
        unit_evidence,
        up,
        up_evidence: if options.up.is_some() { Evidence::Given } else { Evidence::Assumed },
        channels: Vec::new(),
        frame_time: None,
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

impl Scale {
    fn metres(self, v: DVec3) -> inkrig_motion::glam::Vec3 {
        (self.up.clip_from_file(v) * self.metres_per_unit).as_vec3()
    }
}

/// The joints in the order of the bones, every leaf followed by its end site.
fn joints(asf: &Asf, scale: Scale) -> Vec<Joint> {
    let mut joints = vec![Joint::new("root", None, scale.metres(asf.root.position))];
    for (index, bone) in asf.bones.iter().enumerate() {
        let parent = bone.parent.and_then(|parent| asf.bones.get(parent));
        let offset = scale.metres(parent.map_or(DVec3::ZERO, bone::Bone::reach));
        joints.push(Joint::new(bone.name.as_str(), Some(bone.parent_joint), offset));
        if asf.is_leaf(index) {
            joints.push(Joint::end(format!("{}_end", bone.name), bone.joint, scale.metres(bone.reach())));
        }
    }
    joints
}

/// The length of a unit: what the caller says; inches over the file's own factor; else a guess by size.
fn unit(
    asf: &Asf,
    options: &ImportOptions,
    findings: &mut Vec<Finding>,
) -> Result<(f64, Evidence), FormatError> {
    if let Some(metres) = options.metres_per_unit {
        return Ok((metres, Evidence::Given));
    }
    match asf.length_factor {
        Some(factor) if factor != 1.0 => {
            let metres = INCH / factor;
            crate::import::check_metres_per_unit(metres)?;
            let message = format!("the unit is taken as an inch / {factor}, the custom of the format");
            findings.push(Finding::info("asf-unit", message));
            Ok((metres, Evidence::Assumed))
        }
        _ => {
            let as_is = Scale { metres_per_unit: 1.0, up: UpAxis::Y };
            let extent = f64::from(Skeleton::new(joints(asf, as_is))?.extent());
            let (metres, finding) = unit::guess_with_finding(extent);
            findings.push(finding);
            Ok((metres, Evidence::Guessed))
        }
    }
}

/// An error of this format, at a word of one of its texts.
fn error(code: &'static str, place: Place, what: impl Into<String>, hint: impl Into<String>) -> FormatError {
    FormatError::Read { code, place, what: what.into(), hint: hint.into() }
}
