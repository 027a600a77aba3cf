//! Keyframes of every kind, on our samples and on real motion.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod support;

use inkrig_align::{
    AlignError, Alignment, Control, ControlKind, CurveOptions, Key, KeyRow, LiveAlignment, LiveEvent,
    Options, Place, Pose, Preset, align,
};
use inkrig_motion::{Clip, Takes, time};
use inkrig_sketch::{Curve, shapes};
use std::ops::ControlFlow;
use std::sync::Arc;
use support::{reference, sample};

fn circles(frames: usize) -> Curve {
    shapes::growing_circles(5, frames).unwrap()
}

fn drawn(frames: usize) -> Control {
    Control::from_curve(&circles(frames), &CurveOptions::default()).unwrap()
}

fn run(clip: &Clip, control: &Control, keys: Vec<Key>) -> Result<Alignment, AlignError> {
    let options = Options { keys, ..Options::for_control(control.kind, Preset::Follow) };
    align(&clip.clone().into(), control, &options, &mut |_| ControlFlow::Continue(()))
}

fn says(clip: &Clip, control: &Control, keys: Vec<Key>) -> String {
    run(clip, control, keys).unwrap_err().to_string()
}

fn hard(seconds: f64, frame: usize) -> Key {
    Key::Hard { seconds, frame }
}

fn never(pose: impl Into<Pose>, radius: f64) -> Key {
    Key::Never { pose: pose.into(), radius }
}

fn of(clip: &Clip, frame: usize) -> Pose {
    Pose::Of { name: "other.bvh".to_string(), clip: Arc::new(clip.clone()), frame }
}

/// A row of numbers that is the same in every run: 0..count.
fn scattered(seed: u64, count: usize) -> usize {
    (seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407) >> 33) as usize
        % count
}

fn assert_exact(row: &KeyRow) {
    assert_eq!(row.kind, "hard");
    assert!(row.rotation_error.unwrap() < 1e-5 && row.position_error.unwrap() < 1e-5, "{row:?}");
    assert!(row.jump.unwrap() < 2.0, "{row:?}");
}

#[test]
fn hard_keys_are_met_exactly_and_without_a_pop() {
    let clip = sample("person");
    let result = run(&clip, &drawn(300), vec![hard(3.0, 455), hard(7.5, 120)]).unwrap();
    result.report.keys.iter().for_each(assert_exact);
    // The row says it; here it is looked up by hand.
    for (at, frame) in [(90, 455), (225, 120)] {
        for (a, b) in result.clip.rotations(at).iter().zip(clip.rotations(frame)).skip(1) {
            assert!(a.dot(*b).abs() > 1.0 - 1e-7);
        }
        let height = |clip: &Clip, frame: usize| clip.track(0).unwrap()[frame].y;
        assert!((height(&result.clip, at) - height(&clip, frame)).abs() < 1e-5);
    }
    let report = &result.report;
    assert!(report.jump_q999_ratio < 2.0 && report.structure_pearson > 0.4, "{report:?}");
}

#[test]
fn hard_keys_are_exact_on_real_clips_at_every_rate() {
    let files = [
        ("cmu-dance/salsa/01.bvh", 600),
        ("cmu/05/05_02.amc", 1500),
        ("cmu/35/35_29.bvh", 900),
        ("accad-attribution/female1/Female1_D5_RandomStuff2.bvh", 1500),
    ];
    for (file, most) in files {
        let Some(clip) = reference(file) else { return };
        let clip = time::trim(&clip, 0..clip.frames().min(most)).unwrap();
        // The first frames may be a rest pose that is left out.
        let frame = |seed| 10 + scattered(seed, clip.frames() - 10);
        let mut keys: Vec<Key> =
            (0..4).map(|n| hard(0.4 + 1.8 * n as f64 + 0.011 * n as f64, frame(n))).collect();
        // At both ends of the result, and of the clip.
        keys.extend([hard(0.0, clip.frames() - 1), hard(200.0 / 30.0, 10)]);
        let report = run(&clip, &drawn(200), keys).unwrap().report;
        println!("{file} at {:.2}: jump {:.2}", clip.frame_rate(), report.jump_q999_ratio);
        for row in &report.keys {
            println!(
                "  {:.3} s {}: {:?} rad, {:?} m, jump {:.2}",
                row.seconds,
                row.pose,
                row.rotation_error.unwrap(),
                row.position_error.unwrap(),
                row.jump.unwrap()
            );
            assert!(row.rotation_error.unwrap() < 1e-5 && row.position_error.unwrap() < 1e-5, "{row:?}");
        }
    }
}

#[test]
fn a_loop_meets_keys_at_its_seam() {
    let clip = sample("person");
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / 80.0;
    let circle = Curve::new((0..240).map(|i| [angle(i).cos(), angle(i).sin()]).collect()).unwrap();
    let mut control = Control::from_curve(&circle, &CurveOptions::default()).unwrap();
    control.cyclic = true;
    let result = run(&clip, &control, vec![hard(0.0, 455), hard(4.0, 120)]).unwrap();
    result.report.keys.iter().for_each(assert_exact);
    let seam = result.report.loop_seam_ratio.unwrap();
    println!("seam {seam:.2}");
    assert!(seam <= 1.5, "{seam}");
}

#[test]
fn two_keys_close_together_are_both_exact() {
    let clip = sample("person");
    for gap in [1, 2, 4, 9] {
        let keys = vec![hard(3.0, 455), hard(3.0 + gap as f64 / 30.0, 455 + gap)];
        run(&clip, &drawn(300), keys).unwrap().report.keys.iter().for_each(assert_exact);
    }
    // Two poses in a tenth of a second: both are there, and a note says what to change.
    let report = run(&clip, &drawn(300), vec![hard(3.0, 60), hard(3.1, 680)]).unwrap().report;
    assert!(report.keys.iter().all(|row| row.rotation_error.unwrap() < 1e-5));
    assert!(report.notes.iter().any(|note| note.contains("move keys further apart")), "{:?}", report.notes);
}

/// The moment that a run without keys uses most at five seconds, counted in the clip.
fn favourite(clip: &Clip, plain: &Alignment) -> usize {
    let own = (f64::from(plain.best_source[150]) * clip.frame_rate()).round() as usize;
    own + plain.report.rest_pose_frames
}

/// Our person and, where it is there, a real dance and a real walk.
fn clips() -> Vec<(&'static str, Clip)> {
    let real = [("salsa", "cmu-dance/salsa/01.bvh"), ("walk", "cmu/35/35_29.bvh")];
    let real = real.into_iter().filter_map(|(name, file)| Some((name, reference(file)?)));
    let cut = |clip: Clip| time::trim(&clip, 0..clip.frames().min(700)).unwrap();
    std::iter::once(("person", sample("person"))).chain(real).map(|(name, clip)| (name, cut(clip))).collect()
}

#[test]
fn what_must_not_appear_does_not() {
    for (name, clip) in clips() {
        let plain = run(&clip, &drawn(300), vec![]).unwrap();
        let moment = favourite(&clip, &plain);
        let nearest = |keys| run(&clip, &drawn(300), keys).unwrap().report.keys[0].distance.unwrap();
        // Weight 0 asks for nothing and measures.
        let before = nearest(vec![Key::Avoid { pose: moment.into(), distance: 0.0, weight: 0.0 }]);
        for radius in [0.3, 0.6] {
            let without = run(&clip, &drawn(300), vec![never(moment, radius)]).unwrap();
            let (mass, step) = (without.plan.column_mass(), clip.frame_rate() / 30.0);
            let own = ((moment - plain.report.rest_pose_frames) as f64 / step).round() as usize;
            let covering = own.saturating_sub(10)..=own.min(mass.len() - 1);
            assert!(mass[covering].iter().all(|&mass| mass == 0.0), "patches around {moment} are left out");
            let row = &without.report.keys[0];
            let near = row.distance.unwrap();
            println!(
                "{name}: radius {radius}, nearest {before:.3} before, {near:.3} now, at {:.2} s",
                row.seconds
            );
            // Blends of others may come a little nearer than any of them.
            assert!(near > 0.6 * radius && near > before, "{name}: {near} of {radius}");
        }
        // The same pose as one of another clip.
        let other = nearest(vec![never(of(&clip, moment), 0.3)]);
        assert!(other > 0.6 * 0.3, "{name}: {other}");
    }
}

#[test]
fn hard_keys_do_not_fade_through_what_must_not_appear() {
    // Six frames from the key, where its fade and the interpolation of 60 frames a second would go.
    let clip = time::resample(&sample("person"), 60.0).unwrap();
    let keys = |frame| vec![hard(3.0, 400), never(frame, 0.0)];
    let result = run(&clip, &drawn(300), keys(413)).unwrap();
    assert_exact(&result.report.keys[0]);
    let same = |frame: usize| {
        let pairs = result.clip.rotations(frame).iter().zip(clip.rotations(413)).skip(1);
        pairs.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max) < 2e-3
    };
    assert!((0..result.clip.frames()).all(|frame| !same(frame)));
    assert!(says(&clip, &drawn(300), keys(406)).contains("drop one of the two"));
}

#[test]
fn a_pose_is_kept_away_from() {
    for (name, clip) in clips() {
        let plain = run(&clip, &drawn(300), vec![]).unwrap();
        let pose = favourite(&clip, &plain);
        let with = |pose: Pose, weight| {
            let key = Key::Avoid { pose, distance: 1.0, weight };
            run(&clip, &drawn(300), vec![key]).unwrap().report
        };
        let nearest = |report: &inkrig_align::Report| report.keys[0].distance.unwrap();
        let (before, after) = (with(pose.into(), 0.0), with(pose.into(), 1.0));
        let other = with(of(&clip, pose), 1.0);
        println!(
            "{name}: nearest {:.3} without, {:.3} with, {:.3} as a pose of another clip; structure {:.2} and {:.2}",
            nearest(&before),
            nearest(&after),
            nearest(&other),
            before.structure_pearson,
            after.structure_pearson
        );
        assert!(nearest(&after) > 0.25 + nearest(&before) && nearest(&other) > 0.25 + nearest(&before));
        assert!(after.structure_pearson > before.structure_pearson - 0.15);
    }
}

#[test]
fn soft_keys_draw_any_place_of_the_control_to_a_moment() {
    let clip = sample("person");
    let labels = Control::from_labels(&"A:75 B:75 A:75 C:75".parse().unwrap(), None, 30.0).unwrap();
    let wave = Control::from_wave(&"sine(0.5Hz) for 8s".parse().unwrap(), None, 30.0).unwrap();
    let cases = [
        (drawn(300), Place::Value(vec![1.0, 0.0])),
        (drawn(300), Place::Time(9.95)),
        (drawn(300), Place::Row(298)),
        (labels, Place::Label("B".to_string())),
        (wave, Place::Value(vec![1.0])),
    ];
    for (control, place) in cases {
        let row = |weight, pose| {
            let key = Key::Soft { place: place.clone(), pose, weight };
            run(&clip, &control, vec![key]).unwrap().report.keys.remove(0)
        };
        let (without, with) = (row(0.0, 600.into()), row(1.0, 600.into()));
        let other = row(1.0, of(&clip, 600));
        println!(
            "{place:?}: correlation {:.2} without, {:.2} with, {:.2} as another clip; distance {:.2}, {:.2}, {:.2}",
            without.correlation.unwrap(),
            with.correlation.unwrap(),
            other.correlation.unwrap(),
            without.distance.unwrap(),
            with.distance.unwrap(),
            other.distance.unwrap()
        );
        let gain = with.correlation.unwrap() - without.correlation.unwrap();
        assert!(gain > 0.2 || with.distance.unwrap() < 0.5 * without.distance.unwrap(), "{place:?}");
        assert!((other.correlation.unwrap() - with.correlation.unwrap()).abs() < 0.25, "{place:?}");
    }
}

#[test]
fn a_sound_and_a_motion_are_keyed_by_their_time() {
    let Some(clip) = reference("cmu-dance/salsa/05.bvh") else { return };
    let clip = time::trim(&clip, 0..600).unwrap();
    let options = Options::for_control(ControlKind::Motion, Preset::Follow);
    let walk = reference("cmu/35/35_05.bvh").unwrap();
    let controls = [
        Control::from_motion(&walk, 30.0, &options.features).unwrap(),
        Control::from_motion(&time::trim(&sample("quadruped"), 0..300).unwrap(), 30.0, &options.features)
            .unwrap(),
    ];
    for control in controls {
        let row = |weight| {
            let key = Key::Soft { place: Place::Time(1.0), pose: 300.into(), weight };
            run(&clip, &control, vec![key]).unwrap().report.keys.remove(0)
        };
        let (without, with) = (row(0.0), row(1.0));
        println!("{:?} {:?}", without.distance, with.distance);
        assert!(with.distance.unwrap() < without.distance.unwrap());
    }
}

#[test]
fn keys_that_cannot_be_met_are_named() {
    let clip = sample("snake");
    let control = Control::from_curve(&shapes::wave(4, 150).unwrap(), &CurveOptions::default()).unwrap();
    let says = |keys| says(&clip, &control, keys);
    let soft = |place, frame: usize| Key::Soft { place, pose: frame.into(), weight: 1.0 };
    assert!(says(vec![hard(99.0, 1)]).contains("outside of the control's 5.00 s"));
    assert!(says(vec![hard(1.0, 9999)]).contains("there is no frame 9999"));
    assert!(
        says(vec![hard(1.0, 100), hard(1.01, 130)])
            .contains("both frame 100 and frame 130 are asked for: drop one")
    );
    assert!(says(vec![hard(1.0, 100), never(100, 0.1)]).contains("drop one of the two"));
    assert!(says(vec![never(100, 10.0)]).contains("the whole clip: give a smaller radius"));
    assert!(says(vec![soft(Place::Value(vec![1.0]), 1)]).contains("2 numbers, not 1"));
    assert!(says(vec![soft(Place::Label("walk".into()), 1)]).contains("this control has no labels"));
    assert!(says(vec![soft(Place::Row(150), 1)]).contains("no frame 150 in a control of 150"));
    let labels = Control::from_labels(&"A:75 B:75".parse().unwrap(), None, 30.0).unwrap();
    let key = soft(Place::Label("walk".into()), 1);
    assert!(self::says(&clip, &labels, vec![key]).contains("there is no label `walk`; there are A, B"));
    let person = sample("person");
    let other = Key::Avoid { pose: of(&person, 3), distance: 1.0, weight: 1.0 };
    assert!(says(vec![other]).contains("other.bvh has another skeleton"));
    let beyond = Key::Avoid { pose: of(&clip, 9999), distance: 1.0, weight: 1.0 };
    assert!(says(vec![beyond]).contains("no frame 9999 in other.bvh"));
    let heavy = Key::Avoid { pose: 3.into(), distance: 1.0, weight: f64::NAN };
    assert!(says(vec![heavy]).contains("a weight of NaN is not between 0 and 100"));
}

fn fixed(earlier: &Clip, frames: std::ops::Range<usize>) -> Key {
    Key::Fixed { earlier: Arc::new(earlier.clone()), frames }
}

/// Rotations are the same but for the last bit: a clip makes them unit length again.
fn assert_same(a: &Clip, b: &Clip, frame: usize) {
    for (a, b) in a.rotations(frame).iter().zip(b.rotations(frame)) {
        assert!((*a - *b).length() < 1e-6, "frame {frame}: {a} {b}");
    }
}

/// How far the character goes in every frame, metres.
fn steps(clip: &Clip) -> Vec<f32> {
    let places = clip.track(clip.travel_joint()).unwrap();
    places.windows(2).map(|pair| pair[0].distance(pair[1])).collect()
}

#[test]
fn parts_of_an_earlier_result_stay_and_the_rest_joins_on() {
    for (name, clip) in clips() {
        let rate = clip.frame_rate();
        let at = |seconds: f64| (seconds * rate).round() as usize;
        let earlier = run(&clip, &drawn(300), vec![]).unwrap().clip;
        // Another drawing, and so another result everywhere else.
        let control =
            Control::from_curve(&shapes::figure_of_eight(6, 300).unwrap(), &CurveOptions::default()).unwrap();
        let free = run(&clip, &control, vec![]).unwrap();
        for parts in
            [vec![2.0..4.0], vec![1.0..2.0, 6.0..7.5], vec![0.0..1.0], vec![8.0..10.0], vec![5.0..5.1]]
        {
            let keys = parts.iter().map(|part| fixed(&earlier, at(part.start)..at(part.end))).collect();
            let result = run(&clip, &control, keys).unwrap();
            for part in &parts {
                for frame in at(part.start)..at(part.end) {
                    assert_same(&result.clip, &earlier, frame);
                    for (new, old) in result.clip.translations().iter().zip(earlier.translations()) {
                        assert_eq!(new.values[frame], old.values[frame], "{name} {frame}");
                    }
                }
            }
            let report = &result.report;
            let (longest, usual) = (
                steps(&result.clip).into_iter().fold(0.0, f32::max),
                steps(&clip).into_iter().fold(0.0, f32::max),
            );
            println!(
                "{name} {parts:?}: jump at borders {:?}, all {:.2}, structure {:.2} (free {:.2}), longest step {longest:.3} m (clip {usual:.3})",
                report.keys.iter().map(|row| (row.jump.unwrap() * 100.0).round() / 100.0).collect::<Vec<_>>(),
                report.jump_q999_ratio,
                report.structure_pearson,
                free.report.structure_pearson
            );
            assert!(report.keys.iter().all(|row| row.jump.unwrap() <= 2.0), "{name} {parts:?}");
            assert_ne!(result.clip, earlier);
        }
    }
}

#[test]
fn a_part_of_a_loop_may_lie_at_its_seam() {
    let clip = sample("person");
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / 80.0;
    let circle = Curve::new((0..240).map(|i| [angle(i).cos(), angle(i).sin()]).collect()).unwrap();
    let mut control = Control::from_curve(&circle, &CurveOptions::default()).unwrap();
    control.cyclic = true;
    let earlier = run(&clip, &control, vec![]).unwrap().clip;
    let result = run(&clip, &control, vec![fixed(&earlier, 200..240), hard(3.0, 455)]).unwrap();
    assert_same(&result.clip, &earlier, 239);
    assert!(result.report.loop_seam_ratio.unwrap() <= 1.5, "{:?}", result.report.loop_seam_ratio);
    assert_exact(&result.report.keys[1]);
}

#[test]
fn parts_that_cannot_stay_are_named() {
    let clip = sample("snake");
    let control = Control::from_curve(&shapes::wave(4, 150).unwrap(), &CurveOptions::default()).unwrap();
    let earlier = run(&clip, &control, vec![]).unwrap().clip;
    let says = |keys| says(&clip, &control, keys);
    assert!(
        says(vec![fixed(&earlier, 100..200)]).contains("the earlier result has 150 (5.00 s): keep a part")
    );
    let longer = time::sample_at(&clip, &(0..200).map(f64::from).collect::<Vec<_>>(), 30.0).unwrap();
    assert!(says(vec![fixed(&longer, 100..170)]).contains("but the result has 5.00 s"));
    assert!(
        says(vec![fixed(&earlier, 30..60), hard(1.5, 100)]).contains("drop the key, or keep another part")
    );
    assert!(
        says(vec![fixed(&earlier, 30..60), fixed(&earlier, 50..70)])
            .contains("overlap: give one part over both")
    );
    assert!(says(vec![fixed(&earlier, 0..150)]).contains("nothing is left to make"));
    let person = sample("person");
    assert!(says(vec![fixed(&person, 0..30)]).contains("the earlier result has another skeleton"));
    // The moment that the part is made of.
    let result = run(&clip, &control, vec![]).unwrap();
    let moment = (result.best_source[45] * 30.0).round() as usize + result.report.rest_pose_frames;
    let keys = vec![fixed(&earlier, 30..60), never(moment, 0.2)];
    assert!(says(keys).contains("shows a pose that must not appear"));
}

#[test]
fn keys_hold_in_live_updates_too() {
    let (clip, control) = (sample("person"), drawn(200));
    let earlier = run(&clip, &control, vec![]).unwrap().clip;
    let keys = vec![hard(1.0, 455), fixed(&earlier, 90..120), never(300, 0.2), hard(6.0, 120)];
    let plain = run(&clip, &control, keys.clone()).unwrap().clip;
    let mut live = LiveAlignment::new(&clip.into(), &Options { keys, ..Options::default() }).unwrap();
    let mut answers = Vec::new();
    let mut keep = |event| {
        if let LiveEvent::Answer(answer) = event {
            answers.push(answer.clip);
        }
        ControlFlow::Continue(())
    };
    live.update(&control, &mut keep).unwrap();
    live.settle(&mut keep).unwrap();
    for answer in &answers {
        assert_same(answer, &earlier, 100);
        assert!(answer.rotations(180)[3].dot(plain.rotations(180)[3]).abs() > 1.0 - 1e-6);
    }
    assert_eq!(answers.last(), Some(&plain));
}

/// The person's clip, and a piece of it that is shorter than a patch at the finest or at the coarsest level.
fn with_a_short_one(frames: usize) -> Takes {
    let clip = sample("person");
    let short = time::trim(&clip, 300..300 + frames).unwrap();
    Takes::join(&[time::trim(&clip, 0..300).unwrap(), short, time::trim(&clip, 400..700).unwrap()]).unwrap()
}

#[test]
fn a_key_stays_in_its_own_clip() {
    let run = |takes: &Takes, keys: Vec<Key>| {
        let options = Options { keys, ..Options::default() };
        align(takes, &drawn(240), &options, &mut |_| ControlFlow::Continue(()))
    };
    // Eight frames are no piece: what is asked of them is refused, and that they are not used is said.
    let takes = with_a_short_one(8);
    for key in [hard(2.0, 304), Key::Never { pose: Pose::Frame(304), radius: 0.3 }] {
        let said = run(&takes, vec![key]).unwrap_err().to_string();
        assert!(said.contains("clip 2") && said.contains("--patch"), "{said}");
    }
    let plain = run(&takes, Vec::new()).unwrap();
    let says =
        |alignment: &Alignment| alignment.report.notes.iter().any(|note| note.contains("Clip 2 is shorter"));
    assert!(says(&plain), "{:?}", plain.report.notes);
    // Twenty are a piece at the finest level only.
    let takes = with_a_short_one(20);
    let soft = |frame| Key::Soft { place: Place::Time(5.0), pose: Pose::Frame(frame), weight: 0.5 };
    let keyed = run(&takes, vec![hard(2.0, 310), soft(312)]).unwrap();
    assert!(!says(&keyed));
    let row = &keyed.report.keys[0];
    assert!(row.rotation_error.unwrap() < 1e-5 && row.position_error.unwrap() < 1e-4, "{row:?}");
    assert!(keyed.report.jump_q999_ratio < 2.5, "{:?}", keyed.report);
}

#[test]
fn the_ends_of_a_loop_are_one_moment() {
    let clip = sample("person");
    let options = CurveOptions { goes_on: true, samples: Some(120), ..CurveOptions::default() };
    let circle: Vec<[f64; 2]> =
        (0..=120).map(|i| (f64::from(i) / 120.0 * std::f64::consts::TAU).sin_cos().into()).collect();
    let mut ring = Control::from_curve(&Curve::new(circle).unwrap(), &options).unwrap();
    ring.cyclic = true;
    let said = says(&clip, &ring, vec![hard(0.0, 60), hard(4.0, 500)]);
    assert!(said.contains("frame 60 and frame 500"), "{said}");
    let met = run(&clip, &ring, vec![hard(4.0, 500)]).unwrap();
    let turned = (met.clip.rotations(0).iter().zip(clip.rotations(500)).skip(1))
        .map(|(a, b)| a.angle_between(*b))
        .fold(0.0, f32::max);
    assert!(turned < 1e-3, "{turned}");
    // Poses that cannot follow each other, on both sides of the seam.
    let torn = run(&clip, &ring, vec![hard(0.0, 60), hard(119.0 / 30.0, 500)]).unwrap();
    let jump = torn.report.keys[0].jump.unwrap();
    assert!(jump > 2.0, "{jump}");
    let seam = torn.report.loop_seam_ratio.unwrap();
    assert!(seam > 1.5 && torn.report.notes.iter().any(|note| note.contains("seen to end")), "{seam}");
    let whole = run(&clip, &ring, Vec::new()).unwrap();
    let seam = whole.report.loop_seam_ratio.unwrap();
    println!("seam of a circle {seam:.2}");
    assert!((0.3..=1.5).contains(&seam), "{seam}");
}
