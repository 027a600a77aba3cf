//! A small person that walks, turns and waves: made here, so free to use.

use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{Quat, Vec3},
};
use std::{f32::consts::TAU, sync::Arc};

const JOINTS: [(&str, Option<usize>, [f32; 3]); 24] = [
    ("Hips", None, [0.0, 0.92, 0.0]),
    ("Spine", Some(0), [0.0, 0.12, 0.0]),
    ("Chest", Some(1), [0.0, 0.18, 0.0]),
    ("Neck", Some(2), [0.0, 0.22, 0.0]),
    ("Head", Some(3), [0.0, 0.08, 0.02]),
    ("Head_end", Some(4), [0.0, 0.16, 0.0]),
    ("LeftShoulder", Some(2), [0.05, 0.16, 0.0]),
    ("LeftArm", Some(6), [0.13, 0.0, 0.0]),
    ("LeftForeArm", Some(7), [0.0, -0.28, 0.0]),
    ("LeftHand", Some(8), [0.0, -0.26, 0.0]),
    ("LeftHand_end", Some(9), [0.0, -0.14, 0.0]),
    ("RightShoulder", Some(2), [-0.05, 0.16, 0.0]),
    ("RightArm", Some(11), [-0.13, 0.0, 0.0]),
    ("RightForeArm", Some(12), [0.0, -0.28, 0.0]),
    ("RightHand", Some(13), [0.0, -0.26, 0.0]),
    ("RightHand_end", Some(14), [0.0, -0.14, 0.0]),
    ("LeftUpLeg", Some(0), [0.09, -0.03, 0.0]),
    ("LeftLeg", Some(16), [0.0, -0.42, 0.0]),
    ("LeftFoot", Some(17), [0.0, -0.41, 0.0]),
    ("LeftFoot_end", Some(18), [0.0, -0.05, 0.17]),
    ("RightUpLeg", Some(0), [-0.09, -0.03, 0.0]),
    ("RightLeg", Some(20), [0.0, -0.42, 0.0]),
    ("RightFoot", Some(21), [0.0, -0.41, 0.0]),
    ("RightFoot_end", Some(22), [0.0, -0.05, 0.17]),
];

/// A walk on a winding path with a wave of the left hand, `frames` long at 30 frames a second. The names come from
/// `rename`, given the plain one.
pub(crate) fn walk_named(frames: usize, rename: impl Fn(&str) -> String) -> Clip {
    let joints = JOINTS.iter().map(|&(name, parent, offset)| Joint {
        name: rename(name),
        parent,
        offset: Vec3::from_array(offset),
        end_site: name.ends_with("_end"),
    });
    let skeleton = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let (mut rotations, mut places) = (Vec::new(), Vec::new());
    let mut place = Vec3::ZERO;
    for frame in 0..frames {
        let time = frame as f32 / 30.0;
        let heading = 1.3 * (time * 0.9).sin();
        place += Quat::from_rotation_y(heading) * Vec3::Z * (1.25 / 30.0);
        rotations.extend(pose(time, heading));
        places.push(place + Vec3::Y * (0.9 + 0.02 * (TAU * 2.0 * time).cos()));
    }
    Clip::new(skeleton, 30.0, rotations, vec![TranslationTrack { joint: 0, values: places }]).unwrap()
}

/// [`walk_named`] with plain names.
pub(crate) fn walk(frames: usize) -> Clip {
    walk_named(frames, str::to_owned)
}

fn pose(time: f32, heading: f32) -> Vec<Quat> {
    let phase = TAU * time;
    let mut pose = vec![Quat::IDENTITY; JOINTS.len()];
    pose[0] = Quat::from_rotation_y(heading + 0.1 * phase.sin());
    pose[2] = Quat::from_rotation_y(-0.2 * phase.sin()) * Quat::from_rotation_x(0.06);
    for (leg, arm, side, phase) in [(16, 7, 1.0, phase), (20, 12, -1.0, phase + TAU / 2.0)] {
        pose[leg] = Quat::from_rotation_x(-0.5 * phase.sin());
        pose[leg + 1] = Quat::from_rotation_x(0.55 - 0.5 * (phase + 0.9).cos());
        pose[leg + 2] = Quat::from_rotation_x(0.1 * phase.sin() - 0.1);
        pose[arm] = Quat::from_rotation_z(0.12 * side) * Quat::from_rotation_x(0.5 * phase.sin());
        pose[arm + 1] = Quat::from_rotation_x(-0.45 - 0.2 * phase.sin());
    }
    let wave = (1.0 - ((time - 3.0) / 1.2).powi(2)).clamp(0.0, 1.0);
    let raised = Quat::from_rotation_z(2.3) * Quat::from_rotation_x(0.2);
    pose[7] = pose[7].slerp(raised, wave);
    pose[8] = pose[8].slerp(Quat::from_rotation_z(0.5 + 0.5 * (time * 9.0).sin()), wave);
    pose
}
