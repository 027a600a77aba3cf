//! The FBX reader: the file is parsed and its curves are evaluated by `ufbx`, within bounds.

mod axes;
mod bones;
mod budget;
mod open;
mod pose;
mod rest;
mod span;
mod stacks;

use crate::{
    Evidence, Finding, Format, FormatError, Import, ImportOptions, SourceInfo, clip_choice, figure::Stage,
    finding::shown, limits::Together,
};
use axes::Axes;
use bones::Bones;
use budget::Budget;
use inkrig_motion::Clip;
use pose::Player;
use span::Span;
use stacks::Stack;
use ufbx::Scene;

/// Exporters reckon the pose of the mesh and that of a frame in f32, each in its own way: what they differ by that much is
/// no movement, as a part of the figure's size.
const BOUND_STILL: f64 = 5e-5;

/// Reads an FBX file, binary or text, of any version from 3000 on.
///
/// The skeleton is made of the bones and of what skins hang on; in a file without bones, of the nodes that are moved. Its
/// rest pose is that in which meshes were bound, where there is one; else that of the nodes. What stands between or above bones, pivots and rotations before rotations are folded
/// in. All animation stacks are listed in [`Import::clips`], and the one that [`ImportOptions::clip`] chooses is sampled
/// at the file's frame rate; without a choice it is the first that moves a joint. A file without stacks gives its rest
/// pose as one frame.
///
/// Nothing outside of the bytes is opened, whatever the file names.
///
/// # Errors
/// [`FormatError::Part`] when the file is no FBX or damaged, or has no skeleton, [`FormatError::Limit`] when it asks for too
/// much, [`FormatError::Options`] for an option out of range or a clip that is not there.
pub fn read_fbx(bytes: &[u8], options: &ImportOptions) -> Result<Import, FormatError> {
    read_fbx_with(bytes, options, None)
}

/// The same; all clips but the chosen one go to `others`, where somebody wants them.
pub(crate) fn read_fbx_with(
    bytes: &[u8],
    options: &ImportOptions,
    others: Option<&mut Vec<Clip>>,
) -> Result<Import, FormatError> {
    options.check()?;
    options.limits.check_bytes(bytes)?;
    let mut budget = Budget::of(bytes.len());
    let scene = open::open(bytes, &budget)?;
    budget.take_scene(&scene);
    let mut findings = oddities(&scene);
    let bones = Bones::of(&scene);
    let figure = bones.figure(&scene, &options.limits, &mut findings)?;
    pose::check_rest(&bones, &figure)?;
    let axes = Axes::of(&scene, options, &mut findings);
    let (rest, bound) = rest::rest(&scene, &bones, &figure, axes.origin(), &mut findings);
    let stage = Stage::new(&figure, rest);
    let stage = if bound { stage.with_still(BOUND_STILL) } else { stage };
    let stacks: Vec<Stack<'_>> = scene.anim_stacks.iter().map(|stack| Stack::of(stack, &bones)).collect();
    let clips = stacks::list(&stacks);
    let usual = stacks.iter().position(|stack| stack.moves(&figure)).unwrap_or(0);
    let chosen = clip_choice::choose(&clips, options.clip.as_ref(), usual, &mut findings)?;
    let read = |stack: &Stack<'_>, findings: &mut Vec<Finding>| {
        let span = Span::of(&scene, stack, &bones, options, findings);
        let frames = budget.frames(&span, stack, &figure, &options.limits)?;
        Player::new(&bones, &stage, &axes, stack, span).clip(frames, findings)
    };
    let clip = match chosen.and_then(|index| stacks.get(index)) {
        Some(stack) => read(stack, &mut findings)?,
        None => {
            let message = "the file has no clip; its rest pose is taken as one frame";
            findings.push(Finding::info("fbx-rest-pose", message.into()));
            rest_pose(&stage, options)?
        }
    };
    if let Some(others) = others {
        let mut all = Together::of(budget.cells(&options.limits));
        for (_, stack) in stacks.iter().enumerate().filter(|(index, _)| Some(*index) != chosen) {
            let clip = read(stack, &mut findings)?;
            all.take(clip.frames() * clip.skeleton().len())?;
            others.push(clip);
        }
    }
    size_findings(&clip, &stage, &axes, &mut findings);
    let source = SourceInfo {
        format: Format::Fbx,
        metres_per_unit: axes.metres_per_unit,
        unit_evidence: axes.unit_evidence,
        up: axes.up,
        up_evidence: axes.up_evidence,
        channels: Vec::new(),
        frame_time: None,
        humanoid: Vec::new(),
        original: None,
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

/// What `ufbx` says of a file that it could read all the same, the first few.
fn oddities(scene: &Scene) -> Vec<Finding> {
    let warnings = scene.metadata.warnings.iter().take(4);
    let finding = |warning: &ufbx::Warning| {
        let message = format!("the file is odd: {} ({} times)", shown(&warning.description), warning.count);
        Finding::warning("fbx-odd", message)
    };
    warnings.map(finding).collect()
}

fn rest_pose(stage: &Stage<'_>, options: &ImportOptions) -> Result<Clip, FormatError> {
    stage.clip(1, options.frame_rate.unwrap_or(30.0), &mut |_, placed| {
        placed.copy_from_slice(&stage.rest);
        Ok(())
    })
}

fn size_findings(clip: &Clip, stage: &Stage<'_>, axes: &Axes, findings: &mut Vec<Finding>) {
    if stage.has_uneven_scale() {
        let message =
            "joints are scaled unevenly or mirrored; places are kept, rotations are the nearest ones";
        findings.push(Finding::warning("fbx-uneven-scale", message.into()));
    }
    let size = clip.skeleton().extent();
    if !(0.05..20.0).contains(&size) {
        let unit = axes.metres_per_unit;
        let message = match axes.unit_evidence {
            Evidence::Given => format!("the figure is {size:.4} m large, a unit being {unit} m"),
            _ => format!(
                "the figure is {size:.4} m large, a unit of the file being {unit} m; `--unit` sets another"
            ),
        };
        findings.push(Finding::warning("fbx-size", message));
    }
}
