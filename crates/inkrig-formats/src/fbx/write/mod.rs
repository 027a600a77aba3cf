//! The FBX writer: a whole scene with a skeleton and one clip, binary 7.4.

mod animation;
mod body;
mod curve;
mod document;
mod header;
mod ids;
mod keys;
mod skeleton;

use crate::{ExportOptions, Finding, FormatError, Written, import, lexer::LARGEST_NUMBER};
use animation::Animation;
use body::Mesh;
use document::Document;
use ids::Ids;
use inkrig_motion::{
    Clip,
    glam::{DVec3, Vec3},
    keyframes::RotationForm,
};

/// What a clip without a name is called.
const CLIP_NAME: &str = "motion";

/// Longer clips are beyond what the reader takes for a time, seconds.
const LONGEST: f64 = 1e8;

/// Writes a clip as a binary FBX 7.4 file: limbs at their rest places, a body of capsules, one animation stack with one
/// linear key a frame or the few of [`ExportOptions::keys`].
///
/// Unit and axes are those of [`ExportOptions`], and the file says them. Rotations are Euler angles in the format's own
/// order, which run on from frame to frame without jumps of a turn. End sites are limbs that say so: `read_fbx` gives them
/// back, and other programs show them as bones.
///
/// # Errors
/// [`FormatError::Options`] when the unit is out of range, [`FormatError::Write`] when a number, the length or the file is
/// larger than the format holds.
pub fn write_fbx(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    import::check_metres_per_unit(options.metres_per_unit)?;
    options.check_curves("FBX", RotationForm::Angles { axes: options.up.clip_from_file_turn() })?;
    if clip.duration() > LONGEST {
        return Err(FormatError::Write {
            what: format!("the motion is {} s long, and an FBX holds up to 1e8 s", clip.duration()),
            hint: "write a part of it".into(),
        });
    }
    let mut renamed = 0;
    let mut fit = |name: &str| {
        let written = name.replace(char::is_control, "_");
        renamed += usize::from(written != name);
        written
    };
    let name = fit(options.name.as_deref().unwrap_or(CLIP_NAME));
    let names: Vec<String> = clip.skeleton().joints().iter().map(|joint| fit(&joint.name)).collect();
    let scene = Scene { clip, options, name, names };
    let bytes = scene.bytes()?;
    let mut findings = Vec::new();
    if renamed > 0 {
        let message = format!("{renamed} names have control characters; they are written changed");
        findings.push(Finding::warning("fbx-renamed", message));
    }
    Ok(Written { bytes, findings })
}

/// What is written.
struct Scene<'w> {
    clip: &'w Clip,
    options: &'w ExportOptions,
    /// Of the clip.
    name: String,
    /// Of the joints.
    names: Vec<String>,
}

impl Scene<'_> {
    fn bytes(&self) -> Result<Vec<u8>, FormatError> {
        let animation = Animation::of(self)?;
        let mesh = Mesh::of(self)?;
        let ids = Ids { joints: self.clip.skeleton().len(), curve_nodes: animation.curve_nodes() };
        let mut document = Document::new()?;
        header::before(&mut document, self, &ids, &animation, &mesh)?;
        document.open("Objects", &[])?;
        skeleton::objects(&mut document, self, &ids)?;
        mesh.objects(&mut document, self, &ids)?;
        animation.objects(&mut document, &ids)?;
        document.close()?;
        document.open("Connections", &[])?;
        skeleton::connections(&mut document, self, &ids)?;
        mesh.connections(&mut document, &ids)?;
        animation.connections(&mut document, &ids)?;
        document.close()?;
        header::takes(&mut document, self, &animation)?;
        document.finish()
    }

    /// A place in the file's unit and axes.
    fn place(&self, place: Vec3, joint: usize) -> Result<DVec3, FormatError> {
        let place = self.options.up.file_from_clip(place.as_dvec3()) / self.options.metres_per_unit;
        if place.abs().max_element() <= LARGEST_NUMBER {
            return Ok(place);
        }
        let furthest = place.abs().max_element();
        let name = self.names.get(joint).map_or("", String::as_str);
        Err(FormatError::Write {
            what: format!(
                "joint `{}` is {furthest:e} units away, and numbers go up to 1e12",
                crate::finding::shown(name)
            ),
            hint: "write in a larger unit, or bring the motion nearer to the origin".into(),
        })
    }
}
