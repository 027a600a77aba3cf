//! What the HumanML3D form promises, on a motion made here.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{self, Blocks, JOINTS, Joints, PARENTS, RAW_DIRECTIONS, WIDTH};

/// A figure that walks along a bend for three seconds, swinging arms and legs.
fn walk() -> Vec<Joints> {
    let frame = |t: f32| -> Joints {
        let heading = Quat::from_rotation_y(0.8 * t);
        let place = Vec3::new((0.8 * t).sin(), 0.9 + 0.02 * (9.0 * t).sin(), 1.0 - (0.8 * t).cos());
        let mut joints = [place; JOINTS];
        for joint in 1..JOINTS {
            let side = if joint % 2 == 0 { 1.0 } else { -1.0 };
            let swing = match joint {
                4 | 5 | 7 | 8 | 18..=21 => 0.6 * side * (6.0 * t).sin(),
                _ => 0.05 * side * (3.0 * t).cos(),
            };
            let bone = Quat::from_rotation_x(swing) * RAW_DIRECTIONS[joint] * 0.2;
            joints[joint] = joints[PARENTS[joint]] + heading * bone;
        }
        joints
    };
    (0..60).map(|index| frame(index as f32 / 20.0)).collect()
}

fn apart(a: &[Joints], b: &[Joints]) -> f32 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn positions_come_back_by_places_and_by_rotations() {
    let placed = humanml::ground(&walk());
    let features = humanml::features(&placed).unwrap();
    assert_eq!((features.frames(), features.width()), (59, WIDTH));
    let back = humanml::recover_positions(&features).unwrap();
    assert!(apart(&back, &placed[..59]) < 1e-5, "{}", apart(&back, &placed[..59]));
    let body = humanml::bone_lengths(&placed[0]);
    let back = humanml::recover_bones(&features, &body).unwrap();
    assert!(apart(&back, &placed[..59]) < 1e-5, "{}", apart(&back, &placed[..59]));
}

#[test]
fn where_and_which_way_a_motion_begins_does_not_matter() {
    let walk = walk();
    let turned = Quat::from_rotation_y(2.0);
    let moved: Vec<Joints> =
        walk.iter().map(|joints| joints.map(|place| turned * place + Vec3::new(3.0, -1.0, 7.0))).collect();
    assert!(apart(&humanml::ground(&walk), &humanml::ground(&moved)) < 1e-5);
    let first = humanml::ground(&moved)[0];
    assert!(first[0].x.abs() < 1e-6 && first[0].z.abs() < 1e-6);
    let lowest = humanml::ground(&moved).iter().flatten().map(|place| place.y).fold(f32::INFINITY, f32::min);
    assert!(lowest.abs() < 1e-6);
}

#[test]
fn the_mirrored_motion_turns_the_other_way() {
    let right = humanml::features(&humanml::ground(&walk())).unwrap();
    let left = humanml::features(&humanml::ground(&humanml::mirror(&walk()))).unwrap();
    for frame in 0..right.frames() {
        assert!((right.row(frame)[Blocks::YAW] + left.row(frame)[Blocks::YAW]).abs() < 1e-5);
        assert!((right.row(frame)[2] - left.row(frame)[2]).abs() < 1e-5);
        // Contacts of the left foot become those of the right.
        assert_eq!(right.row(frame)[259..261], left.row(frame)[261..263]);
    }
}

#[test]
fn what_cannot_be_a_motion_is_refused() {
    assert!(humanml::features(&walk()[..1]).is_err());
    let mut bad = walk();
    bad[3][5].x = f32::NAN;
    assert!(humanml::features(&bad).unwrap_err().to_string().contains("joint 5, frame 3"));
    let narrow = inkrig_motion::Features::new(vec![0.0; 10], 10).unwrap();
    assert!(humanml::recover_positions(&narrow).unwrap_err().to_string().contains("expected 263"));
    assert!(humanml::uniform(&[], &[Vec3::ZERO; JOINTS]).is_empty() && humanml::ground(&[]).is_empty());
}

#[test]
fn a_clip_of_positions_has_the_bodys_lengths_and_bends_its_knees_as_hinges() {
    let walk = walk();
    let body = humanml::bone_lengths(&walk[0]);
    let skeleton = std::sync::Arc::new(humanml::skeleton(&body, &walk).unwrap());
    let clip = humanml::to_clip(&walk, &skeleton, humanml::FRAME_RATE).unwrap();
    let positions = inkrig_motion::kinematics::positions(&clip);
    for (frame, wanted) in walk.iter().enumerate() {
        let places = positions.frame(frame);
        assert!(places[0].distance(wanted[0]) < 1e-5);
        for joint in 1..JOINTS {
            let length = places[joint].distance(places[PARENTS[joint]]);
            assert!((length - body[joint].length()).abs() < 1e-5, "joint {joint} at frame {frame}");
        }
        // Shins point where they should, whatever the hips do.
        let shin = (places[7] - places[4]).angle_between(wanted[7] - wanted[4]);
        assert!(shin < 0.35, "the shin is {shin} radians off at frame {frame}");
    }
    assert!(humanml::to_clip(&[], &skeleton, 20.0).is_err());
}
