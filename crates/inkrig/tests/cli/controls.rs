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
fn swell() -> Vec<u8> {
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
