//! BVH: a hierarchy of joints with channels, then one row of numbers a frame.
//!
//! There is no written standard. This module follows what files and programs do: rotations are in degrees and
//! multiplied in channel order; a position channel takes the place of its axis of the OFFSET; y is up unless the
//! caller says z; lengths have no unit.

mod channel;
mod hierarchy;
mod hierarchy_parser;
mod kept;
mod motion;
mod outline;
mod rows;
mod write;

pub use kept::bvh_rows;
pub use write::write_bvh;

use crate::{
    Evidence, Finding, Format, FormatError, Import, ImportOptions, Place, SourceInfo, finding, lexer::Lexer,
    unit,
};
use hierarchy::Hierarchy;
use inkrig_motion::{Clip, Joint, Skeleton, glam::DVec3};
use std::{collections::HashSet, sync::Arc};

/// Frame times that a BVH may have, seconds. Outside of it a file is taken for broken.
const FRAME_TIMES: std::ops::RangeInclusive<f64> = 1e-5..=10.0;

/// Reads a BVH file.
///
/// Any channel order, positions on any joint, several roots, CR, LF or CRLF, tabs, a byte order mark, and names with
/// spaces or given twice are all fine. End sites become joints named `<parent>_end`. Rows are used as far as they
/// are there, whatever their announced number.
///
/// # Errors
/// [`FormatError::Read`] with line, column and joint when the text cannot be understood, [`FormatError::Limit`] when
/// it asks for too much, [`FormatError::Options`] for an option out of range.
pub fn read_bvh(bytes: &[u8], options: &ImportOptions) -> Result<Import, FormatError> {
    options.check()?;
    check_bytes(bytes, options)?;
    let mut lexer = Lexer::new(bytes);
    let hierarchy = hierarchy_parser::parse(&mut lexer, &options.limits)?;
    let mut findings = hierarchy.findings();
    findings.extend(duplicates(&hierarchy));
    let (metres_per_unit, unit_evidence) = match options.metres_per_unit {
        Some(metres) => (metres, Evidence::Given),
        None => {
            let (metres, finding) = unit::guess_with_finding(extent_in_units(&hierarchy)?);
            findings.push(finding);
            (metres, Evidence::Guessed)
        }
    };
    let up_evidence = if options.up.is_some() { Evidence::Given } else { Evidence::Assumed };
    let up = options.up.unwrap_or_default();
    let scale = rows::Scale { metres_per_unit, up };
    let motion = motion::parse(&mut lexer, &hierarchy, scale, options, &mut findings)?;
    let (skeleton, channels) = skeleton(hierarchy, scale)?;
    let clip = Clip::new(Arc::new(skeleton), motion.frame_rate, motion.rotations, motion.translations)?;
    let frame_time = motion.frame_time;
    let format = Format::Bvh;
    let source = SourceInfo {
        format,
        metres_per_unit,
        unit_evidence,
        up,
        up_evidence,
        channels,
        frame_time,
        humanoid: Vec::new(),
        original: None,
    };
    Ok(Import::new(clip, source, findings))
}

fn check_bytes(bytes: &[u8], options: &ImportOptions) -> Result<(), FormatError> {
    options.limits.check_bytes(bytes)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(FormatError::Read {
            code: "bvh-utf16",
            place: Place { line: 1, column: 1, joint: None },
            what: "the file is UTF-16 text".into(),
            hint: "save it as UTF-8 in a text editor".into(),
        });
    }
    Ok(())
}

fn duplicates(hierarchy: &Hierarchy) -> Option<Finding> {
    let mut seen = HashSet::with_capacity(hierarchy.joints.len());
    let named = hierarchy.joints.iter().filter(|joint| !joint.end_site);
    let mut repeated = named.filter(|joint| !seen.insert(joint.name.as_str()));
    let first = repeated.next()?;
    let (name, others) = (finding::shown(&first.name), repeated.count());
    let more = if others > 0 { format!(", and {others} more") } else { String::new() };
    let message =
        format!("the joint name `{name}` is used more than once{more}; such joints are told apart by order");
    Some(Finding::warning("bvh-duplicate-name", message))
}

fn extent_in_units(hierarchy: &Hierarchy) -> Result<f64, FormatError> {
    let joints = hierarchy.joints.iter().map(|joint| Joint {
        name: String::new(),
        parent: joint.parent,
        offset: joint.offset.as_vec3(),
        end_site: joint.end_site,
    });
    Ok(f64::from(Skeleton::new(joints.collect())?.extent()))
}

type Channels = Vec<Vec<crate::Channel>>;

fn skeleton(hierarchy: Hierarchy, scale: rows::Scale) -> Result<(Skeleton, Channels), FormatError> {
    let mut channels = Vec::with_capacity(hierarchy.joints.len());
    let mut joints = Vec::with_capacity(hierarchy.joints.len());
    for joint in hierarchy.joints {
        let offset = scale.metres(joint.offset);
        joints.push(Joint { name: joint.name, parent: joint.parent, offset, end_site: joint.end_site });
        channels.push(joint.channels);
    }
    Ok((Skeleton::new(joints)?, channels))
}

/// Components of a vector by axis.
trait ByAxis {
    fn get(&self, axis: crate::Axis) -> f64;
    fn set(&mut self, axis: crate::Axis, value: f64);
}

impl ByAxis for DVec3 {
    fn get(&self, axis: crate::Axis) -> f64 {
        match axis {
            crate::Axis::X => self.x,
            crate::Axis::Y => self.y,
            crate::Axis::Z => self.z,
        }
    }

    fn set(&mut self, axis: crate::Axis, value: f64) {
        match axis {
            crate::Axis::X => self.x = value,
            crate::Axis::Y => self.y = value,
            crate::Axis::Z => self.z = value,
        }
    }
}
