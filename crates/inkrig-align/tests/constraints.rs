//! Every constraint on captured motion: what it asks for is there, measured on the result with a yardstick of its own, and
//! the result still passes the gates of a good one.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{
    Alignment, Control, ControlKind, CurveOptions, Key, Moments, MotionMap, Norm, Options, Place, Pose,
    Preset, candidates, keys_on_map, measures::pearson,
};
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, FeatureLayout, FeatureOptions, Features, Takes, kinematics};
use inkrig_sketch::{Curve, shapes};
use std::sync::Arc;
use support::{assert_gates, follow_with, motion};

/// A captured clip with a control that it follows well: what is asked for comes on top of that.
struct Case {
    name: &'static str,
    clip: Clip,
    control: Control,
}

/// A dance with five growing circles, a walk with the same, a martial art with three labels; those that are there.
fn cases() -> Vec<Case> {
    let circles = |frames| {
        let curve = shapes::growing_circles(5, frames).unwrap();
        Control::from_curve(&curve, &CurveOptions::default()).unwrap()
    };
    let labels = Control::from_labels(&"A:40 B:75 C:75 A:50".parse().unwrap(), None, 30.0).unwrap();
    let files = [
        ("salsa", "cmu-dance/salsa/01.bvh", circles(300)),
        ("walk", "cmu/35/35_29.bvh", circles(200)),
        ("martial", "cmu-dance/martial/08.bvh", labels),
    ];
    let read = |(name, file, control)| Some(Case { name, clip: motion(file, 20.0)?, control });
    files.into_iter().filter_map(read).collect()
}

impl Case {
    fn run(&self, what: &str, keys: Vec<Key>) -> Alignment {
        let options = Options { keys, ..Options::for_control(self.control.kind, Preset::Follow) };
        follow_with(&format!("{} {what}", self.name), &self.clip, &self.control, &options)
    }

    /// The gates that every result must pass, whatever was asked for.
    fn check(&self, result: &Alignment) {
        assert_gates(self.name, self.control.kind, 0.5, &result.report);
    }

    /// The frame of the file that a run uses most at a time of the control.
    fn used(&self, plain: &Alignment, seconds: f64) -> usize {
        plain.used[(seconds * 30.0).round() as usize].frame
    }

    fn yardstick(&self) -> Yardstick {
        Yardstick::of(&self.clip)
    }
}

/// Distances between pieces of motion of eleven frames, in mean distances of the clip's own pieces: the formula, done
/// slowly.
struct Yardstick {
    layout: FeatureLayout,
    frames: Features,
    rate: f64,
    mean: f64,
}

const PATCH: usize = 11;

impl Yardstick {
    fn of(clip: &Clip) -> Self {
        let begin = inkrig_motion::lead_in::rest_pose_frames(clip);
        let takes = Takes::from(clip.clone()).decimate(30.0).unwrap();
        let layout = FeatureLayout::of(&takes, &FeatureOptions::default());
        let mut own = Self { frames: layout.features(&takes), layout, rate: clip.frame_rate(), mean: 1.0 };
        // Every third piece, the rest pose aside.
        let first = (begin as f64 * 30.0 / own.rate).ceil() as usize;
        let pieces: Vec<usize> = (first..own.frames.frames() - PATCH).step_by(3).collect();
        let all = pieces.iter().flat_map(|&a| pieces.iter().map(move |&b| (a, b)));
        let total: f64 = all.map(|(a, b)| distance((&own.frames, a), (&own.frames, b))).sum();
        own.mean = total / (pieces.len() * pieces.len()) as f64;
        own
    }

    /// Of every piece of a result to the one around a frame of the clip.
    fn distances(&self, result: &Clip, frame: usize) -> Vec<f32> {
        let takes = Takes::from(result.clone()).decimate(30.0).unwrap();
        let own = self.layout.features(&takes);
        let middle = (frame as f64 * 30.0 / self.rate).round() as usize;
        let begin = middle.saturating_sub(PATCH / 2).min(self.frames.frames() - PATCH);
        let to_pose = |at| (distance((&own, at), (&self.frames, begin)) / self.mean) as f32;
        (0..=own.frames() - PATCH).map(to_pose).collect()
    }

    fn nearest(&self, result: &Clip, frame: usize) -> f32 {
        self.distances(result, frame).into_iter().fold(f32::INFINITY, f32::min)
    }
}

fn distance((a, at): (&Features, usize), (b, bt): (&Features, usize)) -> f64 {
    let rows = (0..PATCH).flat_map(|step| a.row(at + step).iter().zip(b.row(bt + step)));
    rows.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
}

/// Of every piece of the control to a row of values.
fn to_place(control: &Control, place: &[f32]) -> Vec<f32> {
    let table = &control.features;
    let frame = |at: usize| -> f32 { table.row(at).iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum() };
    let piece = |at: usize| (at..at + PATCH).map(frame).sum::<f32>().sqrt();
    (0..=table.frames() - PATCH).map(piece).collect()
}

#[test]
fn soft_keys_tie_distances_to_distances_on_captured_motion() {
    for case in cases() {
        let plain = case.run("without keys", vec![]);
        let yardstick = case.yardstick();
        // The middle of the drawing and a point at its rim; the second label.
        let places: Vec<(Place, Vec<f32>)> = match case.control.kind {
            ControlKind::Labels => vec![(Place::Label("B".to_string()), vec![0.0, 1.0, 0.0])],
            _ => [[0.0, 0.0], [1.0, 0.0]]
                .map(|[x, y]| (Place::Value(vec![x, y]), vec![x as f32, y as f32]))
                .to_vec(),
        };
        for (place, row) in places {
            let to_place = to_place(&case.control, &row);
            // A pose that the run without keys shows where the control is far away from the place.
            let farthest = (0..to_place.len()).max_by(|&a, &b| to_place[a].total_cmp(&to_place[b])).unwrap();
            let frame = case.used(&plain, (farthest + PATCH / 2) as f64 / 30.0);
            let agreement =
                |result: &Alignment| pearson(&to_place, &yardstick.distances(&result.clip, frame));
            let without = agreement(&plain);
            for weight in [0.3, 1.0] {
                let key = Key::Soft { place: place.clone(), pose: frame.into(), weight };
                let result = case.run(&format!("{place:?} weight {weight}"), vec![key]);
                let with = agreement(&result);
                println!("    correlation with the key: {without:.2} without, {with:.2} with");
                assert!(with > without + 0.25 && with > 0.29, "{}: {without} {with}", case.name);
                case.check(&result);
            }
        }
    }
}

#[test]
fn hard_keys_leave_the_rest_as_good_as_it_was() {
    for case in cases() {
        let rate = case.clip.frame_rate();
        // What it does at two seconds shall be at four, and the other way round.
        let plain = case.run("without keys", vec![]);
        let asked = [(2.0, case.used(&plain, 4.0)), (4.0, case.used(&plain, 2.0))];
        let keys = asked.map(|(seconds, frame)| Key::Hard { seconds, frame });
        let result = case.run("with two hard keys", keys.to_vec());
        for (seconds, frame) in asked {
            let at = (seconds * rate).round() as usize;
            let turned = |clip: &Clip| {
                let pairs = clip.rotations(at).iter().zip(case.clip.rotations(frame)).skip(1);
                pairs.map(|(a, b)| apart(*a, *b)).fold(0.0, f32::max)
            };
            let (off, before) = (turned(&result.clip), turned(&plain.clip));
            let height = |clip: &Clip, frame: usize| clip.track(clip.travel_joint()).unwrap()[frame].y;
            let rise = (height(&result.clip, at) - height(&case.clip, frame)).abs();
            println!("    at {seconds} s: rotations {off:.1e} (without {before:.2}), height {rise:.1e} m");
            assert!(off < 1e-5 && rise < 1e-5 && before > 1e-2, "{}", case.name);
        }
        case.check(&result);
    }
}

/// The largest difference of two rotations' components, the sign of the whole aside.
fn apart(a: Quat, b: Quat) -> f32 {
    let difference =
        |b: Quat| (a - b).to_array().into_iter().fold(0.0, |most: f32, part| most.max(part.abs()));
    difference(b).min(difference(-b))
}

#[test]
fn loops_of_captured_motion_close() {
    for mut case in cases() {
        // Rounds of a circle: nowhere faster than elsewhere, so the seam can be held against the median step. The labels
        // begin as they end.
        if case.control.kind == ControlKind::Curve {
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / 80.0;
            let circle = Curve::new((0..240).map(|i| [angle(i).cos(), angle(i).sin()]).collect()).unwrap();
            case.control = Control::from_curve(&circle, &CurveOptions::default()).unwrap();
        }
        let open = seam(&case.run("open", vec![]).clip);
        case.control.cyclic = true;
        let result = case.run("as a loop", vec![]);
        let closed = seam(&result.clip);
        let report = &result.report;
        println!("    seam {closed:.2} (report {:.2?}), not as a loop {open:.2}", report.loop_seam_ratio);
        // Without turning, as here, the median step is smaller than with it, as in the report.
        assert!(closed <= 2.0 && closed < 0.2 * open, "{}: {closed} {open}", case.name);
        assert!(report.loop_seam_ratio.unwrap() <= 1.5, "{}", case.name);
        // A walk goes in rounds by itself, stretched too: no gain is asked for.
        assert!(report.structure_pearson >= 0.6, "{}: {report:?}", case.name);
        assert!(report.jump_q999_ratio <= 2.0 && report.nearest_patch <= 0.30, "{}: {report:?}", case.name);
    }
}

/// The joints' mean step from the last frame to the first over the median of all steps; the root's travel and its turning
/// about the vertical do not count, for a loop may go on.
fn seam(clip: &Clip) -> f64 {
    let joint = clip.travel_joint();
    let still = inkrig_motion::ground::in_place(clip, &Default::default()).unwrap();
    let positions = kinematics::positions(&still).relative_to(joint);
    let step = |a: usize, b: usize| -> f64 {
        let turn = facing(&still, a) * facing(&still, b).inverse();
        let pairs = positions.frame(a).iter().zip(positions.frame(b));
        pairs.map(|(from, to)| f64::from(from.distance(turn * *to))).sum()
    };
    let last = clip.frames() - 1;
    let mut steps: Vec<f64> = (0..last).map(|frame| step(frame, frame + 1)).collect();
    steps.sort_by(f64::total_cmp);
    step(last, 0) / steps[last / 2]
}

/// The turn about the vertical of the travelling joint.
fn facing(clip: &Clip, frame: usize) -> Quat {
    let turned = clip.rotations(frame)[clip.travel_joint()];
    let ahead = turned * Vec3::Z;
    Quat::from_rotation_y(ahead.x.atan2(ahead.z))
}

#[test]
fn what_is_forbidden_or_kept_away_from_stays_far() {
    for case in cases() {
        let plain = case.run("as it is", vec![]);
        let yardstick = case.yardstick();
        let frame = case.used(&plain, 4.0);
        let before = yardstick.nearest(&plain.clip, frame);
        let asked = [
            ("forbidden", Key::Never { pose: frame.into(), radius: 0.5 }, 0.32),
            ("kept away from", Key::Avoid { pose: frame.into(), distance: 0.8, weight: 0.7 }, 0.2),
        ];
        for (what, key, least) in asked {
            let result = case.run(what, vec![key]);
            let near = yardstick.nearest(&result.clip, frame);
            println!("    nearest to the pose: {before:.2} before, {near:.2} {what}");
            assert!(near > least && near > before + 0.1, "{} {what}: {before} {near}", case.name);
            case.check(&result);
        }
    }
}

#[test]
fn a_fixed_part_stays_and_what_is_new_is_good() {
    for case in cases() {
        let earlier = case.run("first", vec![]).clip;
        let rate = earlier.frame_rate();
        let frames = (2.0 * rate) as usize..(4.0 * rate) as usize;
        let key = Key::Fixed { earlier: Arc::new(earlier.clone()), frames: frames.clone() };
        // The rest is another solution.
        let options = Options {
            keys: vec![key],
            seed: 3,
            mirror: case.control.kind == ControlKind::Curve,
            ..Options::for_control(case.control.kind, Preset::Follow)
        };
        let result = follow_with(&format!("{} fixed", case.name), &case.clip, &case.control, &options);
        let joint = earlier.travel_joint();
        for frame in frames {
            let pairs = result.clip.rotations(frame).iter().zip(earlier.rotations(frame));
            assert!(pairs.map(|(a, b)| apart(*a, *b)).fold(0.0, f32::max) < 1e-6, "{} {frame}", case.name);
            assert_eq!(result.clip.track(joint).unwrap()[frame], earlier.track(joint).unwrap()[frame]);
        }
        case.check(&result);
    }
}

#[test]
fn the_mirrored_solution_uses_other_moments_and_is_as_good() {
    for case in cases() {
        let plain = case.run("first", vec![]);
        let options = Options { mirror: true, ..Options::for_control(case.control.kind, Preset::Follow) };
        let result = follow_with(&format!("{} mirrored", case.name), &case.clip, &case.control, &options);
        let other = plain.best_source.iter().zip(&result.best_source).filter(|(a, b)| (*a - *b).abs() > 0.5);
        let share = other.count() as f64 / plain.best_source.len() as f64;
        println!(
            "    {share:.2} of all times use another moment, symmetry {:.2}",
            plain.report.mirror_symmetry
        );
        case.check(&result);
        if case.control.kind == ControlKind::Curve {
            assert!(share > 0.5, "{}: {share}", case.name);
        }
    }
}

#[test]
fn a_drawing_over_the_map_of_captured_motion_means_its_poses() {
    // A few steps of a walk are one ring on the map, which a line across cannot follow.
    for case in cases().into_iter().filter(|case| case.name != "walk") {
        let takes = Takes::from(case.clip.clone());
        let options = Options::default();
        let moments = Moments::of(&takes, &options).unwrap();
        let found = candidates(&moments, 8).unwrap();
        let map = MotionMap::of(&moments).unwrap();
        // From pose to pose of the map and back, ten seconds.
        let stops: Vec<[f64; 2]> =
            [0, 1, 2, 3, 4, 0].map(|index: usize| map.place_of(found[index].moment.frame).unwrap()).to_vec();
        let control = Control::from_curve(
            &Curve::new(stops).unwrap(),
            &CurveOptions { samples: Some(300), ..CurveOptions::default() },
        )
        .unwrap();
        let away = |result: &Alignment| {
            let place = |at: usize| map.place_of(result.used[at].frame).unwrap();
            let gap = |at: usize| {
                let row = control.features.row(at);
                (place(at)[0] - f64::from(row[0])).hypot(place(at)[1] - f64::from(row[1]))
            };
            (0..300).map(gap).sum::<f64>() / 300.0
        };
        let plain = follow_with(
            &format!("{} over the map without its keys", case.name),
            &case.clip,
            &control,
            &options,
        );
        let options = Options { keys: keys_on_map(&map, &found), control_norm: Norm::Learned, ..options };
        let result = follow_with(&format!("{} over the map", case.name), &case.clip, &control, &options);
        println!(
            "    from the drawing: {:.2} without the map's keys, {:.2} with them",
            away(&plain),
            away(&result)
        );
        assert!(away(&result) < 0.5 && away(&result) < 0.6 * away(&plain), "{}", case.name);
        let report = &result.report;
        assert!(report.jump_q999_ratio <= 2.0 && report.nearest_patch <= 0.30, "{}: {report:?}", case.name);
    }
}

#[test]
fn constraints_of_every_kind_go_together() {
    for mut case in cases() {
        case.control.cyclic = true;
        let plain = case.run("as a loop", vec![]);
        let rate = case.clip.frame_rate();
        let yardstick = case.yardstick();
        let (hard, soft, avoid) = (case.used(&plain, 2.2), case.used(&plain, 4.2), case.used(&plain, 5.0));
        let frames = (1.0 * rate) as usize..(1.5 * rate) as usize;
        // What the part that stays shows cannot be forbidden, nor what the hard key asks for.
        let around = (0.8 * rate) as usize..(1.7 * rate) as usize;
        let part = inkrig_motion::time::trim(&plain.clip, around).unwrap();
        let to_key = inkrig_motion::time::trim(&case.clip, hard.saturating_sub(20)..hard + 20).unwrap();
        let away = |frame: usize| yardstick.nearest(&part, frame).min(yardstick.nearest(&to_key, frame));
        let shown = (12..36).map(|step| case.used(&plain, 0.15 * f64::from(step)));
        let never = shown.max_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap();
        let keys = vec![
            Key::Hard { seconds: 3.0, frame: hard },
            Key::Never { pose: never.into(), radius: 0.2 },
            Key::Avoid { pose: avoid.into(), distance: 0.8, weight: 0.5 },
            Key::Soft { place: Place::Time(4.5), pose: Pose::Frame(soft), weight: 0.3 },
            Key::Fixed { earlier: Arc::new(plain.clip.clone()), frames },
        ];
        let result = case.run("all together", keys);
        for row in &result.report.keys {
            println!("    {row:.2?}");
        }
        let off = result.report.keys[0].rotation_error.unwrap();
        assert!(off < 1e-5 && result.report.loop_seam_ratio.unwrap() <= 1.5, "{}", case.name);
        let near = |result: &Alignment, frame| yardstick.nearest(&result.clip, frame);
        println!("    forbidden {:.2}, before {:.2}", near(&result, never), near(&plain, never));
        assert!(near(&result, never) > 0.12 && near(&result, never) > near(&plain, never), "{}", case.name);
        assert!(near(&result, avoid) > near(&plain, avoid), "{}", case.name);
        assert!(result.report.jump_q999_ratio <= 2.0, "{}", case.name);
    }
}
