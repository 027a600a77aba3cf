//! What an FBX file says is what is read: hand-made files, each with the places worked out beside it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::fbx::{SECOND, Text, int, vector};
use inkrig_formats::{ClipChoice, Evidence, Import, ImportOptions, UpAxis, read_fbx};
use inkrig_motion::{glam::Vec3, kinematics};

fn read(text: &Text) -> Import {
    read_with(text, &ImportOptions::default())
}

fn read_with(text: &Text, options: &ImportOptions) -> Import {
    read_fbx(&text.bytes(), options).unwrap_or_else(|error| panic!("{error}"))
}

fn place(import: &Import, frame: usize, joint: usize) -> Vec3 {
    kinematics::positions(&import.clip).frame(frame)[joint]
}

fn assert_near(found: Vec3, expected: [f32; 3]) {
    assert!(found.distance(Vec3::from_array(expected)) < 1e-5, "{found} and not {expected:?}");
}

fn codes(import: &Import) -> Vec<&'static str> {
    import.findings.iter().map(|finding| finding.code).collect()
}

#[test]
fn a_leg_swings_and_goes_ahead() {
    let import = read(&Text::leg());
    let joints = import.clip.skeleton().joints();
    let facts: Vec<_> =
        joints.iter().map(|joint| (joint.name.as_str(), joint.parent, joint.end_site)).collect();
    assert_eq!(facts, [("hip", None, false), ("knee", Some(0), false), ("tip", Some(1), true)]);
    assert_eq!((import.clip.frames(), import.clip.frame_rate()), (31, 30.0));
    assert_eq!(import.clips[0].name, "walk");
    assert_near(place(&import, 0, 2), [0.0, 0.0, 0.0]);
    // A quarter of a turn about x takes down to back.
    assert_near(place(&import, 30, 0), [0.0, 1.0, 3.0]);
    assert_near(place(&import, 30, 1), [0.0, 1.0, 2.5]);
    assert_near(place(&import, 15, 0), [0.0, 1.0, 1.5]);
    let half = 0.5 * std::f32::consts::FRAC_1_SQRT_2;
    assert_near(place(&import, 15, 1), [0.0, 1.0 - half, 1.5 - half]);
    assert_eq!(codes(&import), Vec::<&str>::new());
    assert_eq!(import.source.metres_per_unit, 0.01);
    assert_eq!(
        (import.source.unit_evidence, import.source.up_evidence),
        (Evidence::Declared, Evidence::Declared)
    );
}

#[test]
fn units_and_axes_are_the_files_or_given() {
    // z up as Blender and 3ds Max have it, in metres.
    let mut text = Text::leg();
    text.settings = text
        .settings
        .replace(&int("UpAxis", 1), &int("UpAxis", 2))
        .replace(&int("FrontAxis", 2), &int("FrontAxis", 1))
        .replace(&int("FrontAxisSign", 1), &int("FrontAxisSign", -1))
        .replace("\"\",1\nP: \"TimeMode", "\"\",100\nP: \"TimeMode");
    let import = read(&text);
    assert_eq!((import.source.metres_per_unit, import.source.up), (1.0, UpAxis::Z));
    assert_eq!(codes(&import), ["fbx-size"]);
    // What lay along y, z, -y now lies along -z, y, z.
    assert_near(place(&import, 0, 0), [0.0, 0.0, -100.0]);
    assert_near(place(&import, 30, 0), [0.0, 300.0, -100.0]);
    assert_near(place(&import, 30, 1), [0.0, 250.0, -100.0]);
    let given = ImportOptions { metres_per_unit: Some(0.01), up: Some(UpAxis::Y), ..Default::default() };
    let import = read_with(&text, &given);
    assert_near(place(&import, 30, 1), [0.0, 1.0, 2.5]);
    assert_eq!((import.source.unit_evidence, import.source.up_evidence), (Evidence::Given, Evidence::Given));
    let mut text = Text::leg();
    text.settings.clear();
    let import = read(&text);
    assert_near(place(&import, 0, 0), [0.0, 1.0, 0.0]);
    assert_eq!(
        (import.source.unit_evidence, import.source.up_evidence),
        (Evidence::Assumed, Evidence::Assumed)
    );
    let mut text = Text::leg();
    text.settings = text.settings.replace(&int("FrontAxis", 2), &int("FrontAxis", 1));
    assert_eq!(codes(&read(&text)), ["fbx-axes"]);
    let mut text = Text::leg();
    text.settings = text.settings.replace(
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1",
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",0",
    );
    assert_eq!(codes(&read(&text)), ["fbx-unit"]);
}

/// An armature as Blender writes it: lying, and a hundred times as large; bones with a turn before their own.
#[test]
fn what_stands_above_and_before_is_folded_in() {
    let mut text = Text::new();
    let lying = vector("Lcl Rotation", [-90.0, 0.0, 0.0]) + &vector("Lcl Scaling", [100.0, 100.0, 100.0]);
    text.node(1, "Armature", "Null", 0, &lying);
    let turned = "P: \"RotationActive\", \"bool\", \"\", \"\",1\n\
        P: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",0,0,90\n";
    text.node(2, "hip", "LimbNode", 1, &(vector("Lcl Translation", [0.0, 0.0, 1.0]) + turned));
    text.node(3, "helper", "Null", 2, &vector("Lcl Translation", [0.2, 0.0, 0.0]));
    text.node(4, "knee", "LimbNode", 3, &vector("Lcl Translation", [0.3, 0.0, 0.0]));
    text.node(5, "knee_end", "LimbNode", 4, &vector("Lcl Translation", [0.5, 0.0, 0.0]));
    text.stack(100, "Armature|swing", [0, SECOND]);
    text.curves(100, 2, "Lcl Rotation", &[Some("0:0"), Some("0:0 30:90"), Some("0:0")]);
    let import = read(&text);
    let names: Vec<_> =
        import.clip.skeleton().joints().iter().map(|joint| (&*joint.name, joint.end_site)).collect();
    assert_eq!(names, [("hip", false), ("knee", false), ("knee_end", true)]);
    // Lying by -90 degrees about x: (x, y, z) becomes (x, z, -y). The hip's own x points to y, so to -z.
    assert_near(place(&import, 0, 0), [0.0, 1.0, 0.0]);
    assert_near(place(&import, 0, 1), [0.0, 1.0, -0.5]);
    assert_near(place(&import, 0, 2), [0.0, 1.0, -1.0]);
    // Turned by 90 degrees about its own y, its x points to its -z, which is the world's down.
    assert_near(place(&import, 30, 2), [0.0, 0.0, 0.0]);
    // The rest pose has no rotations of its own.
    assert!(import.clip.rotations(0).iter().all(|turn| turn.w.abs() > 0.999_999));
    assert!(import.clip.translations().is_empty(), "bones that only turn have no translations");
    assert_eq!(codes(&import), Vec::<&str>::new());
}

#[test]
fn scales_are_inherited_as_the_nodes_say() {
    // The parent is twice as large; what its child takes over of that is told by its type.
    for (mode, knee, tip) in [(0, -1.0, -1.5), (1, -1.0, -2.0), (2, -1.0, -1.5)] {
        let mut text = Text::new();
        text.node(1, "hip", "LimbNode", 0, &vector("Lcl Scaling", [2.0, 2.0, 2.0]));
        let inherit = format!("P: \"InheritType\", \"enum\", \"\", \"\",{mode}\n");
        text.node(2, "knee", "LimbNode", 1, &(vector("Lcl Translation", [0.0, -50.0, 0.0]) + &inherit));
        text.node(3, "tip", "LimbNode", 2, &vector("Lcl Translation", [0.0, -50.0, 0.0]));
        let import = read(&text);
        assert_near(place(&import, 0, 1), [0.0, knee, 0.0]);
        let found = place(&import, 0, 2).y;
        let expected = if mode == 2 { tip } else { -2.0 };
        assert!((found - expected).abs() < 1e-5, "mode {mode}: {found} and not {expected}");
        assert_eq!(codes(&import), ["fbx-rest-pose"]);
    }
}

#[test]
fn clips_are_chosen_by_name_and_empty_ones_passed_over() {
    let mut text = Text::leg();
    text.stack(200, "run", [SECOND, 3 * SECOND]);
    text.curves(200, 1, "Lcl Rotation", &[None, Some("30:0 90:180"), None]);
    let import = read(&text);
    assert_eq!(
        (import.clip.frames(), import.clip_index, codes(&import)),
        (31, Some(0), vec!["several-clips"])
    );
    let run = ImportOptions { clip: Some(ClipChoice::Name("RUN".into())), ..Default::default() };
    let import = read_with(&text, &run);
    assert_eq!((import.clip.frames(), import.clip_index), (61, Some(1)));
    assert!(import.clip.rotations(60)[0].y.abs() > 0.999_999);
    let other = ImportOptions { clip: Some(ClipChoice::Name("swim".into())), ..Default::default() };
    assert_eq!(
        read_fbx(&text.bytes(), &other).unwrap_err().to_string(),
        "there is no clip `swim` in the file; its clips are `walk`, `run`"
    );
    // As from Mixamo: the first take is empty.
    let mut text = Text::new();
    text.stack(300, "Take 001", [0, 10 * SECOND]);
    let leg = Text::leg();
    text.objects += &leg.objects;
    text.connections += &leg.connections;
    let import = read(&text);
    assert_eq!((import.clip_index, import.clip.frames()), (Some(1), 31));
    assert!(import.findings[0].message.contains("`walk`, the first that moves a joint, is read"));
}

#[test]
fn frames_are_those_of_the_file() {
    let with = |mode: &str, keys: &str, stop: i64| {
        let mut text = Text::leg();
        text.settings = text.settings.replace("\"TimeMode\", \"enum\", \"\", \"\",6\n", mode);
        text.stack(200, "other", [0, stop]);
        text.curves(200, 1, "Lcl Rotation", &[None, Some(keys), None]);
        let options = ImportOptions { clip: Some(ClipChoice::Number(2)), ..Default::default() };
        let import = read_with(&text, &options);
        (import.clip.frames(), (import.clip.frame_rate() * 1e3).round() / 1e3, codes(&import))
    };
    let mode = |mode: i32| format!("\"TimeMode\", \"enum\", \"\", \"\",{mode}\n");
    let none = Vec::<&str>::new;
    // One key in two frames at 60 a second.
    assert_eq!(with(&mode(3), "0:0 1:1 2:0 30:4", SECOND), (61, 60.0, none()));
    let custom = mode(14) + "P: \"CustomFrameRate\", \"double\", \"Number\", \"\",12.5\n";
    assert_eq!(with(&custom, "0:0 12:5", SECOND * 2 / 5), (6, 12.5, none()));
    // The format says 29.97 and means 30000 / 1001.
    let drop = "0:0 1.001:1 30.03:2";
    assert_eq!(with(&mode(9), drop, (1.001 * SECOND as f64) as i64), (31, 29.97, none()));
    // Keys at 120 a second in a file that says 30.
    let dense: Vec<String> = (0..=120).map(|frame| format!("{}:{frame}", f64::from(frame) / 4.0)).collect();
    assert_eq!(with(&mode(6), &dense.join(" "), SECOND), (121, 120.0, vec!["fbx-rate"]));
    // Keys anywhere are sampled.
    assert_eq!(with(&mode(6), "0:0 1.37:1 17.9:2 30:0", SECOND), (31, 30.0, vec!["fbx-sampled"]));
    // A span that is none, or for ever, is that of the keys.
    assert_eq!(with(&mode(6), "3:0 30:0", 0), (28, 30.0, none()));
    assert_eq!(with(&mode(6), "3:0 30:0", i64::MAX), (28, 30.0, none()));
    // A rate that is none.
    let custom = mode(14) + "P: \"CustomFrameRate\", \"double\", \"Number\", \"\",0\n";
    assert_eq!(with(&custom, "0:0 30:0", SECOND), (31, 30.0, none()));
}

#[test]
fn steps_and_splines_are_sampled() {
    let at = |flags: &str, data: &str, frame: usize| {
        let mut text = Text::leg();
        text.stack(200, "other", [0, SECOND]);
        let keys = [Some("0:0 30:30"), None, None];
        text.curves_of(200, 2, "Lcl Rotation", &keys, flags, data);
        let options = ImportOptions { clip: Some(ClipChoice::Number(2)), ..Default::default() };
        let turn = read_with(&text, &options).clip.rotations(frame)[1];
        (2.0 * turn.x.atan2(turn.w)).to_degrees()
    };
    let near =
        |found: f32, expected: f32| assert!((found - expected).abs() < 1e-3, "{found}, not {expected}");
    near(at("4", "0,0,0,0", 15), 15.0);
    near(at("2", "0,0,0,0", 29), 0.0);
    near(at("2", "0,0,0,0", 30), 30.0);
    // A cubic that begins and ends flat, at a third of the way: 30 (3 t^2 - 2 t^3).
    near(at("3080", "0,0,0,0", 10), 30.0 * (3.0 / 9.0 - 2.0 / 27.0));
    // One that begins at 90 degrees a second and ends flat: 30 (3 t^2 - 2 t^3) + 90 (t^3 - 2 t^2 + t).
    // Text has the bits of these numbers.
    let slope = format!("{},0,0,0", 90.0_f32.to_bits());
    near(at("3080", &slope, 15), 15.0 + 90.0 * 0.125);
}

#[test]
fn a_file_without_clips_gives_its_rest_pose_and_one_without_bones_what_moves() {
    let mut text = Text::new();
    text.node(1, "hip", "LimbNode", 0, &vector("Lcl Translation", [0.0, 100.0, 0.0]));
    let import = read(&text);
    assert_eq!(
        (import.clip.frames(), import.clip_index, codes(&import)),
        (1, None, vec!["fbx-rest-pose", "fbx-size"])
    );
    let mut text = Text::new();
    text.node(1, "box", "Null", 0, "");
    text.node(2, "lid", "Null", 1, &vector("Lcl Translation", [0.0, 50.0, 0.0]));
    text.node(3, "lamp", "Null", 0, "");
    text.stack(100, "open", [0, SECOND]);
    text.curves(100, 2, "Lcl Rotation", &[Some("0:0 30:90"), None, None]);
    let import = read(&text);
    let names: Vec<_> = import.clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!((names, codes(&import)), (vec!["lid"], vec!["fbx-no-bones", "fbx-size"]));
}

#[test]
fn changing_scales_are_said() {
    let mut text = Text::leg();
    text.curves(100, 1, "Lcl Scaling", &[Some("0:1 30:2"), Some("0:1 30:2"), Some("0:1 30:2")]);
    let import = read(&text);
    assert_eq!(codes(&import), ["fbx-scale"]);
    assert_near(place(&import, 30, 1), [0.0, 1.0, 2.0]);
}

/// The nodes stand as in some frame, the mesh was bound to a leg that points to x.
fn bound_leg(knee: [f64; 3]) -> Text {
    let mut text = Text::leg();
    let matrix =
        |[x, y, z]: [f64; 3]| format!("Matrix: *16 {{\na: 1,0,0,0,0,1,0,0,0,0,1,0,{x},{y},{z},1\n}}\n");
    let pose = |node: u32, place| format!("PoseNode: {{\nNode: {node}\n{}}}\n", matrix(place));
    text.objects += &format!(
        "Pose: 700, \"Pose::bind\", \"BindPose\" {{\nType: \"BindPose\"\nVersion: 100\nNbPoseNodes: 2\n{}{}}}\n",
        pose(1, [0.0, 90.0, 0.0]),
        pose(2, knee)
    );
    text
}

#[test]
fn the_rest_pose_is_that_of_the_mesh() {
    let import = read(&bound_leg([50.0, 90.0, 0.0]));
    let offsets: Vec<Vec3> = import.clip.skeleton().joints().iter().map(|joint| joint.offset).collect();
    assert_near(offsets[0], [0.0, 0.9, 0.0]);
    assert_near(offsets[1], [0.5, 0.0, 0.0]);
    assert_near(offsets[2], [0.0, -0.5, 0.0]);
    assert_eq!(codes(&import), Vec::<&str>::new());
    // The motion is the same. The hip has not turned since, so the knee has a place of its own.
    assert_near(place(&import, 0, 1), [0.0, 0.5, 0.0]);
    assert_near(place(&import, 30, 1), [0.0, 1.0, 2.5]);
    assert_near(place(&import, 30, 2), [0.0, 1.0, 2.0]);
    // A mesh bound to another figure is not believed.
    let import = read(&bound_leg([60.0, 90.0, 0.0]));
    assert_near(import.clip.skeleton().joints()[1].offset, [0.0, -0.5, 0.0]);
    assert_eq!(codes(&import), ["fbx-bind-pose"]);
}
