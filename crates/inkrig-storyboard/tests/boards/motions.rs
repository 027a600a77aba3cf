//! From drawings to motions that meet them.

use crate::support::{MODEL, board, generated, p99, poses, understood};
use inkrig_generate::measures::{jerk, skating};
use inkrig_generate::sampling::SamplingOptions;
use inkrig_motion::humanml::{Joints, bone_lengths};
use inkrig_sketch::storyboard::{Frame, read_storyboard};
use inkrig_storyboard::{Exact, Generated, Goal, MeetOptions, Understood, animation, misses};

#[test]
fn all_storyboards_become_motions_that_meet_what_was_drawn() {
    let model = &*MODEL;
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let read: Vec<Understood> = board.frames.iter().map(|frame| understood(frame).unwrap()).collect();
        let clips: Vec<Generated> = read
            .iter()
            .enumerate()
            .map(|(at, read)| generated(read, at + 1, &model.sampling, true))
            .collect();
        let soft = animation(&clips, None, &model.body, &Exact::Soft).unwrap();
        let pinned = animation(&clips, None, &model.body, &Exact::Pin(MeetOptions::default())).unwrap();
        let goals: Vec<Goal> = pinned.goals.concat();
        let met = pinned.met.unwrap();
        let (before, after) = (poses(&soft.clip), poses(&pinned.clip));
        println!(
            "{}: {} frames, drawn poses moved by {:.3?} m, {:?} steps; off the lines {:.4?} m, pinned {:.4?}; P99 of jerk {:.4}, {:.4}; skating {:.3}, {:.3}",
            sample.name,
            after.len(),
            pinned.proportioned,
            met.steps,
            misses(&before, &goals),
            met.after,
            p99(&jerk(&before)),
            p99(&jerk(&after)),
            skating(&before).ratio,
            skating(&after).ratio,
        );
        assert!(after.iter().flatten().all(|place| place.is_finite() && place.length() < 50.0));
        assert!(met.after[1] < 0.01, "{}: {:?}", sample.name, met.after);
        let bones = bone_lengths(&after[0]);
        let last = bone_lengths(after.last().unwrap());
        assert!(bones.iter().zip(&last).all(|(a, b)| (a.length() - b.length()).abs() < 1e-3));
        // What is written is what was met.
        assert!((misses(&after, &goals)[1] - met.after[1]).abs() < 2e-3, "{}", sample.name);
    }
}

#[test]
fn drawing_and_seed_decide_and_nothing_else() {
    let model = &*MODEL;
    let read = understood(&board("kick").frames[0]).unwrap();
    let once = generated(&read, 1, &model.sampling, true);
    assert_eq!(once, generated(&read, 1, &model.sampling, true));
    assert_ne!(
        once.motion,
        generated(&read, 2, &model.sampling, true).motion,
        "another frame has another seed"
    );
    // Drawn to the lines the motion is nearer to them than by its word alone.
    let free = generated(&read, 1, &model.sampling, false);
    let told = generated(&read, 1, &SamplingOptions { guidance: None, ..model.sampling.clone() }, true);
    println!(
        "kick: {:.3} m by the word, {:.3} m where the networks see the drawing, {:.3} m drawn to the lines too",
        free.error, told.error, once.error
    );
    assert!(told.error < 0.8 * free.error, "{} {}", told.error, free.error);
    assert!(once.error < 0.6 * free.error, "{} {}", once.error, free.error);
}

/// The steps of the paper's figure 13: the word alone, a key pose too, another path, another word. Each change shows where it should.
#[test]
fn word_pose_and_path_each_do_their_part() {
    let model = &*MODEL;
    let kick = board("kick").frames[0].clone();
    let walk = board("walk-and-wave").frames[0].clone();
    let bare = Frame { word: "kick".into(), ..Frame::default() };
    let posed = Frame { trajectories: Vec::new(), speed_lines: Vec::new(), ..kick.clone() };
    let other_path =
        Frame { trajectories: walk.trajectories.clone(), body: walk.body.clone(), ..kick.clone() };
    let other_word = Frame { word: "jump".into(), ..kick.clone() };
    let drawn = understood(&kick).unwrap();
    for (name, frame) in [
        ("word", bare),
        ("pose", posed),
        ("drawing", kick),
        ("other path", other_path),
        ("other word", other_word),
    ] {
        let Ok(read) = understood(&frame) else { panic!("{name} is not understood") };
        let clip = generated(&read, 1, &model.sampling, true);
        let soft = animation(std::slice::from_ref(&clip), None, &model.body, &Exact::Soft).unwrap();
        let own = misses(&poses(&soft.clip), &soft.goals.concat());
        println!("{name}: {:.3} m off what was drawn for it, {} frames", own[0], soft.clip.frames());
        assert!(own[0] < 0.12, "{name}: {own:?}");
    }
    assert!(!drawn.plan.ways.is_empty());
}

#[test]
fn a_drawn_jump_leaves_the_floor() {
    let frames = board("jump").frames;
    let read = frames.iter().map(|frame| understood(frame).unwrap());
    let clips: Vec<Generated> =
        read.enumerate().map(|(at, read)| generated(&read, at + 1, &MODEL.sampling, true)).collect();
    let made = animation(&clips, None, &MODEL.body, &Exact::Pin(MeetOptions::default())).unwrap();
    let motion = poses(&made.clip);
    let lowest =
        |frame: &Joints| [7, 8, 10, 11].map(|joint| frame[joint].y).into_iter().fold(f32::MAX, f32::min);
    let first = 0..clips[0].motion.len();
    let high = motion[first].iter().map(lowest).fold(f32::MIN, f32::max);
    let slides = skating(&motion).ratio;
    println!("a jump: lower foot {high:.2} m up, feet slide in {slides:.3} of all moments");
    assert!(high > 0.1 && slides < 0.05, "{high} {slides}");
}
