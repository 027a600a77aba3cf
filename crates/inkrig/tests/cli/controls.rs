//! Every kind of control and key, on the command line.

use super::{desk, inkrig, text};
use std::path::Path;

pub(super) fn report(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output =
        inkrig(folder, &[&["align", "person.bvh", "-o", "new.bvh", "--force", "--json"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

pub(super) fn complaint(folder: &Path, arguments: &[&str]) -> String {
    let output = inkrig(folder, &[&["align", "person.bvh", "-o", "never.bvh"], arguments].concat());
    assert!(!output.status.success(), "{arguments:?}");
    // Long lines are wrapped for the terminal.
    text(&output.stderr).replace(['\n', '│'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn waves_labels_and_other_motions_are_followed() {
    let (_keep, folder) = desk();
    std::fs::write(
        folder.join("beat.csv"),
        (0..120).map(|i| format!("{}\n", i / 20 % 2)).collect::<String>(),
    )
    .unwrap();
    std::fs::write(folder.join("snake.bvh"), inkrig::samples::find("snake").unwrap().bytes).unwrap();
    std::fs::write(folder.join("tune.wav"), tune()).unwrap();
    std::fs::write(folder.join("swell.wav"), swell()).unwrap();
    let cases: [(&[&str], usize); 12] = [
        (&["--sound", "tune.wav"], 121),
        (&["--sound", "tune.wav", "--smooth", "0", "--norm", "source=quantile"], 121),
        (&["--wave", "swell.wav"], 120),
        (&["--wave", "sine(0.5Hz..2Hz) for 5s", "--preview", "wave.html"], 150),
        (&["--wave", "beat.csv"], 120),
        (&["--labels", "A:60 B:60 A:60", "--preview", "labels.html"], 180),
        (&["--labels", "A:1s B:1s", "--length", "4s"], 120),
        (&["--like", "snake.bvh", "--length", "5s"], 150),
        (&["--curve", "circles.csv", "--loop"], 120),
        (&["--sound", "tune.wav", "--repeat", "2"], 240),
        (&["--sound", "tune.wav", "--repeat", "2", "--length", "3s"], 180),
        (&["--wave", "triangle(1Hz) for 2s", "--repeat", "3", "--preview", "repeated.html"], 180),
    ];
    for (arguments, frames) in cases {
        let report = report(&folder, arguments);
        assert_eq!(report["frames"], frames, "{arguments:?}");
        let gain = report["structure_pearson"].as_f64().unwrap()
            - report["structure_pearson_warp"].as_f64().unwrap();
        assert!(gain > 0.1, "{arguments:?}: {gain}");
    }
    assert!(folder.join("wave.html").exists() && folder.join("labels.html").exists());
}

/// Four seconds of two tones in turn, as a WAV file of 16 bits at 8 kHz.
pub(super) fn tune() -> Vec<u8> {
    wav((0..32_000).map(|i| {
        let pitch = if i / 8000 % 2 == 0 { 220.0 } else { 660.0 };
        ((f64::from(i) / 8000.0 * pitch * std::f64::consts::TAU).sin() * 12_000.0) as i16
    }))
}

/// Four seconds that rise and fall twice.
pub(super) fn swell() -> Vec<u8> {
    wav((0..32_000).map(|i| ((f64::from(i) / 8000.0 * std::f64::consts::PI).sin() * 12_000.0) as i16))
}

/// A WAV file of 16 bits at 8 kHz.
pub(super) fn wav(samples: impl Iterator<Item = i16>) -> Vec<u8> {
    let data: Vec<u8> = samples.flat_map(i16::to_le_bytes).collect();
    let mut file = b"RIFF".to_vec();
    file.extend((36 + data.len() as u32).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend(16_u32.to_le_bytes());
    file.extend([1, 0, 1, 0]);
    file.extend(8000_u32.to_le_bytes());
    file.extend(16_000_u32.to_le_bytes());
    file.extend([2, 0, 16, 0]);
    file.extend(b"data");
    file.extend((data.len() as u32).to_le_bytes());
    file.extend(data);
    file
}

#[test]
fn what_the_columns_of_a_drawing_are_is_said() {
    let (_keep, folder) = desk();
    let row = |i: i32| [f64::from(i) * 0.1, f64::from(i) * 0.05].map(f64::sin);
    let write = |name: &str, header: &str, third: &dyn Fn(i32) -> f64| {
        let rows: String = (0..120).map(|i| format!("{},{},{}\n", row(i)[0], row(i)[1], third(i))).collect();
        std::fs::write(folder.join(name), format!("{header}{rows}")).unwrap();
    };
    let rising = |i: i32| f64::from(i) / 60.0;
    write("named.csv", "x,y,z\n", &rising);
    write("timed.csv", "x,y,seconds\n", &rising);
    write("rising.csv", "", &rising);
    write("deep.csv", "", &|i| (f64::from(i) * 0.1).cos());
    let warned = |name: &str, frames: u64| {
        let report = report(&folder, &["--curve", name, "--levels", "1"]);
        assert_eq!(report["frames"], frames, "{name}");
        report["warnings"].as_array().unwrap().iter().map(ToString::to_string).collect::<String>()
    };
    // 120 rows are 120 frames; two seconds less a row are 61.
    assert_eq!((warned("named.csv", 120).as_str(), warned("timed.csv", 61).as_str()), ("", ""));
    assert!(warned("rising.csv", 61).contains("rising.csv: its third column rises"));
    assert!(warned("deep.csv", 120).contains("3 dimensions"));
    // What is smoothed and spread evenly is so in any number of dimensions.
    let plain = std::fs::read(folder.join("new.bvh")).unwrap();
    for more in [&["--smooth", "8"][..], &["--uniform"]] {
        report(&folder, &[&["--curve", "deep.csv", "--levels", "1"], more].concat());
        assert_ne!(std::fs::read(folder.join("new.bvh")).unwrap(), plain, "{more:?}");
    }
}

#[test]
fn options_without_effect_are_refused() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("tune.wav"), tune()).unwrap();
    let wave = ["--wave", "sine(1Hz) for 4s"];
    for (control, more, part) in [
        (wave, &["--smooth", "3"][..], "--smooth does nothing with --wave"),
        (wave, &["--uniform"], "--uniform does nothing with --wave"),
        (["--labels", "A:30 B:30"], &["--smooth", "3"], "--smooth does nothing with --labels"),
        (["--like", "person.bvh"], &["--smooth", "3"], "--smooth does nothing with --like"),
        (["--sound", "tune.wav"], &["--uniform"], "--uniform does nothing with --sound"),
        (["--curve", "circles.csv"], &["--path-scale", "2"], "--path"),
        (
            ["--curve", "circles.csv"],
            &["--path", "straight", "--path-scale", "2"],
            "--path-scale does nothing",
        ),
    ] {
        let said = complaint(&folder, &[&control[..], more].concat());
        assert!(said.contains(part), "{more:?}: {said}");
    }
}

#[test]
fn how_the_clip_is_read_is_not_said_of_other_files() {
    let (_keep, folder) = desk();
    let frames = |more: &[&str]| {
        std::fs::write(folder.join("snake.bvh"), inkrig::samples::find("snake").unwrap().bytes).unwrap();
        report(&folder, &[&["--like", "snake.bvh", "--levels", "1"], more].concat())["control_frames"].clone()
    };
    assert_eq!(frames(&["--source-fps", "60"]), frames(&[]));
    let report = report(&folder, &["--curve", "circles.csv", "--unit", "0.01", "--solver", "dense"]);
    let parameters = &report["parameters"];
    assert_eq!((&parameters["solver"], &parameters["clip"]), (&"dense".into(), &serde_json::Value::Null));
}

#[test]
fn a_damaged_sound_is_followed_and_said() {
    let (_keep, folder) = desk();
    let tune = tune();
    std::fs::write(folder.join("cut.wav"), &tune[..tune.len() * 3 / 4]).unwrap();
    let report = report(&folder, &["--sound", "cut.wav", "--levels", "1"]);
    assert!(report["warnings"][0].as_str().unwrap().contains("cut.wav: [sound-cut-short]"), "{report}");
}

#[test]
fn a_circle_goes_around_a_loop_without_a_stop() {
    let (_keep, folder) = desk();
    for last in [119, 120] {
        let turn = |i: i32| (f64::from(i) / 120.0 * std::f64::consts::TAU).sin_cos();
        let circle: String = (0..=last).map(|i| format!("{},{}\n", turn(i).0, turn(i).1)).collect();
        std::fs::write(folder.join("circle.csv"), circle).unwrap();
        let report = report(&folder, &["--curve", "circle.csv", "--loop", "--length", "120"]);
        let seam = report["loop_seam_ratio"].as_f64().unwrap();
        println!("the seam of a circle of {} points: {seam:.2}", last + 1);
        assert!((0.3..=1.5).contains(&seam), "{seam}");
    }
}

#[test]
fn each_side_is_scaled_as_it_is_said() {
    let (_keep, folder) = desk();
    let said = |more: &[&str]| {
        report(&folder, &[&["--curve", "circles.csv"], more].concat())["parameters"]["norm"].clone()
    };
    assert_eq!(said(&[]), "source=mean,control=mean");
    assert_eq!(said(&["--norm", "learned"]), "source=learned,control=learned");
    assert_eq!(said(&["--norm", "control=learned"]), "source=mean,control=learned");
    assert_eq!(said(&["--norm", "source=max,control=quantile"]), "source=max,control=quantile");
    let refused = |norm: &str| complaint(&folder, &["--curve", "circles.csv", "--norm", norm]);
    assert!(refused("median").contains("mean, max, quantile or learned"));
    assert!(refused("clip=mean").contains("neither source=NORM nor control=NORM"));
    assert!(refused("source=mean,source=max").contains("twice"));
    assert!(refused("source=learned").contains("only the control's"));
}

#[test]
fn several_clips_of_one_character_are_mixed_and_others_refused() {
    let (_keep, folder) = desk();
    std::fs::copy(folder.join("person.bvh"), folder.join("again.bvh")).unwrap();
    std::fs::write(folder.join("snake.bvh"), inkrig::samples::find("snake").unwrap().bytes).unwrap();
    let two = report(&folder, &["again.bvh", "--curve", "circles.csv", "--range", "0s..8s"]);
    assert_eq!(two["source_frames"], 480);
    assert!(complaint(&folder, &["snake.bvh", "--curve", "circles.csv"]).contains("snake.bvh"));
}

#[test]
fn mistakes_in_controls_and_keys_are_named() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("keys.json"), r#"[{"time": 1, "fram": 2}]"#).unwrap();
    let curve = ["--curve", "circles.csv"];
    let says = |more: &[&str]| complaint(&folder, &[&curve, more].concat());
    assert!(complaint(&folder, &["--wave", "sine(2Hz) for"]).contains("--wave"));
    assert!(complaint(&folder, &["--wave", "song.flac"]).contains("looks like a file"));
    assert!(complaint(&folder, &["--wave", "./music/song.mp3"]).contains("--sound"));
    assert!(says(&["--seed", "-1"]).contains("from 0 to"));
    assert!(complaint(&folder, &["--labels", "A:30"]).contains("--labels"));
    assert!(complaint(&folder, &[]).contains("--curve"), "one of the controls is asked for");
    assert!(says(&["--wave", "sine(1Hz) for 5s"]).contains("cannot be used with"));
    assert!(says(&["--key", "0.5=frame:1"]).contains("0.5s=frame:120"));
    assert!(says(&["--key", "0.5s=frame:100000"]).contains("no frame 100000"));
    assert!(says(&["--never", "120"]).contains("frame:120~0.5"));
    assert!(says(&["--avoid", "walk:1"]).contains("other.bvh:120"));
    assert!(says(&["--key", "1s=other.bvh:3"]).contains("name this file among them"));
    assert!(says(&["--key", "sound:1s~frame:3"]).contains("goes with --sound"));
    assert!(says(&["--never", "missing.bvh:3"]).contains("missing.bvh could not be read"));
    assert!(says(&["--key", "1s=frame:3", "--key", "1s=frame:9"]).contains("drop one of them"));
    assert!(says(&["--fix", "1s..2s"]).contains("--fix-from"));
    assert!(says(&["--fix", "1s..2s", "--fix-from", "never.bvh"]).contains("named twice"));
    assert!(says(&["--key-file", "keys.json"]).contains("keys.json"));
    assert!(says(&["--range", "10s..", "--key", "1s=frame:3"]).contains("before --range begins"));
    assert!(!folder.join("never.bvh").exists());
}
