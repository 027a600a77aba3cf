//! ASF and AMC: what is read means what the format says, and what is broken is said with its place.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "a test may panic, and prints"
)]

mod common;

use inkrig_formats::{Evidence, FormatError, Import, ImportOptions, Severity, read_amc};
use inkrig_motion::glam::Vec3;
use inkrig_motion::{Clip, kinematics};
use std::path::{Path, PathBuf};

const ASF: &str = "# a comment\n:version 1.10\n:name test\n:units\n  mass 1.0\n  length 0.5\n  angle deg\n:documentation\n  free text\n\
:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n:bonedata\n\
 begin\n  id 1\n  name thigh\n  direction 0 -2 0\n  length 10\n  axis 0 0 90 XYZ\n  dof rx rz\n  limits (-160.0 20.0)\n         (-60 70)\n end\n\
 begin\n  id 2\n  name shin\n  direction 0 -1 0\n  length 8\n  axis 0 0 0 XYZ\n  dof rx\n end\n\
 begin\n  id 3\n  name stump\n  direction 1 0 0\n  length 2\n  axis 0 0 0 XYZ\n end\n\
:hierarchy\n begin\n  thigh shin\n  root stump thigh\n end\n";

const AMC: &str = "#!OML:ASF x\n:FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 20 0 0 90 0\nthigh 0 0\nshin 0\n2\nroot 1 20 0 0 0 0\nthigh 90 0\nshin 90\n";

fn read(asf: &str, amc: &str) -> Result<Import, FormatError> {
    let skeleton = Some(asf.as_bytes().to_vec());
    read_amc(amc.as_bytes(), &ImportOptions { skeleton, frame_rate: Some(60.0), ..ImportOptions::default() })
}

fn joint(clip: &Clip, name: &str) -> usize {
    clip.skeleton().joints().iter().position(|joint| joint.name == name).unwrap()
}

#[test]
fn bones_become_joints_at_their_beginnings() {
    let import = read(ASF, AMC).unwrap();
    let skeleton = import.clip.skeleton();
    let names: Vec<&str> = skeleton.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["root", "stump", "stump_end", "thigh", "shin", "shin_end"]);
    assert_eq!((import.source.metres_per_unit, import.source.unit_evidence), (0.0508, Evidence::Assumed));
    assert_eq!((import.clip.frame_rate(), import.clip.frames()), (60.0, 2));
    assert!(
        import.findings.iter().all(|finding| finding.severity == Severity::Info),
        "{:?}",
        import.findings
    );
    // The direction is made a unit vector; the shin begins 10 units below the thigh's beginning.
    assert_eq!(skeleton.joints()[4].offset, Vec3::new(0.0, -0.508, 0.0));
}

#[test]
fn angles_turn_a_bone_within_its_own_frame() {
    let clip = read(ASF, AMC).unwrap().clip;
    let positions = kinematics::positions(&clip);
    let place = |frame: usize, name: &str| positions.frame(frame)[joint(&clip, name)] / 0.0508;
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-4, "{a} is not {b}");
    // The root turned by 90 degrees about y: what points to x points to -z.
    near(place(0, "stump_end"), Vec3::new(0.0, 20.0, -2.0));
    near(place(0, "shin"), Vec3::new(0.0, 10.0, 0.0));
    // The thigh's frame is turned by 90 degrees about z, so its x is the world's y: the turn leaves the bone in place,
    // and takes the shin's x to -z, about which the shin then turns from -y to -x.
    near(place(1, "shin"), Vec3::new(1.0, 10.0, 0.0));
    near(place(1, "shin_end"), Vec3::new(-7.0, 10.0, 0.0));
}

#[test]
fn what_is_broken_is_said_with_its_place() {
    let no_rate = ImportOptions { skeleton: Some(ASF.into()), ..ImportOptions::default() };
    let import = read_amc(AMC.as_bytes(), &no_rate).unwrap();
    assert_eq!(import.clip.frame_rate(), 120.0);
    assert!(import.findings.iter().any(|finding| finding.code == "amc-frame-rate"));
    let without = read_amc(AMC.as_bytes(), &ImportOptions::default()).unwrap_err().to_string();
    assert!(without.contains("--skeleton"), "{without}");
    let cases = [
        (ASF.replace("direction 1", "direction one"), AMC.to_string(), "asf-number", "line 37, column 13"),
        (ASF.replace("root stump thigh", "root stump"), AMC.to_string(), "amc-bone", "line 6"),
        (
            ASF.replace("thigh shin\n", "thigh thigh\n"),
            AMC.to_string(),
            "asf-hierarchy",
            "line 44, column 14",
        ),
        (ASF.replace("root stump", "foot stump"), AMC.to_string(), "asf-hierarchy", "no bone `foot`"),
        (ASF.replace("dof rx rz", "dof rx rx"), AMC.to_string(), "asf-dof", "found `rx`"),
        (ASF.replace(":hierarchy", "hierarchy"), AMC.to_string(), "asf-begin", "found `hierarchy`"),
        (ASF.into(), AMC.replace("shin 90", "shin 90 1"), "amc-count", "joint `shin`"),
        (
            ASF.into(),
            AMC.replace("shin 90", "shin"),
            "amc-count",
            "has 1 numbers in the skeleton file, 0 here",
        ),
        (ASF.into(), AMC.replace("shin 90", "shin NaN"), "amc-number", "line 11, column 6"),
        (ASF.into(), AMC.replace("shin 90", "calf 90"), "amc-bone", "no bone `calf`"),
        (ASF.into(), AMC.replace("1\nroot", "root"), "amc-frame", "line 4"),
        (ASF.into(), String::new(), "amc-no-frames", "no frames"),
        (String::new(), AMC.into(), "asf-section", ":bonedata"),
    ];
    for (asf, amc, code, words) in cases {
        let error = read(&asf, &amc).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
        assert!(error.to_string().contains(words), "{error} does not say {words}");
    }
}

#[test]
fn a_bone_that_a_frame_does_not_name_stays_and_a_loose_bone_is_left_out() {
    let import = read(ASF, &AMC.replace("thigh 90 0\n", "")).unwrap();
    assert_eq!(import.clip.rotations(0)[3], import.clip.rotations(1)[3]);
    assert!(import.findings.iter().any(|finding| finding.code == "amc-missing"));
    let ring = ASF.replace("  thigh shin\n", "").replace("root stump thigh", "root stump");
    let import = read(&ring, "1\nroot 0 0 0 0 0 0\n").unwrap();
    assert_eq!(import.clip.skeleton().len(), 3);
    assert!(import.findings.iter().any(|finding| finding.code == "asf-loose-bone"));
}

/// The skeleton that a motion of the reference folder belongs to: the only one beside it.
fn skeleton_beside(path: &Path) -> PathBuf {
    let mut beside = std::fs::read_dir(path.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path());
    beside.find(|path| path.extension().is_some_and(|extension| extension == "asf")).unwrap()
}

#[test]
fn every_reference_file_is_a_person() {
    let Some(files) = common::reference_files("amc") else { return };
    let (mut frames, mut heights) = (0, Vec::new());
    for path in &files {
        let skeleton = Some(std::fs::read(skeleton_beside(path)).unwrap());
        let options = ImportOptions { skeleton, frame_rate: Some(60.0), ..ImportOptions::default() };
        let clip = read_amc(&std::fs::read(path).unwrap(), &options)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
            .clip;
        frames += clip.frames();
        let positions = kinematics::positions(&clip);
        let head = joint(&clip, "head_end");
        let toes = [joint(&clip, "ltoes_end"), joint(&clip, "rtoes_end")];
        let tallest = (0..clip.frames()).map(|frame| positions.frame(frame)[head].y).fold(0.0, f32::max);
        let lowest = (0..clip.frames())
            .flat_map(|frame| toes.map(|toe| positions.frame(frame)[toe].y))
            .fold(f32::INFINITY, f32::min);
        // Some trials have their ground elsewhere (stairs, a pool), so only sizes are compared.
        let stature = tallest - lowest;
        assert!((0.8..3.2).contains(&stature), "{}: a person of {stature} m", path.display());
        heights.push(tallest - lowest);
    }
    heights.sort_by(f32::total_cmp);
    println!("{} AMC files, {frames} frames, median height {:.2} m", files.len(), heights[heights.len() / 2]);
    assert!(files.len() > 300);
    assert!((1.5..2.0).contains(&heights[heights.len() / 2]));
}

/// Distances between two pairs of joints over time, over their mean: what two conversions of one capture share.
fn spans(clip: &Clip, pairs: [(&str, &str); 3]) -> Vec<Vec<f64>> {
    let positions = kinematics::positions(clip);
    let span = |(a, b): (&str, &str)| {
        let (a, b) = (joint(clip, a), joint(clip, b));
        let distances: Vec<f64> = (0..clip.frames())
            .map(|frame| f64::from(positions.frame(frame)[a].distance(positions.frame(frame)[b])))
            .collect();
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        distances.into_iter().map(|distance| distance / mean).collect()
    };
    pairs.map(span).into()
}

#[test]
fn a_capture_moves_alike_in_amc_and_bvh() {
    let (Some(amc), Some(bvh)) = (common::reference_files("amc"), common::reference_files("bvh")) else {
        return;
    };
    let find = |files: &[PathBuf], end: &str| files.iter().find(|path| path.ends_with(end)).unwrap().clone();
    for (number, other) in [("135_04", "04"), ("135_07", "07")] {
        let path = find(&amc, &format!("135/{number}.amc"));
        let skeleton = Some(std::fs::read(skeleton_beside(&path)).unwrap());
        let options = ImportOptions { skeleton, frame_rate: Some(60.0), ..ImportOptions::default() };
        let amc = read_amc(&std::fs::read(&path).unwrap(), &options).unwrap().clip;
        let path = find(&bvh, &format!("martial/{other}.bvh"));
        let bvh =
            inkrig_formats::read_bvh(&std::fs::read(path).unwrap(), &ImportOptions::default()).unwrap().clip;
        assert_eq!(bvh.frames(), amc.frames() + 1, "the other has a T-pose ahead");
        let own = spans(&amc, [("lhand", "rfoot"), ("rhand", "lhand"), ("lfoot", "rhand")]);
        let theirs = spans(&bvh, [("lHand", "rFoot"), ("rHand", "lHand"), ("lFoot", "rHand")]);
        for (own, theirs) in own.iter().zip(&theirs) {
            let off: Vec<f64> = own.iter().zip(&theirs[1..]).map(|(a, b)| (a - b).abs()).collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            println!("{number}: {mean:.4} of the mean distance apart");
            assert!(mean < 0.08, "{number}: {mean}");
        }
    }
}
