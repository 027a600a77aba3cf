//! The first real job from end to end: a clip and a drawn curve give a motion that follows the curve.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{
    AlignError, Alignment, Control, ControlKind, CurveOptions, Norm, Options, Preset, Report, align,
};
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, Features, Joint, Skeleton, Takes, TranslationTrack, kinematics, time};
use inkrig_sketch::{Curve, shapes};
use std::ops::ControlFlow;
use support::{reference, sample};

fn follow(clip: &Clip, curve: &Curve, options: &Options) -> Alignment {
    let control = Control::from_curve(curve, &CurveOptions::default()).unwrap();
    let result = align(&clip.clone().into(), &control, options, &mut |_| ControlFlow::Continue(())).unwrap();
    let r = &result.report;
    println!(
        "structure {:.3} (ranks {:.3}, warp {:.3}), nearest {:.3}, coverage {:.2}, speed {:.2}, jump {:.2}, jerk {:.2}, freeze {:.2}",
        r.structure_pearson,
        r.structure_spearman,
        r.structure_pearson_warp,
        r.nearest_patch,
        r.coverage,
        r.speed_mean_ratio,
        r.jump_q999_ratio,
        r.jerk_ratio,
        r.freeze
    );
    result
}

/// The gates of a good result.
fn assert_follows(report: &Report) {
    assert!(report.structure_pearson >= 0.6, "structure {}", report.structure_pearson);
    let gain = report.structure_pearson - report.structure_pearson_warp;
    assert!(gain >= 0.4, "only {gain} above the time warp");
    assert!(report.nearest_patch <= 0.30, "nearest patch {}", report.nearest_patch);
    assert!(report.jump_q999_ratio <= 2.0, "jump {}", report.jump_q999_ratio);
    assert!((0.5..=2.0).contains(&report.speed_mean_ratio), "speed {}", report.speed_mean_ratio);
}

#[test]
fn salsa_follows_five_growing_circles() {
    let Some(clip) = reference("cmu-dance/salsa/01.bvh") else { return };
    let clip = time::trim(&clip, 0..600).unwrap();
    let result = follow(&clip, &shapes::growing_circles(5, 300).unwrap(), &Options::default());
    assert_follows(&result.report);
    assert_eq!(result.report.rest_pose_frames, 2, "the T-pose is left out");
    assert!(result.report.notes.iter().any(|note| note.contains("T-pose")), "and said");
    assert_eq!(result.clip.frames(), 300);
    // The movement grows with the circles: more of it in the last third than in the first.
    let growth = movement(&result.clip, 200..300) / movement(&result.clip, 0..100);
    println!("movement of the last third over that of the first: {growth:.2}");
    assert!(growth > 1.3, "{growth}");
}

#[test]
fn a_walk_at_sixty_frames_follows_circles_and_keeps_its_rate() {
    let Some(clip) = reference("cmu/35/35_29.bvh") else { return };
    let result = follow(&clip, &shapes::growing_circles(5, 200).unwrap(), &Options::default());
    assert_follows(&result.report);
    assert_eq!(result.clip.frame_rate(), clip.frame_rate());
    assert_eq!(result.clip.frames(), 400);
}

#[test]
fn natural_is_nearer_to_the_clip_and_follows_less() {
    let Some(clip) = reference("cmu-dance/salsa/01.bvh") else { return };
    let clip = time::trim(&clip, 0..600).unwrap();
    let curve = shapes::growing_circles(5, 300).unwrap();
    let report = follow(&clip, &curve, &Options::preset(Preset::Natural)).report;
    let follow = follow(&clip, &curve, &Options::default()).report;
    assert!(report.structure_pearson >= 0.55 && report.nearest_patch <= 0.20, "{report:?}");
    assert!(report.nearest_patch < follow.nearest_patch);
    assert!(report.structure_pearson < follow.structure_pearson);
}

#[test]
fn every_sample_follows_its_curve() {
    for (motion, curve) in [("person", "spiral"), ("quadruped", "eight"), ("snake", "wave")] {
        println!("{motion} follows {curve}");
        let drawing = inkrig_samples::find(curve).unwrap();
        let format = inkrig_sketch::Format::from_path(drawing.file_name.as_ref()).unwrap();
        let curve = inkrig_sketch::read_curve(drawing.bytes, format).unwrap();
        let result = follow(&sample(motion), &curve, &Options::default());
        assert_follows(&result.report);
        assert_eq!(result.clip.frames(), 300);
        assert_eq!(result.best_source.len(), 300);
        assert!(result.confidence.iter().all(|share| (0.0..=1.0).contains(share)));
    }
}

#[test]
fn the_same_input_gives_the_same_motion_on_any_number_of_threads() {
    let clip = sample("snake");
    let curve = shapes::wave(4, 150).unwrap();
    let with = |threads, seed| follow(&clip, &curve, &Options { threads, seed, ..Options::default() });
    let one = with(1, 0);
    assert_eq!(one.clip, with(2, 0).clip);
    assert_eq!(one.clip, with(3, 0).clip);
    assert_ne!(one.clip, with(1, 7).clip, "another seed may find another solution");
}

#[test]
fn a_run_can_be_watched_and_stopped() {
    let clip = sample("snake");
    let control = Control::from_curve(&shapes::wave(4, 150).unwrap(), &CurveOptions::default()).unwrap();
    let mut seen = Vec::new();
    let options = Options::default();
    align(&clip.clone().into(), &control, &options, &mut |progress| {
        seen.push(progress.done);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(seen.is_sorted() && seen.last() == Some(&options.gradients()));
    let mut calls = 0;
    let stopped = align(&clip.into(), &control, &options, &mut |_| {
        calls += 1;
        if calls == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(stopped, Err(AlignError::Cancelled)));
    assert_eq!(calls, 3);
}

#[test]
fn what_cannot_be_aligned_is_said_with_what_to_do() {
    let clip = sample("snake");
    let control = |frames: usize| {
        Control::from_curve(&shapes::wave(4, frames).unwrap(), &CurveOptions::default()).unwrap()
    };
    let message = |clip: &Clip, control: &Control, options: &Options| {
        align(&clip.clone().into(), control, options, &mut |_| ControlFlow::Continue(()))
            .unwrap_err()
            .to_string()
    };
    let usual = Options::default();
    let short = time::trim(&clip, 0..12).unwrap();
    assert!(message(&short, &control(100), &usual).contains("give a longer clip"));
    assert!(message(&clip, &control(15), &usual).contains("--length"));
    let still = time::sample_at(&clip, &[5.0; 100], 30.0).unwrap();
    assert!(message(&still, &control(100), &usual).contains("nothing in the clip moves"));
    let flat = Control {
        features: Features::new(vec![1.0; 200], 2).unwrap(),
        rate: 30.0,
        cyclic: false,
        domain: None,
        kind: ControlKind::Curve,
        heard: None,
    };
    assert!(message(&clip, &flat, &usual).contains("the control does not change"));
    let long = Control {
        features: Features::new((0..200_002).map(|i| i as f32).collect(), 2).unwrap(),
        rate: 30.0,
        cyclic: false,
        domain: None,
        kind: ControlKind::Curve,
        heard: None,
    };
    assert!(message(&clip, &long, &usual).contains("cut it with --length"));
    let bad = Options { alpha: 1.5, ..usual };
    assert!(message(&clip, &control(100), &bad).contains("alpha is 1.5, but must be from 0 to 1"));
}

#[test]
fn a_loop_closes() {
    // Three rounds of a circle: nowhere faster than elsewhere, so the seam can be held against the median step.
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / 80.0;
    let circle = Curve::new((0..240).map(|i| [angle(i).cos(), angle(i).sin()]).collect()).unwrap();
    let mut control = Control::from_curve(&circle, &CurveOptions::default()).unwrap();
    for name in ["person", "quadruped", "snake"] {
        let run = |control: &Control| {
            align(&sample(name).into(), control, &Options::default(), &mut |_| ControlFlow::Continue(()))
                .unwrap()
        };
        control.cyclic = false;
        assert_eq!(run(&control).report.loop_seam_ratio, None);
        control.cyclic = true;
        let closed = run(&control);
        let seam = closed.report.loop_seam_ratio.unwrap();
        println!("{name}: seam {seam:.2}, structure {:.3}", closed.report.structure_pearson);
        assert!(seam <= 1.5, "{name}: {seam}");
        assert_eq!(closed.clip.frames(), 240);
    }
}

#[test]
fn takes_are_mixed_but_no_piece_crosses_from_one_to_the_next() {
    let clip = sample("person");
    let cut = [time::trim(&clip, 0..200).unwrap(), time::trim(&clip, 400..720).unwrap()];
    let takes = Takes::join(&cut).unwrap();
    let control =
        Control::from_curve(&shapes::growing_circles(5, 300).unwrap(), &CurveOptions::default()).unwrap();
    let result = align(&takes, &control, &Options::default(), &mut |_| ControlFlow::Continue(())).unwrap();
    let both = [0.0..200.0 / 30.0, 200.0 / 30.0..520.0 / 30.0];
    for part in both {
        assert!(result.best_source.iter().any(|moment| part.contains(moment)), "{part:?} is not used");
    }
    // 201 - 11 patches of the one and 321 - 11 of the other.
    assert_eq!(result.plan.cols(), 190 + 310);
    assert!(result.report.structure_pearson > result.report.structure_pearson_warp + 0.3);
    assert!(result.report.jump_q999_ratio < 2.0);
}

#[test]
fn one_motion_follows_another_of_another_skeleton() {
    let options = Options::for_control(ControlKind::Motion, Preset::Follow);
    let dog = time::trim(&sample("quadruped"), 0..300).unwrap();
    let control = Control::from_motion(&dog, 30.0, &options.features).unwrap();
    let result =
        align(&sample("person").into(), &control, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    let report = &result.report;
    println!(
        "person like a dog: structure {:.3} warp {:.3}",
        report.structure_pearson, report.structure_pearson_warp
    );
    assert!(report.structure_pearson >= report.structure_pearson_warp + 0.3, "{report:?}");
}

#[test]
fn every_norm_works_and_learning_does_no_harm() {
    let curve = shapes::growing_circles(5, 300).unwrap();
    let usual = follow(&sample("person"), &curve, &Options::default()).report.structure_pearson;
    for norm in [Norm::Max, Norm::Quantile, Norm::Learned] {
        let options = Options { control_norm: norm, source_norm: norm, ..Options::default() };
        let report = follow(&sample("person"), &curve, &options).report;
        println!("{norm:?}: {:.3} against {usual:.3}", report.structure_pearson);
        assert!(report.structure_pearson > 0.4 && report.jump_q999_ratio < 3.0);
    }
}

#[test]
fn a_clip_of_every_collection_can_be_aligned() {
    let files = [
        "bandai-namco-1-noncommercial/dataset-1_dance-short_normal_001.bvh",
        "bandai-namco-1-noncommercial/dataset-1_walk_normal_001.bvh",
        "accad-attribution/female1/Female1_D5_RandomStuff2.bvh",
        "accad-attribution/male1/Male1_B10_WalkTurnLeft45.bvh",
        "cmu/35/35_05.bvh",
        "cmu/131/131_02.bvh",
        "cmu-dance/indian/04.bvh",
        "cmu-dance/martial/08.bvh",
    ];
    for file in files {
        let Some(clip) = reference(file) else { return };
        let clip = time::trim(&clip, 0..clip.frames().min(900)).unwrap();
        println!("{file}");
        let report = follow(&clip, &shapes::growing_circles(4, 200).unwrap(), &Options::default()).report;
        assert!(report.structure_pearson > report.structure_pearson_warp + 0.2, "{file}: {report:?}");
        assert!(report.nearest_patch < 0.5 && report.jump_q999_ratio < 3.0, "{file}: {report:?}");
    }
}

#[test]
fn a_still_root_above_the_hips_changes_nothing() {
    let clip = sample("person");
    let skeleton = clip.skeleton();
    let mut joints = vec![Joint::new("world", None, Vec3::new(3.0, 0.0, -2.0))];
    joints.extend(
        skeleton
            .joints()
            .iter()
            .cloned()
            .map(|joint| Joint { parent: Some(joint.parent.map_or(0, |parent| parent + 1)), ..joint }),
    );
    let rotations = (0..clip.frames())
        .flat_map(|frame| std::iter::once(Quat::IDENTITY).chain(clip.rotations(frame).iter().copied()))
        .collect();
    let tracks =
        clip.translations().iter().map(|track| TranslationTrack { joint: track.joint + 1, ..track.clone() });
    let skeleton = Skeleton::new(joints).unwrap();
    let below = Clip::new(skeleton.into(), clip.frame_rate(), rotations, tracks.collect()).unwrap();
    let curve = shapes::growing_circles(5, 300).unwrap();
    let (plain, lifted) =
        (follow(&clip, &curve, &Options::default()), follow(&below, &curve, &Options::default()));
    assert!((plain.report.structure_pearson - lifted.report.structure_pearson).abs() < 1e-3);
    for frame in 0..300 {
        assert!(lifted.clip.rotations(frame)[0].dot(Quat::IDENTITY).abs() > 1.0 - 1e-6, "the root stays");
    }
    let (a, b) = (plain.clip.track(0).unwrap()[0], lifted.clip.track(1).unwrap()[0]);
    assert!(a.distance(b) < 1e-3, "{a} {b}");
}

fn run(clip: &Clip, control: &Control) -> Alignment {
    let options = Options::for_control(control.kind, Preset::Follow);
    let result = align(&clip.clone().into(), control, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    let r = &result.report;
    println!(
        "{:?}: structure {:.3}, warp {:.3}, nearest {:.3}, speed {:.2}, jump {:.2}, coverage {:.2}",
        control.kind,
        r.structure_pearson,
        r.structure_pearson_warp,
        r.nearest_patch,
        r.speed_mean_ratio,
        r.jump_q999_ratio,
        r.coverage
    );
    result
}

#[test]
fn waves_and_labels_are_followed() {
    let waves = [
        "sine(0.5Hz..2Hz) for 10s",
        "triangle(1Hz) for 8s",
        "alternate(sine(1Hz), centres=-1|1, every=2s) for 8s",
    ];
    let labels = ["A:75 B:75 A:75 C:75", "walk:3s wave:2s walk:3s"];
    let mut controls: Vec<Control> = Vec::new();
    for text in waves {
        controls.push(Control::from_wave(&text.parse().unwrap(), None, 30.0).unwrap());
    }
    for text in labels {
        controls.push(Control::from_labels(&text.parse().unwrap(), None, 30.0).unwrap());
    }
    for control in controls {
        let report = run(&sample("person"), &control).report;
        assert!(report.structure_pearson >= report.structure_pearson_warp + 0.4, "{report:?}");
        assert!(report.structure_pearson >= 0.55 && report.jump_q999_ratio <= 2.0, "{report:?}");
    }
}

#[test]
fn too_little_material_is_said() {
    // One slow figure of eight in ten seconds: a gallop cannot be followed that slowly, it can only stand.
    let result = follow(&sample("quadruped"), &shapes::figure_of_eight(1, 300).unwrap(), &Options::default());
    assert!(
        result.report.notes.iter().any(|note| note.starts_with("Too little material")),
        "{:?}",
        result.report
    );
}

/// Mean speed of the joints relative to the root over a part of a clip.
fn movement(clip: &Clip, frames: std::ops::Range<usize>) -> f32 {
    let positions = kinematics::positions(clip).relative_to(clip.travel_joint());
    let steps = frames.skip(1).map(|frame| {
        let pairs = positions.frame(frame).iter().zip(positions.frame(frame - 1));
        pairs.map(|(to, from)| to.distance(*from)).sum::<f32>()
    });
    steps.sum()
}
