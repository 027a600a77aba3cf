//! Storyboards answered from clips.

use crate::support::{MODEL, board, poses, understood};
use inkrig_formats::{Format, ImportOptions, no_files, read_motion};
use inkrig_generate::measures::skating;
use inkrig_motion::glam::Vec3;
use inkrig_motion::ground::Contacts;
use inkrig_motion::{Clip, kinematics, time};
use inkrig_sketch::storyboard::{Frame, Storyboard, read_storyboard};
use inkrig_storyboard::{
    Creature, Exact, Example, Generated, Library, MeetOptions, animation, creature, misses, read_creature,
};

pub(crate) fn sample(name: &str) -> Clip {
    let bytes = inkrig_samples::find(name).unwrap().bytes;
    read_motion(bytes, Format::Bvh, &ImportOptions::default(), &no_files).unwrap().clip
}

fn library(clips: &[(&str, Clip)]) -> Library {
    let example = |(said, clip): &(&str, Clip)| Example {
        name: (*said).into(),
        said: (*said).into(),
        clip: clip.clone(),
    };
    Library::new(clips.iter().map(example).collect()).unwrap()
}

fn drawn(frames: &str) -> Storyboard {
    read_storyboard(format!("{{\"inkrig_storyboard\": 1, \"frames\": [{frames}]}}").as_bytes()).unwrap()
}

/// A quarter of a circle to the left and up the page, then straight on.
const BEND: &str = r#"{"word": "trot", "trajectories": [{"points": [[0,0,0],[40,4,0.4],[76,15,0.8],[106,33,1.2],[128,56,1.6],[140,84,2.0],[140,114,2.4],[140,144,2.8],[140,174,3.2]]}]}"#;

fn made(library: &Library, board: &Storyboard, exact: &Exact) -> Creature {
    let read = |(at, frame): (usize, &Frame)| read_creature(frame, at + 1, library).unwrap();
    let frames: Vec<_> = board.frames.iter().enumerate().map(read).collect();
    creature(library, &frames, exact).unwrap()
}

/// The largest step of a joint, in mean steps of all.
fn jump(clip: &Clip) -> f32 {
    let places = kinematics::positions(clip);
    let steps: Vec<f32> = (1..clip.frames())
        .flat_map(|frame| {
            let (a, b) = (places.frame(frame - 1).to_vec(), places.frame(frame).to_vec());
            a.into_iter().zip(b).map(|(a, b)| a.distance(b)).collect::<Vec<f32>>()
        })
        .collect();
    steps.iter().copied().fold(0.0, f32::max) / (steps.iter().sum::<f32>() / steps.len() as f32)
}

#[test]
fn a_hound_and_a_snake_go_where_a_line_is_drawn() {
    for (name, most) in [("quadruped.bvh", 14.0), ("snake.bvh", 14.0)] {
        let library = library(&[("trot", sample(name))]);
        assert!(!library.of_person());
        let board = drawn(&format!("{BEND}, {BEND}"));
        let soft = made(&library, &board, &Exact::Soft);
        let pinned = made(&library, &board, &Exact::Pin(MeetOptions::default()));
        let size = pinned.clip.skeleton().extent();
        for (part, soft) in pinned.parts.iter().zip(&soft.parts) {
            println!(
                "{name}: {:?}, soft {:.3?} m, pinned {:.4?} m of {size:.2}",
                part.retrieved, soft.after, part.after
            );
            assert!(soft.after[0] < 0.2 * size, "{:?}", soft.after);
            assert!(part.after[1] < 1e-3, "{:?}", part.after);
        }
        // Both lines are of one length; the second goes on where the first has come to, without a jump.
        assert!((pinned.parts[0].frames as i64 - pinned.parts[1].frames as i64).abs() <= 1);
        let (jump, own) = (jump(&pinned.clip), jump(&sample(name)));
        let slide = Contacts::of(&pinned.clip).slide(&pinned.clip).map(|slide| slide.mean_step_mm);
        println!(
            "{name}: largest step {jump:.1} mean ones, {own:.1} in the clip; feet slide {slide:.1?} mm a frame"
        );
        assert!(jump < most, "{jump}");
        // The body turns as its way does: over the first frame's line about a quarter round.
        let carrier = pinned.clip.travel_joint();
        let places = kinematics::positions(&pinned.clip);
        let ahead = |from: usize, to: usize| places.frame(to)[carrier] - places.frame(from)[carrier];
        let last = pinned.parts[0].frames - 1;
        let (a, b) = (ahead(0, last / 6), ahead(last - last / 6, last));
        assert!(a.with_y(0.0).angle_between(b.with_y(0.0)) > 0.6, "{a} {b}");
    }
}

#[test]
fn a_body_does_not_jump_after_a_pause() {
    let library = library(&[("trot", sample("quadruped.bvh"))]);
    for pause in [0.5, 2.0] {
        let board = drawn(&format!("{BEND}, {{\"word\": \"trot\", \"seconds\": {pause}}}, {BEND}"));
        let [soft, pinned] =
            [Exact::Soft, Exact::Pin(MeetOptions::default())].map(|exact| made(&library, &board, &exact));
        let carrier = pinned.clip.travel_joint();
        let [own, plain] = [&pinned.clip, &soft.clip].map(kinematics::positions);
        // How far pins shift the body: that goes on from frame to frame, and a way begins with what is left of it.
        let shift = |frame: usize| own.frame(frame)[carrier] - plain.frame(frame)[carrier];
        let given = shift(pinned.parts[1].begins - 1).length();
        let jumps = (pinned.parts[1].begins..=pinned.parts[2].begins)
            .map(|frame| shift(frame).distance(shift(frame - 1)))
            .fold(0.0, f32::max);
        println!(
            "{given:.3} m off at the end of a way; in {pause} s given back by {jumps:.4} m a frame at most"
        );
        assert!(given > 0.02 && jumps < 0.1 * given, "{given} {jumps}");
    }
}

#[test]
fn what_is_too_long_is_said() {
    let library = library(&[("trot", sample("quadruped.bvh"))]);
    let long = drawn(&[r#"{"word": "trot", "seconds": 60}"#; 11].join(","));
    let read = |(at, frame): (usize, &Frame)| read_creature(frame, at + 1, &library).unwrap();
    let frames: Vec<_> = long.frames.iter().enumerate().map(read).collect();
    let said = creature(&library, &frames, &Exact::Soft).unwrap_err().to_string();
    assert!(said.contains("frame 11: with it the animation is longer than 10 minutes"), "{said}");
    let slow = drawn(r#"{"trajectories": [{"points": [[0, 0, 0], [9, 9, 75]]}]}"#);
    let said = read_creature(&slow.frames[0], 1, &library).unwrap_err().to_string();
    assert!(said.contains("trajectory 1 lasts 75.0 s, but at most 60 s"), "{said}");
    let fitted = drawn(r#"{"seconds": 5, "trajectories": [{"points": [[0, 0, 0], [9, 9, 75]]}]}"#);
    let read = read_creature(&fitted.frames[0], 1, &library).unwrap();
    assert!(read.seconds == 5.0 && read.ways[0].seconds == 5.0 && read.notes[0].contains("made to fit"));
}

#[test]
fn another_word_takes_another_clip_and_a_limb_follows_its_own_line() {
    let hound = sample("quadruped.bvh");
    let (half, end) = (hound.frames() / 2, hound.frames());
    let parts =
        [("trot", time::trim(&hound, 0..half).unwrap()), ("gallop", time::trim(&hound, half..end).unwrap())];
    let library = library(&parts);
    for word in ["trot", "gallop", "run"] {
        let board = drawn(&format!("{{\"word\": \"{word}\"}}"));
        let made = made(&library, &board, &Exact::Soft);
        let expected = if word == "trot" { "trot" } else { "gallop" };
        assert_eq!(made.parts[0].retrieved.example, expected, "{word}");
        assert!((made.clip.duration() - 3.0).abs() < 0.1, "{}", made.clip.duration());
    }
    let skeleton = hound.skeleton();
    let head = skeleton.joints().iter().position(|joint| joint.name.to_lowercase().contains("head")).unwrap();
    let name = &skeleton.joints()[head].name;
    let board = drawn(&format!(
        "{{\"word\": \"trot\", \"seconds\": 2, \"trajectories\": [{{\"joint\": \"{name}\", \"points\": [[0,0],[2,10],[0,20],[-2,10],[0,0]]}}]}}"
    ));
    let [soft, pinned] =
        [Exact::Soft, Exact::Pin(MeetOptions::default())].map(|exact| made(&library, &board, &exact));
    println!("{name}: {:.3?} m off, pinned {:.4?}", soft.parts[0].after, pinned.parts[0].after);
    assert!(pinned.parts[0].after[1] < 0.02 && soft.parts[0].after[1] > 0.03, "{:?}", pinned.parts[0].after);
    let wrong = drawn("{\"trajectories\": [{\"joint\": \"wing\", \"points\": [[0,0],[1,1]]}]}");
    let said = read_creature(&wrong.frames[0], 1, &library).unwrap_err().to_string();
    assert!(said.contains("wing") && said.contains("Its joints begin with"), "{said}");
}

#[test]
fn a_person_is_answered_from_clips_and_pinned() {
    let library = library(&[("walk around", sample("person.bvh"))]);
    assert!(library.of_person());
    let model = &*MODEL;
    for name in ["walk-and-wave", "turn-and-run"] {
        let read: Vec<_> = board(name).frames.iter().map(|frame| understood(frame).unwrap()).collect();
        let plans: Vec<_> = read.iter().map(|read| read.plan.clone()).collect();
        let answers = library.answers(&plans, &model.body, true).unwrap();
        let clips: Vec<Generated> = answers.iter().map(|answer| answer.clip.clone()).collect();
        let made = animation(&clips, None, &model.body, &Exact::Pin(MeetOptions::default())).unwrap();
        let motion = poses(&made.clip);
        let off = misses(&motion, &made.goals.concat());
        println!(
            "{name}: {:?}; found {:.3?} m, pinned {off:.4?} m; skating {:.3}",
            answers
                .iter()
                .map(|answer| (answer.retrieved.seconds, answer.retrieved.aligned))
                .collect::<Vec<_>>(),
            clips.iter().map(|clip| clip.error).collect::<Vec<_>>(),
            skating(&motion).ratio
        );
        assert!(off[1] < 0.02, "{off:?}");
        assert!(motion.iter().flatten().all(|place: &Vec3| place.length() < 30.0));
        assert_eq!(
            answers.iter().map(|answer| answer.clip.motion.len()).collect::<Vec<_>>(),
            plans.iter().map(|plan| plan.frames).collect::<Vec<_>>()
        );
    }
}

#[test]
fn clips_of_several_skeletons_are_refused_by_name() {
    let clips = [
        ("hound", sample("quadruped.bvh")),
        ("hound 2", sample("quadruped.bvh")),
        ("snake", sample("snake.bvh")),
    ];
    let example = |(name, clip): (&str, Clip)| Example { name: name.into(), said: name.into(), clip };
    let said = Library::new(clips.map(example).into()).unwrap_err().to_string();
    assert!(said.contains("2 skeletons") && said.contains("snake have another"), "{said}");
    let said = Library::new(Vec::new()).unwrap_err().to_string();
    assert!(said.contains("no clip"), "{said}");
}

/// Real animals, where they are there.
#[test]
fn real_animals_go_where_a_line_is_drawn() {
    for (file, way) in [
        ("wolf", "gallop"),
        ("fox-animations", "run"),
        ("horse-animations", "run"),
        ("shibainu", "gallop"),
        ("snake-animations", "winding"),
        ("bird-animations", "walk"),
    ] {
        let Some(bytes) = crate::onto::reference(&format!("creatures/{file}.glb")) else { return };
        let read = |choice| {
            let options = ImportOptions { clip: choice, ..ImportOptions::default() };
            read_motion(&bytes, Format::Glb, &options, &no_files).unwrap()
        };
        let names: Vec<String> = read(None).clips.into_iter().map(|clip| clip.name).collect();
        let clips: Vec<(&str, Clip)> = names
            .iter()
            .enumerate()
            .map(|(number, name)| {
                (name.as_str(), read(Some(inkrig_formats::ClipChoice::Number(number + 1))).clip)
            })
            .collect();
        let library = library(&clips);
        let board = drawn(&format!(
            "{}, {}, {{\"word\": \"eating\"}}",
            BEND.replace("trot", "walk"),
            r#"{"word": "WAY", "trajectories": [{"points": [[0,0],[-60,10],[-120,0],[-180,-30],[-220,-80]]}]}"#.replace("WAY", way)
        ));
        let begun = std::time::Instant::now();
        let [soft, pinned] =
            [Exact::Soft, Exact::Pin(MeetOptions::default())].map(|exact| made(&library, &board, &exact));
        let size = pinned.clip.skeleton().extent();
        let slide = Contacts::of(&pinned.clip).slide(&pinned.clip).map(|slide| slide.mean_step_mm);
        println!(
            "{file}: {size:.2} m, {:.1} s; feet slide {slide:.1?} mm a frame; largest step {:.1}",
            begun.elapsed().as_secs_f64(),
            jump(&pinned.clip)
        );
        for (part, soft) in pinned.parts.iter().zip(&soft.parts) {
            let speed = part.metres_per_unit;
            println!(
                "  {} {:?}, aligned {}: soft {:.3?}, pinned {:.4?}, unit {speed:?}",
                part.retrieved.example,
                part.retrieved.seconds,
                part.retrieved.aligned,
                soft.after,
                part.after
            );
            assert!(part.after[1] < 1e-3 * size, "{file} {:?}", part.after);
            assert!(soft.after[0] < 0.3 * size, "{file} {:?}", soft.after);
        }
        let carrier = pinned.clip.travel_joint();
        println!("  carried by {}", pinned.clip.skeleton().joints()[carrier].name);
        assert!(pinned.parts[1].retrieved.word < 0.7, "{file}: {:?}", pinned.parts[1].retrieved);
    }
}
