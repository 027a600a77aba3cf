//! What the suites share: fixtures, reference files, comparing clips.
#![allow(dead_code, reason = "each suite uses its part")]

pub(crate) mod fbx;
pub(crate) mod gltf;

use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{EulerRot, Quat, Vec3},
    kinematics,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The bytes of a fixture.
pub(crate) fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(fixtures().join(name).with_extension("bvh")).unwrap()
}

/// The names of all fixtures, without extension.
pub(crate) fn fixture_names() -> BTreeSet<String> {
    let entries = std::fs::read_dir(fixtures()).unwrap().map(|entry| entry.unwrap().path());
    entries.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect()
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/bvh")
}

/// A forest with tips, a joint that moves in its parent, one that never turns, and names that repeat.
pub(crate) fn odd_clip(frames: usize, rate: f64) -> Clip {
    let joints = vec![
        Joint::new("hips", None, Vec3::new(0.1, 0.9, 0.0)),
        Joint::new("spine", Some(0), Vec3::Y * 0.5),
        Joint::new("prop", None, Vec3::X),
        Joint::new("knee: left", Some(0), Vec3::new(0.1, -0.4, 0.01)),
        Joint::end("a tip", 3, Vec3::Y * -0.4),
        Joint::new("spine", Some(1), Vec3::Y * 0.3),
        Joint::end("spine_end", 5, Vec3::Y * 0.2),
    ];
    let count = joints.len();
    let rotation = |frame: usize, joint: usize| match joint {
        1 => Quat::from_rotation_z(0.5),
        4 | 6 => Quat::IDENTITY,
        _ => {
            let turn = 0.05 * frame as f32 * (1 + joint) as f32;
            Quat::from_euler(EulerRot::XYZ, turn, 2.0 * turn, -turn)
        }
    };
    let rotations =
        (0..frames).flat_map(|frame| (0..count).map(move |joint| rotation(frame, joint))).collect();
    let track = |joint: usize, still: bool| TranslationTrack {
        joint,
        values: (0..frames)
            .map(|frame| Vec3::new(if still { 3.0 } else { 0.03 * frame as f32 }, 1.0, 0.2))
            .collect(),
    };
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    Clip::new(skeleton, rate, rotations, vec![track(0, false), track(3, true), track(5, false)]).unwrap()
}

/// All files below the reference folder with an extension, sorted; `None`, with a line that says so, when there is no
/// such folder.
pub(crate) fn reference_files(extension: &str) -> Option<Vec<PathBuf>> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or(default, PathBuf::from).join("data");
    if !folder.is_dir() {
        assert!(std::env::var("CI").is_err(), "no reference data in {}", folder.display());
        println!("skipped: no reference data in {} (set INKRIG_REFERENCE)", folder.display());
        return None;
    }
    let (mut files, mut folders) = (Vec::new(), vec![folder]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension)) {
                files.push(path);
            }
        }
    }
    files.sort();
    assert!(!files.is_empty(), "the reference folder has no .{extension} file");
    Some(files)
}

/// How far two clips of the same shape lie apart.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Difference {
    /// Largest distance between world positions of a joint, over the figure's size.
    pub(crate) position: f64,
    /// Largest angle between local rotations of a joint, degrees; end sites do not count.
    pub(crate) degrees: f64,
}

impl Difference {
    /// Panics when frames or joints differ.
    pub(crate) fn between(a: &Clip, b: &Clip) -> Self {
        assert_eq!(a.frames(), b.frames(), "frames");
        let joints = a.skeleton().joints().iter().zip(b.skeleton().joints());
        assert_eq!(a.skeleton().len(), b.skeleton().len(), "joints");
        for (p, q) in joints {
            assert_eq!((&p.name, p.parent, p.end_site), (&q.name, q.parent, q.end_site));
        }
        let size = f64::from(a.skeleton().extent()).max(0.1);
        let mut out = Self { position: 0.0, degrees: Self::of_rotations(a, b) };
        let (one, other) = (kinematics::positions(a), kinematics::positions(b));
        for frame in 0..a.frames() {
            for (p, q) in one.frame(frame).iter().zip(other.frame(frame)) {
                out.position = out.position.max(p.as_dvec3().distance(q.as_dvec3()) / size);
            }
        }
        out
    }

    /// The largest angle between local rotations alone, degrees.
    pub(crate) fn of_rotations(a: &Clip, b: &Clip) -> f64 {
        let mut degrees = 0.0_f64;
        for frame in 0..a.frames() {
            let pairs = a.rotations(frame).iter().zip(b.rotations(frame)).zip(a.skeleton().joints());
            for ((p, q), _) in pairs.filter(|(_, joint)| !joint.end_site) {
                let rest = p.as_dquat().inverse() * q.as_dquat();
                degrees = degrees.max(2.0 * rest.xyz().length().atan2(rest.w.abs()).to_degrees());
            }
        }
        degrees
    }

    pub(crate) fn largest(self, other: Self) -> Self {
        Self { position: self.position.max(other.position), degrees: self.degrees.max(other.degrees) }
    }

    /// What a file must keep: 1e-5 of the figure's size, 0.01 degree.
    pub(crate) fn is_kept(self) -> bool {
        self.position <= 1e-5 && self.degrees <= 0.01
    }
}
