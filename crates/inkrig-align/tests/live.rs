//! Following a control that changes: strokes redrawn and samples that come one by one, on this project's own samples and
//! on a real dance.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{
    AlignError, Comparison, Control, CurveOptions, Key, LiveAlignment, LiveAnswer, LiveEvent, Options,
    Quality, StreamAlignment, StreamOptions, align,
};
use inkrig_motion::{Clip, Takes, kinematics, time};
use inkrig_sketch::{Curve, Timing};
use std::ops::ControlFlow;
use support::{reference, sample};

/// Five circles that grow, as a hand draws them; from `bent` of its length on, a tenth is drawn elsewhere.
fn drawn(frames: usize, bent: Option<f64>) -> Vec<[f64; 2]> {
    let at = |i: usize| {
        let t = i as f64 / frames as f64;
        let (sin, cos) = (std::f64::consts::TAU * 5.0 * t).sin_cos();
        let size = 0.2 + 0.8 * t;
        let hump = bent.map_or(0.0, |from| {
            let place = (t - from) / 0.1;
            if (0.0..1.0).contains(&place) { 0.6 * (std::f64::consts::PI * place).sin() } else { 0.0 }
        });
        [300.0 + 100.0 * (size + hump) * cos, 200.0 + 100.0 * (size + hump) * sin]
    };
    (0..frames).map(at).collect()
}

fn control(points: Vec<[f64; 2]>) -> Control {
    let options = CurveOptions { timing: Some(Timing::AsSampled), ..CurveOptions::default() };
    Control::from_curve(&Curve::new(points).unwrap(), &options).unwrap()
}

fn update(live: &mut LiveAlignment, control: &Control) -> Vec<LiveAnswer> {
    let mut answers = Vec::new();
    live.update(control, &mut |event| {
        if let LiveEvent::Answer(answer) = event {
            answers.push(*answer);
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    answers
}

fn quality(clip: &Clip, control: &Control, result: &Clip, options: &Options) -> Quality {
    Comparison::new(&clip.clone().into(), control, options).unwrap().measure(result).unwrap()
}

/// Six small changes after each other, against one run from the beginning.
fn stays_close_to_a_fresh_solve(clip: &Clip) {
    let options = Options::default();
    let mut live = LiveAlignment::new(&clip.clone().into(), &options).unwrap();
    let first = update(&mut live, &control(drawn(300, None)));
    assert_eq!(first.iter().map(|answer| answer.level).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(first.iter().all(|answer| answer.clip.frames() == first[0].clip.frames() && !answer.warm));
    let mut last = Vec::new();
    let mut now = control(drawn(300, None));
    for step in 0..6 {
        now = control(drawn(300, Some(0.13 * step as f64)));
        last = update(&mut live, &now);
        assert!(last[0].changed_patches < 160, "{} patches changed", last[0].changed_patches);
    }
    let answer = last.last().unwrap();
    assert!(answer.is_final && last[..3].iter().all(|answer| !answer.is_final));
    let fresh = align(&clip.clone().into(), &now, &options.clone().preview_schedule(), &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let (warm, fresh) =
        (quality(clip, &now, &answer.clip, &options), quality(clip, &now, &fresh.clip, &options));
    let coarse = quality(clip, &now, &last[1].clip, &options);
    println!(
        "structure {:.3} against {:.3} fresh (second answer {:.3}), nearest {:.3} against {:.3}, jump {:.2} against {:.2}, warm: {}",
        warm.structure_pearson,
        fresh.structure_pearson,
        coarse.structure_pearson,
        warm.nearest_patch,
        fresh.nearest_patch,
        warm.jump_q999_ratio,
        fresh.jump_q999_ratio,
        answer.warm,
    );
    assert!(warm.structure_pearson > fresh.structure_pearson - 0.05);
    assert!(warm.nearest_patch < fresh.nearest_patch + 0.06);
    assert!(warm.jump_q999_ratio < 2.0);
    assert!(
        coarse.structure_pearson > warm.structure_pearson - 0.35,
        "the coarse answer shows where it goes"
    );
    let mut settled = None;
    live.settle(&mut |event| {
        if let LiveEvent::Answer(answer) = event {
            settled = Some(answer);
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    let full = align(&clip.clone().into(), &now, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(settled.unwrap().clip, full.clip, "what is settled is what align gives");
}

#[test]
fn a_stroke_redrawn_on_a_dance_stays_close_to_a_fresh_solve() {
    let Some(clip) = reference("cmu-dance/salsa/01.bvh") else { return };
    stays_close_to_a_fresh_solve(&time::trim(&clip, 0..600).unwrap());
}

#[test]
fn a_stroke_redrawn_stays_close_to_a_fresh_solve() {
    for name in ["person", "snake"] {
        println!("{name}");
        stays_close_to_a_fresh_solve(&sample(name));
    }
}

#[test]
fn a_stroke_may_grow_and_shrink_and_become_another() {
    let clip = sample("quadruped");
    let options = Options::default();
    let mut live = LiveAlignment::new(&clip.clone().into(), &options).unwrap();
    let whole = drawn(260, None);
    let mut warm = 0;
    for frames in [120, 150, 180, 230, 260, 200] {
        let answers = update(&mut live, &control(whole[..frames].to_vec()));
        let last = answers.last().unwrap();
        assert_eq!(last.weights.rows(), frames);
        assert!((0..frames).all(|row| (last.weights.row(row).iter().sum::<f32>() - 1.0).abs() < 1e-3));
        warm += usize::from(last.warm);
    }
    println!("{warm} of 5 changes went on from the last plan");
    assert!(warm >= 3);
    let other = Control::from_curve(
        &inkrig_sketch::shapes::wave(6, 200).unwrap(),
        &CurveOptions { timing: Some(Timing::AsSampled), ..CurveOptions::default() },
    )
    .unwrap();
    let answers = update(&mut live, &other);
    let fresh = align(&clip.clone().into(), &other, &options.clone().preview_schedule(), &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let found = quality(&clip, &other, &answers.last().unwrap().clip, &options);
    println!("structure {:.3} against {:.3}", found.structure_pearson, fresh.report.structure_pearson);
    assert!(found.structure_pearson > fresh.report.structure_pearson - 0.1);
}

#[test]
fn an_update_can_be_stopped_and_the_next_goes_on() {
    let clip = sample("snake");
    let mut live = LiveAlignment::new(&clip.into(), &Options::default()).unwrap();
    let (one, two) = (control(drawn(150, None)), control(drawn(170, Some(0.5))));
    for stop in 1..9 {
        let mut events = 0;
        let stopped = live.update(if stop % 2 == 0 { &one } else { &two }, &mut |_| {
            events += 1;
            if events == stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(stopped, Err(AlignError::Cancelled)));
        assert_eq!(events, stop);
    }
    assert!(update(&mut live, &two).last().unwrap().is_final);
}

/// The samples of a control in the units that [`StreamAlignment::append`] takes.
fn rows(points: &[[f64; 2]]) -> Vec<f32> {
    points.iter().flatten().map(|&value| value as f32).collect()
}

/// Pieces of a stream joined, and how many there were.
fn streamed(clip: &Clip, options: &StreamOptions, points: &[[f64; 2]], at_once: usize) -> (Vec<Clip>, usize) {
    let mut stream = StreamAlignment::new(&clip.clone().into(), options).unwrap();
    let (mut pieces, mut frames) = (Vec::new(), 0);
    let step = clip.frame_rate() / 30.0;
    for (index, part) in points.chunks(at_once).enumerate() {
        let piece = stream.append(&rows(part), 2).unwrap();
        let taken = index * at_once + part.len();
        assert_eq!(piece.first_frame, frames);
        frames += piece.clip.as_ref().map_or(0, Clip::frames);
        if taken >= options.warm_up + options.hop {
            assert!(piece.samples_given + stream.latency() >= taken, "{} of {taken}", piece.samples_given);
        }
        assert!(piece.samples_given + options.look_ahead <= taken || piece.samples_given == 0);
        pieces.extend(piece.clip);
    }
    let last = stream.finish().unwrap();
    assert_eq!(last.samples_given, points.len());
    frames += last.clip.as_ref().map_or(0, Clip::frames);
    assert_eq!(frames, (points.len() as f64 * step).round() as usize);
    pieces.extend(last.clip);
    (pieces, frames)
}

/// The largest step of a joint, relative to the travelling one, within a clip; metres a second.
fn fastest(clips: &[Clip]) -> (f32, f32) {
    let (mut within, mut across) = (0.0_f32, 0.0_f32);
    let mut before: Option<Vec<_>> = None;
    for clip in clips {
        let positions = kinematics::positions(clip);
        for frame in 0..clip.frames() {
            let joints = positions.frame(frame);
            if let Some(before) = &before {
                let step =
                    joints.iter().zip(before).map(|(a, b): (_, &_)| a.distance(*b)).fold(0.0, f32::max);
                let speed = step * clip.frame_rate() as f32;
                if frame == 0 { across = across.max(speed) } else { within = within.max(speed) }
            }
            before = Some(joints.to_vec());
        }
    }
    (within, across)
}

fn a_stream_goes_on_without_jumps(clip: &Clip) {
    let options = StreamOptions::default();
    let points: Vec<[f64; 2]> = drawn(300, None).into_iter().chain(drawn(300, None)).skip(150).collect();
    let (pieces, frames) = streamed(clip, &options, &points, 3);
    assert!(pieces.len() > 100, "{} pieces", pieces.len());
    let (original, _) = fastest(std::slice::from_ref(clip));
    let (within, across) = fastest(&pieces);
    println!(
        "{frames} frames; fastest {original:.2} in the clip, {within:.2} in pieces, {across:.2} at borders"
    );
    assert!(across < 1.1 * within && within < 1.5 * original);
    let whole = Takes::join(&pieces).unwrap();
    let control = control(points);
    let quality = quality(clip, &control, whole.clip(), &options.align);
    let all =
        align(&clip.clone().into(), &control, &options.align, &mut |_| ControlFlow::Continue(())).unwrap();
    println!(
        "structure {:.3} ({:.3} when all is known), nearest {:.3}, speed {:.2}, jump {:.2}",
        quality.structure_pearson,
        all.report.structure_pearson,
        quality.nearest_patch,
        quality.speed_mean_ratio,
        quality.jump_q999_ratio
    );
    assert!(quality.structure_pearson > 0.3);
    assert!(quality.jump_q999_ratio < 2.0);
    assert!(quality.nearest_patch < 0.35);
}

#[test]
fn a_stream_makes_a_dancer_follow_without_jumps() {
    let Some(clip) = reference("cmu-dance/salsa/01.bvh") else { return };
    a_stream_goes_on_without_jumps(&time::trim(&clip, 0..600).unwrap());
}

#[test]
fn a_stream_is_followed_without_jumps() {
    a_stream_goes_on_without_jumps(&sample("person"));
}

#[test]
fn how_samples_come_does_not_matter_and_what_was_given_stays() {
    let clip = sample("snake");
    let options = StreamOptions::default();
    let points = drawn(200, None);
    let join = |at_once| {
        let (pieces, _) = streamed(&clip, &options, &points, at_once);
        Takes::join(&pieces).unwrap().clip().clone()
    };
    let one = join(1);
    assert_eq!(one, join(7));
    assert_eq!(one, join(64));
}

#[test]
fn a_long_stream_keeps_to_its_window() {
    let clip = sample("snake");
    let options = StreamOptions { window: 60, warm_up: 40, rounds: 1, ..StreamOptions::default() };
    let mut stream = StreamAlignment::new(&clip.into(), &options).unwrap();
    let mut given = 0;
    for second in 0..60 {
        let at = |i: usize| (second * 30 + i) as f32 * 0.15;
        let samples: Vec<f32> =
            (0..30).flat_map(|i| [at(i).sin() * (1.0 + 0.2 * (0.1 * at(i)).cos())]).collect();
        let piece = stream.append(&samples, 1).unwrap();
        given += piece.weights.len();
        assert_eq!(given, piece.samples_given);
    }
    assert_eq!(given, 1800 - options.look_ahead);
    let held = stream.window_samples();
    assert!(held <= options.window + options.hop, "{held} samples are held");
}

#[test]
fn a_stream_may_rest_for_minutes_before_it_begins() {
    let clip = sample("snake");
    let options = StreamOptions { window: 60, warm_up: 40, rounds: 1, ..StreamOptions::default() };
    let moves: Vec<f32> = (0..240).map(|i| 0.5 + (i as f32 * 0.12).sin()).collect();
    let after = |rest: usize| {
        let mut stream = StreamAlignment::new(&clip.clone().into(), &options).unwrap();
        let (mut given, mut pieces) = (0, Vec::new());
        for samples in std::iter::repeat_n(&[0.5; 100][..], rest).chain([&moves[..]]) {
            let piece = stream.append(samples, 1).unwrap();
            given += piece.weights.len();
            assert_eq!(given, piece.samples_given);
            let held = stream.window_samples();
            assert!(held <= options.window + options.hop, "{held}");
            pieces.extend(piece.clip);
        }
        let last = stream.finish().unwrap();
        assert_eq!(last.samples_given, 100 * rest + 240, "every sample has its motion");
        pieces.extend(last.clip);
        fastest(&pieces)
    };
    let (rested, at_once) = (after(100), after(0));
    let original = fastest(std::slice::from_ref(&clip)).0;
    println!(
        "fastest {original:.2} in the clip, {at_once:?} in pieces and at their borders, {rested:?} after a rest"
    );
    // A window this short follows a quick wave restlessly, with a rest before it or without.
    assert!(rested.1 < 1.5 * original && rested.0 < 1.2 * at_once.0.max(original));
}

#[test]
fn what_a_stream_cannot_take_is_said() {
    let takes = sample("snake").into();
    let with = |change: &dyn Fn(&mut StreamOptions)| {
        let mut options = StreamOptions::default();
        change(&mut options);
        StreamAlignment::new(&takes, &options).map(|_| ()).unwrap_err().to_string()
    };
    assert!(with(&|options| options.look_ahead = 0).contains("look-ahead is 0"));
    assert!(with(&|options| options.window = 30).contains("window is 30"));
    let key = Key::Never { pose: 3.into(), radius: 0.1 };
    assert!(with(&|options| options.align.keys.push(key.clone())).contains("without an end"));
    let mut stream = StreamAlignment::new(&takes, &StreamOptions::default()).unwrap();
    assert!(stream.append(&[1.0, f32::NAN], 2).unwrap_err().to_string().contains("not a number"));
    assert!(stream.append(&[1.0, 2.0, 3.0], 2).unwrap_err().to_string().contains("same number"));
    assert!(stream.append(&[1.0, 2.0], 2).unwrap().clip.is_none());
    assert!(stream.append(&[1.0], 1).is_err());
    assert!(matches!(stream.finish(), Err(AlignError::ControlTooShort { frames: 1, .. })));
    let mut still = StreamAlignment::new(&takes, &StreamOptions::default()).unwrap();
    assert!(still.append(&[1.0; 200], 2).unwrap().clip.is_none(), "it waits for the pen to move");
    assert!(matches!(still.finish(), Err(AlignError::StillControl)));
}
