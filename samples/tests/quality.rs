//! What a viewer would see in the stored motions: pops, limbs that bend the wrong way, feet in the ground, and
//! whether there is small and large motion for a growing curve to choose from.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{
    Clip,
    glam::Vec3,
    kinematics::{Pose, Positions, positions},
    rotation::twist_angle,
};
use inkrig_samples::{find, motions};

fn clip(name: &str) -> Clip {
    read_bvh(find(name).unwrap().bytes, &ImportOptions::default()).unwrap().clip
}

fn joint(clip: &Clip, name: &str) -> usize {
    clip.skeleton().find(name).unwrap()
}

/// Place of a joint at every frame, metres.
fn track(positions: &Positions, joint: usize) -> Vec<Vec3> {
    (0..positions.frames()).map(|frame| positions.frame(frame)[joint]).collect()
}

/// Largest acceleration over its 99th percentile: a pop is one frame far above all others.
fn pop(track: &[Vec3]) -> f32 {
    let mut steps: Vec<f32> = track.windows(3).map(|t| (t[2] - 2.0 * t[1] + t[0]).length()).collect();
    steps.sort_unstable_by(f32::total_cmp);
    // Joints that hardly ever move are measured against a tenth of a millimetre a frame.
    steps[steps.len() - 1] / steps[(steps.len() - 1) * 99 / 100].max(1e-4)
}

#[test]
fn nothing_pops() {
    for sample in motions() {
        let clip = clip(sample.name);
        let places = positions(&clip);
        for (index, joint) in clip.skeleton().joints().iter().enumerate() {
            let size = pop(&track(&places, index));
            assert!(size < 1.7, "{} of {}: {size:.2} times the 99th percentile", joint.name, sample.name);
        }
        // The measure sees a jump of the hips by 5 cm from one frame to the next.
        let mut jumping = track(&places, 0);
        jumping.iter_mut().skip(100).for_each(|place| place.y += 0.05);
        assert!(pop(&jumping) > 1.7, "{}", sample.name);
    }
}

#[test]
fn joints_turn_smoothly() {
    // Degrees a frame that a joint turns at most, and how much this changes from frame to frame.
    for (name, fastest, change) in [("person", 12.0, 11.0), ("quadruped", 25.0, 23.5), ("snake", 15.0, 4.0)] {
        let clip = clip(name);
        for (index, joint) in clip.skeleton().joints().iter().enumerate() {
            let turns: Vec<Vec3> = (1..clip.frames())
                .map(|frame| {
                    let step = clip.rotations(frame - 1)[index].inverse() * clip.rotations(frame)[index];
                    let step = if step.w < 0.0 { -step } else { step };
                    step.to_scaled_axis() * 180.0 / std::f32::consts::PI
                })
                .collect();
            let largest = turns.iter().map(|turn| turn.length()).fold(0.0, f32::max);
            assert!(largest < fastest, "{} of {name}: {largest:.1} degrees a frame", joint.name);
            let largest = turns.windows(2).map(|t| (t[1] - t[0]).length()).fold(0.0, f32::max);
            assert!(largest < change, "{} of {name}: changes by {largest:.1} degrees a frame", joint.name);
        }
    }
}

#[test]
fn nothing_sinks_into_the_ground_and_something_stands_on_it() {
    for sample in motions() {
        let places = positions(&clip(sample.name));
        let lowest: Vec<f32> = (0..places.frames())
            .map(|frame| places.frame(frame).iter().map(|place| place.y).fold(f32::MAX, f32::min))
            .collect();
        let deepest = lowest.iter().copied().fold(f32::MAX, f32::min);
        assert!(deepest > -0.005, "{} sinks by {:.1} mm", sample.name, -1000.0 * deepest);
        let grounded = lowest.iter().filter(|&&height| height < 0.04).count();
        let share = grounded as f32 / lowest.len() as f32;
        assert!(share > 0.85, "{} stands in {share:.2} of all frames", sample.name);
    }
}

/// When a joint stands over the given frames: within 3 mm of its lowest place and slower than 5 cm/s.
fn standing(places: &Positions, joint: usize, frames: std::ops::Range<usize>) -> Vec<bool> {
    let track = track(places, joint);
    let lowest = track.iter().map(|place| place.y).fold(f32::MAX, f32::min);
    let still = |frame: usize| (track[frame + 1] - track[frame]).length() * 30.0 < 0.05;
    frames.map(|f| track[f].y < lowest + 0.003 && (still(f) || still(f - 1))).collect()
}

#[test]
fn the_footfalls_of_trot_and_gallop_are_seen_in_the_file() {
    let clip = clip("quadruped");
    let places = positions(&clip);
    let paws = ["LeftToe", "RightToe", "LeftFingers", "RightFingers"].map(|name| joint(&clip, name));
    let trot = paws.map(|paw| standing(&places, paw, 115..160));
    let apart = (0..45).filter(|&f| trot[0][f] != trot[3][f] || trot[1][f] != trot[2][f]).count();
    assert!(apart <= 2, "diagonal paws differ in {apart} of 45 frames of the trot");
    let gallop = paws.map(|paw| standing(&places, paw, 190..255));
    let landings: Vec<usize> = (1..65)
        .flat_map(|f| (0..4).map(move |paw| (f, paw)))
        .filter(|&(f, paw)| gallop[paw][f] && !gallop[paw][f - 1])
        .map(|(_, paw)| paw)
        .skip_while(|&paw| paw != 0)
        .collect();
    assert!(landings.len() >= 12, "{landings:?}");
    assert!(landings.iter().enumerate().all(|(beat, &paw)| paw == beat % 4), "{landings:?}");
    let flight = (0..65).filter(|&f| gallop.iter().all(|paw| !paw[f])).count();
    assert!((13..35).contains(&flight), "no paw stands in {flight} of 65 frames of the gallop");
}

/// Angle from bone `a..b` to bone `b..c` about the body's left axis, radians; and how straight the limb is, 0..=1.
fn bend(pose: &Pose, [a, b, c]: [usize; 3], hips: usize) -> (f32, f32) {
    let upper = pose.positions[b] - pose.positions[a];
    let lower = pose.positions[c] - pose.positions[b];
    let left = pose.rotations[hips] * Vec3::X;
    let sign = upper.cross(lower).dot(left).signum();
    let reach = (upper + lower).length() / (upper.length() + lower.length());
    (sign * upper.angle_between(lower), reach)
}

#[test]
fn limbs_bend_the_right_way_and_are_never_torn_straight() {
    let limbs = [
        ("person", ["UpLeg", "Leg", "Foot"], 1.0, 0.0..2.6),
        ("quadruped", ["UpLeg", "Leg", "Foot"], 1.0, 0.1..2.4),
        ("quadruped", ["Leg", "Foot", "Toe"], -1.0, 0.1..2.4),
        ("quadruped", ["Arm", "ForeArm", "Hand"], -1.0, 0.1..2.4),
    ];
    for (name, parts, sign, range) in limbs {
        let clip = clip(name);
        let hips = joint(&clip, "Hips");
        let mut pose = Pose::new(clip.skeleton());
        for side in ["Left", "Right"] {
            let joints = parts.map(|part| joint(&clip, &format!("{side}{part}")));
            for frame in 0..clip.frames() {
                pose.set(&clip, frame);
                let (angle, reach) = bend(&pose, joints, hips);
                let at = format!("{side}{} of {name} at frame {frame}", parts[1]);
                assert!(range.contains(&(sign * angle)), "{at}: {:.2} rad", sign * angle);
                assert!(reach < 0.999, "{at}: stretched to {reach:.4}");
            }
        }
    }
}

#[test]
fn elbows_bend_forward_only() {
    let clip = clip("person");
    for (name, sign) in [("LeftForeArm", -1.0), ("RightForeArm", 1.0)] {
        let index = joint(&clip, name);
        for frame in 0..clip.frames() {
            let bend = sign * twist_angle(clip.rotations(frame)[index], Vec3::Y);
            assert!((0.05..2.6).contains(&bend), "{name} at frame {frame}: {bend:.2} rad");
        }
    }
}

/// Mean squared speed of all joints against the hips in each second, (m/s)^2.
fn energy(places: &Positions, joints: &[usize], seconds: std::ops::Range<f32>) -> f32 {
    let frames = (seconds.start * 30.0) as usize..(seconds.end * 30.0) as usize;
    let count = (frames.len() * joints.len()) as f32;
    let moved =
        |frame: usize, joint: usize| (places.frame(frame + 1)[joint] - places.frame(frame)[joint]) * 30.0;
    frames.flat_map(|f| joints.iter().map(move |&j| moved(f, j).length_squared())).sum::<f32>() / count
}

#[test]
fn the_person_has_small_and_large_motion() {
    let clip = clip("person");
    let places = positions(&clip).relative_to(0);
    let all: Vec<usize> = (0..places.joints()).collect();
    let mut energies: Vec<f32> =
        (0..23).map(|second| energy(&places, &all, second as f32..second as f32 + 1.0)).collect();
    energies.sort_unstable_by(f32::total_cmp);
    let ratio = energies[energies.len() * 9 / 10] / energies[energies.len() / 10];
    println!("energy of seconds: the 90th percentile is {ratio:.1} times the 10th");
    assert!(ratio > 3.0, "the 90th percentile is {ratio:.1} times the 10th: {energies:?}");
    // Within each kind of motion as well: first steps and largest steps, first and last waves, first and last sways.
    for (what, names, small, large) in [
        ("steps", ["LeftFoot", "RightFoot"], 0.7..1.7, 3.0..4.0),
        ("waves", ["RightHand", "RightForeArm"], 8.4..9.1, 11.0..11.7),
        ("crouches", ["Chest", "Head"], 12.4..13.9, 13.9..15.9),
        ("sways", ["LeftHand", "RightHand"], 16.0..17.0, 19.0..20.0),
    ] {
        let joints = names.map(|name| joint(&clip, name));
        let ratio = energy(&places, &joints, large) / energy(&places, &joints, small);
        println!("the largest {what} have {ratio:.1} times the energy of the smallest");
        assert!(ratio > 1.8, "the largest {what} have {ratio:.2} times the energy of the smallest");
    }
}

#[test]
fn the_snake_does_not_slide_sideways() {
    let clip = clip("snake");
    let places = positions(&clip);
    let (mut along, mut across) = (0.0_f32, 0.0_f32);
    for name in ["Tail1", "Tail4", "Tail8", "Spine2", "Spine4"] {
        let index = joint(&clip, name);
        for frame in 1..clip.frames() - 1 {
            let here = places.frame(frame);
            let parent = clip.skeleton().joints()[index].parent.unwrap();
            let along_body = here[index + 1] - here[parent];
            let forward = if name.starts_with("Tail") { -along_body } else { along_body };
            let moved = (places.frame(frame + 1)[index] - places.frame(frame - 1)[index]) * 15.0;
            let straight = moved.dot(forward.normalize());
            along += straight * straight;
            across += moved.length_squared() - straight * straight;
        }
    }
    let share = (across / along).sqrt();
    println!("{share:.3} of the snake's speed goes sideways");
    assert!(share < 0.1, "{share:.3} of the speed goes sideways");
}
