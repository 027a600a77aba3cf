//! The six storyboards of this project, from file to motion, with the weights that come with the program; and drawings that cannot
//! be made a motion, each with what is said of it.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints what it measures")]

use inkrig_generate::checkpoint::ModelFile;
use inkrig_generate::configuration::Configuration;
use inkrig_generate::readers::file::read;
use inkrig_generate::readers::sketch::SketchReader;
use inkrig_generate::sampling::{Networks, SamplingOptions};
use inkrig_generate::text::{TextEncoder, VerbTable};
use inkrig_motion::humanml::{FRAME_RATE, Joints, Statistics, bone_lengths, skeleton, to_clip};
use inkrig_sketch::storyboard::{
    End, Frame, Pin, Storyboard, Stroke, Trajectory, read_storyboard, read_storyboard_svg,
};
use inkrig_storyboard::{
    Generated, Goal, Maker, MakerOptions, MeetOptions, Understood, meet, misses, read_figure, sequence,
    understand,
};
use std::io::Cursor;
use std::sync::{Arc, LazyLock};

struct Model {
    networks: Networks,
    features: Statistics,
    body: Joints,
    words: VerbTable,
    reader: SketchReader,
    sampling: SamplingOptions,
}

static MODEL: LazyLock<Model> = LazyLock::new(|| {
    let clean = include_bytes!("../../../models/clean.safetensors");
    let mut file = ModelFile::open(Cursor::new(&clean[..])).unwrap();
    let header = file.header().clone();
    let weights = file.tensors().unwrap();
    let reader = include_bytes!("../../../models/sketch-reader.safetensors");
    let usual = Configuration::paper().unwrap().sampling_options();
    Model {
        networks: Networks::new(&header.sizes, &weights).unwrap(),
        features: header.statistics().unwrap().0,
        body: header.skeleton().unwrap(),
        words: VerbTable::new(&weights, header.sizes.text_width).unwrap(),
        reader: SketchReader::new(&read(Cursor::new(&reader[..]), "sketch").unwrap().1).unwrap(),
        sampling: SamplingOptions {
            text_weight: header.text_weight.unwrap(),
            semantics: header.semantics,
            guide_every: 10,
            ..usual
        },
    }
});

fn board(name: &str) -> Storyboard {
    read_storyboard(inkrig_samples::find(name).unwrap().bytes).unwrap()
}

fn understood(frame: &Frame) -> Result<Understood, String> {
    let model = &*MODEL;
    let figure = read_figure(frame, 1, &model.reader).map_err(|error| error.to_string())?;
    understand(frame, 1, figure, &model.body, None).map_err(|error| error.to_string())
}

/// One candidate a frame, guided at every tenth step.
fn generated(read: &Understood, number: usize, sampling: &SamplingOptions) -> Generated {
    let model = &*MODEL;
    let no_text = model.words.encode("").unwrap();
    let maker =
        Maker { networks: &model.networks, features: &model.features, no_text: &no_text, usual_frames: 40 };
    let options = MakerOptions { sampling: sampling.clone(), candidates: 1, seed: 0 };
    maker.clip(number, &read.plan, &model.words.encode(&read.plan.word).unwrap(), &options).unwrap()
}

#[test]
fn all_storyboards_become_motions_that_meet_what_was_drawn() {
    let model = &*MODEL;
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let read: Vec<Understood> = board.frames.iter().map(|frame| understood(frame).unwrap()).collect();
        let clips: Vec<Generated> =
            read.iter().enumerate().map(|(at, read)| generated(read, at + 1, &model.sampling)).collect();
        let joined = sequence(&clips, None).unwrap();
        let rig = Arc::new(skeleton(&model.body, &joined.motion).unwrap());
        let clip = to_clip(&joined.motion, &rig, FRAME_RATE).unwrap();
        let placed = clips.iter().zip(&joined.starts).zip(&joined.placements);
        let goals: Vec<Goal> = placed
            .flat_map(|((clip, start), placement)| {
                let goal = |ask: &inkrig_generate::guidance::Ask| {
                    let at = ask.place.truncate();
                    Goal::placed(start + ask.frame, ask.joint, at, &clip.plan.camera, *placement, true)
                };
                clip.plan.asks().iter().map(goal).collect::<Vec<_>>()
            })
            .collect();
        let met = meet(&clip, &goals, &MeetOptions::default());
        let soft: Vec<f32> = clips.iter().map(|clip| clip.error).collect();
        println!(
            "{}: {} frames, soft {soft:.3?}, pinned {:.4?}",
            sample.name,
            joined.motion.len(),
            met.after
        );
        assert!(met.motion.iter().flatten().all(|place| place.is_finite() && place.length() < 50.0));
        assert!(met.after[0] < 0.01, "{}: {:?}", sample.name, met.after);
        let bones = bone_lengths(&met.motion[0]);
        let last = bone_lengths(met.motion.last().unwrap());
        assert!(bones.iter().zip(&last).all(|(a, b)| (a.length() - b.length()).abs() < 1e-3));
        // What is written is what was met.
        let written = to_clip(&met.motion, &rig, FRAME_RATE).unwrap();
        let places = inkrig_motion::kinematics::positions(&written);
        let again: Vec<Joints> =
            (0..written.frames()).map(|frame| places.frame(frame).try_into().unwrap()).collect();
        assert!((misses(&again, &goals)[1] - met.after[1]).abs() < 2e-3, "{}", sample.name);
    }
}

#[test]
fn drawing_and_seed_decide_and_nothing_else() {
    let model = &*MODEL;
    let read = understood(&board("kick").frames[0]).unwrap();
    let once = generated(&read, 1, &model.sampling);
    assert_eq!(once, generated(&read, 1, &model.sampling));
    assert_ne!(once.motion, generated(&read, 2, &model.sampling).motion, "another frame has another seed");
    // Drawn to the lines the motion is nearer to them than by its word alone.
    let free = generated(&read, 1, &SamplingOptions { guidance: None, ..model.sampling.clone() });
    println!("kick: {:.3} m by the word, {:.3} m drawn to the lines", free.error, once.error);
    assert!(once.error < 0.6 * free.error, "{} {}", once.error, free.error);
}

#[test]
fn joints_and_ways_are_read_as_they_were_drawn() {
    let kick = understood(&board("kick").frames[0]).unwrap();
    assert_eq!((kick.attached[0].joint, kick.attached[0].figure), (11, End::Start), "{:?}", kick.attached);
    let sit = understood(&board("sit-down-and-stand-up").frames[0]).unwrap();
    assert_eq!((sit.attached[0].joint, sit.attached[0].figure), (0, End::End), "{:?}", sit.attached);
    assert_eq!(sit.plan.key_frame(), sit.plan.frames - 1, "the drawn pose is the last");
    // Lines of speed: the same drawing without them takes longer.
    let mut frame = board("kick").frames[0].clone();
    let frames = |frame: &Frame| understood(frame).unwrap().plan.ways[0].2.len();
    let quick = frames(&frame);
    frame.speed_lines.clear();
    assert!(frames(&frame) > quick, "{} {quick}", frames(&frame));
}

#[test]
fn pins_win_and_a_figure_may_lack_legs() {
    let mut frame = board("kick").frames[0].clone();
    frame.trajectories.clear();
    frame.pins = vec![Pin { joint: "left wrist".into(), at: [30.0, 300.0] }];
    let read = understood(&frame).unwrap();
    let found = read.figure.unwrap().joints[20].unwrap();
    assert!(found.pinned && found.at == [30.0, 300.0]);
    // Head, trunk, shoulders and arms are drawn first.
    frame.body.truncate(5);
    frame.pins = ["left_knee", "right_knee", "left_ankle", "right_ankle"]
        .map(|joint| Pin { joint: joint.into(), at: [0.0, 0.0] })
        .to_vec();
    let pinned = understood(&frame);
    frame.pins.clear();
    match understood(&frame) {
        Ok(read) => {
            let asked: Vec<usize> = read.plan.keypose.unwrap().1.iter().map(|(joint, ..)| *joint).collect();
            let legs = [4, 5, 7, 8].iter().any(|joint| asked.contains(joint));
            assert!(
                legs || read.notes.iter().any(|note| note.contains("no legs")),
                "{asked:?} {:?}",
                read.notes
            );
        }
        Err(said) => assert!(said.contains("pin"), "{said}"),
    }
    assert!(pinned.is_ok() || pinned.unwrap_err().contains("pin"));
}

#[test]
fn what_cannot_be_understood_is_said_with_what_to_do() {
    let kick = board("kick").frames[0].clone();
    let line = |points: &[[f64; 2]]| Stroke::new(points.to_vec());
    let way = |points: &[[f64; 2]]| Trajectory { points: line(points), ..Trajectory::default() };
    let pin = |joint: &str, at: [f64; 2]| Pin { joint: joint.into(), at };
    let second = kick
        .body
        .iter()
        .map(|stroke| Stroke::new(stroke.points.iter().map(|point| [point[0] + 400.0, point[1]]).collect()));
    let second: Vec<Stroke> = second.collect();
    let ends = kick.trajectories[0].points.points.iter().rev().copied().collect::<Vec<_>>();
    let cases = [
        ("nothing", Frame::default(), "Draw or type something"),
        (
            "two figures",
            Frame { body: [kick.body.clone(), second].concat(), ..kick.clone() },
            "frame of its own",
        ),
        (
            "a line beside",
            Frame { trajectories: vec![way(&[[600.0, 600.0], [700.0, 650.0]])], ..kick.clone() },
            "touches nothing",
        ),
        ("a dot", Frame { trajectories: vec![way(&[[0.0, 0.0]])], ..kick.clone() }, "is a dot"),
        (
            "one joint twice",
            Frame { trajectories: vec![kick.trajectories[0].clone(); 2], ..kick.clone() },
            "both of right_foot",
        ),
        (
            "a line without a figure",
            Frame { trajectories: kick.trajectories.clone(), ..Frame::default() },
            "no figure that says how large",
        ),
        (
            "a joint that is none",
            Frame { pins: vec![pin("rigth foot", [0.0, 0.0])], ..kick.clone() },
            "nearest names are right_foot",
        ),
        (
            "two places of a joint",
            Frame { pins: vec![pin("head", [0.0, 0.0]), pin("head", [1.0, 0.0])], ..kick.clone() },
            "pinned to two places",
        ),
        (
            "pins too far apart",
            Frame {
                pins: vec![pin("left_knee", [0.0, 100.0]), pin("left_ankle", [300.0, 0.0])],
                ..kick.clone()
            },
            "contradict each other",
        ),
        ("scribble", Frame { body: vec![line(&[[0.0, 0.0], [1.0, 0.0]])], ..Frame::default() }, "pin"),
    ];
    for (name, frame, part) in cases {
        let said = match understood(&frame) {
            Err(said) => said,
            Ok(read) => read.notes.join("; "),
        };
        assert!(said.contains(part), "{name}: {said}");
    }
    let mut both = kick.clone();
    both.trajectories[0].figure = Some(End::Start);
    both.trajectories.push(Trajectory {
        joint: Some("left_wrist".into()),
        figure: Some(End::End),
        ..way(&ends)
    });
    let said = understood(&both).unwrap_err();
    assert!(said.contains("starts at the figure") && said.contains("\"figure\""), "{said}");
    let wordless = understood(&Frame { word: " ".into(), ..kick }).unwrap();
    assert!(wordless.notes.iter().any(|note| note.contains("no word")), "{:?}", wordless.notes);
}

#[test]
fn the_svg_says_the_same_as_the_json() {
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let svg = inkrig_samples::make::storyboards::to_svg(&board);
        let read = read_storyboard_svg(svg.as_bytes()).unwrap();
        assert_eq!(read.title, board.title);
        for (own, other) in board.frames.iter().zip(&read.frames) {
            assert_eq!((&own.word, own.body.len()), (&other.word, other.body.len()), "{}", sample.name);
            let counts =
                |frame: &Frame| [frame.trajectories.len(), frame.speed_lines.len(), frame.scene.len()];
            assert_eq!(counts(own), counts(other), "{}", sample.name);
        }
        assert_eq!(board.frames.len(), read.frames.len());
    }
}
