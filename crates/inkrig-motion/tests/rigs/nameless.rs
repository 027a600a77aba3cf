//! Bodies by their build alone.

use super::build::Build;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::rig::{Body, Humanoid, NoBody, Quadruped, Side};
use inkrig_motion::{Joint, Skeleton};

/// A person with fingers, collar bones, eyes and toes; arms point to `arm`, the left one.
fn person(arm: Vec3) -> (Skeleton, Humanoid) {
    let mut build = Build::default();
    let mut number = 17;
    let mut add = |build: &mut Build, parent: Option<usize>, place: Vec3| {
        number += 1;
        build.add(format!("bone_{number}"), parent, place)
    };
    let at = Vec3::new;
    let root = add(&mut build, None, Vec3::ZERO);
    let hips = add(&mut build, Some(root), at(0.0, 0.95, 0.0));
    let spine = add(&mut build, Some(hips), at(0.0, 1.1, 0.0));
    let chest = add(&mut build, Some(spine), at(0.0, 1.3, 0.0));
    let mut legs = Vec::new();
    let mut arms = Vec::new();
    for side in [1.0, -1.0] {
        let flip = Vec3::new(side, 1.0, 1.0);
        let thigh = add(&mut build, Some(hips), flip * at(0.1, 0.9, 0.0));
        let shin = add(&mut build, Some(thigh), flip * at(0.1, 0.5, 0.01));
        let foot = add(&mut build, Some(shin), flip * at(0.1, 0.08, -0.02));
        let toes = add(&mut build, Some(foot), flip * at(0.1, 0.02, 0.12));
        add(&mut build, Some(toes), flip * at(0.1, 0.02, 0.2));
        legs.push((thigh, shin, foot, toes));
        let collar = add(&mut build, Some(chest), flip * at(0.03, 1.4, 0.0));
        let shoulder = at(0.18, 1.42, 0.0);
        let upper = add(&mut build, Some(collar), flip * shoulder);
        let lower = add(&mut build, Some(upper), flip * (shoulder + 0.27 * arm));
        let hand = add(&mut build, Some(lower), flip * (shoulder + 0.51 * arm));
        for finger in 0..5 {
            let spread = at(0.0, 0.0, 0.02 * (finger as f32 - 2.0));
            let one = add(&mut build, Some(hand), flip * (shoulder + 0.6 * arm + spread));
            add(&mut build, Some(one), flip * (shoulder + 0.65 * arm + spread));
        }
        arms.push((collar, upper, lower, hand));
    }
    let neck = add(&mut build, Some(chest), at(0.0, 1.5, 0.0));
    let head = add(&mut build, Some(neck), at(0.0, 1.6, 0.0));
    add(&mut build, Some(head), at(0.03, 1.7, 0.1));
    add(&mut build, Some(head), at(-0.03, 1.7, 0.1));
    add(&mut build, Some(head), at(0.0, 1.8, 0.0));
    let skeleton = build.skeleton();
    let arm = |(clavicle, upper, lower, hand): (usize, usize, usize, usize)| {
        Some(inkrig_motion::rig::Arm { clavicle: Some(clavicle), upper, lower, hand: Some(hand) })
    };
    let leg = |(upper, lower, foot, toes): (usize, usize, usize, usize)| inkrig_motion::rig::Leg {
        upper,
        lower,
        foot: Some(foot),
        toes: Some(toes),
    };
    let body = Humanoid {
        hips,
        spine: vec![spine, chest],
        neck: vec![neck],
        head: Some(head),
        arms: [arm(arms[0]), arm(arms[1])],
        legs: [leg(legs[0]), leg(legs[1])],
    };
    (skeleton, body)
}

#[test]
fn a_person_is_found_by_build() {
    for arm in [Vec3::X, Vec3::new(0.5, -0.85, 0.1).normalize(), Vec3::new(0.2, -0.9, 0.3).normalize()] {
        let (skeleton, body) = person(arm);
        assert_eq!(Humanoid::find(&skeleton), Ok(body), "arms along {arm}");
    }
}

#[test]
fn who_looks_the_other_way_has_his_left_on_the_other_side() {
    let (skeleton, body) = person(Vec3::X);
    let turn = Quat::from_rotation_y(std::f32::consts::PI);
    let turned = skeleton.joints().iter().map(|joint| Joint { offset: turn * joint.offset, ..joint.clone() });
    assert_eq!(Humanoid::find(&Skeleton::new(turned.collect()).unwrap()), Ok(body));
}

/// A dog of chains; `name` says what joints are called: the part, the side.
fn dog(name: &dyn Fn(&str, Option<Side>) -> String) -> Skeleton {
    let mut build = Build::default();
    let at = Vec3::new;
    let hips = build.add(name("Hips", None), None, at(0.0, 0.6, -0.4));
    let spine = build.add(name("Spine", None), Some(hips), at(0.0, 0.62, -0.1));
    let chest = build.add(name("Chest", None), Some(spine), at(0.0, 0.6, 0.25));
    let neck = build.add(name("Neck", None), Some(chest), at(0.0, 0.7, 0.4));
    let head = build.add(name("Head", None), Some(neck), at(0.0, 0.8, 0.5));
    build.add(name("Nose", None), Some(head), at(0.0, 0.75, 0.7));
    for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
        let mut at_joint = hips;
        for (part, place) in [
            ("UpLeg", at(0.1, 0.55, -0.42)),
            ("Leg", at(0.1, 0.35, -0.35)),
            ("Foot", at(0.1, 0.18, -0.48)),
            ("Toe", at(0.1, 0.03, -0.42)),
            ("ToeEnd", at(0.1, 0.01, -0.36)),
        ] {
            at_joint = build.add(name(part, Some(side)), Some(at_joint), place * Vec3::new(sign, 1.0, 1.0));
        }
        let mut at_joint = chest;
        for (part, place) in [
            ("Shoulder", at(0.08, 0.62, 0.22)),
            ("Arm", at(0.1, 0.5, 0.32)),
            ("ForeArm", at(0.1, 0.35, 0.22)),
            ("Hand", at(0.1, 0.12, 0.24)),
            ("Fingers", at(0.1, 0.02, 0.25)),
            ("FingersEnd", at(0.1, 0.01, 0.31)),
        ] {
            at_joint = build.add(name(part, Some(side)), Some(at_joint), place * Vec3::new(sign, 1.0, 1.0));
        }
    }
    let mut at_joint = hips;
    for index in 0..4 {
        let place = at(0.0, 0.6 - 0.05 * index as f32, -0.5 - 0.12 * index as f32);
        at_joint = build.add(name(&format!("Tail{index}"), None), Some(at_joint), place);
    }
    build.skeleton()
}

fn human_names(part: &str, side: Option<Side>) -> String {
    side.map_or(part.to_string(), |side| format!("{side:?}{part}"))
}

#[test]
fn a_dog_is_no_person_whatever_its_joints_are_called() {
    let number = std::cell::Cell::new(0);
    let nameless = |_: &str, _: Option<Side>| {
        number.set(number.get() + 1);
        format!("bone_{}", number.get())
    };
    let named = dog(&human_names);
    let found = Quadruped::find(&named).unwrap();
    assert_eq!(Humanoid::find(&named), Err(NoBody::FourLegs));
    assert_eq!(Body::find(&named), Ok(Body::Quadruped(found.clone())));
    let name = |joint: usize| named.joints()[joint].name.as_str();
    let names = |joints: &[usize]| joints.iter().map(|&joint| name(joint).to_string()).collect::<Vec<_>>();
    assert_eq!(name(found.hips), "Hips");
    assert_eq!(names(&found.spine), ["Spine", "Chest"]);
    assert_eq!((names(&found.neck), found.head.map(name)), (vec!["Neck".to_string()], Some("Head")));
    assert_eq!(names(&found.tail), ["Tail0", "Tail1", "Tail2", "Tail3"]);
    assert_eq!(names(&found.fore[0].girdle), ["LeftShoulder"]);
    assert_eq!(
        names(&found.fore[0].joints),
        ["LeftArm", "LeftForeArm", "LeftHand", "LeftFingers", "LeftFingersEnd"]
    );
    assert_eq!(
        names(&found.hind[1].joints),
        ["RightUpLeg", "RightLeg", "RightFoot", "RightToe", "RightToeEnd"]
    );
    assert_eq!(Quadruped::find(&dog(&nameless)), Ok(found), "by build alone");
}

#[test]
fn a_person_has_no_four_legs_and_a_table_is_nobody() {
    assert_eq!(Quadruped::find(&person(Vec3::X).0), Err(NoBody::NotFourLegs));
    let mut build = Build::default();
    let root = build.add("a", None, Vec3::ZERO);
    for index in 0..5 {
        build.add(format!("b{index}"), Some(root), Vec3::new(index as f32, 1.0, 0.0));
    }
    let error = Body::find(&build.skeleton()).unwrap_err();
    assert_eq!(error.to_string(), "no joint was found that is the UpperLeg (Left)");
}
