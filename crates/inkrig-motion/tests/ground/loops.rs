//! Exact loops.

use super::build::{clips, walker, yaw};
use inkrig_motion::cycle::{LoopOptions, laps, make_loop, resample_loop, seam_ratio};
use inkrig_motion::{MotionError, kinematics, time};
use proptest::prelude::*;

#[test]
fn a_walk_becomes_a_loop_of_exactly_so_many_frames() {
    let walk = walker(200, 0.3);
    for frames in [28, 30, 60, 65, 90] {
        let made = make_loop(&walk, frames, &LoopOptions::default()).unwrap();
        assert_eq!(made.clip.frames(), frames);
        assert!(made.seam_ratio <= 1.5, "{frames}: {}", made.seam_ratio);
        assert!(made.period % 30 <= 1 || made.period % 30 == 29, "whole steps: {} of {frames}", made.period);
        // It travels and turns as far as the walk does in these frames.
        let places = made.clip.track(0).unwrap();
        let way: f32 = places.windows(2).map(|pair| pair[0].with_y(0.0).distance(pair[1].with_y(0.0))).sum();
        let own = 1.2 / 30.0 * made.period as f32 * (frames - 1) as f32 / frames as f32;
        assert!((way / own - 1.0).abs() < 0.05, "{frames}: {way} m for {own} m");
        let turned = yaw(made.clip.rotations(frames - 1)[0]) - yaw(made.clip.rotations(0)[0]);
        assert!((turned - 0.3 * made.period as f32 / 30.0).abs() < 0.03, "{turned}");
    }
}

#[test]
fn what_differs_is_spread_and_nothing_else_changes() {
    // Half a step more than fits: the ends differ whatever is taken.
    let walk = time::trim(&walker(200, 0.0), 0..46).unwrap();
    let spread = make_loop(&walk, 44, &LoopOptions::default()).unwrap();
    let cut = make_loop(&walk, 44, &LoopOptions { window_seconds: 0.0 }).unwrap();
    assert!(cut.seam_ratio > 2.0 && spread.seam_ratio < 1.5, "{} {}", cut.seam_ratio, spread.seam_ratio);
    assert!(spread.apart > 0.05, "and it says how much: {} m", spread.apart);
    // Away from the seam both are the same.
    for frame in 13..30 {
        for (a, b) in spread.clip.rotations(frame).iter().zip(cut.clip.rotations(frame)) {
            assert!(a.dot(*b).abs() > 1.0 - 1e-6, "frame {frame}");
        }
    }
}

#[test]
fn a_loop_at_another_rate_stays_whole() {
    let looped = make_loop(&walker(200, 0.3), 60, &LoopOptions::default()).unwrap().clip;
    for (rate, frames) in [(24.0, 48), (60.0, 120), (25.0, 50), (29.0, 58), (15.0, 30)] {
        let other = resample_loop(&looped, rate).unwrap();
        assert_eq!((other.frames(), other.frame_rate()), (frames, rate));
        let seam = seam_ratio(&other).unwrap();
        assert!(seam < 1.5, "{rate}: {seam}");
    }
    assert_eq!(time::resample(&looped, 60.0).unwrap().frames(), 119, "which an open clip does not");
    assert!(matches!(resample_loop(&looped, 0.0), Err(MotionError::FrameRate(_))));
}

#[test]
fn lengths_without_sense_are_refused() {
    let walk = walker(50, 0.0);
    for frames in [0, 3, 63, usize::MAX / 2] {
        let error = make_loop(&walk, frames, &LoopOptions::default()).unwrap_err();
        assert!(matches!(error, MotionError::LoopLength { got: 50, .. }), "{error}");
    }
    assert!(make_loop(&walk, 60, &LoopOptions::default()).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn any_clip_gives_a_finite_loop_of_that_length(clip in clips(), part in 0.3_f64..1.2) {
        let frames = ((clip.frames() as f64 * part) as usize).max(4);
        match make_loop(&clip, frames, &LoopOptions::default()) {
            Ok(made) => {
                prop_assert_eq!(made.clip.frames(), frames);
                let positions = kinematics::positions(&made.clip);
                prop_assert!((0..frames).all(|frame| positions.frame(frame).iter().all(|place| place.is_finite())));
            }
            Err(MotionError::LoopLength { .. }) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

#[test]
fn a_loop_goes_on_as_often_as_asked() {
    // A walk of 30 frames a round that turns; without and with its first pose once more at the end.
    let walk = walker(300, 0.4);
    let place = |clip: &inkrig_motion::Clip, frame: usize| kinematics::positions(clip).frame(frame).to_vec();
    for frames in [30, 31] {
        let round = time::trim(&walk, 0..frames).unwrap();
        let long = laps(&round, 8).unwrap().unwrap();
        assert_eq!(long.frames(), 240);
        for frame in [0, 29, 30, 75, 239] {
            for (a, b) in place(&long, frame).iter().zip(place(&walk, frame)) {
                assert!(a.distance(b) < 0.02, "frame {frame} of {frames}: {a} {b}");
            }
        }
    }
    assert_eq!(laps(&time::trim(&walk, 0..46).unwrap(), 3).unwrap(), None, "its ends do not meet");
    assert_eq!(laps(&time::trim(&walk, 0..3).unwrap(), 3).unwrap(), None);
}
