//! Real motion on real characters: bones point where the source's do, feet that stand do not slide.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may panic, and prints")]

mod common;

use inkrig_formats::{ImportOptions, read_bvh, read_deepmimic, read_gltf};
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use inkrig_motion::rig::{Humanoid, Part, Side};
use inkrig_motion::{Clip, kinematics};

fn find(extension: &str, end: &str) -> Option<Vec<u8>> {
    let files = common::reference_files(extension)?;
    Some(std::fs::read(files.iter().find(|path| path.ends_with(end)).unwrap()).unwrap())
}

fn bvh(end: &str) -> Option<Clip> {
    Some(read_bvh(&find("bvh", end)?, &ImportOptions::default()).unwrap().clip)
}

fn human() -> Option<Clip> {
    let bytes = find("glb", "human-model.glb")?;
    Some(read_gltf(&bytes, &ImportOptions::default(), &inkrig_formats::no_files).unwrap().clip)
}

fn deepmimic(name: &str) -> Option<Clip> {
    let skeleton = Some(find("txt", "humanoid3d.txt")?);
    let motion = find("txt", name)?;
    Some(read_deepmimic(&motion, &ImportOptions { skeleton, ..ImportOptions::default() }).unwrap().clip)
}

fn at(sorted: &[f32], share: f64) -> f32 {
    sorted.get(((sorted.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(0.0)
}

#[test]
fn people_walk_on_other_peoples_bodies() {
    let (Some(walk), Some(human)) = (bvh("35/35_01.bvh"), human()) else { return };
    let (Some(jog), Some(bandai)) = (deepmimic("humanoid3d_walk.txt"), bvh("dataset-1_walk_normal_001.bvh"))
    else {
        return;
    };
    let Some(salsa) = bvh("salsa/01.bvh") else { return };
    let salsa = inkrig_motion::time::trim(&salsa, 2..600).unwrap();
    let cases = [
        ("CMU walk on the human model", &walk, &human),
        ("CMU salsa on the human model", &salsa, &human),
        ("DeepMimic walk on CMU", &jog, &walk),
        ("Bandai walk on the human model", &bandai, &human),
        ("CMU walk on the salsa dancer", &walk, &salsa),
        ("CMU walk on the Bandai figure", &walk, &bandai),
        ("DeepMimic walk on the Bandai figure", &jog, &bandai),
    ];
    for (name, source, target) in cases {
        let options = RetargetOptions { stance: standing_pose(target), ..RetargetOptions::default() };
        let moved = retarget(source, target.skeleton(), &options).unwrap();
        let certificate = Certificate::of(source, &moved).unwrap();
        println!(
            "{name}: scale {:.2}, {} joints keep their rest, {} contacts",
            certificate.scale,
            certificate.unmapped.len(),
            certificate.contacts
        );
        for (what, spread) in [
            ("direction, degrees", certificate.direction),
            ("slide, mm a frame", certificate.slide),
            ("below the ground, mm", certificate.penetration),
        ] {
            println!("  {what}: mean {:.2}, P95 {:.2}, max {:.2}", spread.mean, spread.p95, spread.max);
        }
        assert_eq!(certificate.broken(&CertificateLimits::default()), [], "{name}");
        assert!(certificate.contacts > 0, "{name}");
        assert_eq!(moved.clip.frames(), source.frames());
    }
}

#[test]
fn a_motion_comes_back_from_another_body_as_it_was() {
    let (Some(walk), Some(human)) = (bvh("35/35_01.bvh"), human()) else { return };
    let options = RetargetOptions { keep_feet: false, ..RetargetOptions::default() };
    let there = retarget(&walk, human.skeleton(), &options).unwrap();
    let back = retarget(&there.clip, walk.skeleton(), &options).unwrap();
    let body = Humanoid::find(walk.skeleton()).unwrap();
    let (a, b) = (kinematics::positions(&walk), kinematics::positions(&back.clip));
    let mut off = Vec::new();
    for frame in 0..walk.frames() {
        // Relative to the hips: where the ground is, is guessed anew each time.
        let (own, other) = (a.frame(frame), b.frame(frame));
        for (part, side) in [Part::Foot, Part::LowerLeg, Part::LowerArm, Part::Hand, Part::Head]
            .into_iter()
            .flat_map(|part| Side::BOTH.map(|side| (part, side)))
        {
            let joint = body.joint(part, side).unwrap();
            off.push((own[joint] - own[body.hips]).distance(other[joint] - other[body.hips]));
        }
    }
    off.sort_by(f32::total_cmp);
    println!(
        "there and back: P95 {:.1} mm, scales {:.3} and {:.3}",
        1e3 * at(&off, 0.95),
        there.scale,
        back.scale
    );
    assert!(at(&off, 0.95) < 0.02);
    assert!((there.scale * back.scale - 1.0).abs() < 0.02);
}

#[test]
fn what_is_no_person_is_said() {
    let Some(walk) = bvh("35/35_01.bvh") else { return };
    let bytes = find("glb", "wolf.glb").unwrap();
    let wolf = read_gltf(&bytes, &ImportOptions::default(), &inkrig_formats::no_files).unwrap().clip;
    let error = retarget(&walk, wolf.skeleton(), &RetargetOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("the character's skeleton: it stands on four legs"), "{error}");
}
