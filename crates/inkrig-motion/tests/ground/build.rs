//! Characters and motions for the tests.

use inkrig_motion::glam::{EulerRot, Quat, Vec3};
use inkrig_motion::kinematics::{self, Pose};
use inkrig_motion::{Clip, Joint, Skeleton, TranslationTrack};
use proptest::prelude::*;
use std::sync::Arc;

/// Any forest of joints with smooth random motion: the first root travels, or a joint below a still root does.
pub(crate) fn clips() -> impl Strategy<Value = Clip> {
    let joints = prop::collection::vec((any::<prop::sample::Index>(), 0..8_u8, -1.0_f32..1.0), 2..9);
    (joints, 8..60_usize, any::<bool>(), 0.0_f32..0.2, -0.4_f32..0.4).prop_map(
        |(seeds, frames, below_still_root, step, turn)| {
            let joints: Vec<Joint> = (seeds.iter().enumerate())
                .map(|(index, (parent, kind, length))| {
                    // A few joints are further roots.
                    let parent = (index > 0 && (*kind > 0 || index == 1)).then(|| parent.index(index));
                    let parent = if index == 1 && below_still_root { Some(0) } else { parent };
                    Joint::new(format!("joint{index}"), parent, Vec3::new(*length, 0.4, 0.2 * length))
                })
                .collect();
            let travels = usize::from(below_still_root);
            let skeleton = Arc::new(Skeleton::new(joints).unwrap());
            let mut rotations = Vec::new();
            let mut places = Vec::new();
            let mut place = Vec3::new(0.3, 1.0, -0.5);
            for frame in 0..frames {
                let time = frame as f32 / 30.0;
                for joint in 0..skeleton.len() {
                    let wave = (3.0 * time + joint as f32).sin();
                    let heading = if joint == travels { 2.0 * turn * time } else { 0.0 };
                    let still = joint < travels;
                    let bend = if still { 0.3 } else { 0.4 * wave };
                    rotations.push(Quat::from_rotation_y(heading) * Quat::from_rotation_x(bend));
                }
                let ahead = Quat::from_rotation_y(2.0 * turn * time) * Vec3::Z;
                place += step * ahead + Vec3::new(0.01 * (9.0 * time).sin(), 0.0, 0.0);
                places.push(place + Vec3::Y * 0.05 * (12.0 * time).sin());
            }
            let tracks = vec![TranslationTrack { joint: travels, values: places }];
            Clip::new(skeleton, 30.0, rotations, tracks).unwrap()
        },
    )
}

/// A walker of `frames` frames at 30 a second: 1.2 m/s, two legs that swing, sway across and bob. `curve` is the turn
/// to the left in radians a second.
pub(crate) fn walker(frames: usize, curve: f32) -> Clip {
    let skeleton = Skeleton::new(vec![
        Joint::new("hips", None, Vec3::new(0.0, 0.9, 0.0)),
        Joint::new("spine", Some(0), Vec3::Y * 0.5),
        Joint::end("spine_end", 1, Vec3::Y * 0.3),
        Joint::new("left", Some(0), Vec3::new(0.1, -0.05, 0.0)),
        Joint::end("left_end", 3, Vec3::Y * -0.85),
        Joint::new("right", Some(0), Vec3::new(-0.1, -0.05, 0.0)),
        Joint::end("right_end", 5, Vec3::Y * -0.85),
    ]);
    let (mut rotations, mut values) = (Vec::new(), Vec::new());
    let mut place = Vec3::ZERO;
    for frame in 0..frames {
        let time = frame as f32 / 30.0;
        let heading = Quat::from_rotation_y(curve * time);
        let phase = std::f32::consts::TAU * time;
        place += heading * Vec3::Z * (1.2 / 30.0);
        let sway = heading * Vec3::X * 0.03 * phase.sin();
        values.push(place + sway + Vec3::Y * (0.9 + 0.02 * (2.0 * phase).cos()));
        let leg = |side: f32| Quat::from_rotation_x(0.4 * side * phase.cos());
        let id = Quat::IDENTITY;
        rotations.extend([
            heading,
            Quat::from_rotation_y(0.1 * phase.sin()),
            id,
            leg(1.0),
            id,
            leg(-1.0),
            id,
        ]);
    }
    let tracks = vec![TranslationTrack { joint: 0, values }];
    Clip::new(Arc::new(skeleton.unwrap()), 30.0, rotations, tracks).unwrap()
}

/// The largest distance between joints of the same name, metres; `joint` is where the second clip has one more.
pub(crate) fn apart(a: &Clip, b: &Clip, joint: Option<usize>) -> f32 {
    let (a, b) = (kinematics::positions(a), kinematics::positions(b));
    let mut largest = 0.0_f32;
    for frame in 0..a.frames() {
        let others = b.frame(frame).iter().enumerate().filter(|(index, _)| Some(*index) != joint);
        for (one, (_, other)) in a.frame(frame).iter().zip(others) {
            largest = largest.max(one.distance(*other));
        }
    }
    largest
}

/// The largest angle between world rotations of the same joints, radians.
pub(crate) fn turned_apart(a: &Clip, b: &Clip) -> f32 {
    let (mut one, mut other) = (Pose::new(a.skeleton()), Pose::new(b.skeleton()));
    let mut largest = 0.0_f32;
    for frame in 0..a.frames() {
        one.set(a, frame);
        other.set(b, frame);
        for (p, q) in one.rotations.iter().zip(&other.rotations) {
            // The angle of a small difference from its vector part: from the scalar part it would be lost in rounding.
            largest = largest.max(2.0 * (p.inverse() * *q).xyz().length());
        }
    }
    largest
}

/// The turn about the vertical of a rotation that has no other.
pub(crate) fn yaw(rotation: Quat) -> f32 {
    rotation.to_euler(EulerRot::YXZ).0
}
