//! Real motion on real characters: bones point where the source's do, feet that stand do not slide.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may panic, and prints")]

mod common;

use inkrig_formats::{ClipChoice, ImportOptions, read_bvh, read_deepmimic, read_gltf};
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use inkrig_motion::rig::{Body, Humanoid, Part, QuadrupedLeg, Side};
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

fn glb(end: &str, clip: Option<&str>) -> Option<Clip> {
    let clip = clip.map(|name| ClipChoice::Name(name.into()));
    let options = ImportOptions { clip, ..ImportOptions::default() };
    Some(read_gltf(&find("glb", end)?, &options, &inkrig_formats::no_files).unwrap().clip)
}

/// Carries over, prints what was measured, and holds it against the limits.
fn gate(name: &str, source: &Clip, target: &Clip) -> Certificate {
    let options = RetargetOptions { stance: standing_pose(target), ..RetargetOptions::default() };
    let moved = retarget(source, target.skeleton(), &options).unwrap();
    assert_eq!(moved.clip.frames(), source.frames());
    let certificate = Certificate::of(source, &moved);
    println!(
        "{name}: scale {:.2}, {} joints keep their rest, {} contacts, on the spot: {}",
        certificate.scale,
        certificate.unmapped.len(),
        certificate.contacts,
        certificate.on_the_spot
    );
    for (what, spread) in [
        ("direction, degrees", certificate.direction),
        ("trunk, degrees", certificate.trunk),
        ("across, degrees", certificate.across),
        ("slide, mm a frame", certificate.slide),
        ("floating, mm", certificate.floating),
        ("below the ground, mm", certificate.penetration),
        ("drift, mm", certificate.drift),
        ("position, mm", certificate.position),
    ] {
        println!("  {what}: mean {:.2}, P95 {:.2}, max {:.2}", spread.mean, spread.p95, spread.max);
    }
    for hinge in &certificate.hinges {
        println!("  {:?} {:?}: {:?} from {:?}", hinge.side, hinge.part, hinge.result, hinge.source);
    }
    let mut worst: Vec<_> =
        certificate.limbs.iter().map(|limb| (limb.degrees.p95, limb.bone.as_str())).collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("  worst bones: {:.1?}", &worst[..worst.len().min(4)]);
    let places = kinematics::positions(&moved.clip);
    let deep = (0..places.frames()).flat_map(|frame| moved.pairs.iter().map(move |pair| (frame, pair.0)));
    let deepest = deep.min_by(|a, b| places.frame(a.0)[a.1].y.total_cmp(&places.frame(b.0)[b.1].y)).unwrap();
    println!("  deepest: {} at {}", target.skeleton().joints()[deepest.1].name, deepest.0);
    println!("  broken: {:?}", certificate.broken(&CertificateLimits::default()));
    certificate
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
    let mut broken = Vec::new();
    for (name, source, target) in cases {
        let certificate = gate(name, source, target);
        broken.extend(
            certificate.broken(&CertificateLimits::default()).into_iter().map(|broken| (name, broken)),
        );
        assert!(certificate.contacts > 0, "{name}");
    }
    assert_eq!(broken, []);
}

#[test]
fn animals_move_as_other_animals_do() {
    let Some(fox) = glb("fox-animations.glb", Some("Walk")) else { return };
    let mut broken = Vec::new();
    let mut hold = |name: &str, source: &Clip, target: &Clip| {
        let certificate = gate(name, source, target);
        assert!(certificate.contacts > 0, "{name}");
        broken.extend(
            certificate
                .broken(&CertificateLimits::default())
                .into_iter()
                .map(|broken| (name.to_string(), broken)),
        );
    };
    for clip in ["Attack", "Idle", "Eating", "Walk", "Gallop", "Gallop_Jump"] {
        let wolf = glb("wolf.glb", Some(&format!("AnimalArmature|{clip}"))).unwrap();
        hold(&format!("wolf, {clip}, on the fox"), &wolf, &fox);
    }
    let horse = glb("horse-animations.glb", Some("Walk")).unwrap();
    hold("horse, Walk, on the fox", &horse, &fox);
    // The paws of this rig stand under roots of their own.
    hold("fox, Walk, on the shiba inu", &fox, &glb("shibainu.glb", None).unwrap());
    assert_eq!(broken, []);
}

/// All clips of six animals on each of the six. What falls, sleeps or sits on a body of other build goes into the ground,
/// and the certificate says so.
#[test]
fn most_clips_of_animals_suit_all_other_animals() {
    let names = ["cow", "fox-animations", "horse-animations", "shibainu", "stag", "wolf"];
    let mut clips: Vec<(String, Clip)> = Vec::new();
    let mut targets: Vec<(&str, Clip)> = Vec::new();
    for name in names {
        let Some(bytes) = find("glb", &format!("{name}.glb")) else { return };
        let read = |clip| {
            let options = ImportOptions { clip, ..ImportOptions::default() };
            read_gltf(&bytes, &options, &inkrig_formats::no_files).unwrap()
        };
        let first = read(None);
        for (number, clip) in first.clips.iter().enumerate() {
            let named = format!("{name} {}", clip.name.rsplit('|').next().unwrap());
            clips.push((named, read(Some(ClipChoice::Number(number + 1))).clip));
        }
        targets.push((name, first.clip));
    }
    let (mut all, mut kept) = (0, 0);
    for (name, target) in &targets {
        let options = RetargetOptions { stance: standing_pose(target), ..RetargetOptions::default() };
        for (clip, source) in &clips {
            let moved = retarget(source, target.skeleton(), &options).unwrap();
            let broken = Certificate::of(source, &moved).broken(&CertificateLimits::default());
            all += 1;
            kept += usize::from(broken.is_empty());
            let what: Vec<String> =
                broken.iter().map(|broken| format!("{} {:.1}", broken.what, broken.value)).collect();
            if !what.is_empty() {
                println!("{clip} on {name}: {}", what.join("; "));
            }
        }
    }
    println!("{kept} of {all} keep all limits");
    assert!(20 * kept >= 17 * all, "{kept} of {all}");
}

/// The half of the pelvis that turns about its own length in the wolf is a long bone to the rear in the fox.
#[test]
fn hips_stay_level_whatever_their_girdles_look_like() {
    let Some(fox) = glb("fox-animations.glb", Some("Walk")) else { return };
    let wolf = glb("wolf.glb", Some("AnimalArmature|Walk")).unwrap();
    let moved = retarget(&wolf, fox.skeleton(), &RetargetOptions::default()).unwrap();
    let Ok(Body::Quadruped(body)) = Body::find(fox.skeleton()) else { panic!("no fox") };
    let places = kinematics::positions(&moved.clip);
    for legs in [&body.hind, &body.fore] {
        let tilt = |frame: usize| {
            (places.frame(frame)[legs[0].joints[0]].y - places.frame(frame)[legs[1].joints[0]].y).abs()
        };
        let most = (0..wolf.frames()).map(tilt).fold(0.0, f32::max);
        println!("hips or shoulders: one at most {:.0} mm above the other", 1e3 * most);
        assert!(most < 0.05);
    }
    // On the spot paws stand while they go back, and swing while they come forward.
    assert!(moved.on_the_spot);
    for leg in 0..4 {
        let stands: usize = (moved.contacts.iter().filter(|contact| contact.0 == leg))
            .map(|contact| contact.2 + 1 - contact.1)
            .sum();
        assert!((8..=18).contains(&stands), "leg {leg} stands in {stands} of 26 frames");
    }
}

#[test]
fn a_motion_comes_back_from_another_body_as_it_was() {
    let (Some(walk), Some(human)) = (bvh("35/35_01.bvh"), human()) else { return };
    for keep_feet in [false, true] {
        there_and_back(&walk, &human, keep_feet);
    }
    let (wolf, fox) =
        (glb("wolf.glb", Some("AnimalArmature|Idle")).unwrap(), glb("fox-animations.glb", None).unwrap());
    there_and_back_on_four_legs(&wolf, &fox);
}

fn there_and_back_on_four_legs(wolf: &Clip, fox: &Clip) {
    let there = retarget(wolf, fox.skeleton(), &RetargetOptions::default()).unwrap();
    let back = retarget(&there.clip, wolf.skeleton(), &RetargetOptions::default()).unwrap();
    let Ok(Body::Quadruped(body)) = Body::find(wolf.skeleton()) else { panic!("no wolf") };
    let (a, b) = (kinematics::positions(wolf), kinematics::positions(&back.clip));
    let legs = body.hind.iter().chain(&body.fore).map(QuadrupedLeg::hip_knee_foot);
    let joints: Vec<usize> = legs.flat_map(|[_, knee, foot]| [knee, foot]).chain(body.head).collect();
    let mut off = Vec::new();
    for frame in 0..wolf.frames() {
        let (own, other) = (a.frame(frame), b.frame(frame));
        off.extend(
            joints
                .iter()
                .map(|&joint| (own[joint] - own[body.hips]).distance(other[joint] - other[body.hips])),
        );
    }
    off.sort_by(f32::total_cmp);
    // The wolf is larger than life: its hips are at 1.74 m.
    println!("wolf, there and back: P95 {:.1} mm of {:.2} m", 1e3 * at(&off, 0.95), wolf.skeleton().extent());
    assert!(at(&off, 0.95) < 0.02 * 1.74 / 0.6);
}

fn there_and_back(walk: &Clip, human: &Clip, keep_feet: bool) {
    let options = RetargetOptions { keep_feet, ..RetargetOptions::default() };
    let there = retarget(walk, human.skeleton(), &options).unwrap();
    let back = retarget(&there.clip, walk.skeleton(), &options).unwrap();
    let body = Humanoid::find(walk.skeleton()).unwrap();
    let (a, b) = (kinematics::positions(walk), kinematics::positions(&back.clip));
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
        "there and back, feet held {keep_feet}: P95 {:.1} mm, scales {:.3} and {:.3}",
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
