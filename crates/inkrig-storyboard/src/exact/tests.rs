#![allow(clippy::print_stdout, reason = "a test prints what it measures")]

use super::*;
use inkrig_motion::glam::Vec2;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::Camera;
use inkrig_motion::humanml::{bone_lengths, skeleton, to_clip};
use std::sync::Arc;

const PLACED: (Quat, Vec3) = (Quat::IDENTITY, Vec3::ZERO);

/// A person who stands with hanging arms and sways a little.
pub(super) fn standing(frames: usize) -> Clip {
    let pose: Joints = [
        [0.0, 0.93, 0.0],
        [0.09, 0.85, 0.0],
        [-0.09, 0.85, 0.0],
        [0.0, 1.05, 0.0],
        [0.1, 0.47, 0.03],
        [-0.1, 0.47, 0.03],
        [0.0, 1.18, 0.0],
        [0.1, 0.07, 0.0],
        [-0.1, 0.07, 0.0],
        [0.0, 1.25, 0.0],
        [0.12, 0.02, 0.13],
        [-0.12, 0.02, 0.13],
        [0.0, 1.45, 0.0],
        [0.08, 1.38, 0.0],
        [-0.08, 1.38, 0.0],
        [0.0, 1.55, 0.03],
        [0.18, 1.38, 0.0],
        [-0.18, 1.38, 0.0],
        [0.2, 1.12, 0.0],
        [-0.2, 1.12, 0.0],
        [0.2, 0.87, 0.05],
        [-0.2, 0.87, 0.05],
    ]
    .map(Vec3::from);
    let sway = |frame: usize| Vec3::X * 0.01 * (frame as f32 * 0.2).sin();
    let motion: Vec<Joints> = (0..frames)
        .map(|frame| {
            let mut own = pose;
            own.iter_mut().filter(|place| place.y > 0.6).for_each(|place| *place += sway(frame));
            own
        })
        .collect();
    let body = bone_lengths(&pose);
    to_clip(&motion, &Arc::new(skeleton(&body, &motion).unwrap()), 20.0).unwrap()
}

fn circle(clip: &Clip, joint: usize, radius: f32) -> Vec<Goal> {
    let camera = Camera::default();
    let motion = joints_of(clip);
    (0..motion.len())
        .map(|frame| {
            let angle = frame as f32 / motion.len() as f32 * std::f32::consts::TAU;
            let by = radius * Vec2::new(angle.sin(), 1.0 - angle.cos());
            let at = camera.project(motion[0][joint]) + by;
            Goal::placed(frame, joint, at, &camera, PLACED, Source::Way)
        })
        .collect()
}

/// A residual: its weight, its value, and how it changes with what.
type Row = (f64, f64, Vec<(usize, f64)>);

/// Residuals as they are told.
#[derive(Default)]
struct Told(Vec<Row>);

impl Listener for Told {
    fn row(&mut self, weight: f64, residual: f64, by: &[(usize, f64)]) {
        self.0.push((weight, residual, by.to_vec()));
    }
}

#[test]
fn residuals_change_as_is_said() {
    let clip = standing(6);
    let goals = circle(&clip, 20, 0.2);
    let body = Body::of(&clip);
    let start = body.stances(&clip);
    let edit = Goal::in_space(3, 21, Vec3::new(-0.4, 1.2, 0.3), &Camera::default(), PLACED);
    let constraints = [
        Constraint { frames: 1..4, rule: Rule::Distance([20, 21], Some(0.5)) },
        Constraint { frames: 2..9, rule: Rule::Plane(10, Vec3::Y, 0.2) },
        Constraint { frames: 0..6, rule: Rule::Balance },
    ];
    let goals: Vec<Goal> = goals.into_iter().chain([edit]).collect();
    let asked = Asked { goals: &goals, constraints: &constraints, frozen: &[] };
    let mut costs = Costs::new(&body, &start, &asked, &[[true; 2]; 6]);
    (costs.goal, costs.edit) = (3.0, 5.0);
    let away = |at: usize| 0.05 * (at as f64 * 1.7).sin();
    let shake = |own: &Stance, first: usize| {
        let step: Vec<f64> = (0..FREEDOMS).map(|at| away(first + at)).collect();
        own.moved(&step)
    };
    let here: Vec<Stance> = start.iter().enumerate().map(|(at, own)| shake(own, at * FREEDOMS)).collect();
    let told = |stances: &[Stance]| {
        let mut told = Told::default();
        costs.tell(stances, &mut told);
        told.0
    };
    let rows = told(&here);
    for at in (0..6 * FREEDOMS).step_by(5) {
        let moved = |by: f64| {
            let mut step = vec![0.0; FREEDOMS];
            step[at % FREEDOMS] = by;
            let mut moved = here.clone();
            moved[at / FREEDOMS] = here[at / FREEDOMS].moved(&step);
            told(&moved)
        };
        let (more, less) = (moved(1e-5), moved(-1e-5));
        assert!(rows.len() == more.len() && rows.len() == less.len());
        for (row, (more, less)) in rows.iter().zip(more.iter().zip(&less)) {
            let slope = (more.1 - less.1) / 2e-5;
            let said = row.2.iter().find(|(other, _)| *other == at).map_or(0.0, |(_, by)| *by);
            assert!((slope - said).abs() < 1e-5, "{at}: {slope} {said}");
        }
    }
}

#[test]
fn a_drawn_way_is_met_with_bones_feet_and_the_rest_as_they_were() {
    let clip = standing(40);
    let goals = circle(&clip, 20, 0.25);
    let met = meet(&clip, &goals, &[[true; 2]; 40], &MeetOptions::default());
    assert!(met.before[1] > 0.2 && met.after[1] < 0.003, "{:?}", met.after);
    let motion = joints_of(&clip);
    let bones = bone_lengths(&motion[0]);
    for (frame, pose) in met.motion.iter().enumerate() {
        let own = bone_lengths(pose);
        assert!(own.iter().zip(&bones).all(|(a, b)| (a.length() - b.length()).abs() < 1e-4), "{frame}");
        for foot in [7, 8, 10, 11] {
            let moved = pose[foot].distance(motion[frame][foot]);
            assert!(moved < 0.02, "{frame}: {foot} by {moved}");
        }
        let moved = pose[21].distance(motion[frame][21]);
        assert!(moved < 0.15, "{frame}: the other hand by {moved}, where this one goes by .5");
    }
    let jerk = inkrig_generate::measures::jerk(&met.motion);
    assert!(jerk.iter().all(|jerk| *jerk < 0.03), "{jerk:?}");
}

#[test]
fn what_cannot_be_met_is_come_near_to() {
    let clip = standing(10);
    let mut goals = circle(&clip, 20, 0.0);
    goals[5].at += Vec2::new(5.0, 0.0);
    let met = meet(&clip, &goals[5..6], &[], &MeetOptions::default());
    assert!(met.after[1] < met.before[1] && met.motion.iter().flatten().all(|place| place.is_finite()));
    assert!(meet(&clip, &[], &[], &MeetOptions::default()).steps == 0);
}

#[test]
fn a_drawn_pose_is_given_the_proportions_of_a_body() {
    let clip = standing(3);
    let camera = Camera::default();
    let pose = joints_of(&clip)[1];
    let goal = |joint: usize, by: Vec2, source: Source| {
        let at = camera.project(pose[joint]) + by;
        Goal::placed(1, joint, at, &camera, (Quat::IDENTITY, Vec3::ZERO), source)
    };
    // A forearm that is half as long again, below an arm that is pinned.
    let drawn = vec![
        goal(18, Vec2::ZERO, Source::Pin),
        goal(16, Vec2::ZERO, Source::Pin),
        goal(20, Vec2::new(0.0, -0.12), Source::Pose),
        goal(0, Vec2::ZERO, Source::Pose),
    ];
    let mut goals = drawn.clone();
    let moved = proportion(&clip, &mut goals);
    assert!((0.08..0.13).contains(&moved.poses) && moved.ways == 0.0, "{moved:?}");
    assert_eq!(goals[..2], drawn[..2]);
    let met = meet(&clip, &goals, &[], &MeetOptions::default());
    assert!(met.after[1] < 0.008, "{:?}", met.after);
    assert!(meet(&clip, &drawn, &[], &MeetOptions::default()).after[1] > 0.01);
}

#[test]
fn ways_that_part_farther_than_a_leg_are_brought_together() {
    let clip = standing(20);
    let camera = Camera::default();
    let pose = joints_of(&clip)[0];
    let place = (Quat::IDENTITY, Vec3::ZERO);
    let way = |joint: usize, by: f32| {
        let at = camera.project(pose[joint]);
        (0..20).map(move |frame| {
            let far = by * (1.0 - (frame as f32 - 10.0).abs() / 10.0);
            Goal::placed(frame, joint, at + Vec2::new(0.0, far), &camera, place, Source::Way)
        })
    };
    // A pelvis that goes up, and a foot that goes down.
    let drawn: Vec<Goal> = way(0, 0.15).chain(way(10, -0.1)).collect();
    let mut goals = drawn.clone();
    let moved = proportion(&clip, &mut goals);
    assert!((0.05..0.15).contains(&moved.ways) && moved.poses == 0.0, "{moved:?}");
    assert_eq!((goals[0], goals[19]), (drawn[0], drawn[19]));
    let stands = [[false; 2]; 20];
    assert!(meet(&clip, &goals, &stands, &MeetOptions::default()).after[1] < 0.005);
    assert!(meet(&clip, &drawn, &stands, &MeetOptions::default()).after[1] > 0.02);
}

#[test]
fn a_foot_that_is_drawn_along_the_ground_is_lifted() {
    let clip = standing(30);
    let camera = Camera::default();
    let motion = joints_of(&clip);
    let goals: Vec<Goal> = (0..30)
        .map(|frame| {
            let at = camera.project(motion[0][10] + Vec3::Z * 0.03 * frame as f32);
            Goal::placed(frame, 10, at, &camera, (Quat::IDENTITY, Vec3::ZERO), Source::Way)
        })
        .collect();
    let met = meet(&clip, &goals, &[[true; 2]; 30], &MeetOptions::default());
    assert!(met.after[1] < 0.003, "{:?}", met.after);
    let low = met.motion[5..25].iter().map(|pose| pose[10].y).fold(f32::INFINITY, f32::min);
    assert!(low > 0.045, "{low}");
    assert!(inkrig_generate::measures::skating(&met.motion).ratio < 0.1);
}

/// The largest change of some joints in frames that are at least so far from a frame, metres.
fn change(a: &[Joints], b: &[Joints], joints: &[usize], (frame, far): (usize, usize)) -> f32 {
    let frames = a.iter().zip(b).enumerate().filter(|(at, _)| at.abs_diff(frame) >= far);
    let each = frames.flat_map(|(_, (a, b))| joints.iter().map(move |joint| a[*joint].distance(b[*joint])));
    each.fold(0.0, f32::max)
}

#[test]
fn a_joint_that_is_put_in_space_moves_its_limb_and_the_frames_around() {
    let clip = standing(60);
    let motion = joints_of(&clip);
    for (joint, by, limb) in [
        (21, Vec3::new(-0.1, 0.35, 0.25), [17, 19, 21]),
        (21, Vec3::new(0.0, 0.05, 0.1), [17, 19, 21]),
        (10, Vec3::new(0.0, 0.3, 0.2), [4, 7, 10]),
    ] {
        let goal = Goal::in_space(30, joint, motion[30][joint] + by, &Camera::default(), PLACED);
        let asked = Asked { goals: &[goal], ..Asked::default() };
        // Whatever the drawing counts.
        for options in [
            MeetOptions::soft(),
            MeetOptions::default(),
            MeetOptions { weight: 0.0, ..MeetOptions::default() },
        ] {
            let met = meet_all(&clip, &asked, &[[true; 2]; 60], &options);
            assert!(met.after[1] < 0.002, "{joint}: {:?} in {} steps", met.after, met.steps);
            let others: Vec<usize> = (0..JOINTS).filter(|joint| !limb.contains(joint)).collect();
            let (near, far) = (
                change(&met.motion, &motion, &others, (30, 0)),
                change(&met.motion, &motion, &limb, (30, 11)),
            );
            println!(
                "{joint} by {:.2} m: others by {near:.4}, farther than 10 frames by {far:.4} m, {} steps",
                by.length(),
                met.steps
            );
            assert!(near < 0.1 * by.length() && far < 0.1 * by.length(), "{joint}: {near} {far}");
        }
    }
}

#[test]
fn frozen_frames_stay_to_the_bit() {
    let clip = standing(30);
    let still = meet_all(&clip, &Asked { frozen: &[true; 30], ..FAR }, &[], &MeetOptions::default());
    let frozen: Vec<bool> = (0..30).map(|frame| !(5..25).contains(&frame)).collect();
    let met = meet_all(&clip, &Asked { frozen: &frozen, ..FAR }, &[], &MeetOptions::default());
    for (frame, (own, other)) in met.motion.iter().zip(&still.motion).enumerate() {
        assert_eq!(own == other, frozen[frame], "{frame}");
    }
    assert!(change(&still.motion, &joints_of(&clip), &[0, 20], (0, 0)) < 1e-5);
}

#[test]
fn constraints_are_met() {
    let clip = standing(40);
    let cuboid = Cuboid::between(Vec3::new(0.0, 0.0, 0.1), Vec3::new(0.4, 0.3, 0.6));
    for (name, rule) in [
        ("a bar", Rule::Distance([20, 21], Some(0.6))),
        ("a hand on the floor", Rule::Plane(20, Vec3::Y, 0.0)),
        ("a hand on a wall", Rule::Plane(21, Vec3::Z, 0.4)),
        ("a foot on a box", Rule::Box(10, cuboid)),
    ] {
        let constraints =
            [Constraint { frames: 10..30, rule }, Constraint { frames: 0..40, rule: Rule::Balance }];
        let asked = Asked { constraints: &constraints, ..Asked::default() };
        let standing: Vec<[bool; 2]> = vec![[!name.starts_with("a foot"), true]; 40];
        let met = meet_all(&clip, &asked, &standing, &MeetOptions::default());
        let misses = constraints.map(|constraint| constraint.miss(&met.motion, &standing).unwrap());
        println!("{name}: {misses:.4?} in {} steps", met.steps);
        assert!(misses.iter().all(|(miss, _)| *miss < 0.004), "{name}: {misses:?}");
        let bones = bone_lengths(&joints_of(&clip)[0]);
        for pose in &met.motion {
            let own = bone_lengths(pose);
            assert!(own.iter().zip(&bones).all(|(a, b)| (a.length() - b.length()).abs() < 1e-4));
        }
    }
}

/// A hand that is asked for where it is not.
const FAR: Asked<'_> = Asked {
    goals: &[Goal {
        frame: 15,
        joint: 20,
        axes: [Vec3::X, Vec3::Y],
        at: Vec2::new(0.5, 1.3),
        away: None,
        source: Source::Way,
    }],
    constraints: &[],
    frozen: &[],
};
