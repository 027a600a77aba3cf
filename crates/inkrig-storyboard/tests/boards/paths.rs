//! Ways over the ground that a frame takes over from what was made before.

use crate::support::{MODEL, generated, p99, poses, understood};
use inkrig_generate::measures::{jerk, skating};
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::Joints;
use inkrig_sketch::storyboard::{Frame, read_storyboard};
use inkrig_storyboard::{Animation, Exact, Generated, MeetOptions, Source, Understood, animation, misses};

/// A walk along a drawn way, and a frame behind it.
fn board(second: &str) -> Vec<Frame> {
    let sample = inkrig_samples::find("walk-and-wave.json").unwrap().bytes;
    let first = read_storyboard(sample).unwrap().frames.remove(0);
    let text = format!("{{\"inkrig_storyboard\": 1, \"frames\": [{{\"word\": \"walk\"}}, {second}]}}");
    vec![first, read_storyboard(text.as_bytes()).unwrap().frames.remove(1)]
}

/// The clips of frames, each along the path that it takes over; `drawn` as in the program.
fn clips(frames: &[Frame], drawn: bool) -> Vec<Generated> {
    let mut clips: Vec<Generated> = Vec::new();
    for (at, frame) in frames.iter().enumerate() {
        // Frames know their place only when they are read with it.
        let mut read: Understood = understood(&Frame { path: None, ..frame.clone() }).unwrap();
        read.plan.follows = frame.path;
        if let Some(leads) = read.plan.path_of(at + 1) {
            read.plan = read.plan.along(&clips[leads - 1].motion);
        }
        clips.push(generated(&read, at + 1, &MODEL.sampling, drawn));
    }
    clips
}

fn made(clips: &[Generated], exact: &Exact) -> Animation {
    animation(clips, None, &MODEL.body, exact).unwrap()
}

/// Mean and largest distance of the pelvis from the path, metres.
fn off(clips: &[Generated], exact: &Exact) -> ([f32; 2], Vec<Joints>) {
    let made = made(clips, exact);
    let path: Vec<_> = made.goals.concat().into_iter().filter(|goal| goal.source == Source::Path).collect();
    assert_eq!(path.len(), clips[1].plan.frames);
    let motion = poses(&made.clip);
    (misses(&motion, &path), motion)
}

/// Where a clip's pelvis goes in a second, metres.
fn gone(motion: &[Joints], at: usize) -> Vec2 {
    let by: Vec3 = motion[at + 19][0] - motion[at][0];
    Vec2::new(by.x, by.z)
}

#[test]
fn a_frame_goes_on_as_the_one_before_it_ends() {
    for second in [
        r#"{"word": "walk", "path": "continue"}"#,
        r#"{"word": "run", "seconds": 3, "path": "continue"}"#,
        r#"{"word": "wave", "path": "continue"}"#,
    ] {
        let frames = board(second);
        let led = clips(&frames, true);
        let free = clips(&[frames[0].clone(), Frame { path: None, ..frames[1].clone() }], true);
        assert_eq!(led[0].motion, free[0].motion, "the frame before is the same");
        // The same motion without the path is far from it, sampled with it it is near, and in the end it is on it.
        let path = &led[1].plan.path.clone().unwrap();
        let away = Generated { plan: led[1].plan.clone(), ..free[1].clone() };
        let (unled, _) = off(&[led[0].clone(), away], &Exact::Off);
        let by_word = clips(&frames, false);
        let (off_word, _) = off(&by_word, &Exact::Off);
        let (sampled, _) = off(&led, &Exact::Off);
        let (soft, near) = off(&led, &Exact::Soft);
        let (pinned, motion) = off(&led, &Exact::Pin(MeetOptions::default()));
        let length: f32 = path.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        println!(
            "{second}: {length:.2} m; off the path {unled:.3?} m without it, {sampled:.3?} with it ({off_word:.3?} where nothing drawn counts), {soft:.4?} soft, {pinned:.4?} pinned; skating {:.3}, {:.3}, P99 of jerk {:.4}, {:.4}",
            skating(&near).ratio,
            skating(&motion).ratio,
            p99(&jerk(&near)),
            p99(&jerk(&motion)),
        );
        assert!(sampled[0] < 0.5 * unled[0] && off_word[0] < 0.5 * unled[0], "{sampled:?} {unled:?}");
        assert!(soft[0] < 0.05 && soft[1] < 0.25, "{soft:?}");
        assert!(pinned[1] < 0.01, "{pinned:?}");
        // As fast as the path, and on in the same direction.
        let start = made(&led, &Exact::Soft).joined.starts[1];
        let (before, after) = (gone(&near, start - 32), gone(&near, start));
        let asked = path[19].distance(path[0]);
        assert!((after.length() / asked - 1.0).abs() < 0.35, "{after} {asked}");
        assert!(before.angle_to(after).abs() < 0.8, "{before} {after}");
    }
}

#[test]
fn a_way_is_gone_again_from_where_the_one_before_ends() {
    let frames = board(r#"{"word": "walk", "path": 1}"#);
    let led = clips(&frames, true);
    let path = led[1].plan.path.clone().unwrap();
    let first = &led[0].motion;
    // Up to the sway of the body.
    for (frame, place) in path.iter().enumerate().take(first.len()) {
        let own = first[frame][0] - first[0][0];
        let moved = *place - path[0];
        assert!((own - moved).with_y(0.0).length() < 0.08, "{frame}: {own} {moved}");
    }
    let (soft, _) = off(&led, &Exact::Soft);
    println!("again: {soft:.3?} m");
    assert!(soft[0] < 0.05, "{soft:?}");
}

/// A drawn pose keeps its say where the way over the ground is another frame's.
#[test]
fn a_drawn_pose_goes_along_a_path() {
    let mut frames = board(r#"{"word": "walk", "path": "continue"}"#);
    let sample = inkrig_samples::find("walk-and-wave.json").unwrap().bytes;
    let waving = read_storyboard(sample).unwrap().frames.remove(1);
    frames[1] = Frame { path: frames[1].path, seconds: Some(2.0), ..waving };
    assert!(!frames[1].body.is_empty());
    let led = clips(&frames, true);
    let (path, _) = off(&led, &Exact::Soft);
    let pinned = made(&led, &Exact::Pin(MeetOptions::default()));
    let met = misses(&poses(&pinned.clip), &pinned.goals.concat());
    println!("drawn: {path:.3?} m off the path, pinned {met:.4?} off all");
    assert!(path[0] < 0.06 && met[1] < 0.01, "{path:?} {met:?}");
}

#[test]
fn a_path_that_cannot_be_is_said() {
    let frames = board(r#"{"word": "walk", "path": "continue"}"#);
    let said = understood(&frames[1]).unwrap_err();
    assert!(said.contains("frame 1: it is to go on along the path of the frame before"), "{said}");
    let own = Frame { path: frames[1].path, ..frames[0].clone() };
    let said = understood(&own).unwrap_err();
    assert!(said.contains("cannot go both ways") && said.contains("Leave out \"path\""), "{said}");
}
