//! What is suggested, explained and offered beside a result, on a sample and on captured dance.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_align::{
    AMBIGUOUS, Alignment, Alternative, Candidate, Control, CurveOptions, Moments, MotionMap, Norm, Options,
    align, alternatives, candidates, keys_on_map,
};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{Clip, Takes, time};
use inkrig_sketch::{Curve, Format, read_curve};
use std::ops::ControlFlow;
use std::path::PathBuf;

fn sample(name: &str) -> Clip {
    read_bvh(inkrig_samples::find(name).unwrap().bytes, &ImportOptions::default()).unwrap().clip
}

/// The first twenty seconds of a captured salsa; `None`, said in one line, where it is not there.
fn salsa() -> Option<Clip> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("data/cmu-dance/salsa/01.bvh");
    match std::fs::read(&file) {
        Ok(bytes) => {
            let clip = read_bvh(&bytes, &ImportOptions::default()).unwrap().clip;
            Some(time::trim(&clip, 0..600).unwrap())
        }
        Err(error) => {
            assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{}: {error}", file.display());
            println!("skipped: no reference motion at {}", file.display());
            None
        }
    }
}

fn spiral() -> Control {
    let curve = read_curve(inkrig_samples::find("spiral").unwrap().bytes, Format::Json).unwrap();
    Control::from_curve(&curve, &CurveOptions::default()).unwrap()
}

fn aligned(takes: &Takes, control: &Control, options: &Options) -> Alignment {
    align(takes, control, options, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn solutions(takes: &Takes, control: &Control, options: &Options, most: usize) -> Vec<Alternative> {
    let all = alternatives(takes, control, options, most, &mut |_| ControlFlow::Continue(())).unwrap();
    for one in &all {
        println!(
            "objective {:.5}, distance {:.2}, structure {:.3}",
            one.objective, one.distance, one.alignment.report.structure_pearson
        );
    }
    all
}

fn check_solutions(clip: Clip) {
    let (takes, control) = (Takes::from(clip), spiral());
    let plain = Options::default();
    let all = solutions(&takes, &control, &plain, 4);
    assert!((2..=4).contains(&all.len()), "{}", all.len());
    assert!(all[0].alignment.clip == aligned(&takes, &control, &plain).clip, "the first is the usual one");
    assert_eq!(all[0].distance, 0.0);
    for other in &all[1..] {
        assert!(other.distance >= 0.5, "{}", other.distance);
        let (own, first) = (&other.alignment.report, &all[0].alignment.report);
        assert!(own.structure_pearson > first.structure_pearson - 0.1, "as good: {}", own.structure_pearson);
        assert!(own.structure_pearson > own.structure_pearson_warp + 0.3);
    }
    // A spiral may be walked on the one side of it or on the other.
    assert!(all[0].alignment.report.mirror_symmetry > AMBIGUOUS);
    let mirrored = aligned(&takes, &control, &Options { mirror: true, ..plain });
    let same = |one: &&Alternative| one.alignment.best_source == mirrored.best_source;
    assert!(all[1..].iter().any(|one| same(&one)), "the mirrored one is among the solutions");
}

#[test]
fn a_drawing_with_two_sides_has_several_solutions() {
    check_solutions(sample("person"));
}

#[test]
fn captured_dance_has_several_solutions_for_a_spiral() {
    let Some(clip) = salsa() else { return };
    check_solutions(clip);
}

#[test]
fn solutions_do_not_depend_on_threads() {
    let takes = Takes::from(time::trim(&sample("quadruped"), 0..200).unwrap());
    let clips = [1, 2].map(|threads| {
        let options = Options { threads, mirror: true, ..Options::default() };
        solutions(&takes, &spiral(), &options, 2)
            .into_iter()
            .map(|one| one.alignment.clip)
            .collect::<Vec<_>>()
    });
    assert!(clips[0] == clips[1]);
}

#[test]
fn a_drawing_without_two_sides_is_not_called_ambiguous() {
    // Wanders through ever new places, faster and faster, without a way back.
    let points = (0..240).map(|i| {
        let t = f64::from(i) / 24.0;
        [t + 0.3 * (t * t * 0.2).sin(), 0.02 * t.powi(3) * (0.3 * t).cos() + (0.9 * t).sin()]
    });
    let curve = Curve::new(points.collect()).unwrap();
    let control = Control::from_curve(&curve, &CurveOptions::default()).unwrap();
    let result = aligned(&sample("person").into(), &control, &Options::default());
    let symmetry = result.report.mirror_symmetry;
    assert!(symmetry < AMBIGUOUS, "{symmetry}");
}

/// Stops at the map's places of some candidates, with ways between them; and which candidate when.
fn tour(map: &MotionMap, found: &[Candidate], stops: &[usize]) -> (Vec<[f64; 2]>, Vec<Option<usize>>) {
    let place = |stop: usize| map.place_of(found[stop].moment.frame).unwrap();
    let (mut points, mut at) = (Vec::new(), Vec::new());
    for (index, &stop) in stops.iter().enumerate() {
        let next = place(stops[(index + 1).min(stops.len() - 1)]);
        for i in 0..50 {
            let part = (f64::from(i) - 30.0).max(0.0) / 20.0;
            points.push([0, 1].map(|axis: usize| place(stop)[axis] * (1.0 - part) + next[axis] * part));
            at.push((3..27).contains(&i).then_some(stop));
        }
    }
    (points, at)
}

fn check_map(clip: Clip) {
    let takes = Takes::from(clip);
    let moments = Moments::of(&takes, &Options::default()).unwrap();
    let found = candidates(&moments, 8).unwrap();
    assert_eq!(found.len(), 8);
    assert!((found.iter().map(|candidate| candidate.share).sum::<f64>() - 1.0).abs() < 1e-9);
    let map = MotionMap::of(&moments).unwrap();
    println!("stress {:.3}", map.stress);
    assert!(map.stress < 0.35);
    // Far on the map is far in the clip.
    let from = moments.distances_from(found[0].patch).unwrap();
    let places = |patch: usize| map.place_of(moments.middle(patch).frame).unwrap();
    let [x, y] = places(found[0].patch);
    let on_map = (0..moments.count()).map(|patch| (places(patch)[0] - x).hypot(places(patch)[1] - y) as f32);
    let agreement = inkrig_align::measures::pearson(&from, &on_map.collect::<Vec<_>>());
    assert!(agreement > 0.8, "{agreement}");

    let (points, at) = tour(&map, &found, &[1, 2, 0, 1, 2, 3]);
    let options = CurveOptions { samples: Some(points.len()), ..CurveOptions::default() };
    let control = Control::from_curve(&Curve::new(points).unwrap(), &options).unwrap();
    let distance = |options: &Options| {
        let result = aligned(&takes, &control, options);
        let (mut total, mut count) = (0.0, 0);
        for (sample, stop) in at.iter().enumerate() {
            let Some(stop) = stop else { continue };
            let frame = (f64::from(result.best_source[sample]) * 30.0).round() as usize;
            let distances = moments.distances_from(found[*stop].patch).unwrap();
            total += f64::from(distances[moments.patch_around(frame)]);
            count += 1;
        }
        total / f64::from(count)
    };
    let keys = keys_on_map(&map, &found);
    let (without, with) = (
        distance(&Options::default()),
        distance(&Options { keys, control_norm: Norm::Learned, ..Options::default() }),
    );
    println!("from the poses drawn over: {without:.2} without the map's keys, {with:.2} with them");
    assert!(with < 0.65 && with < without, "{with} {without}");
}

#[test]
fn a_drawing_over_the_map_passes_the_poses_it_means() {
    check_map(sample("person"));
}

#[test]
fn a_drawing_over_the_map_of_captured_dance_passes_the_poses_it_means() {
    let Some(clip) = salsa() else { return };
    check_map(clip);
}
