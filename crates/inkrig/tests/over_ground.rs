//! Root motion, ground paths and loops on this project's samples and on captured motion.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig::formats::{ImportOptions, read_bvh};
use inkrig::motion::cycle::{LoopOptions, make_loop};
use inkrig::motion::glam::DVec2;
use inkrig::motion::ground::{
    Contacts, GroundPath, PathOptions, Route, SkeletonChange, TravelOptions, add_root_bone, fold_root_bone,
    follow_path, in_place,
};
use inkrig::motion::{Clip, kinematics, time};
use std::path::PathBuf;

fn samples() -> Vec<(&'static str, Clip)> {
    let read = |name| {
        let bytes = inkrig::samples::find(name).unwrap().bytes;
        (name, read_bvh(bytes, &ImportOptions::default()).unwrap().clip)
    };
    ["person", "quadruped", "snake"].map(read).to_vec()
}

/// Motions of the reference folder, without their calibration poses; none, said in one line, where it is not there.
fn captured(paths: &[&'static str]) -> Vec<(&'static str, Clip)> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let mut clips = Vec::new();
    for path in paths {
        match std::fs::read(folder.join("data").join(path)) {
            Ok(bytes) => {
                let clip = read_bvh(&bytes, &ImportOptions::default()).unwrap().clip;
                let begin = inkrig::motion::lead_in::rest_pose_frames(&clip);
                clips.push((*path, time::trim(&clip, begin..clip.frames()).unwrap()));
            }
            Err(error) => {
                assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{path}: {error}");
                println!("skipped: no reference motion {path} in {}", folder.display());
            }
        }
    }
    clips
}

const WALKS: [&str; 4] = ["cmu/35/35_01.bvh", "cmu/35/35_02.bvh", "cmu/35/35_17.bvh", "cmu/35/35_28.bvh"];
const OTHERS: [&str; 3] = [
    "cmu-dance/salsa/01.bvh",
    "bandai-namco-1-noncommercial/dataset-1_walk_normal_001.bvh",
    "bandai-namco-1-noncommercial/dataset-1_bow_normal_001.bvh",
];

fn apart(a: &Clip, b: &Clip, without: Option<usize>) -> f32 {
    let (a, b) = (kinematics::positions(a), kinematics::positions(b));
    let mut largest = 0.0_f32;
    for frame in 0..a.frames() {
        let others = b.frame(frame).iter().enumerate().filter(|(joint, _)| Some(*joint) != without);
        for (one, (_, other)) in a.frame(frame).iter().zip(others) {
            largest = largest.max(one.distance(*other));
        }
    }
    largest
}

#[test]
fn bones_come_and_go_without_a_trace() {
    for (name, clip) in [samples(), captured(&WALKS), captured(&OTHERS)].concat() {
        let bone = add_root_bone(&clip, &TravelOptions::default()).unwrap();
        let still_root = name.starts_with("bandai");
        let joint = match bone.skeleton {
            SkeletonChange::Inserted(joint) => Some(joint),
            _ => None,
        };
        assert_eq!(joint.is_none(), still_root, "{name}: {:?}", bone.skeleton);
        // The still root of a Bandai file is itself the bone: it moves, everything else stays.
        let moved =
            if still_root { without_root(&clip, &bone.clip) } else { apart(&clip, &bone.clip, joint) };
        let back = fold_root_bone(&bone.clip).unwrap().clip;
        let (returned, size) = (apart(&clip, &back, None), clip.skeleton().extent());
        println!("{name}: with a bone {moved:.1e} m away, folded back {returned:.1e} m, size {size:.2} m");
        assert!(moved < 1e-5 * size.max(1.0) && returned < 1e-5 * size.max(1.0), "{name}");
        assert_eq!(back.skeleton(), clip.skeleton());
    }
}

fn without_root(a: &Clip, b: &Clip) -> f32 {
    let (a, b) = (kinematics::positions(a), kinematics::positions(b));
    let of_frame = |frame: usize| a.frame(frame)[1..].iter().zip(&b.frame(frame)[1..]);
    (0..a.frames()).flat_map(of_frame).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn in_place_stays_in_place() {
    for (name, clip) in [samples(), captured(&WALKS), captured(&OTHERS)].concat() {
        let joint = clip.travel_joint();
        let still = in_place(&clip, &TravelOptions::default()).unwrap();
        let (before, after) = (kinematics::positions(&clip), kinematics::positions(&still));
        let reach = |positions: &kinematics::Positions| {
            let first = positions.frame(0)[joint].with_y(0.0);
            let far = |frame: usize| positions.frame(frame)[joint].with_y(0.0).distance(first);
            (0..positions.frames()).map(far).fold(0.0, f32::max)
        };
        println!("{name}: {:.2} m away from its place, in place {:.3} m", reach(&before), reach(&after));
        assert!(reach(&after) < 0.25 * clip.skeleton().extent(), "{name}");
        let (a, b) = (before.relative_to(joint), after.relative_to(joint));
        let above = clip.skeleton().ancestors(joint);
        for frame in 0..clip.frames() {
            for (index, (a, b)) in a.frame(frame).iter().zip(b.frame(frame)).enumerate() {
                assert!(above[index] || a.distance(*b) < 2e-5, "{name}, frame {frame}, joint {index}");
            }
        }
    }
}

#[test]
fn walks_follow_paths() {
    let circle: Vec<DVec2> = (0..60).map(|step| DVec2::from_angle(0.1047 * f64::from(step))).collect();
    let zigzag = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [5.0, 2.0]].map(DVec2::from);
    let routes = [
        ("straight", Route::Straight),
        ("arc:90", Route::Arc(1.57)),
        ("circle", Route::Path(GroundPath::new(&circle, true).unwrap())),
        ("corners", Route::Path(GroundPath::new(&zigzag, false).unwrap())),
    ];
    for (name, clip) in [samples(), captured(&WALKS), captured(&OTHERS[..2])].concat() {
        let size = f64::from(clip.skeleton().extent());
        let contacts = Contacts::of(&clip);
        let before = contacts.slide(&clip);
        let steps =
            |slide: Option<inkrig::motion::ground::Slide>| slide.map_or(0.0, |slide| slide.mean_step_mm);
        for (what, route) in &routes {
            let result = follow_path(&clip, route, &PathOptions::default()).unwrap();
            let after = contacts.slide(&result.clip);
            println!(
                "{name} along {what}: {:.2} m, {:.3} m away in the mean, {:.3} m at most; slide {:.2} mm a frame, before {:.2}",
                result.travelled_metres,
                result.mean_distance,
                result.max_distance,
                steps(after),
                steps(before)
            );
            // A dance goes to and fro on the spot more than it travels.
            let most = if name.contains("salsa") { 0.1 } else { 0.05 };
            assert!(result.mean_distance < most * size, "{name} along {what}: {}", result.mean_distance);
            assert!(result.max_distance < 0.25 * size, "{name} along {what}: {}", result.max_distance);
        }
    }
}

#[test]
fn a_straight_walk_is_hardly_changed_by_a_straight_path() {
    for (name, clip) in captured(&WALKS[..2]) {
        let result = follow_path(&clip, &Route::Straight, &PathOptions::default()).unwrap();
        let moved = apart(&clip, &result.clip, None);
        println!("{name}: at most {moved:.3} m away");
        assert!(moved < 0.12, "{name}: {moved}");
    }
}

#[test]
fn walks_become_loops() {
    for (name, clip) in captured(&WALKS) {
        let rate = clip.frame_rate();
        for seconds in [1.0, 1.2, 2.0] {
            let frames = (seconds * rate) as usize;
            let Ok(made) = make_loop(&clip, frames, &LoopOptions::default()) else {
                println!("{name}: too short for {seconds} s");
                continue;
            };
            println!(
                "{name}: {frames} frames of {} from {}, ends {:.3} m apart, seam {:.2}",
                made.period, made.start, made.apart, made.seam_ratio
            );
            assert_eq!(made.clip.frames(), frames);
            assert!(made.seam_ratio <= 1.5, "{name}: {}", made.seam_ratio);
            let places = made.clip.track(made.clip.travel_joint()).unwrap();
            assert!(places[0].distance(places[frames - 1]) > 0.5, "{name} goes on walking");
        }
    }
}
