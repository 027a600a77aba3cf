//! glTF 2.0: GLB and .gltf, with the humanoids of VRM and VRMA.

mod accessor;
mod bounded;
mod buffers;
mod clips;
mod container;
mod document;
mod figure;
mod forest;
mod humanoid;
mod licence;
mod pose;
mod track;
mod write;

pub use humanoid::{HUMAN_BONES, HumanBone};
pub use licence::gltf_licence;
pub(crate) use write::write_into_gltf;
pub use write::{write_glb, write_vrma};

use crate::{
    Evidence, FileSource, Finding, Format, FormatError, Import, ImportOptions, Limits, Original, SourceInfo,
    clip_choice,
    figure::{Figure, Stage, clip_from_file},
    limits::Together,
    timing::Timing,
};
use buffers::Buffers;
use clips::Channels;
use container::Container;
use document::Document;
use forest::Forest;
use inkrig_motion::{Clip, glam::DAffine3};
use pose::Player;
use track::Track;

/// Reads a glTF 2.0 file: GLB, .gltf, VRM or VRMA.
///
/// The skeleton is made of the joints of all skins, in VRM and VRMA also of the bones of the humanoid; bare leaves below
/// them are end sites. Its rest pose is that of the nodes. All clips are listed in [`Import::clips`], and the one that
/// [`ImportOptions::clip`] chooses is read, at the rate of its keys where they stand on one. A file without clips gives
/// its rest pose as one frame.
///
/// Bytes outside of the file are asked for by `files`, never opened here.
///
/// # Errors
/// [`FormatError::Read`] when the JSON cannot be parsed, [`FormatError::Part`] when a part of the file is not as it should
/// be or lies out of reach, [`FormatError::Limit`] when it asks for too much, [`FormatError::Options`] for an option out of
/// range or a clip that is not there.
pub fn read_gltf(
    bytes: &[u8],
    options: &ImportOptions,
    files: FileSource<'_>,
) -> Result<Import, FormatError> {
    read_gltf_with(bytes, options, files, None)
}

/// The same; all clips but the chosen one go to `others`, where somebody wants them.
pub(crate) fn read_gltf_with(
    bytes: &[u8],
    options: &ImportOptions,
    files: FileSource<'_>,
    others: Option<&mut Vec<Clip>>,
) -> Result<Import, FormatError> {
    options.check()?;
    options.limits.check_bytes(bytes)?;
    let container = container::open(bytes)?;
    let document = document::parse(container.json)?;
    let forest = Forest::of(&document)?;
    let mut findings = Vec::new();
    let figure = figure::figure(&document, &forest, &options.limits, &mut findings)?;
    let metres_per_unit = options.metres_per_unit.unwrap_or(1.0);
    let up = options.up.unwrap_or_default();
    let clip_from_file = clip_from_file(metres_per_unit, up);
    let stage = pose::stage(&figure, &forest, clip_from_file);
    let clips = clips::list(&document);
    let chosen = clip_choice::choose(&clips, options.clip.as_ref(), 0, &mut findings)?;
    let mut wanted: Vec<usize> = chosen.into_iter().collect();
    if others.is_some() {
        wanted.extend((0..clips.len()).filter(|index| Some(*index) != chosen));
    }
    let channels: Vec<_> =
        wanted.iter().filter_map(|&index| Channels::of(&document, index, &figure, &mut findings)).collect();
    let buffers = clips::buffers(&channels, &document, &container, options, files)?;
    let size = bytes.len().saturating_add(buffers.bytes());
    let parts = Parts {
        document: &document,
        buffers: &buffers,
        forest: &forest,
        clip_from_file,
        stage: &stage,
        size,
    };
    let mut channels = channels.iter();
    let clip = match channels.next() {
        Some(channels) => parts.clip(channels, options, &mut findings)?.0,
        None => parts.rest_pose(options, &mut findings)?,
    };
    if let Some(others) = others {
        let mut all = Together::of(options.limits.cells_for(size));
        for channels in channels {
            let (clip, keys) = parts.clip(channels, options, &mut findings)?;
            all.take(keys.saturating_add(clip.frames() * clip.skeleton().len()))?;
            others.push(clip);
        }
    }
    size_findings(&clip, &stage, &mut findings);
    let declared = |given: bool, evidence| if given { Evidence::Given } else { evidence };
    let source = SourceInfo {
        format: format(&document, &container),
        metres_per_unit,
        unit_evidence: declared(options.metres_per_unit.is_some(), Evidence::Declared),
        up,
        up_evidence: declared(options.up.is_some(), Evidence::Declared),
        channels: Vec::new(),
        frame_time: None,
        humanoid: human_bones(&document, &figure),
        original: Some(Original::new(bytes)),
    };
    Ok(Import { clip, source, clips, clip_index: chosen, findings })
}

/// What the parts of this module say about a part of the file.
fn damaged(
    code: &'static str,
    part: impl Into<String>,
    what: impl Into<String>,
    hint: impl Into<String>,
) -> FormatError {
    FormatError::Part { code, part: part.into(), what: what.into(), hint: hint.into() }
}

struct Parts<'p> {
    document: &'p Document,
    buffers: &'p Buffers<'p>,
    forest: &'p Forest,
    clip_from_file: DAffine3,
    stage: &'p Stage<'p>,
    /// Bytes of the file and of the buffers beside it.
    size: usize,
}

impl<'p> Parts<'p> {
    /// A clip, and how many keys it was made of.
    fn clip(
        &self,
        channels: &Channels<'_>,
        options: &ImportOptions,
        findings: &mut Vec<Finding>,
    ) -> Result<(Clip, usize), FormatError> {
        let (tracks, times) = channels.tracks(self.document, self.buffers, self.size)?;
        let (timing, finding) = Timing::of(&times, options.frame_rate);
        drop(times);
        findings.extend(finding);
        let frames = self.frames(timing, &options.limits)?;
        let keys = tracks.iter().map(Track::keys).sum();
        Ok((self.player(tracks, timing).clip(frames, findings)?, keys))
    }

    fn rest_pose(&self, options: &ImportOptions, findings: &mut Vec<Finding>) -> Result<Clip, FormatError> {
        let message = "the file has no clip; its rest pose is taken as one frame";
        findings.push(Finding::info("gltf-rest-pose", message.into()));
        let (timing, _) = Timing::of(&[0.0], options.frame_rate);
        self.player(Vec::new(), timing).clip(1, findings)
    }

    fn player<'t>(&self, tracks: Vec<Track<'t>>, timing: Timing) -> Player<'p, 'p, 't> {
        Player::new(self.stage, self.forest, self.clip_from_file, tracks, timing)
    }

    /// The number of frames, when they are not too many.
    fn frames(&self, timing: Timing, limits: &Limits) -> Result<usize, FormatError> {
        // Nodes above joints are work as well.
        let figure = self.stage.figure;
        let joints = figure.chain.len().max(figure.joints.len());
        let cells = timing.frames * joints as f64;
        // Keys that stay as they are take no bytes, so a cell may have fewer than in other formats; but a cell may
        // take 28 bytes here, with a translation.
        let limit = limits.cells.min(Limits::FREE_CELLS.saturating_add(self.size / 2));
        if cells <= limit as f64 {
            return Ok(timing.frames as usize);
        }
        Err(FormatError::Limit {
            what: format!("{} frames of {joints} nodes make {cells} rotations", timing.frames),
            limit,
            place: None,
            hint: "cut the motion into shorter ones, or read it at a lower rate with `--source-fps`".into(),
        })
    }
}

fn format(document: &Document, container: &Container<'_>) -> Format {
    let extensions = &document.extensions;
    if extensions.vrm_animation.is_some() {
        Format::Vrma
    } else if extensions.vrm0.is_some() || extensions.vrm1.is_some() {
        Format::Vrm
    } else if container.binary {
        Format::Glb
    } else {
        Format::Gltf
    }
}

fn human_bones(document: &Document, figure: &Figure) -> Vec<HumanBone> {
    let joint = |node: u32| figure.joints.iter().position(|joint| joint.node == node as usize);
    let bones = humanoid::nodes(document);
    bones.into_iter().filter_map(|(name, node)| Some(HumanBone { name, joint: joint(node)? })).collect()
}

fn size_findings(clip: &Clip, stage: &Stage<'_>, findings: &mut Vec<Finding>) {
    if stage.has_uneven_scale() {
        let message =
            "joints are scaled unevenly or mirrored; places are kept, rotations are the nearest ones";
        findings.push(Finding::warning("gltf-uneven-scale", message.into()));
    }
    let size = clip.skeleton().extent();
    if !(0.05..20.0).contains(&size) {
        let message =
            format!("the figure is {size:.4} m large, glTF being in metres; `--unit` sets another unit");
        findings.push(Finding::warning("gltf-size", message));
    }
}
