//! What is read of drawings, and what is said of those that cannot be read.

use crate::support::{board, understood};
use inkrig_sketch::storyboard::{End, Frame, Pin, Stroke, Trajectory};

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
fn twice_as_fast_takes_half_the_frames_and_denser_lines_of_speed_fewer() {
    let board = board("walk-and-wave");
    let mut frame = board.frames[0].clone();
    frame.seconds = None;
    frame.speed_lines.clear();
    let way = |frame: &Frame| understood(frame).unwrap().plan.ways[0].2.len();
    let line = &mut frame.trajectories[0].points;
    let last = (line.points.len() - 1) as f64;
    let timed = |all: f64| -> Vec<f64> { (0..line.points.len()).map(|at| all * at as f64 / last).collect() };
    let times = [3.2, 1.6].map(timed);
    let [slow, fast] = times.map(|seconds| {
        frame.trajectories[0].points.seconds = Some(seconds);
        way(&frame)
    });
    assert!((slow as f64 / 2.0 - fast as f64).abs() <= 1.0, "{slow} {fast}");
    let points = frame.trajectories[0].points.points.clone();
    let dash = Stroke::new(points[points.len() / 4..points.len() / 2].to_vec());
    let mut before = usize::MAX;
    for count in 0..5 {
        frame.speed_lines = vec![dash.clone(); count];
        let frames = way(&frame);
        assert!(frames < before, "{count} lines: {frames} frames, with one less {before}");
        before = frames;
    }
}

#[test]
fn sides_that_are_unsure_are_offered_and_chosen() {
    use inkrig_sketch::storyboard::{SideChoice, Sides};
    let kick = board("kick").frames[0].clone();
    let read = understood(&kick).unwrap().figure.unwrap();
    let all = &read.alternatives;
    assert_eq!((all.len(), all[0].name()), (4, "as read"));
    assert!((all.iter().map(|own| own.share).sum::<f32>() - 1.0).abs() < 1e-4, "{all:?}");
    assert!(all.windows(2).all(|pair| pair[0].share >= pair[1].share), "{all:?}");
    let sides = Sides { arms: SideChoice::Swapped, legs: SideChoice::Read };
    let swapped = understood(&Frame { sides, ..kick.clone() }).unwrap().figure.unwrap();
    let at = |figure: &inkrig_storyboard::Figure, joint: usize| figure.joints[joint].map(|found| found.at);
    assert_eq!((at(&swapped, 20), at(&swapped, 21)), (at(&read, 21), at(&read, 20)));
    assert_eq!(at(&swapped, 7), at(&read, 7), "legs stay");
    // What the user has said is not asked about.
    let notes = swapped.notes.join(" ");
    assert!(!notes.contains("of the arms"), "{notes}");
    let text =
        "{\"inkrig_storyboard\": 1, \"frames\": [{\"word\": \"kick\", \"sides\": {\"legs\": \"swapped\"}}]}";
    let frame = inkrig_sketch::storyboard::read_storyboard(text.as_bytes()).unwrap().frames[0].clone();
    assert_eq!(frame.sides, Sides { arms: SideChoice::Read, legs: SideChoice::Swapped });
}
