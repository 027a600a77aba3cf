//! Long inputs: what the low-rank and the sparse solver make of them, and how near that is to the dense one.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_align::{Alignment, Control, CurveOptions, Key, Options, Place, Pose, Solver, align};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{Clip, Takes, time};
use inkrig_sketch::shapes;
use std::ops::ControlFlow;

fn person() -> Clip {
    read_bvh(inkrig_samples::find("person").unwrap().bytes, &ImportOptions::default()).unwrap().clip
}

/// The person at several speeds, one take each.
fn takes(frames: usize) -> Takes {
    let (clip, mut left, mut all) = (person(), frames, Vec::new());
    for speed in (0..).map(|k| 0.7 + 0.1 * f64::from(k)) {
        let places = (0..(clip.frames() as f64 / speed) as usize).map(|at| at as f64 * speed);
        let places: Vec<f64> = places.take(left).collect();
        left -= places.len();
        all.push(time::sample_at(&clip, &places, 30.0).unwrap());
        if left == 0 {
            return Takes::join(&all).unwrap();
        }
    }
    unreachable!()
}

/// Growing circles, one every two seconds.
fn circles(frames: usize) -> Control {
    let curve = shapes::growing_circles(frames / 60, frames).unwrap();
    Control::from_curve(&curve, &CurveOptions::default()).unwrap()
}

fn run(source: &Takes, control: &Control, options: &Options) -> Alignment {
    let result = align(source, control, options, &mut |_| ControlFlow::Continue(())).unwrap();
    let report = &result.report;
    println!(
        "{} x {} {} ({} entries a row): structure {:.3} (stretched {:.3}), nearest {:.3}, coverage {:.2}, speed {:.2}, \
         jumps {:.2}",
        report.control_frames,
        report.source_frames,
        report.solver.name,
        report.solver.entries_per_row,
        report.structure_pearson,
        report.structure_pearson_warp,
        report.nearest_patch,
        report.coverage,
        report.speed_mean_ratio,
        report.jump_q999_ratio
    );
    result
}

fn by(solver: Solver) -> Options {
    Options { solver, ..Options::default() }
}

#[test]
fn long_inputs_are_followed_in_little_memory() {
    let result = run(&takes(2400), &circles(3000), &Options::default());
    let report = &result.report;
    assert_eq!((report.solver.name, report.solver.ranks), ("sparse", [Some(32); 2]));
    assert!(report.solver.entries_per_row <= 128 && report.measured_patches == Some(1000));
    assert_eq!((report.levels.len(), result.clip.frames(), result.best_source.len()), (6, 3000, 3000));
    assert_eq!(report.levels.iter().map(|row| row.gradients).sum::<usize>(), report.gradients);
    assert!(report.structure_pearson >= report.structure_pearson_warp + 0.4, "{report:?}");
    assert!(report.nearest_patch <= 0.3 && report.jump_q999_ratio <= 2.0, "{report:?}");
    assert!((0.5..=2.0).contains(&report.speed_mean_ratio), "{report:?}");
    assert!(result.confidence.iter().all(|share| (0.0..=1.0).contains(share)));
    let support = result.plan.support().unwrap();
    assert_eq!((support.rows(), support.cols()), (2990, result.plan.cols()));
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(line) = status.lines().find(|line| line.starts_with("VmHWM")) {
        let kilobytes: usize = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        println!("{} MB", kilobytes / 1024);
        // Tables of all distances and plans alone would be five of 30 MB; tests may run side by side in one process.
        assert!(kilobytes < 600_000);
    }
}

/// The tables of a side with itself are bounded by that side alone, however short the other is.
#[test]
fn a_long_control_on_a_short_clip_takes_little_memory() {
    // Fewer than 4 million pairs, but 100 million distances within the control.
    let result = run(&takes(350), &circles(10_000), &Options::default());
    let report = &result.report;
    assert_eq!((result.clip.frames(), report.solver.name), (10_000, "sparse"));
    assert!(report.structure_pearson >= report.structure_pearson_warp + 0.2, "{report:?}");
    assert!(report.mirror_symmetry > 0.0);
}

#[test]
fn every_solver_comes_to_about_the_same() {
    let (source, control) = (takes(700), circles(600));
    let [dense, low, sparse] = [Solver::Dense, Solver::LowRank, Solver::Sparse]
        .map(|solver| run(&source, &control, &by(solver)).report);
    assert_eq!([dense.solver.name, low.solver.name, sparse.solver.name], ["dense", "low_rank", "sparse"]);
    for other in [low, sparse] {
        assert!((other.structure_pearson - dense.structure_pearson).abs() <= 0.05, "{other:?}");
        assert!(other.nearest_patch <= dense.nearest_patch + 0.04, "{other:?}");
        assert!(other.jump_q999_ratio <= 2.0, "{other:?}");
    }
}

#[test]
fn the_number_of_threads_never_shows() {
    let (source, control) = (takes(500), circles(360));
    let with = |threads, seed| run(&source, &control, &Options { threads, seed, ..by(Solver::Sparse) });
    let one = with(1, 0);
    let two = with(2, 0);
    assert_eq!((&one.clip, &one.plan), (&two.clip, &two.plan));
    assert_ne!(one.clip, with(1, 7).clip, "another seed may find another solution");
}

#[test]
fn a_long_loop_closes_and_cuts_are_kept() {
    let source = takes(900);
    let mut control = circles(480);
    control.cyclic = true;
    let result = run(&source, &control, &by(Solver::Sparse));
    let seam = result.report.loop_seam_ratio.unwrap();
    println!("seam {seam:.2}");
    assert!(seam <= 1.5 && result.report.jump_q999_ratio <= 2.0, "{:?}", result.report);
    assert_eq!((result.plan.rows(), result.plan.cols()), (480, 900 - 10 * source.count()));
}

#[test]
fn too_long_is_said_before_anything_is_made() {
    let says = |control: &Control, options: &Options| {
        align(&takes(100), control, options, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string()
    };
    let mut control = circles(300);
    control.rate = 0.08;
    assert!(says(&control, &Options::default()).contains("100000 that this solver matches at once"));
    control.rate = 1.5;
    let message = says(&control, &by(Solver::Dense));
    assert!(message.contains("6000 frames") && message.contains("--length"), "{message}");
}

#[test]
fn keys_hold_in_sparse_plans_too() {
    let (source, control) = (takes(900), circles(480));
    let plain = run(&source, &control, &by(Solver::Sparse));
    // The moment that is used most in the middle, at 30 frames a second.
    let used = (plain.best_source[240] * 30.0).round() as usize;
    let keys = vec![
        Key::Hard { seconds: 3.0, frame: 700 },
        Key::Never { pose: Pose::Frame(used), radius: 0.3 },
        Key::Soft { place: Place::Value(vec![1.0, 0.0]), pose: Pose::Frame(820), weight: 0.5 },
        Key::Avoid { pose: Pose::Frame(300), distance: 0.5, weight: 1.0 },
    ];
    let result = run(&source, &control, &Options { keys, ..by(Solver::Sparse) });
    let pairs = result.clip.rotations(90).iter().zip(source.clip().rotations(700)).skip(1);
    let apart = pairs.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max);
    assert!(apart < 1e-3, "{apart} radians from the key's pose");
    let without = |result: &Alignment| {
        result.best_source.iter().all(|moment| ((moment * 30.0).round() as usize).abs_diff(used) > 1)
    };
    assert!(without(&result) && !without(&plain));
    // The patches that hold that frame: every take has ten fewer of them than frames.
    let (take, range) = source.ranges().enumerate().find(|(_, range)| range.contains(&used)).unwrap();
    let starts = used.saturating_sub(10).max(range.start)..=used.min(range.end - 11);
    for start in starts {
        assert_eq!(result.plan.column_mass()[start - 10 * take], 0.0, "patch from frame {start} on");
    }
    assert!(result.report.jump_q999_ratio <= 2.5, "{:?}", result.report);
    let both =
        vec![Key::Hard { seconds: 1.0, frame: 100 }, Key::Never { pose: Pose::Frame(100), radius: 0.1 }];
    let options = Options { keys: both, ..by(Solver::Sparse) };
    assert!(align(&source, &control, &options, &mut |_| ControlFlow::Continue(())).is_err());
}
