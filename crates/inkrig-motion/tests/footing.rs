//! Feet on the floor, on motions of which is known what they should be.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, Kept, PARENTS, keep_footing};

const RATE: f64 = 20.0;
const LEGS: [[usize; 4]; 2] = [[1, 4, 7, 10], [2, 5, 8, 11]];
const TRUNK: [(usize, [f32; 3]); 13] = [
    (3, [0.0, 0.12, 0.0]),
    (6, [0.0, 0.25, 0.0]),
    (9, [0.0, 0.3, 0.0]),
    (12, [0.0, 0.52, 0.0]),
    (13, [0.07, 0.45, 0.0]),
    (14, [-0.07, 0.45, 0.0]),
    (15, [0.0, 0.62, 0.03]),
    (16, [0.18, 0.45, 0.0]),
    (17, [-0.18, 0.45, 0.0]),
    (18, [0.2, 0.18, 0.0]),
    (19, [-0.2, 0.18, 0.0]),
    (20, [0.2, -0.05, 0.05]),
    (21, [-0.2, -0.05, 0.05]),
];

/// A body whose pelvis and toes are where they are said to be; knees bend to the front.
fn body(pelvis: Vec3, toes: [Vec3; 2]) -> Joints {
    let mut joints = [pelvis; JOINTS];
    for (joint, place) in TRUNK {
        joints[joint] = pelvis + Vec3::from(place);
    }
    for (([hip, knee, ankle, toe], own), side) in LEGS.into_iter().zip(toes).zip([0.09, -0.09]) {
        joints[hip] = pelvis + Vec3::new(side, -0.07, 0.0);
        joints[toe] = own;
        joints[ankle] = own + Vec3::new(0.0, 0.06, -0.12);
        let way = joints[ankle] - joints[hip];
        let half = 0.5 * way.length();
        let out = Vec3::Z.reject_from(way).normalize();
        joints[knee] = joints[hip] + 0.5 * way + (0.42_f32.powi(2) - half * half).sqrt() * out;
    }
    joints
}

/// Frames of a step, standing and swinging.
const STANDS: usize = 14;
const SWINGS: usize = 10;

/// Metres a second.
const SPEED: f32 = 0.8;

/// Where a foot is that walks, and whether it stands.
fn foot(frame: usize, late: usize, side: f32) -> (Vec3, bool) {
    let (round, step) = ((frame + late) / (STANDS + SWINGS), (frame + late) % (STANDS + SWINGS));
    let length = SPEED * (STANDS + SWINGS) as f32 / RATE as f32;
    let begin = round as f32 * length - SPEED * late as f32 / RATE as f32 + 0.36;
    let share = (step.max(STANDS) - STANDS) as f32 / SWINGS as f32;
    let eased = share * share * share * (10.0 - 15.0 * share + 6.0 * share * share);
    let up = 0.1 * (std::f32::consts::PI * eased).sin();
    (Vec3::new(side, up, begin + eased * length), step < STANDS)
}

/// A walk along z on the floor, and when its feet stand.
fn walk(frames: usize) -> (Vec<Joints>, Vec<[bool; 2]>) {
    let at = |frame: usize| {
        let (left, left_stands) = foot(frame, 0, 0.09);
        let (right, right_stands) = foot(frame, (STANDS + SWINGS) / 2, -0.09);
        let pelvis = Vec3::new(0.0, 0.85, SPEED * frame as f32 / RATE as f32);
        (body(pelvis, [left, right]), [left_stands, right_stands])
    };
    (0..frames).map(at).unzip()
}

fn moved(motion: &[Joints], by: impl Fn(f32) -> Vec3) -> Vec<Joints> {
    let moved =
        |(frame, joints): (usize, &Joints)| joints.map(|place| place + by(frame as f32 / RATE as f32));
    motion.iter().enumerate().map(moved).collect()
}

fn apart(a: &[Joints], b: &[Joints]) -> f32 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

fn lower_toe(joints: &Joints) -> f32 {
    joints[10].y.min(joints[11].y)
}

fn lowest(motion: &[Joints]) -> f32 {
    motion.iter().flatten().map(|place| place.y).fold(f32::INFINITY, f32::min)
}

/// The fastest that a toe is inside of a contact, a tenth of a second from its edges, metres a second.
fn slide(motion: &[Joints], standing: &[[bool; 2]]) -> f32 {
    let mut fastest = 0.0_f32;
    for (foot, toe) in [(0, 10), (1, 11)] {
        for frame in 2..motion.len() - 3 {
            if standing[frame - 2..frame + 4].iter().all(|feet| feet[foot]) {
                let step = (motion[frame + 1][toe] - motion[frame][toe]).with_y(0.0);
                fastest = fastest.max(step.length() * RATE as f32);
            }
        }
    }
    fastest
}

fn check_bones(before: &[Joints], after: &[Joints]) {
    for (frame, (before, after)) in before.iter().zip(after).enumerate() {
        for (joint, parent) in PARENTS.into_iter().enumerate() {
            let [own, now] = [before, after].map(|joints: &Joints| joints[joint].distance(joints[parent]));
            assert!((own - now).abs() < 1e-5, "joint {joint} at frame {frame}: {own} {now}");
        }
        for [hip, knee, ankle, toe] in LEGS {
            let bent = (after[knee] - after[hip]).reject_from(after[ankle] - after[hip]);
            assert!(bent.dot(after[toe] - after[ankle]) > -1e-3, "a knee bends backwards at frame {frame}");
        }
    }
}

#[test]
fn a_walk_on_the_floor_is_left_alone() {
    let (walk, standing) = walk(80);
    let footing = keep_footing(&walk, &[], RATE, &[]).unwrap();
    check_bones(&walk, &footing.frames);
    // But for the first and last moments of a swing, which are as high as the rest of it.
    assert!(apart(&walk, &footing.frames) < 0.06, "{}", apart(&walk, &footing.frames));
    let pairs = walk.iter().flatten().zip(footing.frames.iter().flatten());
    let mean = pairs.map(|(a, b)| a.distance(*b)).sum::<f32>() / (80 * JOINTS) as f32;
    assert!(mean < 0.003, "{mean}");
    assert!(footing.airborne.iter().all(|airborne| !airborne));
    let wrong = standing.iter().zip(&footing.standing).filter(|(own, found)| own != found).count();
    assert!(wrong < 30, "{wrong} of 80 frames: a foot counts as standing a frame or two longer");
}

#[test]
fn a_walk_that_floats_or_sinks_comes_to_the_floor() {
    let (walk, standing) = walk(80);
    for height in [0.25, 0.1, -0.2] {
        let off = moved(&walk, |time| Vec3::Y * (height + 0.04 * (1.5 * time).sin()));
        // A network that is sure of nothing, and one that is wrong.
        for contacts in [vec![], vec![[0.0; 4]; 80], vec![[f32::NAN, 9.0, -9.0, 1.0]; 80]] {
            let footing = keep_footing(&off, &contacts, RATE, &[]).unwrap();
            check_bones(&off, &footing.frames);
            assert!(lowest(&footing.frames) > -0.005, "{height}: {}", lowest(&footing.frames));
            let floats = footing.frames.iter().map(lower_toe).fold(0.0, f32::max);
            assert!(floats < 0.02, "{height}: {floats}");
            assert!(apart(&walk, &footing.frames) < 0.06, "{height}: {}", apart(&walk, &footing.frames));
            assert!(slide(&footing.frames, &standing) < 0.1);
        }
    }
}

#[test]
fn feet_that_slide_are_held_and_the_body_travels_as_they_say() {
    let (walk, standing) = walk(80);
    // As on ice: all of the body goes astray.
    let off = moved(&walk, |time| Vec3::new(0.3 * time, 0.05, -0.4 * time));
    assert!(slide(&off, &standing) > 0.45);
    let footing = keep_footing(&off, &[], RATE, &[]).unwrap();
    check_bones(&off, &footing.frames);
    assert!(slide(&footing.frames, &standing) < 0.15, "{}", slide(&footing.frames, &standing));
    let (end, wanted) = (footing.frames[79][0] - footing.frames[0][0], walk[79][0] - walk[0][0]);
    assert!(end.distance(wanted) < 0.5, "{end} in place of {wanted}; it was {}", off[79][0] - off[0][0]);
}

#[test]
fn a_jump_keeps_its_arc() {
    let (begin, end) = (30, 42);
    let at = |frame: usize| {
        let time = frame.clamp(begin, end) - begin;
        let (time, whole) = (time as f32 / RATE as f32, (end - begin) as f32 / RATE as f32);
        let up = 0.5 * 9.81 * time * (whole - time);
        let toes = [0.09, -0.09].map(|side| Vec3::new(side, up, 0.0));
        body(Vec3::new(0.0, 0.85 + up, 0.0), toes)
    };
    let jump: Vec<Joints> = (0..80).map(at).collect();
    let off = moved(&jump, |time| Vec3::Y * (0.12 + 0.02 * time));
    let footing = keep_footing(&off, &[], RATE, &[]).unwrap();
    check_bones(&off, &footing.frames);
    let flies: Vec<usize> = (0..80).filter(|frame| footing.airborne[*frame]).collect();
    assert!(flies.iter().all(|frame| (begin..=end).contains(frame)) && flies.len() >= 9, "{flies:?}");
    assert!(apart(&jump, &footing.frames) < 0.05, "{}", apart(&jump, &footing.frames));
    for frame in begin + 2..end - 2 {
        let [a, b, c] = [0, 1, 2].map(|next| footing.frames[frame + next - 1][0].y);
        let gravity = (a - 2.0 * b + c) * (RATE * RATE) as f32;
        assert!((gravity + 9.81).abs() < 1.0, "{gravity} at frame {frame}");
    }
    // A body that is lifted slowly is not in the air.
    let lifted = moved(&walk(80).0, |time| Vec3::Y * 0.2 * (1.5 * time).sin().max(0.0));
    let footing = keep_footing(&lifted, &[], RATE, &[]).unwrap();
    assert!(footing.airborne.iter().all(|airborne| !airborne), "{:?}", footing.airborne);
}

#[test]
fn one_who_crawls_comes_down_onto_hands_and_knees() {
    let at = |frame: usize| {
        let along = 0.3 * frame as f32 / RATE as f32;
        let mut joints = body(Vec3::new(0.0, 0.5, along), [Vec3::Y, Vec3::Y]);
        for joint in [3, 6, 9, 12, 13, 14, 15, 16, 17] {
            let own = joints[joint] - joints[0];
            joints[joint] = joints[0] + Vec3::new(own.x, 0.1 * own.y, own.y);
        }
        for (side, [hip, knee, ankle, toe]) in [(1.0, LEGS[0]), (-1.0, LEGS[1])] {
            let swing = 0.05 * side * (3.0 * frame as f32 / RATE as f32).sin();
            joints[knee] = joints[hip] + Vec3::new(0.0, -0.43, swing);
            joints[ankle] = joints[knee] + Vec3::new(0.0, 0.05, -0.4);
            joints[toe] = joints[ankle] + Vec3::new(0.0, -0.03, -0.12);
        }
        for (shoulder, elbow, wrist) in [(16, 18, 20), (17, 19, 21)] {
            joints[elbow] = joints[shoulder] - 0.26 * Vec3::Y;
            joints[wrist] = joints[elbow] - 0.26 * Vec3::Y;
        }
        joints
    };
    let crawl: Vec<Joints> = (0..60).map(at).collect();
    let off = moved(&crawl, |_| Vec3::Y * 0.3);
    let footing = keep_footing(&off, &[], RATE, &[]).unwrap();
    check_lengths_of_legs(&off, &footing.frames);
    let heights = footing.frames.iter().map(|joints| joints.iter().map(|place| place.y).fold(1.0, f32::min));
    assert!(
        heights.clone().all(|height| (-0.005..0.02).contains(&height)),
        "{:?}",
        heights.collect::<Vec<_>>()
    );
    assert!(footing.standing.iter().all(|feet| *feet == [false; 2]));
}

fn check_lengths_of_legs(before: &[Joints], after: &[Joints]) {
    for (before, after) in before.iter().zip(after) {
        for [hip, knee, ankle, _] in LEGS {
            for pair in [[hip, knee], [knee, ankle]] {
                let [own, now] =
                    [before, after].map(|joints: &Joints| joints[pair[0]].distance(joints[pair[1]]));
                assert!((own - now).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn what_was_asked_for_stays_or_comes_nearer() {
    let off = moved(&walk(80).0, |time| Vec3::new(0.2 * time, 0.15, 0.0));
    // The way of a hand, exact at every frame.
    let hand = |frame: usize| Kept { frame, joint: 21, place: off[frame][21] };
    let kept: Vec<Kept> = (0..80).map(hand).collect();
    let footing = keep_footing(&off, &[], RATE, &kept).unwrap();
    check_bones(&off, &footing.frames);
    for (frame, (own, before)) in footing.frames.iter().zip(&off).enumerate() {
        assert!(own[21].distance(before[21]) < 1e-4, "frame {frame}");
    }
    // A pose, exact at one frame; elsewhere feet still come to the floor.
    let kept: Vec<Kept> = (0..JOINTS).map(|joint| Kept { frame: 40, joint, place: off[40][joint] }).collect();
    let footing = keep_footing(&off, &[], RATE, &kept).unwrap();
    assert!(apart(&off[40..41], &footing.frames[40..41]) < 1e-4);
    assert!(lower_toe(&footing.frames[5]) < 0.03 && lower_toe(&footing.frames[75]) < 0.03);
    // A pelvis that was asked to be where it would be on the floor comes there.
    let kept: Vec<Kept> =
        (0..80).map(|frame| Kept { frame, joint: 0, place: off[frame][0] - 0.15 * Vec3::Y }).collect();
    let footing = keep_footing(&off, &[], RATE, &kept).unwrap();
    for (frame, (own, pin)) in footing.frames.iter().zip(&kept).enumerate() {
        assert!(own[0].distance(pin.place) < 0.03, "frame {frame}: {}", own[0].distance(pin.place));
    }
}

#[test]
fn what_cannot_be_a_motion_is_refused_and_little_is_no_matter() {
    let (walk, _) = walk(4);
    for frames in 0..4 {
        let footing = keep_footing(&walk[..frames], &[], RATE, &[]).unwrap();
        assert_eq!(
            (footing.frames.len(), footing.standing.len(), footing.moved.len()),
            (frames, frames, frames)
        );
    }
    let mut bad = walk.clone();
    bad[1][3].y = f32::NAN;
    assert!(keep_footing(&bad, &[], RATE, &[]).is_err());
    assert!(keep_footing(&walk, &[], 0.0, &[]).is_err() && keep_footing(&walk, &[], f64::NAN, &[]).is_err());
    let pin = Kept { frame: 0, joint: 22, place: Vec3::ZERO };
    assert!(keep_footing(&walk, &[], RATE, &[pin]).is_err());
    assert!(keep_footing(&walk, &[], RATE, &[Kept { joint: 3, place: Vec3::NAN, ..pin }]).is_err());
    assert!(keep_footing(&walk, &[], RATE, &[Kept { joint: 3, frame: usize::MAX, ..pin }]).is_ok());
    // All joints at one place.
    let heap = vec![[Vec3::ONE; JOINTS]; 10];
    let footing = keep_footing(&heap, &[], RATE, &[]).unwrap();
    assert!(footing.frames.iter().flatten().all(|place| place.is_finite()));
}
