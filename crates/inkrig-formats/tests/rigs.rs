//! Bodies are found in the skeletons of real files.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may panic, and prints")]

mod common;

use inkrig_formats::{ImportOptions, read_amc, read_bvh};
use inkrig_motion::rig::{Humanoid, Part, Side};
use inkrig_motion::{Clip, humanml};
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
