//! Bodies are found in the skeletons of real files.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may panic, and prints")]

mod common;

use inkrig_formats::{ImportOptions, no_files, read_amc, read_bvh, read_deepmimic, read_gltf};
use inkrig_motion::rig::{Body, Humanoid, NoBody, Part, Side};
use inkrig_motion::{Clip, Joint, Skeleton, humanml};
use std::path::PathBuf;

/// Every clip of the reference folder that can be read, with its path.
fn people(extension: &str) -> Option<Vec<(PathBuf, Clip)>> {
    let files = common::reference_files(extension)?;
    let clip = |path: PathBuf| {
        let bytes = std::fs::read(&path).unwrap();
        let read = if extension == "amc" {
            let beside =
                std::fs::read_dir(path.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path());
            let skeleton =
                beside.into_iter().find(|path| path.extension().is_some_and(|extension| extension == "asf"));
            let skeleton = Some(std::fs::read(skeleton.unwrap()).unwrap());
            read_amc(&bytes, &ImportOptions { skeleton, frame_rate: Some(60.0), ..ImportOptions::default() })
        } else {
            read_bvh(&bytes, &ImportOptions::default())
        };
        let clip = read.unwrap_or_else(|error| panic!("{}: {error}", path.display())).clip;
        (path, clip)
    };
    Some(files.into_iter().map(clip).collect())
}

#[test]
fn every_person_among_the_reference_files_is_found_and_becomes_22_joints() {
    for extension in ["bvh", "amc"] {
        let Some(people) = people(extension) else { return };
        let count = people.len();
        assert!(count > 300);
        let (mut frames, mut standing, mut height, mut backwards) = (0, 0.0, 0.0, 0);
        let mut target = None;
        for (path, clip) in people {
            let name = path.display();
            let body = Humanoid::find(clip.skeleton()).unwrap_or_else(|error| panic!("{name}: {error}"));
            for side in Side::BOTH {
                for part in [Part::Foot, Part::Hand, Part::Head, Part::Spine, Part::Clavicle] {
                    assert!(body.joint(part, side).is_some(), "{name}: no {part:?}");
                }
            }
            let joints = humanml::from_clip(&clip, &body);
            let target = target.get_or_insert_with(|| {
                let lengths = humanml::bone_lengths(&joints[0]);
                let leg = lengths[4].length() + lengths[7].length();
                // One body for all, with legs of .8 m.
                lengths.map(|offset| offset * (0.8 / leg))
            });
            if joints.len() < 2 {
                continue;
            }
            let features = humanml::features(&humanml::ground(&humanml::uniform(&joints, target))).unwrap();
            let back = humanml::recover_positions(&features).unwrap();
            frames += features.frames();
            let mut forward = 0.0;
            for (row, joints) in (0..features.frames()).map(|frame| features.row(frame)).zip(&back) {
                standing += f64::from(row[humanml::Blocks::CONTACTS].iter().sum::<f32>()) / 4.0;
                height += f64::from(row[humanml::Blocks::HEIGHT]);
                assert!(joints[1].distance(joints[2]) > 0.03, "{name}: hips in one place");
                // In the facing frame: the place of a joint is 4 + 3 (joint - 1) + axis.
                let ahead = |joint: usize| row[4 + 3 * (joint - 1) + 2];
                forward += ahead(10) - ahead(7) + ahead(11) - ahead(8);
            }
            // Facing comes from left and right: were they exchanged, feet would point backwards. Of those who stand; in a
            // kick or a run feet may point down and back.
            let stands = back.iter().map(|joints| joints[0].y).fold(f32::INFINITY, f32::min) > 0.7;
            backwards += usize::from(stands && forward < 0.0);
        }
        let (standing, height) = (standing / frames as f64, height / frames as f64);
        println!(
            "{count} {extension} files, {frames} frames: feet stand {standing:.2} of the time, root at {height:.2} m"
        );
        assert!(backwards < count / 25, "{backwards} of {count} face backwards");
        assert!((0.6..0.95).contains(&standing) && (0.7..1.1).contains(&height));
    }
}

/// What stands in a file of the folder `creatures`, `kaykit` or `deepmimic`.
#[derive(Debug, PartialEq)]
enum Kind {
    Person,
    FourLegs,
    Neither,
}

#[test]
fn animals_are_told_from_people() {
    let kinds = [
        ("bird-animations.glb", Kind::Neither),
        ("cow.glb", Kind::FourLegs),
        ("fox-animations.glb", Kind::FourLegs),
        ("horse-animations.glb", Kind::FourLegs),
        ("human-farmer.glb", Kind::Person),
        ("human-model.glb", Kind::Person),
        ("human-punk.glb", Kind::Person),
        ("human-woman.glb", Kind::Person),
        ("human-worker.glb", Kind::Person),
        ("shibainu.glb", Kind::FourLegs),
        ("snake-animations.glb", Kind::Neither),
        ("stag.glb", Kind::FourLegs),
        ("wolf.glb", Kind::FourLegs),
    ];
    let Some(files) = common::reference_files("glb") else { return };
    let mut seen = 0;
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        let Ok(import) = read_gltf(&bytes, &ImportOptions::default(), &no_files) else { continue };
        let name = path.file_name().unwrap().to_str().unwrap();
        let skeleton = import.clip.skeleton();
        let found = match Body::find(skeleton) {
            Ok(Body::Humanoid(_)) => Kind::Person,
            Ok(Body::Quadruped(body)) => {
                let joint = |joint: &usize| skeleton.joints()[*joint].name.clone();
                let names = |joints: &[usize]| joints.iter().map(joint).collect::<Vec<_>>().join(" ");
                println!("{name}: hips {}, spine {}", joint(&body.hips), names(&body.spine));
                println!("  neck {}, head {:?}", names(&body.neck), body.head.map(|head| joint(&head)));
                for leg in [&body.fore[0], &body.hind[1]] {
                    println!("  [{}] {} detached {:?}", names(&leg.girdle), names(&leg.joints), leg.detached);
                }
                println!(
                    "  tail {}, ears {:?}",
                    names(&body.tail),
                    body.ears.as_ref().map(|ears| names(&ears[0]))
                );
                let ears = ["fox", "horse", "shiba", "wolf"].iter().any(|eared| name.starts_with(eared));
                assert_eq!(body.ears.is_some(), ears, "{name}");
                assert!(body.head.is_some() && !body.tail.is_empty() && !body.neck.is_empty(), "{name}");
                assert_eq!(Humanoid::find(skeleton), Err(NoBody::FourLegs), "{name}");
                Kind::FourLegs
            }
            Err(_) => Kind::Neither,
        };
        let expected = kinds.iter().find(|kind| kind.0 == name).map_or(&Kind::Person, |kind| &kind.1);
        assert_eq!(&found, expected, "{name}");
        seen += 1;
    }
    assert!(seen >= kinds.len(), "{seen}");
    let Some(motions) = common::reference_files("txt") else { return };
    for path in motions.iter().filter(|path| path.parent().is_some_and(|folder| folder.ends_with("motions")))
    {
        let name = path.file_name().unwrap().to_str().unwrap();
        let skeleton = path.parent().unwrap().join("..").join(if name.starts_with("dog") {
            "dog3d.txt"
        } else {
            "humanoid3d.txt"
        });
        let skeleton = Some(std::fs::read(skeleton).unwrap());
        let options = ImportOptions { skeleton, ..ImportOptions::default() };
        let clip = read_deepmimic(&std::fs::read(path).unwrap(), &options).unwrap().clip;
        let found = Body::find(clip.skeleton()).unwrap();
        assert_eq!(matches!(found, Body::Quadruped(_)), name.starts_with("dog"), "{name}");
    }
}

#[test]
fn bodies_are_found_when_names_say_nothing() {
    let Some(files) = common::reference_files("glb") else { return };
    let mut people = 0;
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        let Ok(import) = read_gltf(&bytes, &ImportOptions::default(), &no_files) else { continue };
        let skeleton = import.clip.skeleton();
        let Ok(named) = Body::find(skeleton) else { continue };
        let joints = skeleton.joints().iter().enumerate();
        let nameless = joints.map(|(index, joint)| Joint { name: format!("bone_{index}"), ..joint.clone() });
        let nameless = Skeleton::new(nameless.collect()).unwrap();
        let found = Body::find(&nameless);
        let name = path.display();
        match (&named, &found) {
            (Body::Humanoid(named), Ok(Body::Humanoid(found))) => {
                people += 1;
                assert_eq!(
                    (found.hips, &found.legs.map(|leg| (leg.upper, leg.lower, leg.foot))),
                    (named.hips, &named.legs.map(|leg| (leg.upper, leg.lower, leg.foot))),
                    "{name}"
                );
                assert_eq!((&found.spine, found.head), (&named.spine, named.head), "{name}");
                for (found, named) in found.arms.iter().zip(&named.arms) {
                    let (found, named) = (found.unwrap(), named.unwrap());
                    assert_eq!(
                        (found.upper, found.lower, found.hand),
                        (named.upper, named.lower, named.hand),
                        "{name}"
                    );
                }
            }
            (Body::Quadruped(named), Ok(Body::Quadruped(found))) => {
                assert_eq!(found.hips, named.hips, "{name}");
                for (found, named) in
                    found.fore.iter().chain(&found.hind).zip(named.fore.iter().chain(&named.hind))
                {
                    assert_eq!(found.hip_knee_foot(), named.hip_knee_foot(), "{name}");
                }
            }
            _ => panic!("{name}: {named:?} without names {found:?}"),
        }
    }
    assert!(people > 5);
}
