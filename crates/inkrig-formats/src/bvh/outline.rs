//! What a BVH of a clip consists of: the order of its joints and the channels of each.

use super::ByAxis;
use crate::euler::EulerSolver;
use crate::{Axis, Channel, ExportOptions, Finding, finding::shown};
use inkrig_motion::{Clip, Skeleton, glam::Vec3};

/// A rotation may be missed by this much before a joint is given more channels, radians.
const MISSED: f64 = 1e-4;

/// The joints of a clip as a BVH lists them.
pub(super) struct Outline<'c> {
    pub(super) steps: Vec<Step>,
    /// Channels of each joint; end sites have none.
    pub(super) channels: Vec<Vec<Channel>>,
    /// The translation track of each joint.
    pub(super) tracks: Vec<Option<&'c [Vec3]>>,
    pub(super) findings: Vec<Finding>,
}

/// One brace of the hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    OpenJoint(usize),
    OpenEndSite(usize),
    Close,
}

impl<'c> Outline<'c> {
    pub(super) fn of(clip: &'c Clip, options: &ExportOptions) -> Self {
        let skeleton = clip.skeleton();
        let mut tracks = vec![None; skeleton.len()];
        for track in clip.translations() {
            if let Some(slot) = tracks.get_mut(track.joint) {
                *slot = Some(track.values.as_slice());
            }
        }
        let steps = steps(skeleton, &tracks);
        let (channels, mut findings) = channels(clip, options, &steps, &tracks);
        let opened = steps.iter().filter_map(|step| step.joint());
        if !opened.eq(0..skeleton.len()) {
            let message = "joints are written depth first, so their order changes";
            findings.push(Finding::info("bvh-joint-order", message.into()));
        }
        Self { steps, channels, tracks, findings }
    }

    /// The joints that have columns, in the order of their columns.
    pub(super) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().filter_map(|step| match step {
            Step::OpenJoint(joint) => Some(*joint),
            Step::OpenEndSite(_) | Step::Close => None,
        })
    }
}

impl Step {
    fn joint(self) -> Option<usize> {
        match self {
            Self::OpenJoint(joint) | Self::OpenEndSite(joint) => Some(joint),
            Self::Close => None,
        }
    }
}

/// Depth first, without recursion: skeletons may be thousands of joints deep.
fn steps(skeleton: &Skeleton, tracks: &[Option<&[Vec3]>]) -> Vec<Step> {
    let mut children = vec![Vec::new(); skeleton.len()];
    for (index, joint) in skeleton.joints().iter().enumerate() {
        if let Some(list) = joint.parent.and_then(|parent| children.get_mut(parent)) {
            list.push(index);
        }
    }
    let open = |index: usize| {
        let leaf = children.get(index).is_some_and(Vec::is_empty);
        let still = tracks.get(index).is_some_and(Option::is_none);
        let end_site =
            skeleton.joints().get(index).is_some_and(|joint| joint.end_site && joint.parent.is_some());
        if leaf && still && end_site { Step::OpenEndSite(index) } else { Step::OpenJoint(index) }
    };
    let mut steps = Vec::with_capacity(2 * skeleton.len());
    let mut ahead: Vec<Step> = skeleton.roots().map(open).collect();
    ahead.reverse();
    while let Some(step) = ahead.pop() {
        steps.push(step);
        let Some(joint) = step.joint() else { continue };
        ahead.push(Step::Close);
        ahead.extend(children.get(joint).into_iter().flatten().rev().map(|&child| open(child)));
    }
    steps
}

/// The channels of each joint, as the options want them and more where the motion needs more.
fn channels(
    clip: &Clip,
    options: &ExportOptions,
    steps: &[Step],
    tracks: &[Option<&[Vec3]>],
) -> (Vec<Vec<Channel>>, Vec<Finding>) {
    let joints = clip.skeleton().joints();
    let given = Some(&options.channels).filter(|channels| channels.len() == joints.len());
    let mut findings = Vec::new();
    if given.is_none() && !options.channels.is_empty() {
        let message = "the channels to write belong to another skeleton; the usual ones are written";
        findings.push(Finding::info("bvh-other-channels", message.into()));
    }
    let mut all = vec![Vec::new(); joints.len()];
    let mut widened = Vec::new();
    for joint in
        steps.iter().filter_map(|step| if let Step::OpenJoint(joint) = step { Some(*joint) } else { None })
    {
        let (Some(slot), Some(data)) = (all.get_mut(joint), joints.get(joint)) else { continue };
        let track = tracks.get(joint).copied().flatten();
        *slot = match given.and_then(|channels| channels.get(joint)) {
            None => default_channels(data.parent.is_none() || track.is_some()),
            Some(channels) => {
                let mut channels = channels.clone();
                let more_positions = add_positions(&mut channels, track, data.offset, options);
                let more_rotations = add_rotations(&mut channels, clip, joint, options);
                if more_positions || more_rotations {
                    widened.push(data.name.as_str());
                }
                channels
            }
        };
    }
    if all.iter().all(Vec::is_empty)
        && let Some(slot) = clip.skeleton().roots().next().and_then(|root| all.get_mut(root))
    {
        *slot = default_channels(true);
    }
    if let Some((first, others)) = widened.split_first() {
        let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
        let message = format!(
            "joint `{}`{more} moves in ways that its channels cannot hold; channels are added",
            shown(first)
        );
        findings.push(Finding::warning("bvh-channels-added", message));
    }
    (all, findings)
}

fn default_channels(positions: bool) -> Vec<Channel> {
    let places = Axis::ALL.into_iter().filter(|_| positions).map(Channel::Position);
    places.chain(Axis::ALL.into_iter().rev().map(Channel::Rotation)).collect()
}

fn add_positions(
    channels: &mut Vec<Channel>,
    track: Option<&[Vec3]>,
    offset: Vec3,
    options: &ExportOptions,
) -> bool {
    let Some(values) = track else { return false };
    let rest = options.up.file_from_clip(offset.as_dvec3());
    let needed = |axis: Axis| {
        let off = |value: &Vec3| {
            let value = options.up.file_from_clip(value.as_dvec3());
            // The rounding of f32 is no motion.
            (value.get(axis) - rest.get(axis)).abs() > 1e-6 * rest.get(axis).abs()
        };
        values.iter().any(off)
    };
    let missing: Vec<Channel> = (Axis::ALL.into_iter())
        .filter(|&axis| !channels.contains(&Channel::Position(axis)) && needed(axis))
        .map(Channel::Position)
        .collect();
    let is_position = |channel: &Channel| matches!(channel, Channel::Position(_));
    let place = channels.iter().rposition(is_position).map_or(0, |last| last + 1);
    let added = !missing.is_empty();
    channels.splice(place..place, missing);
    added
}

fn add_rotations(channels: &mut Vec<Channel>, clip: &Clip, joint: usize, options: &ExportOptions) -> bool {
    let mut solver = EulerSolver::new(channels);
    if solver.is_full() {
        return false;
    }
    let rotations = (0..clip.frames()).filter_map(|frame| clip.rotations(frame).get(joint));
    let mut misses = rotations.map(|rotation| {
        let in_file = options.up.file_from_clip_rotation(rotation.as_dquat());
        solver.next(in_file)
    });
    if misses.all(|miss| miss <= MISSED) {
        return false;
    }
    for channel in Axis::ALL.into_iter().rev().map(Channel::Rotation) {
        if !channels.contains(&channel) {
            channels.push(channel);
        }
    }
    true
}
