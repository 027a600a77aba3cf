//! In place, root bones, and back.

use super::build::{apart, clips, turned_apart, walker, yaw};
use inkrig_motion::ground::{
    SkeletonChange, Trajectory, TravelOptions, add_root_bone, fold_root_bone, in_place, root_bone,
};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{Quat, Vec3},
    kinematics,
};
use proptest::prelude::*;
use std::sync::Arc;

fn options() -> TravelOptions {
    TravelOptions::default()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn a_bone_moves_nothing_and_folding_it_gives_the_clip_back(clip in clips()) {
        let with_bone = add_root_bone(&clip, &options()).unwrap();
        let size = clip.skeleton().extent().max(1.0);
        match with_bone.skeleton {
            SkeletonChange::Inserted(joint) => {
                prop_assert_eq!(with_bone.clip.skeleton().len(), clip.skeleton().len() + 1);
                prop_assert!(apart(&clip, &with_bone.clip, Some(joint)) < 1e-5 * size);
                let back = fold_root_bone(&with_bone.clip).unwrap();
                // A bone that never moves cannot be told from any still joint.
                prop_assume!(root_bone(&with_bone.clip) == Some(joint));
                prop_assert_eq!(back.skeleton, SkeletonChange::Removed(joint));
                prop_assert_eq!(back.clip.skeleton().joints(), clip.skeleton().joints());
                prop_assert!(apart(&clip, &back.clip, None) < 1e-5 * size);
                prop_assert!(turned_apart(&clip, &back.clip) < 1e-5);
            }
            SkeletonChange::Kept(_) => prop_assert_eq!(with_bone.clip.skeleton(), clip.skeleton()),
            SkeletonChange::Removed(_) => prop_assert!(false, "adding takes nothing away"),
        }
    }

    #[test]
    fn in_place_keeps_every_pose_and_goes_nowhere(clip in clips()) {
        let still = in_place(&clip, &options()).unwrap();
        let joint = clip.travel_joint();
        let (before, after) =
            (kinematics::positions(&clip), kinematics::positions(&still));
        let above = clip.skeleton().ancestors(joint);
        for frame in 0..clip.frames() {
            let (a, b) = (before.frame(frame), after.frame(frame));
            for index in (0..a.len()).filter(|index| !above[*index]) {
                let moved = (a[index] - a[joint]).distance(b[index] - b[joint]);
                prop_assert!(moved < 1e-5, "frame {frame}, joint {index}: {moved}");
            }
            prop_assert!((a[joint].y - b[joint].y).abs() < 1e-5, "height stays");
        }
        prop_assert!(turned_apart(&clip, &still) < 1e-5, "turning stays");
        let travel = Trajectory::of(&still, &options());
        let way = travel.path.iter().map(|place| place.distance(travel.path[0])).fold(0.0, f64::max);
        let whole = Trajectory::of(&clip, &options()).length();
        prop_assert!(way <= 0.05 * whole + 0.02, "still {way} m of {whole} m");
    }
}

#[test]
fn sway_and_bob_stay_in_place() {
    let clip = walker(180, 0.0);
    let still = in_place(&clip, &options()).unwrap();
    let places = still.track(0).unwrap();
    let middle = &places[40..140];
    let spread = |value: fn(&Vec3) -> f32| {
        let values = middle.iter().map(value);
        values.clone().fold(f32::MIN, f32::max) - values.fold(f32::MAX, f32::min)
    };
    assert!((0.05..0.07).contains(&spread(|p| p.x)), "sway of 6 cm: {}", spread(|p| p.x));
    assert!((0.035..0.045).contains(&spread(|p| p.y)), "bob of 4 cm: {}", spread(|p| p.y));
    assert!(spread(|p| p.z) < 0.01, "no travel: {}", spread(|p| p.z));
    assert_eq!(places[0].y, clip.track(0).unwrap()[0].y);
}

#[test]
fn a_bone_stands_on_the_ground_and_turns_with_the_walk() {
    let clip = walker(180, 0.5);
    let bone = add_root_bone(&clip, &options()).unwrap();
    assert_eq!(bone.skeleton, SkeletonChange::Inserted(0));
    let joints = bone.clip.skeleton().joints();
    assert_eq!((joints[0].name.as_str(), joints[1].parent), ("root", Some(0)));
    let values = bone.clip.track(0).unwrap();
    assert!(values.iter().all(|place| place.y == 0.0));
    for frame in [60, 90, 120] {
        let heading = yaw(bone.clip.rotations(frame)[0]);
        assert!((heading - 0.5 * frame as f32 / 30.0).abs() < 0.01, "frame {frame}: {heading}");
        let hips = bone.clip.track(1).unwrap()[frame];
        assert!(hips.x.abs() < 0.06 && hips.z.abs() < 0.05, "the hips keep their sway only: {hips}");
    }
    // Again: nothing to do. In place now holds the bone still, and the hips' sway is what it was.
    assert_eq!(add_root_bone(&bone.clip, &options()).unwrap().skeleton, SkeletonChange::Kept(Some(0)));
    let still = in_place(&bone.clip, &options()).unwrap();
    assert!(still.track(0).unwrap().iter().all(|place| place.distance(values[0]) < 1e-6));
    assert_eq!(still.track(1), bone.clip.track(1));
}

#[test]
fn without_smoothing_the_bone_stands_right_under_the_hips() {
    let clip = walker(60, 0.0);
    let raw = TravelOptions { smoothing_seconds: 0.0, ..options() };
    let bone = add_root_bone(&clip, &raw).unwrap();
    let hips = bone.clip.track(1).unwrap();
    assert!(hips.iter().all(|place| place.x.abs() < 1e-6 && place.z.abs() < 1e-6 && place.y > 0.8));
}

/// As capture systems write it: a root that stays at the origin, and hips that travel below it.
fn still_root(frames: usize) -> Clip {
    let walk = walker(frames, 0.3);
    let mut joints = vec![Joint::new("Armature", None, Vec3::ZERO)];
    joints.extend(
        walk.skeleton().joints().iter().map(|joint| Joint {
            parent: Some(joint.parent.map_or(0, |parent| parent + 1)),
            ..joint.clone()
        }),
    );
    let rotations =
        (0..frames).flat_map(|frame| [&[Quat::IDENTITY], walk.rotations(frame)].concat()).collect();
    let tracks = vec![
        TranslationTrack { joint: 0, values: vec![Vec3::ZERO; frames] },
        TranslationTrack { joint: 1, values: walk.track(0).unwrap().to_vec() },
    ];
    Clip::new(Arc::new(Skeleton::new(joints).unwrap()), 30.0, rotations, tracks).unwrap()
}

#[test]
fn a_still_root_becomes_the_bone_and_stands_still_again() {
    let clip = still_root(120);
    let bone = add_root_bone(&clip, &options()).unwrap();
    assert_eq!(bone.skeleton, SkeletonChange::Kept(Some(0)), "no joint is put in");
    assert_eq!(bone.clip.travel_joint(), 0);
    let back = fold_root_bone(&bone.clip).unwrap();
    assert_eq!(back.skeleton, SkeletonChange::Kept(Some(0)), "nor taken out");
    assert!(apart(&clip, &back.clip, None) < 1e-5);
    assert_eq!(back.clip.travel_joint(), 1);
    assert_eq!(fold_root_bone(&clip).unwrap().skeleton, SkeletonChange::Kept(None));
}

#[test]
fn a_taken_name_gets_a_number() {
    let walk = walker(90, 0.0);
    let joints = walk.skeleton().joints().iter().map(|joint| Joint {
        name: if joint.parent.is_none() { "Root".into() } else { joint.name.clone() },
        ..joint.clone()
    });
    let skeleton = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let rotations = (0..90).flat_map(|frame| walk.rotations(frame).to_vec()).collect();
    let clip = Clip::new(skeleton, 30.0, rotations, walk.translations().to_vec()).unwrap();
    let bone = add_root_bone(&clip, &options()).unwrap();
    assert_eq!(bone.clip.skeleton().joints()[0].name, "root_2");
    assert_eq!(fold_root_bone(&bone.clip).unwrap().clip.skeleton(), clip.skeleton());
}

#[test]
fn a_loop_in_place_has_no_seam() {
    // Six whole steps on a circle: the frame after the last is the first, further on.
    let clip = walker(180, std::f32::consts::TAU / 6.0);
    let seam = |options: &TravelOptions| {
        let still = in_place(&clip, options).unwrap();
        let places = still.track(0).unwrap();
        places[0].distance(places[179])
    };
    let step = 0.03 * std::f32::consts::TAU / 30.0 + 0.001;
    assert!(seam(&TravelOptions { cyclic: true, ..options() }) < step);
    assert!(seam(&options()) > 2.0 * step, "an open clip knows nothing of its other end");
}
