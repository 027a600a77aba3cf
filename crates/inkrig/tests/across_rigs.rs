//! Motions of real characters follow those of others with quite different bodies, within the gates of every alignment:
//! `cargo test --release -p inkrig --test across_rigs -- --nocapture` prints the figures.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig::{cli::ImportArgs, load};
use inkrig_align::{Control, ControlKind, Options, Preset, Report, align};
use inkrig_motion::{Clip, Takes, cycle};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const WALK: &str = "cmu/35/35_05.bvh";
const STROLL: &str = "cmu/35/35_29.bvh";

/// What follows: clips of one character, those that are loops so many times over.
struct Source<'a> {
    file: &'a str,
    clips: &'a [&'a str],
    laps: usize,
}

const WOLF: &str = "creatures/wolf.glb";
const FOX: Source<'_> = Source {
    file: "creatures/fox-animations.glb",
    clips: &["Bark", "Bite", "Fetch", "Howl", "Idle", "Idle Alert", "Jump", "Run", "Sit", "Sneak", "Walk"],
    laps: 4,
};

#[test]
fn a_wolf_goes_as_a_person_walks() {
    let gaits = Source { file: WOLF, clips: &["Walk", "Gallop"], laps: 4 };
    let moves = ["Walk", "Gallop", "Eating", "Attack", "Jump_ToIdle", "Gallop_Jump"];
    let once = Source { file: WOLF, clips: &moves, laps: 1 };
    let moves = Source { file: WOLF, clips: &moves, laps: 4 };
    for walk in [STROLL, WALK] {
        for source in [&gaits, &moves, &once] {
            let Some(report) = follow(source, walk, 1, 1.0) else { return };
            assert_gates(walk, &report);
        }
    }
    // Two loops alone, once each, are 49 frames: too few.
    let once = Source { file: WOLF, clips: &["Walk", "Gallop"], laps: 1 };
    let few = follow(&once, STROLL, 1, 1.0).unwrap();
    assert!(few.nearest_patch > 0.3, "laps are what makes these loops usable: {}", few.nearest_patch);
}

#[test]
fn a_person_goes_as_a_dog() {
    let person = Source { file: "", clips: &[STROLL, WALK], laps: 1 };
    for (gait, slower) in [("trot", 2.0), ("canter", 2.0), ("pace", 1.5), ("spin", 1.5)] {
        let dog = format!("deepmimic/motions/dog3d_{gait}.txt");
        // A dog takes two steps while a person takes one: at its own speed no walk is as quick.
        let Some(quick) = follow(&person, &dog, 6, 1.0) else { return };
        let slow = follow(&person, &dog, 6, slower).unwrap();
        assert_gates(&dog, &slow);
        assert!(quick.nearest_patch > slow.nearest_patch + 0.1);
        assert!(quick.structure_pearson > 0.75 && quick.jump_q999_ratio <= 2.0, "{quick:?}");
    }
}

#[test]
fn a_fox_fights_as_a_game_character() {
    for blow in [
        "2H_Attack_Spin",
        "Unarmed_Attack_Punch_A",
        "Unarmed_Attack_Kick",
        "2H_Attack_Chop",
        "1H_Attack_Stab",
        "Dualwield_Attack_Stab",
    ] {
        let blow = format!("kaykit/Med_CombatMelee.glb#Melee_{blow}");
        let Some(report) = follow(&FOX, &blow, 4, 1.5) else { return };
        assert_gates(&blow, &report);
        // At its own speed: the quickest, a kick, asks for more than the fox's clips have.
        let quick = follow(&FOX, &blow, 4, 1.0).unwrap();
        assert!(quick.structure_pearson > 0.6 && quick.nearest_patch < 0.4, "{quick:?}");
    }
}

/// Aligns by the preset as it is, and prints the figures: the control `times` times, each `slower` times as long. `None`
/// without the reference data.
fn follow(source: &Source<'_>, like: &str, times: usize, slower: f64) -> Option<Report> {
    let paths: Vec<String> = match source.file {
        "" => source.clips.iter().map(ToString::to_string).collect(),
        file => source.clips.iter().map(|clip| format!("{file}#{clip}")).collect(),
    };
    let clip = |path: &String| {
        let clip = motion(path)?;
        let again = if source.laps > 1 { cycle::laps(&clip, source.laps).unwrap() } else { None };
        Some(again.unwrap_or(clip))
    };
    let takes = Takes::join(&paths.iter().map(clip).collect::<Option<Vec<_>>>()?).unwrap();
    let options = Options::for_control(ControlKind::Motion, Preset::Follow);
    let mut control = Control::from_motion(&motion(like)?, 30.0, &options.features).unwrap();
    control.rate /= slower;
    let control = control.repeated(times).unwrap();
    let report = align(&takes, &control, &options, &mut |_| ControlFlow::Continue(())).unwrap().report;
    let what = if source.file.is_empty() { source.clips.join(" ") } else { source.file.to_string() };
    println!(
        "{like} {times} times, {slower} times as long, on {} clips of {what}, {} laps:",
        source.clips.len(),
        source.laps
    );
    println!(
        "    structure {:.2} (stretched {:.2}), nearest {:.2}, speed {:.2}, jump {:.2}, {} of {} frames",
        report.structure_pearson,
        report.structure_pearson_warp,
        report.nearest_patch,
        report.speed_mean_ratio,
        report.jump_q999_ratio,
        report.control_frames,
        report.source_frames
    );
    Some(report)
}

/// There is no reference for these cases: the gain over the stretched clip is what structure is held to.
fn assert_gates(name: &str, report: &Report) {
    let gain = report.structure_pearson - report.structure_pearson_warp;
    assert!(gain >= 0.4, "{name}: only {gain:.3} above the stretched clip");
    assert!(report.nearest_patch <= 0.3, "{name}: nearest patch {:.3}", report.nearest_patch);
    assert!(report.jump_q999_ratio <= 2.0, "{name}: jump {:.2}", report.jump_q999_ratio);
    let speed = report.speed_mean_ratio;
    assert!((0.45..=2.0).contains(&speed), "{name}: speed {speed:.2}");
}

/// A motion of the reference data; `None`, said in one line, where the folder is not there.
fn motion(path: &str) -> Option<Clip> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let data = std::env::var_os("INKRIG_REFERENCE").map_or(beside, PathBuf::from).join("data");
    if !data.is_dir() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "no reference data in {}", data.display());
        println!("skipped: no reference data in {}", data.display());
        return None;
    }
    Some(load::motion(&data.join(path), &ImportArgs::default()).unwrap().clip)
}
