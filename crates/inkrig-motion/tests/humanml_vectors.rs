//! The HumanML3D form agrees with stored results of its authors' code, where those are at hand.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may panic, and prints its figures"
)]

use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{self, Blocks, Camera, JOINTS, Joints, Statistics, WIDTH};
use safetensors::{Dtype, SafeTensors};
use std::path::PathBuf;

/// A file of the reference folder; `None`, said in one line, where that is not there.
fn vectors(name: &str) -> Option<Vec<u8>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("vectors/sketch2anim").join(name).with_extension("safetensors");
    match std::fs::read(&file) {
        Ok(bytes) => Some(bytes),
        Err(error) => {
            assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{}: {error}", file.display());
            println!("skipped: no reference vectors at {}", file.display());
            None
        }
    }
}

fn numbers(bytes: &[u8], name: &str) -> Vec<f32> {
    let file = SafeTensors::deserialize(bytes).unwrap();
    let tensor = file.tensor(name).unwrap();
    match tensor.dtype() {
        Dtype::F32 => {
            tensor.data().chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
        }
        Dtype::F64 => {
            tensor.data().chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()) as f32).collect()
        }
        other => panic!("{name} is {other:?}"),
    }
}

fn joints(values: &[f32]) -> Vec<Joints> {
    let frames = values.chunks_exact(3 * JOINTS);
    frames.map(|frame| std::array::from_fn(|joint| Vec3::from_slice(&frame[3 * joint..]))).collect()
}

/// The largest distance between two motions, metres.
fn apart(a: &[Joints], b: &[Joints]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

fn largest(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn motion_of_anybody_becomes_the_stored_features() {
    let Some(bytes) = vectors("humanml_process") else { return };
    let body = joints(&numbers(&bytes, "tgt_offsets"))[0];
    let uniform = humanml::uniform(&joints(&numbers(&bytes, "joints_in")), &body);
    let off = apart(&uniform, &joints(&numbers(&bytes, "uniform_skeleton")));
    println!("uniform body: {off:.1e} m apart at most");
    assert!(off < 2e-6);
    let placed = humanml::ground(&uniform);
    let off = apart(&placed, &joints(&numbers(&bytes, "global_positions")));
    println!("placed: {off:.1e} m");
    assert!(off < 2e-6);
    let features = humanml::features(&placed).unwrap();
    let stored = numbers(&bytes, "features");
    assert_eq!(features.frames() * WIDTH, stored.len());
    for block in Blocks::ALL {
        let pick = |values: &[f32]| -> Vec<f32> {
            values.chunks_exact(WIDTH).flat_map(|row| row[block.clone()].to_vec()).collect()
        };
        let off = largest(&pick(features.as_slice()), &pick(&stored));
        println!("columns {block:?}: {off:.1e}");
        assert!(off < 2e-5, "columns {block:?}: {off}");
    }
}

#[test]
fn features_become_the_stored_positions() {
    let Some(bytes) = vectors("recover") else { return };
    let features = Features::new(numbers(&bytes, "vec_012314"), WIDTH).unwrap();
    let off =
        apart(&humanml::recover_positions(&features).unwrap(), &joints(&numbers(&bytes, "joints_from_ric")));
    println!("by places: {off:.1e} m apart at most");
    assert!(off < 2e-5);
    let Some(rotated) = vectors("recover_rot") else { return };
    let features = Features::new(numbers(&rotated, "features"), WIDTH).unwrap();
    let off = apart(
        &humanml::recover_positions(&features).unwrap(),
        &joints(&numbers(&rotated, "joints_from_ric")),
    );
    assert!(off < 2e-5, "{off}");
    let path = humanml::root_path(&features).unwrap();
    let flat: Vec<f32> = path.places.iter().flat_map(Vec3::to_array).collect();
    let off = largest(&flat, &numbers(&rotated, "root_pos"));
    println!("root's path: {off:.1e} m");
    assert!(off < 2e-5);
    let turns: Vec<f32> = path.turns.iter().flat_map(|turn| [turn.w, turn.x, turn.y, turn.z]).collect();
    assert!(largest(&turns, &numbers(&rotated, "root_quat")) < 1e-5);
    let Some(process) = vectors("humanml_process") else { return };
    let body = joints(&numbers(&process, "tgt_offsets"))[0];
    let by_bones = humanml::recover_bones(&features, &body).unwrap();
    let off = apart(&by_bones, &joints(&numbers(&rotated, "joints_from_rot")));
    println!("by rotations: {off:.1e} m");
    assert!(off < 2e-5);
}

#[test]
fn key_points_are_seen_and_normalised_as_stored() {
    let (Some(bytes), Some(recover)) = (vectors("projection"), vectors("recover")) else { return };
    let seen: Vec<Joints> = joints(&numbers(&bytes, "joints_in")).iter().map(humanml::augment).collect();
    assert!(apart(&seen, &joints(&numbers(&bytes, "joints_after_convert"))) < 1e-6);
    let camera = Camera::default();
    let flat: Vec<f32> =
        seen.iter().flatten().flat_map(|joint| camera.project(*joint).extend(1.0).to_array()).collect();
    let off = largest(&flat, &numbers(&bytes, "joints_2d"));
    println!("projection: {off:.1e} m");
    assert!(off < 1e-5);
    let statistics = Statistics::new(numbers(&recover, "mean_raw"), numbers(&recover, "std_raw")).unwrap();
    let mut rows: Vec<f32> = seen.iter().flatten().flat_map(Vec3::to_array).collect();
    statistics.normalise(&mut rows);
    assert!(largest(&rows, &numbers(&bytes, "norm_3d")) < 1e-4);
}

#[test]
fn a_stored_motion_becomes_a_clip_that_a_rig_can_use() {
    let Some(bytes) = vectors("humanml_process") else { return };
    let body = joints(&numbers(&bytes, "tgt_offsets"))[0];
    let wanted = joints(&numbers(&bytes, "global_positions"));
    let skeleton = std::sync::Arc::new(humanml::skeleton(&body, &wanted).unwrap());
    let clip = humanml::to_clip(&wanted, &skeleton, humanml::FRAME_RATE).unwrap();
    let positions = inkrig_motion::kinematics::positions(&clip);
    let mut off: Vec<f32> = (0..clip.frames())
        .flat_map(|frame| {
            positions.frame(frame).iter().zip(&wanted[frame]).map(|(a, b)| a.distance(*b)).collect::<Vec<_>>()
        })
        .collect();
    off.sort_by(f32::total_cmp);
    let (mean, largest) = (off.iter().sum::<f32>() / off.len() as f32, off[off.len() - 1]);
    let steps = (1..clip.frames()).flat_map(|frame| {
        let pairs = clip.rotations(frame).iter().zip(clip.rotations(frame - 1));
        pairs.map(|(a, b)| a.angle_between(*b).to_degrees()).collect::<Vec<_>>()
    });
    let fastest = steps.fold(0.0, f32::max);
    let bone = |frame: usize, joint: usize| wanted[frame][joint] - wanted[frame][humanml::PARENTS[joint]];
    let mut fastest_bone = 0.0_f32;
    for (frame, joint) in (1..wanted.len()).flat_map(|frame| (1..JOINTS).map(move |joint| (frame, joint))) {
        let swing = bone(frame, joint).angle_between(bone(frame - 1, joint));
        fastest_bone = fastest_bone.max(swing.to_degrees());
    }
    println!(
        "clip: {:.1} mm apart on average, {:.1} mm at most; at most {fastest:.0} degrees a frame, bones {fastest_bone:.0}",
        1e3 * mean,
        1e3 * largest
    );
    assert!(mean < 2e-4 && largest < 1e-3 && fastest < fastest_bone + 10.0);
    // Knees bend about their own x axis: hinges.
    for knee in [4, 5] {
        for frame in 0..clip.frames() {
            let (axis, angle) = clip.rotations(frame)[knee].to_axis_angle();
            if angle > 0.6 {
                assert!(axis.x > 0.8, "knee {knee} bends about {axis} at frame {frame}");
            }
        }
    }
}
