//! Retargeting between two bodies made here: one in a T-pose, one twice as large in an A-pose with other names.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::kinematics::Pose;
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use inkrig_motion::rig::{Humanoid, Part, Side};
use inkrig_motion::{Clip, Joint, Skeleton, TranslationTrack, kinematics};
use std::sync::Arc;

/// Names of hips, spine, head, and for one side: collar, arm, elbow, hand, thigh, shin, foot, toes.
type Names = [&'static str; 11];

const ONE: Names = [
    "Hips",
    "Spine",
    "Head",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
];
const OTHER: Names = [
    "pelvis",
    "spine_01",
    "head",
    "clavicle_l",
    "upperarm_l",
    "lowerarm_l",
    "hand_l",
    "thigh_l",
    "calf_l",
    "foot_l",
    "ball_l",
];

fn body(names: Names, size: f32, arm: Vec3) -> Arc<Skeleton> {
    let mut joints = vec![
        Joint::new(names[0], None, Vec3::ZERO),
        Joint::new(names[1], Some(0), size * Vec3::new(0.0, 0.2, 0.0)),
        Joint::new(names[2], Some(1), size * Vec3::new(0.0, 0.4, 0.0)),
    ];
    for side in [1.0, -1.0] {
        let flip = |v: Vec3| size * Vec3::new(side * v.x, v.y, v.z);
        let name = |index: usize| {
            let name: &str = names[index];
            if side > 0.0 { name.to_string() } else { name.replace("Left", "Right").replace("_l", "_r") }
        };
        let first = joints.len();
        let chain = [
            (Some(1), Vec3::new(0.05, 0.3, 0.0)),
            (None, Vec3::new(0.12, 0.0, 0.0)),
            (None, 0.28 * arm),
            (None, 0.25 * arm),
            (Some(0), Vec3::new(0.1, 0.0, 0.0)),
            (None, Vec3::new(0.0, -0.45, 0.0)),
            (None, Vec3::new(0.0, -0.4, 0.0)),
            (None, Vec3::new(0.0, -0.08, 0.15)),
        ];
        for (index, (parent, offset)) in chain.into_iter().enumerate() {
            let parent = parent.unwrap_or(first + index - 1);
            joints.push(Joint::new(name(3 + index), Some(parent), flip(offset)));
        }
    }
    Arc::new(Skeleton::new(joints).unwrap())
}

/// Somebody who walks on the spot and swings arms.
fn motion(skeleton: &Arc<Skeleton>) -> Clip {
    let frames = 40;
    let mut rotations = Vec::new();
    for frame in 0..frames {
        let t = frame as f32 * 0.2;
        for joint in skeleton.joints() {
            let side = if joint.name.contains("Right") { 1.0 } else { -1.0 };
            let swing = side * t.sin();
            rotations.push(match joint.name.trim_start_matches("Left").trim_start_matches("Right") {
                "Arm" => Quat::from_rotation_z(side * 1.2) * Quat::from_rotation_x(0.5 * swing),
                "ForeArm" => Quat::from_rotation_y(0.6 * side),
                "UpLeg" => Quat::from_rotation_x(0.5 * swing - 0.2),
                "Leg" => Quat::from_rotation_x(0.5),
                "Hips" => Quat::from_rotation_y(0.1 * t),
                _ => Quat::IDENTITY,
            });
        }
    }
    let values = (0..frames).map(|frame| Vec3::new(0.02 * frame as f32, 0.9, 0.0)).collect();
    Clip::new(Arc::clone(skeleton), 30.0, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap()
}

#[test]
fn ones_own_body_changes_nothing() {
    let skeleton = body(ONE, 1.0, Vec3::X);
    let source = motion(&skeleton);
    let options = RetargetOptions { keep_feet: false, ..RetargetOptions::default() };
    let moved = retarget(&source, &skeleton, &options).unwrap();
    assert!((moved.scale - 1.0).abs() < 1e-5);
    for frame in 0..source.frames() {
        for (a, b) in source.rotations(frame).iter().zip(moved.clip.rotations(frame)) {
            assert!(a.angle_between(*b) < 2e-3, "frame {frame}");
        }
    }
}

#[test]
fn limbs_point_alike_on_a_body_of_other_size_rest_pose_and_names() {
    let (from, onto) = (body(ONE, 1.0, Vec3::X), body(OTHER, 2.0, Vec3::new(0.6, -0.8, 0.0)));
    let source = motion(&from);
    let options = RetargetOptions { keep_feet: false, ..RetargetOptions::default() };
    let moved = retarget(&source, &onto, &options).unwrap();
    assert!((moved.scale - 2.0).abs() < 1e-4);
    let (a, b) = (kinematics::positions(&source), kinematics::positions(&moved.clip));
    let bodies = (Humanoid::find(&from).unwrap(), Humanoid::find(&onto).unwrap());
    for frame in 0..source.frames() {
        for (begin, end) in [
            (Part::UpperArm, Part::LowerArm),
            (Part::LowerArm, Part::Hand),
            (Part::UpperLeg, Part::LowerLeg),
            (Part::LowerLeg, Part::Foot),
        ] {
            for side in Side::BOTH {
                let bone = |places: &[Vec3], body: &Humanoid| {
                    places[body.joint(end, side).unwrap()] - places[body.joint(begin, side).unwrap()]
                };
                let (own, other) = (bone(a.frame(frame), &bodies.0), bone(b.frame(frame), &bodies.1));
                assert!(own.angle_between(other) < 2e-3, "{begin:?} {side:?} at frame {frame}");
                assert!((other.length() / own.length() - 2.0).abs() < 1e-3);
            }
        }
    }
    let travelled = |positions: &kinematics::Positions| positions.frame(39)[0] - positions.frame(0)[0];
    assert!((travelled(&b) - 2.0 * travelled(&a)).length() < 0.02);
}

#[test]
fn legs_without_length_need_a_scale() {
    let source = motion(&body(ONE, 1.0, Vec3::X));
    let flat = body(OTHER, 0.0, Vec3::X);
    let error = retarget(&source, &flat, &RetargetOptions::default()).unwrap_err();
    assert!(error.to_string().contains("give a scale"), "{error}");
    let options = RetargetOptions { scale: Some(1.0), ..RetargetOptions::default() };
    assert!(retarget(&source, &flat, &options).is_ok());
    for scale in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        let options = RetargetOptions { scale: Some(scale), ..RetargetOptions::default() };
        let error = retarget(&source, &flat, &options).unwrap_err();
        assert!(error.to_string().contains("give a number above 0"), "{error}");
    }
}

#[test]
fn a_figure_whose_bones_lie_anywhere_at_rest_stands_in_its_own_clip() {
    let (from, onto) = (body(ONE, 1.0, Vec3::X), body(OTHER, 1.0, Vec3::X));
    let source = motion(&from);
    // All offsets of one joint after another turned away, and turned back by the pose.
    let lying = Quat::from_rotation_x(1.2);
    let joints = onto.joints().iter().map(|joint| Joint { offset: lying * joint.offset, ..joint.clone() });
    let lying_body = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let mut rotations = vec![Quat::IDENTITY; lying_body.len()];
    rotations[0] = lying.conjugate();
    let up = TranslationTrack { joint: 0, values: vec![Vec3::Y] };
    let standing = Clip::new(lying_body.clone(), 30.0, rotations, vec![up]).unwrap();
    assert!(standing_pose(&source).is_none());
    let options = RetargetOptions { stance: standing_pose(&standing), ..RetargetOptions::default() };
    assert!(options.stance.is_some());
    let moved = retarget(&source, &lying_body, &options).unwrap();
    let certificate = Certificate::of(&source, &moved);
    assert!((moved.scale - 1.0).abs() < 1e-3, "{}", moved.scale);
    assert_eq!(certificate.broken(&CertificateLimits::default()), []);
    let without = retarget(&source, &lying_body, &RetargetOptions::default()).unwrap();
    let broken = Certificate::of(&source, &without).broken(&CertificateLimits::default());
    assert!(!broken.is_empty(), "the certificate sees that this went wrong");
    let foreign = Skeleton::new(vec![Joint::new("one", None, Vec3::ZERO)]).unwrap();
    let options = RetargetOptions { stance: Some(Pose::new(&foreign)), ..RetargetOptions::default() };
    let error = retarget(&source, &lying_body, &options).unwrap_err();
    assert!(error.to_string().contains("has 1 joints"), "{error}");
}

#[test]
fn a_forearms_twist_is_shared_along_it() {
    let from = body(ONE, 1.0, Vec3::X);
    let onto = {
        let plain = body(OTHER, 1.0, Vec3::X);
        let mut joints = plain.joints().to_vec();
        for side in ["l", "r"] {
            let find = |name: &str| plain.find(&format!("{name}_{side}")).unwrap();
            let (forearm, hand, upper) = (find("lowerarm"), find("hand"), find("upperarm"));
            let half = 0.5 * plain.joints()[hand].offset;
            joints.push(Joint::new(format!("lowerarm_twist_01_{side}"), Some(forearm), half));
            let half = 0.5 * plain.joints()[forearm].offset;
            joints.push(Joint::new(format!("upperarm_twist_01_{side}"), Some(upper), half));
        }
        Arc::new(Skeleton::new(joints).unwrap())
    };
    // The left hand turns over about the forearm, further and further.
    let frames = 20;
    let angle = |frame: usize| 0.15 * frame as f32;
    let hand = from.find("LeftHand").unwrap();
    let mut rotations = vec![Quat::IDENTITY; frames * from.len()];
    for frame in 0..frames {
        rotations[frame * from.len() + hand] = Quat::from_rotation_x(angle(frame));
    }
    let source = Clip::new(from, 30.0, rotations, vec![]).unwrap();
    let moved = retarget(&source, &onto, &RetargetOptions::default()).unwrap();
    let find = |name: &str| onto.find(name).unwrap();
    assert_eq!(moved.twists.len(), 4);
    let certificate = Certificate::of(&source, &moved);
    assert_eq!(certificate.unmapped, Vec::<String>::new());
    let mut pose = Pose::new(&onto);
    for frame in 0..frames {
        pose.set(&moved.clip, frame);
        let turned = |joint: &str| {
            let rotation = pose.rotations[find("lowerarm_l")].conjugate() * pose.rotations[find(joint)];
            2.0 * rotation.x.atan2(rotation.w)
        };
        assert!((turned("hand_l") - angle(frame)).abs() < 0.01, "frame {frame}");
        // Half way along the forearm half of it, past half a turn too.
        assert!((turned("lowerarm_twist_01_l") - 0.5 * angle(frame)).abs() < 0.02, "frame {frame}");
        assert!(turned("lowerarm_twist_01_r").abs() < 0.01);
    }
}

/// A crane of joints in a row, which bends as time goes on.
fn crane(name: &str, bones: &[f32], frames: usize) -> Clip {
    let joint = |(index, length): (usize, &f32)| {
        let parent = index.checked_sub(1);
        Joint::new(format!("{name}{index}"), parent, if index == 0 { Vec3::ZERO } else { *length * Vec3::Y })
    };
    let skeleton = Arc::new(Skeleton::new(bones.iter().enumerate().map(joint).collect()).unwrap());
    let rotations = (0..frames).flat_map(|frame| {
        let bend = 0.02 * frame as f32;
        (0..bones.len()).map(move |joint| Quat::from_rotation_z(bend * (joint as f32 - 1.0)))
    });
    Clip::new(skeleton.clone(), 30.0, rotations.collect(), vec![]).unwrap()
}

#[test]
fn a_map_joins_what_nobody_knows() {
    let (source, target) = (crane("s", &[0.0, 1.0, 1.0, 1.0], 30), crane("t", &[0.0, 0.5, 2.0, 1.0, 1.0], 1));
    let options = |map: Vec<(usize, usize)>| RetargetOptions { map: Some(map), ..RetargetOptions::default() };
    let error = retarget(&source, target.skeleton(), &RetargetOptions::default()).unwrap_err();
    assert!(error.to_string().contains("give a map"), "{error}");
    // The third joint of the longer one has no counterpart.
    let map = vec![(0, 0), (1, 1), (2, 3), (3, 4)];
    let moved = retarget(&source, target.skeleton(), &options(map)).unwrap();
    let certificate = Certificate::of(&source, &moved);
    assert_eq!(certificate.unmapped, ["t2"]);
    assert!((certificate.scale - 1.5).abs() < 1e-4);
    assert!(
        certificate.direction.count > 0 && certificate.direction.max < 0.1,
        "{:?}",
        certificate.direction
    );
    for (map, said) in [
        (vec![], "no pair"),
        (vec![(0, 9)], "not there"),
        (vec![(9, 0)], "not there"),
        (vec![(0, 1), (1, 1)], "follow two"),
    ] {
        let error = retarget(&source, target.skeleton(), &options(map)).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}
