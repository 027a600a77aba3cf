//! Feet on the floor, on walks of the reference folder: real feet hardly need it.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may panic, and prints its figures"
)]

mod common;

use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, Joints, from_clip, keep_footing};
use inkrig_motion::rig::Body;

#[test]
fn real_walks_are_nearly_left_alone() {
    let Some(files) = common::reference_files("bvh") else { return };
    for walk in ["35_15.bvh", "12_02.bvh"] {
        let path = files.iter().find(|path| path.ends_with(walk)).unwrap();
        let clip = read_bvh(&std::fs::read(path).unwrap(), &ImportOptions::default()).unwrap().clip;
        let Ok(Body::Humanoid(body)) = Body::find(clip.skeleton()) else { panic!("{walk} is a person's") };
        // Without the T-pose at its beginning.
        let frames: Vec<Joints> = from_clip(&clip, &body).into_iter().skip(20).take(100).collect();
        let footing = keep_footing(&frames, &[], FRAME_RATE, &[]).unwrap();
        assert!(footing.airborne.iter().all(|airborne| !airborne), "{walk}: a walk is not in the air");
        let height = |moved: &Vec3| moved.y;
        let mean = footing.moved.iter().map(height).sum::<f32>() / footing.moved.len() as f32;
        let wanders = footing.moved.iter().map(|moved| (moved.y - mean).abs()).fold(0.0, f32::max);
        let travels = footing.moved.iter().map(|moved| moved.with_y(0.0).length()).fold(0.0, f32::max);
        let mut limbs: Vec<f32> = (footing.frames.iter().zip(&frames).zip(&footing.moved))
            .flat_map(|((own, before), moved)| {
                own.iter().zip(before).map(|(own, before)| own.distance(*before + *moved)).collect::<Vec<_>>()
            })
            .collect();
        limbs.sort_by(f32::total_cmp);
        let [middle, p95] = [limbs.len() / 2, limbs.len() * 95 / 100].map(|at| limbs[at]);
        println!(
            "{walk}: floor {:.0} mm off, bent by {:.0} mm at most; travel changed by {:.0} mm at most; joints in the body: \
             median {:.1} mm, P95 {:.0} mm",
            -1e3 * mean,
            1e3 * wanders,
            1e3 * travels,
            1e3 * middle,
            1e3 * p95
        );
        assert!(wanders < 0.03 && travels < 0.1 && middle < 0.008 && p95 < 0.05, "{walk}");
    }
}
