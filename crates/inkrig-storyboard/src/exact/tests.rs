use super::*;
use inkrig_generate::guidance::Objective;
use inkrig_motion::humanml::{bone_lengths, skeleton, to_clip};
use std::sync::Arc;

/// A person who stands with hanging arms and sways a little.
fn standing(frames: usize) -> Clip {
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
            Goal::placed(frame, joint, at, &camera, (Quat::IDENTITY, Vec3::ZERO), true)
        })
        .collect()
}

#[test]
fn the_gradient_is_that_of_the_sum() {
    let clip = standing(6);
    let motion = joints_of(&clip);
    let mut goals = circle(&clip, 20, 0.2);
    goals[3].firm = false;
    let variables = Variables::of(&clip);
    let mut x = variables.start(&clip);
    // Away from the start, where most costs are zero.
    x.iter_mut().enumerate().for_each(|(at, x)| *x += 0.05 * (at as f32 * 1.7).sin());
    let mut energy = Energy::new(&variables, &motion, &goals);
    energy.harden(&x);
    let mut gradient = vec![0.0; x.len()];
    let Ok(_) = energy.evaluate(&x, &mut gradient);
    let mut unused = vec![0.0; x.len()];
    for at in (0..x.len()).step_by(3) {
        let (mut more, mut less) = (x.clone(), x.clone());
        more[at] += 1e-2;
        less[at] -= 1e-2;
        let (Ok(above), Ok(below)) =
            (energy.evaluate(&more, &mut unused), energy.evaluate(&less, &mut unused));
        let slope = (above - below) / f64::from(more[at] - less[at]);
        let got = f64::from(gradient[at]);
        assert!((slope - got).abs() < 0.02 * (1.0 + got.abs()), "{at}: {slope} {got}");
    }
}

#[test]
fn a_drawn_way_is_met_with_bones_feet_and_the_rest_as_they_were() {
    let clip = standing(40);
    let goals = circle(&clip, 20, 0.25);
    let met = meet(&clip, &goals, &MeetOptions::default());
    assert!(met.before[1] > 0.2 && met.after[1] < 0.006, "{met:?}");
    let motion = joints_of(&clip);
    let bones = bone_lengths(&motion[0]);
    for (frame, pose) in met.motion.iter().enumerate() {
        let own = bone_lengths(pose);
        assert!(own.iter().zip(&bones).all(|(a, b)| (a.length() - b.length()).abs() < 1e-4), "{frame}");
        for foot in [7, 8, 10, 11] {
            let moved = pose[foot].distance(motion[frame][foot]);
            assert!(moved < 0.03, "{frame}: {foot} by {moved}");
        }
        let moved = pose[21].distance(motion[frame][21]);
        assert!(moved < 0.35, "{frame}: the other hand by {moved}, where this one goes by .5");
    }
    let jerk = inkrig_generate::measures::jerk(&met.motion);
    assert!(jerk.iter().all(|jerk| *jerk < 0.03), "{jerk:?}");
}

#[test]
fn what_cannot_be_met_is_come_near_to() {
    let clip = standing(10);
    let mut goals = circle(&clip, 20, 0.0);
    goals[5].at += Vec2::new(5.0, 0.0);
    let met = meet(&clip, &goals[5..6], &MeetOptions::default());
    assert!(met.after[1] < met.before[1] && met.motion.iter().flatten().all(|place| place.is_finite()));
    assert!(meet(&clip, &[], &MeetOptions::default()).evaluations == 0);
}
