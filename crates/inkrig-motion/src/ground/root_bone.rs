//! A bone on the ground that carries the character, as game engines want it, and the way back.

use super::placement::{Parts, Placement};
use super::{Trajectory, TravelOptions, size_of};
use crate::{Clip, Joint, MotionError, Skeleton, TranslationTrack};
use glam::{DQuat, DVec3, Quat, Vec3};
use std::sync::Arc;

/// The name of a root bone that is put in; a number follows where it is taken.
pub const BONE_NAME: &str = "root";
/// Steps of a bone's height and tilt that count as none: metres in sizes of the character, and 1 - cos.
const LEVEL: f64 = 1e-4;

/// What became of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct BoneChange {
    /// The clip.
    pub clip: Clip,
    /// What was done to its skeleton.
    pub skeleton: SkeletonChange,
}

/// What was done to the joints of a skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SkeletonChange {
    /// Nothing; an index names the root bone that was there, if there was one.
    Kept(Option<usize>),
    /// A joint was put in before the one that had this index; it has it now.
    Inserted(usize),
    /// The joint of this index was taken out.
    Removed(usize),
}

/// Puts a root bone on the ground under the character, which carries its travel and heading without sway; the hips
/// keep the rest. World poses of all joints stay as they are.
///
/// - A skeleton whose hips hang alone below a still, upright root gets no new joint: that root becomes the bone.
/// - Otherwise a joint [`BONE_NAME`] is put in just above the travelling joint.
/// - A clip that has a root bone is left as it is.
///
/// The bone stands on [`Trajectory::ground`], is upright, and looks to +z where the character looks as in its rest
/// pose.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn add_root_bone(clip: &Clip, options: &TravelOptions) -> Result<BoneChange, MotionError> {
    if let Some(bone) = root_bone(clip) {
        return Ok(BoneChange { clip: clip.clone(), skeleton: SkeletonChange::Kept(Some(bone)) });
    }
    let trajectory = Trajectory::of(clip, options);
    let travel_joint = trajectory.joint;
    let ground: Vec<Placement> = (trajectory.path.iter().zip(&trajectory.headings))
        .map(|(place, heading)| Placement {
            rotation: DQuat::from_rotation_y(*heading),
            position: DVec3::new(place.x, trajectory.ground, place.y),
        })
        .collect();
    // Rounded as the bone will be, so that what hangs on it makes up for it.
    let hips: Vec<Placement> = (ground.iter().enumerate())
        .map(|(frame, bone)| bone.seen(Placement::world(clip, travel_joint, frame)))
        .collect();
    if let Some(bone) = still_root(clip, travel_joint) {
        let mut parts = Parts::of(clip);
        parts.place(bone, ground.into_iter());
        parts.place(travel_joint, hips.into_iter());
        return Ok(BoneChange { clip: parts.finish(clip)?, skeleton: SkeletonChange::Kept(Some(bone)) });
    }
    let parent = clip.skeleton().joints()[travel_joint].parent;
    let bone = (ground.into_iter().enumerate())
        .map(|(frame, place)| Placement::of_parent(clip, parent, frame).seen(place));
    let mut wider = Wider::of(clip, travel_joint)?;
    wider.parts.place(travel_joint, bone);
    wider.parts.place(travel_joint + 1, hips.into_iter());
    let clip = wider.parts.finish(&wider.clip)?;
    Ok(BoneChange { clip, skeleton: SkeletonChange::Inserted(travel_joint) })
}

/// Folds a root bone's motion into the joints that hang on it: the inverse of [`add_root_bone`]. World poses of all
/// other joints stay as they are. The bone is taken out of the skeleton when it is called [`BONE_NAME`] and carries
/// one joint; any other stands still in its rest pose from then on. A clip without a root bone is left as it is.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn fold_root_bone(clip: &Clip) -> Result<BoneChange, MotionError> {
    folded(clip, true)
}

/// As [`fold_root_bone`], but the bone stays in the skeleton whatever it is called and stands still: for files whose
/// skeleton must not change.
///
/// # Errors
/// As for [`fold_root_bone`].
pub fn empty_root_bone(clip: &Clip) -> Result<BoneChange, MotionError> {
    folded(clip, false)
}

fn folded(clip: &Clip, removable: bool) -> Result<BoneChange, MotionError> {
    let Some(bone) = root_bone(clip) else {
        return Ok(BoneChange { clip: clip.clone(), skeleton: SkeletonChange::Kept(None) });
    };
    let joints = clip.skeleton().joints();
    let parent = joints[bone].parent;
    let children: Vec<usize> =
        (0..joints.len()).filter(|&joint| joints[joint].parent == Some(bone)).collect();
    let removed = removable && children.len() == 1 && is_bone_name(&joints[bone].name);
    let rest = Placement {
        rotation: DQuat::IDENTITY,
        position: if removed { DVec3::ZERO } else { joints[bone].offset.as_dvec3() },
    };
    let mut parts = Parts::of(clip);
    for child in children {
        let places = (0..clip.frames()).map(|frame| {
            let own = Placement::local(clip, bone, frame).then(Placement::local(clip, child, frame));
            rest.seen(own)
        });
        parts.place(child, places);
    }
    if !removed {
        parts.place(bone, (0..clip.frames()).map(|_| rest));
        return Ok(BoneChange { clip: parts.finish(clip)?, skeleton: SkeletonChange::Kept(Some(bone)) });
    }
    let joints: Vec<Joint> = (joints.iter().enumerate())
        .filter(|(index, _)| *index != bone)
        .map(|(_, joint)| {
            let mut joint = joint.clone();
            if joint.parent == Some(bone) {
                joint.offset += clip.skeleton().joints()[bone].offset;
                joint.parent = parent;
            } else {
                joint.parent = joint.parent.map(|parent| parent - usize::from(parent > bone));
            }
            joint
        })
        .collect();
    let width = clip.skeleton().len();
    let rotations = (parts.rotations.into_iter().enumerate())
        .filter(|(index, _)| index % width != bone)
        .map(|(_, rotation)| rotation)
        .collect();
    let tracks = (parts.tracks.into_iter())
        .filter(|track| track.joint != bone)
        .map(|track| TranslationTrack { joint: track.joint - usize::from(track.joint > bone), ..track })
        .collect();
    let clip = Clip::new(Arc::new(Skeleton::new(joints)?), clip.frame_rate(), rotations, tracks)?;
    Ok(BoneChange { clip, skeleton: SkeletonChange::Removed(bone) })
}

/// The root bone of a clip, if there is one: the travelling joint, when it stays upright at one height, and the joint
/// with most below it of those that hang on it moves along too.
pub fn root_bone(clip: &Clip) -> Option<usize> {
    let bone = clip.travel_joint();
    let joints = clip.skeleton().joints();
    let mut below = vec![0_usize; joints.len()];
    for (index, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            below[parent] += below[index] + 1;
        }
    }
    let children = (0..joints.len()).filter(|&joint| joints[joint].parent == Some(bone));
    let hips = children.max_by_key(|&child| (below[child], std::cmp::Reverse(child)))?;
    clip.track(bone)?;
    clip.track(hips)?;
    let first = Placement::world(clip, bone, 0).position.y;
    let most = LEVEL * size_of(clip.skeleton());
    let level = |frame: usize| {
        let place = Placement::world(clip, bone, frame);
        (place.position.y - first).abs() < most && (place.rotation * DVec3::Y).y > 1.0 - LEVEL
    };
    (0..clip.frames()).all(level).then_some(bone)
}

/// A root that does nothing but stand upright above the travelling joint.
fn still_root(clip: &Clip, travel_joint: usize) -> Option<usize> {
    let joints = clip.skeleton().joints();
    let root = joints[travel_joint].parent?;
    let alone = joints.iter().filter(|joint| joint.parent == Some(root)).count() == 1;
    let first = Placement::local(clip, root, 0);
    let most = LEVEL * size_of(clip.skeleton());
    let still = |frame: usize| {
        let place = Placement::local(clip, root, frame);
        place.position.distance(first.position) < most
            && place.rotation.dot(first.rotation).abs() > 1.0 - LEVEL
            && (place.rotation * DVec3::Y).y > 1.0 - LEVEL
    };
    (alone && joints[root].parent.is_none() && (0..clip.frames()).all(still)).then_some(root)
}

fn is_bone_name(name: &str) -> bool {
    name.strip_prefix(BONE_NAME)
        .is_some_and(|rest| rest.is_empty() || rest.strip_prefix('_').is_some_and(is_number))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// A clip with one joint more.
struct Wider {
    clip: Clip,
    parts: Parts,
}

impl Wider {
    /// Puts a bone in above a joint; both are placed by the caller.
    fn of(clip: &Clip, at: usize) -> Result<Self, MotionError> {
        let old = clip.skeleton();
        let offset = old.joints()[at].offset;
        // The bone takes what places a root on the ground, so that the figure's size stays what it is.
        let on_ground = Vec3::new(offset.x, 0.0, offset.z);
        let under = if old.joints()[at].parent.is_none() { on_ground } else { Vec3::ZERO };
        let mut joints: Vec<Joint> = Vec::with_capacity(old.len() + 1);
        for (index, joint) in old.joints().iter().enumerate() {
            if index == at {
                joints.push(Joint::new(free_name(old), joint.parent, under));
                joints.push(Joint { parent: Some(at), offset: joint.offset - under, ..joint.clone() });
            } else {
                let parent = joint.parent.map(|parent| parent + usize::from(parent >= at));
                joints.push(Joint { parent, ..joint.clone() });
            }
        }
        let mut rotations = Vec::with_capacity(clip.frames() * joints.len());
        for frame in 0..clip.frames() {
            let (before, after) = clip.rotations(frame).split_at(at);
            rotations.extend_from_slice(before);
            rotations.push(Quat::IDENTITY);
            rotations.extend_from_slice(after);
        }
        let tracks = (clip.translations().iter())
            .map(|track| TranslationTrack {
                joint: track.joint + usize::from(track.joint >= at),
                values: track.values.clone(),
            })
            .collect();
        let clip = Clip::new(Arc::new(Skeleton::new(joints)?), clip.frame_rate(), rotations, tracks)?;
        Ok(Self { parts: Parts::of(&clip), clip })
    }
}

fn free_name(skeleton: &Skeleton) -> String {
    let taken = |name: &str| skeleton.joints().iter().any(|joint| joint.name.eq_ignore_ascii_case(name));
    let numbered = (2..).map(|number| format!("{BONE_NAME}_{number}"));
    let mut names = std::iter::once(BONE_NAME.to_string()).chain(numbered);
    // There are more numbers than joints.
    names.find(|name| !taken(name)).unwrap_or_else(|| BONE_NAME.to_string())
}
