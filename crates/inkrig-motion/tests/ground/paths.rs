//! Other ways over the ground.

use super::build::{apart, clips, walker, yaw};
use inkrig_motion::glam::{DVec2, Quat, Vec3};
use inkrig_motion::ground::{
    Contacts, GroundPath, PathOptions, Route, Trajectory, TravelOptions, follow_path,
};
use inkrig_motion::{Clip, MotionError, TranslationTrack, kinematics};
use proptest::prelude::*;

fn path(points: &[[f64; 2]], closed: bool) -> Route {
    let points: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
    Route::Path(GroundPath::new(&points, closed).unwrap())
}

fn way(clip: &Clip) -> Trajectory {
    Trajectory::of(clip, &TravelOptions::default())
}

#[test]
fn a_straight_walk_straightened_stays_as_it_is() {
    let walk = walker(240, 0.0);
    let straight = follow_path(&walk, &Route::Straight, &PathOptions::default()).unwrap();
    assert!(apart(&walk, &straight.clip, None) < 0.02, "{}", apart(&walk, &straight.clip, None));
    assert!(straight.max_distance < 0.005, "{}", straight.max_distance);
}

#[test]
fn a_curved_walk_is_straightened_and_a_straight_one_bent() {
    let curved = walker(240, 0.4);
    let straight = follow_path(&curved, &Route::Straight, &PathOptions::default()).unwrap();
    let (path, length) = (way(&straight.clip).path, way(&curved).length());
    let chord = path[0].distance(path[239]);
    assert!(chord > 0.97 * length, "{chord} m as the crow flies of {length} m");
    let heading = |frame: usize| yaw(straight.clip.rotations(frame)[0]);
    assert!((heading(60) - heading(180)).abs() < 0.1, "the body no longer turns");

    let bent = follow_path(&walker(240, 0.0), &Route::Arc(1.5), &PathOptions::default()).unwrap();
    let ends = yaw(bent.clip.rotations(200)[0]) - yaw(bent.clip.rotations(40)[0]);
    assert!((ends - 1.5 * 160.0 / 240.0).abs() < 0.1, "turned to the left: {ends}");
    assert!(bent.mean_distance < 0.02 && bent.max_distance < 0.06, "{bent:?}");

    let more = follow_path(&curved, &Route::Bend(-3.2), &PathOptions::default()).unwrap();
    let path = way(&more.clip).path;
    assert!(path[20].distance(path[219]) > 0.95 * length * 200.0 / 240.0, "the bend undoes the curve");
}

#[test]
fn speed_and_sway_along_a_drawing_are_the_walks_own() {
    let walk = walker(300, 0.0);
    let drawing = path(&[[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [6.0, 2.0]], false);
    let result = follow_path(&walk, &drawing, &PathOptions::default()).unwrap();
    assert!((result.path_metres - result.travelled_metres).abs() < 1e-6, "as long as the walk");
    assert!(result.mean_distance < 0.1 && result.max_distance < 0.4, "{result:?}");
    let speeds = |clip: &Clip| -> Vec<f64> {
        way(clip).path.windows(2).map(|pair| 30.0 * pair[0].distance(pair[1])).collect()
    };
    for (frame, speed) in speeds(&result.clip).into_iter().enumerate() {
        assert!((0.75..1.35).contains(&speed), "frame {frame}: {speed} m/s");
    }
    // Heights and local poses are untouched.
    for frame in 0..300 {
        assert_eq!(walk.rotations(frame)[1..], result.clip.rotations(frame)[1..]);
        assert!((walk.track(0).unwrap()[frame].y - result.clip.track(0).unwrap()[frame].y).abs() < 1e-6);
    }
    // On the long straight ends the hips still sway by 3 cm to each side.
    let places = result.clip.track(0).unwrap();
    let across: Vec<f32> = places[15..75].iter().map(|place| place.z).collect();
    let spread =
        across.iter().copied().fold(f32::MIN, f32::max) - across.iter().copied().fold(f32::MAX, f32::min);
    assert!((0.04..0.09).contains(&spread), "{spread}");
}

#[test]
fn a_walk_sideways_stays_one() {
    let walk = walker(180, 0.0);
    let mut tracks = walk.translations().to_vec();
    let aside = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    tracks[0].values.iter_mut().for_each(|place| *place = aside * *place);
    let rotations = (0..180).flat_map(|frame| walk.rotations(frame).to_vec()).collect();
    let clip = Clip::new(walk.skeleton().clone(), 30.0, rotations, tracks).unwrap();
    // The drawing leads towards +z; the body walked towards +x and looked to +z, so now it looks to -x.
    let result =
        follow_path(&clip, &path(&[[0.0, 0.0], [0.0, 5.0]], false), &PathOptions::default()).unwrap();
    let forward = result.clip.rotations(90)[0] * Vec3::Z;
    assert!(forward.distance(Vec3::NEG_X) < 0.05, "{forward}");
}

#[test]
fn ends_of_paths() {
    let walk = walker(300, 0.0);
    let metres = PathOptions { metres_per_unit: Some(1.0), ..Default::default() };
    // In metres the path lies where it says.
    let long = follow_path(&walk, &path(&[[5.0, 5.0], [5.0, 105.0]], false), &metres).unwrap();
    let (first, last) = (way(&long.clip).path[0], way(&long.clip).path[299]);
    assert!(first.distance(DVec2::new(5.0, 5.0)) < 0.05 && (last.y - 5.0 - 11.96).abs() < 0.1, "{last}");
    // A short open one goes on straight, a closed one around again.
    let short = follow_path(&walk, &path(&[[0.0, 0.0], [2.0, 0.0]], false), &metres).unwrap();
    assert!((way(&short.clip).path[299].x - 11.96).abs() < 0.1);
    let square = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.5], [0.0, 1.5]];
    let round = follow_path(&walk, &path(&square, true), &metres).unwrap();
    let path = way(&round.clip).path;
    assert!(path.iter().all(|place| place.x > -0.3 && place.x < 1.8 && place.y > -0.3 && place.y < 1.8));
    assert!((round.path_metres - 6.0).abs() < 1e-9 && round.max_distance < 0.4, "{round:?}");
}

#[test]
fn standing_about_does_not_walk_on() {
    // Walk, stand and shift weight for ten seconds, walk on.
    let walk = walker(600, 0.0);
    let mut tracks = walk.translations().to_vec();
    let own = tracks[0].values.clone();
    for (frame, place) in tracks[0].values.iter_mut().enumerate() {
        let shift = 0.04 * (frame as f32 * 0.05).sin();
        let along = match frame {
            0..150 => own[frame].z,
            150..450 => own[150].z + shift,
            _ => own[frame - 300].z,
        };
        *place = Vec3::new(shift, 0.9, along);
    }
    let rotations = (0..600).flat_map(|frame| walk.rotations(frame).to_vec()).collect();
    let clip = Clip::new(walk.skeleton().clone(), 30.0, rotations, tracks).unwrap();
    let result = follow_path(&clip, &Route::Arc(3.0), &PathOptions::default()).unwrap();
    let path = way(&result.clip).path;
    assert!(path[190].distance(path[410]) < 0.15, "{}", path[190].distance(path[410]));
    let turned = yaw(result.clip.rotations(410)[0]) - yaw(result.clip.rotations(190)[0]);
    assert!(turned.abs() < 0.15, "{turned}");
}

#[test]
fn feet_are_found_and_their_slide_is_measured() {
    // Two feet that stand by turns on a body that floats along: made from the walker's toes by hand.
    let walk = walker(120, 0.0);
    let skeleton = walk.skeleton().clone();
    let mut left = Vec::new();
    let mut hips = Vec::new();
    for frame in 0..120 {
        let (step, part) = (frame / 30, (frame % 30) as f32 / 30.0);
        let ahead = step as f32 * 1.2;
        // Stands for the first half of each second, then swings ahead.
        let swing = ((part - 0.5) * 2.0).max(0.0);
        let lift = 0.2 * (std::f32::consts::PI * swing).sin();
        let place = Vec3::new(0.0, lift, ahead + 1.2 * swing);
        let hip = Vec3::new(0.0, 0.9, 1.2 * frame as f32 / 30.0);
        hips.push(hip);
        left.push(place - hip);
    }
    let tracks = vec![
        TranslationTrack { joint: 0, values: hips },
        TranslationTrack { joint: 3, values: left.iter().map(|place| *place + Vec3::Y * 0.85).collect() },
        TranslationTrack { joint: 5, values: vec![Vec3::Y; 120] },
    ];
    let clip = Clip::new(skeleton, 30.0, vec![Quat::IDENTITY; 120 * 7], tracks).unwrap();
    let contacts = Contacts::of(&clip);
    assert_eq!(contacts.spans.len(), 4, "{:?}", contacts.spans);
    assert!(contacts.spans.iter().all(|span| span.0 == 4));
    let before = contacts.slide(&clip).unwrap();
    assert!(before.max_drift_mm < 10.0, "{before:?}");
    let bent = follow_path(&clip, &Route::Arc(2.0), &PathOptions::default()).unwrap().clip;
    let after = contacts.slide(&bent).unwrap();
    assert!(after.mean_step_mm > before.mean_step_mm && after.max_drift_mm > 20.0, "{after:?}");
}

#[test]
fn what_cannot_be_followed_is_said() {
    let walk = walker(120, 0.0);
    let mut tracks = walk.translations().to_vec();
    tracks[0].values.iter_mut().for_each(|place| *place = Vec3::Y * place.y);
    let rotations = (0..120).flat_map(|frame| walk.rotations(frame).to_vec()).collect();
    let still = Clip::new(walk.skeleton().clone(), 30.0, rotations, tracks).unwrap();
    let error = follow_path(&still, &Route::Straight, &PathOptions::default()).unwrap_err();
    assert!(
        matches!(error, MotionError::Still { .. }) && error.to_string().contains("does not travel"),
        "{error}"
    );
    let line = path(&[[0.0, 0.0], [1.0, 0.0]], false);
    for (route, unit, part) in [
        (line.clone(), Some(0.01), "too short"),
        (line.clone(), Some(-1.0), "length above 0"),
        (line, Some(f64::NAN), "length above 0"),
        (Route::Arc(f64::NAN), None, "36000"),
        (Route::Bend(1e9), None, "36000"),
    ] {
        let options = PathOptions { metres_per_unit: unit, ..Default::default() };
        let error = follow_path(&walk, &route, &options).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    /// Any drawing, however sharp, crossing or doubled, gives a motion that stays near it, or a clear refusal.
    #[test]
    fn any_drawing_gives_a_motion_near_it(
        clip in clips(),
        points in prop::collection::vec((-3.0_f64..3.0, -3.0_f64..3.0), 2..12),
        closed in any::<bool>(),
        unit in prop::option::of(0.1_f64..10.0),
    ) {
        let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
        let route = Route::Path(GroundPath::new(&points, closed).unwrap());
        let options = PathOptions { metres_per_unit: unit, ..Default::default() };
        match follow_path(&clip, &route, &options) {
            Ok(result) => {
                let size = f64::from(clip.skeleton().extent()).max(0.1);
                let all = kinematics::positions(&result.clip);
                prop_assert!((0..all.frames()).all(|frame| all.frame(frame).iter().all(|place| place.is_finite())));
                prop_assert!(result.mean_distance < 0.5 * size, "{} of {size}", result.mean_distance);
            }
            Err(MotionError::Still { .. } | MotionError::Path { .. }) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
