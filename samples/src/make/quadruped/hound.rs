//! The body of the hound: its skeleton, and its legs from trunk to paw.

use super::{
    super::{
        figure::{Pose, Rig},
        limb_ik::{hang, relax, sink, two_bone},
    },
    paws::Paw,
};
use inkrig_motion::glam::{DQuat, DVec3};

/// Height of the hips' joint when standing, metres.
pub(crate) const HIP_HEIGHT: f64 = 0.79;
/// Height of the chest's joint when standing, metres.
pub(crate) const SHOULDER_HEIGHT: f64 = 0.79;
/// From hips to chest, metres.
pub(crate) const TRUNK: f64 = 0.5;
/// Height of a paw's joint when it stands, metres.
pub(crate) const PAW_HEIGHT: f64 = 0.03;
/// From a paw's joint to the tips of its toes, metres.
pub(crate) const TOES: f64 = 0.075;
/// From the hips' joint to the left hind leg, and from the chest's joint to the left shoulder blade; metres.
pub(crate) const HIND: DVec3 = DVec3::new(0.09, -0.03, -0.05);
pub(crate) const FORE: DVec3 = DVec3::new(0.07, 0.05, 0.05);
/// The tail's joints.
pub(crate) const TAIL: [&str; 5] = ["Tail", "Tail1", "Tail2", "Tail3", "Tail4"];

const FEMUR: f64 = 0.29;
const TIBIA: f64 = 0.31;
const METATARSUS: f64 = 0.21;
const BLADE: f64 = 0.2;
const HUMERUS: f64 = 0.222;
const RADIUS: f64 = 0.312;
const METACARPUS: f64 = 0.15;
/// How far a standing hind leg stretches, of its full length.
const STRETCH: f64 = 0.97;
/// The same between shoulder and wrist: an elbow that is nearly straight would turn fast for little way.
const ELBOW: f64 = 0.93;
/// How far the hind and the fore legs reach from their carriers in the air before they give way, metres.
pub(crate) const RELAXED: [f64; 2] = [0.67, 0.73];
/// How far the elbow stretches in the air, of its full length.
const LOOSE: f64 = 0.84;
const SIDES: [&str; 2] = ["Left", "Right"];

/// 32 joints and 8 tips, 1.7 m from nose to tail, facing +z, every leg straight down: the legs' own angles come from
/// the motion.
pub(crate) fn rig() -> Rig {
    let mut rig = Rig::default();
    rig.joint("Hips", "", [0.0, HIP_HEIGHT, 0.0]);
    rig.joint("Spine", "Hips", [0.0, 0.01, 0.16]);
    rig.joint("Spine1", "Spine", [0.0, 0.01, 0.17]);
    rig.joint("Chest", "Spine1", [0.0, -0.02, TRUNK - 0.33]);
    rig.joint("Neck", "Chest", [0.0, 0.07, 0.13]);
    rig.joint("Neck1", "Neck", [0.0, 0.13, 0.13]);
    rig.joint("Head", "Neck1", [0.0, 0.12, 0.12]);
    rig.end("Head", [0.0, -0.07, 0.21]);
    for (side, sign) in SIDES.into_iter().zip([1.0, -1.0]) {
        let ear = format!("{side}Ear");
        rig.joint(&ear, "Head", [0.045 * sign, 0.05, -0.01]);
        rig.end(&ear, [0.03 * sign, 0.04, -0.06]);
    }
    for (side, sign) in SIDES.into_iter().zip([1.0, -1.0]) {
        let name = |part: &str| format!("{side}{part}");
        rig.joint(&name("Shoulder"), "Chest", [FORE.x * sign, FORE.y, FORE.z]);
        rig.joint(&name("Arm"), &name("Shoulder"), [0.02 * sign, -BLADE, 0.0]);
        rig.joint(&name("ForeArm"), &name("Arm"), [0.0, -HUMERUS, 0.0]);
        rig.joint(&name("Hand"), &name("ForeArm"), [0.0, -RADIUS, 0.0]);
        rig.joint(&name("Fingers"), &name("Hand"), [0.0, -METACARPUS, 0.0]);
        rig.end(&name("Fingers"), [0.0, 0.005 - PAW_HEIGHT, 0.07]);
    }
    for (side, sign) in SIDES.into_iter().zip([1.0, -1.0]) {
        let name = |part: &str| format!("{side}{part}");
        rig.joint(&name("UpLeg"), "Hips", [HIND.x * sign, HIND.y, HIND.z]);
        rig.joint(&name("Leg"), &name("UpLeg"), [0.0, -FEMUR, 0.0]);
        rig.joint(&name("Foot"), &name("Leg"), [0.0, -TIBIA, 0.0]);
        rig.joint(&name("Toe"), &name("Foot"), [0.0, -METATARSUS, 0.0]);
        rig.end(&name("Toe"), [0.0, 0.005 - PAW_HEIGHT, TOES]);
    }
    let mut parent = "Hips";
    for name in TAIL {
        let offset = if name == TAIL[0] { [0.0, 0.03, -0.13] } else { [0.0, -0.04, -0.115] };
        rig.joint(name, parent, offset);
        parent = name;
    }
    rig.end(parent, [0.0, -0.04, -0.115]);
    rig
}

/// Lays a leg (left hind, right hind, left fore, right fore) from the trunk to its paw. In a bow (0..=1) the pasterns
/// of the fore legs lie down. Returns how far the trunk must sink there, metres, for the leg not to be stretched.
pub(crate) fn leg(pose: &mut Pose<'_>, leg: usize, paw: &Paw, bow: f64) -> f64 {
    let names = if leg < 2 {
        ["UpLeg", "Leg", "Foot", "Toe"].as_slice()
    } else {
        ["Shoulder", "Arm", "ForeArm", "Hand", "Fingers"].as_slice()
    };
    let joints: Vec<usize> =
        names.iter().filter_map(|part| pose.rig().find(&format!("{}{part}", SIDES[leg % 2]))).collect();
    match joints[..] {
        [femur, tibia, foot, toe] => hind(pose, [femur, tibia, foot, toe], paw),
        [blade, humerus, radius, hand, fingers] => {
            fore(pose, [blade, humerus, radius, hand, fingers], paw, bow)
        }
        _ => 0.0,
    }
}

/// Place of the joint that carries a leg, metres: the hip, or the top of the shoulder blade.
pub(crate) fn carrier(pose: &Pose<'_>, leg: usize) -> DVec3 {
    let part = if leg < 2 { "UpLeg" } else { "Shoulder" };
    pose.rig().find(&format!("{}{part}", SIDES[leg % 2])).map_or(pose.root, |joint| pose.world(joint).0)
}

/// Thigh and metatarsus stay parallel, as tendons keep them in running animals: that makes two bones of three.
fn hind(pose: &mut Pose<'_>, [femur, tibia, foot, toe]: [usize; 4], paw: &Paw) -> f64 {
    let forward = paw.forward();
    let hip = pose.world(femur).0;
    let limb = two_bone(hip, paw.place, (FEMUR + METATARSUS, TIBIA), forward);
    pose.set_world(femur, limb.upper);
    pose.set_world(tibia, limb.lower);
    pose.set_world(foot, limb.upper);
    // In the air the toes hang from the metatarsus and turn with it.
    let along = limb.upper_along.dot(forward).atan2(-limb.upper_along.y);
    pose.set_world(toe, paw.rotation(0.5 + 0.6 * (0.35 - along)));
    sink(hip, paw.place, STRETCH * (FEMUR + METATARSUS + TIBIA))
}

fn fore(
    pose: &mut Pose<'_>,
    [blade, humerus, radius, hand, fingers]: [usize; 5],
    paw: &Paw,
    bow: f64,
) -> f64 {
    let forward = paw.forward();
    let side = DVec3::Y.cross(forward);
    pose.local[blade] = DQuat::IDENTITY;
    let (top, chest) = pose.world(blade);
    let reach = paw.place - top;
    // How far the leg swings forward, radians from the vertical.
    let swung = reach.dot(forward).atan2(-reach.y);
    let chest_forward = chest * DVec3::Z;
    let lean = 0.52 + 0.7 * swung;
    let down = chest * DVec3::NEG_Y;
    pose.set_world(blade, hang((down * lean.cos() + chest_forward * lean.sin()).normalize(), side));
    // The pastern leans with the leg while it stands and folds back in the air.
    let tilt = 0.75 * swung + 0.1 - 0.66 * paw.fold + 0.5 * bow;
    let pastern = (DVec3::NEG_Y * tilt.cos() + forward * tilt.sin()).normalize();
    let shoulder = pose.world(humerus).0;
    let wrist = relax(shoulder, paw.place - pastern * METACARPUS, HUMERUS + RADIUS, LOOSE, paw.air);
    let limb = two_bone(shoulder, wrist, (HUMERUS, RADIUS), -forward);
    // Elbows point backward: the hinge is the same, bent the other way.
    let half_turn = DQuat::from_rotation_y(std::f64::consts::PI);
    pose.set_world(humerus, limb.upper * half_turn);
    pose.set_world(radius, limb.lower * half_turn);
    pose.set_world(hand, hang(pastern, side));
    pose.set_world(fingers, paw.rotation(0.3 - 0.8 * tilt));
    sink(shoulder, wrist, ELBOW * (HUMERUS + RADIUS))
}
