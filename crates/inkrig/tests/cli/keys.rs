//! Keyframes on the command line and in files.

use super::controls::{complaint, report, tune};
use super::{desk, text};
use inkrig::formats::{ImportOptions, read_bvh};
use inkrig::motion::Clip;
use std::path::Path;

fn clip(folder: &Path, name: &str) -> Clip {
    read_bvh(&std::fs::read(folder.join(name)).unwrap(), &ImportOptions::default()).unwrap().clip
}

/// The rows of a BVH file.
fn rows(folder: &Path, name: &str) -> Vec<String> {
    let text = text(&std::fs::read(folder.join(name)).unwrap());
    text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).map(str::to_string).collect()
}

/// A second clip of the person: the end of the first.
fn other(folder: &Path) {
    let import =
        read_bvh(&std::fs::read(folder.join("person.bvh")).unwrap(), &ImportOptions::default()).unwrap();
    let end = inkrig::motion::time::trim(&import.clip, 400..720).unwrap();
    let options = inkrig::formats::ExportOptions::like(&import.source);
    std::fs::write(folder.join("other.bvh"), inkrig::formats::write_bvh(&end, &options).unwrap().bytes)
        .unwrap();
}

#[test]
fn keys_are_met() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("keys.json"), r#"[{"time": 1, "frame": 500}, {"never": 320}]"#).unwrap();
    report(&folder, &["--curve", "circles.csv", "--key", "2s=frame:400", "--key-file", "keys.json"]);
    let read = |name: &str| clip(&folder, name);
    let (new, old) = (read("new.bvh"), read("person.bvh"));
    for (at, frame) in [(60, 400), (30, 500)] {
        for (a, b) in new.rotations(at).iter().zip(old.rotations(frame)).skip(1) {
            assert!(a.angle_between(*b) < 2e-3, "frame {at}");
        }
    }
    // Counted in the file, also where only a part of it is used.
    report(&folder, &["--curve", "circles.csv", "--range", "10s..", "--key", "2s=frame:400"]);
    let new = read("new.bvh");
    assert!(new.rotations(60)[5].angle_between(old.rotations(400)[5]) < 2e-3);
}

/// Every kind of key in one run; the report has a row for each.
#[test]
fn every_kind_of_key_stands_in_the_report() {
    let (_keep, folder) = desk();
    other(&folder);
    let arguments = "--curve circles.csv --key 1s=frame:500 --key 0.3,-1~other.bvh:100*0.5 --key frame:100~frame:30 \
                     --avoid other.bvh:20~0.8*0.5 --never frame:320~0.2";
    let report = report(&folder, &arguments.split_whitespace().collect::<Vec<_>>());
    let rows = report["keys"].as_array().unwrap();
    let kinds: Vec<&str> = rows.iter().map(|row| row["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["hard", "soft", "soft", "avoid", "never"]);
    assert!(rows[0]["rotation_error"].as_f64().unwrap() < 1e-5, "{}", rows[0]);
    assert_eq!(rows[1]["pose"], "frame 100 of other.bvh");
    assert!(rows[1]["correlation"].is_f64() && rows[3]["distance"].is_f64() && rows[4]["asked"] == 0.2);
    assert_eq!(report["key_arguments"][3], "--avoid other.bvh:20~0.8*0.5");
    assert!(report["inputs"].as_array().unwrap().iter().any(|input| input == "other.bvh"));
}

#[test]
fn labels_and_sounds_are_keyed_by_name_and_time() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("tune.wav"), tune()).unwrap();
    let row = |arguments: &[&str]| report(&folder, arguments)["keys"][0].clone();
    let label = row(&["--labels", "walk:2s wave:2s walk:2s", "--key", "label:wave~frame:600"]);
    assert!((2.0..=4.0).contains(&label["seconds"].as_f64().unwrap()), "{label}");
    // Played twice as long, the sound's second is the result's third.
    let sound = row(&["--sound", "tune.wav", "--length", "8s", "--key", "sound:1.5s~frame:600"]);
    assert!((sound["seconds"].as_f64().unwrap() - 3.0).abs() < 0.1, "{sound}");
    let exact = row(&["--sound", "tune.wav", "--length", "8s", "--key", "sound:1.5s=frame:600"]);
    assert!((exact["seconds"].as_f64().unwrap() - 3.0).abs() < 0.05, "{exact}");
}

/// With several clips a key may name one of them.
#[test]
fn exact_keys_name_one_of_several_clips() {
    let (_keep, folder) = desk();
    other(&folder);
    let arguments = ["other.bvh", "--curve", "circles.csv", "--key", "2s=other.bvh:100"];
    report(&folder, &arguments);
    let (new, old) = (clip(&folder, "new.bvh"), clip(&folder, "other.bvh"));
    for (a, b) in new.rotations(60).iter().zip(old.rotations(100)).skip(1) {
        assert!(a.angle_between(*b) < 2e-3);
    }
}

#[test]
fn exact_keys_survive_another_rate() {
    let (_keep, folder) = desk();
    report(&folder, &["--curve", "circles.csv", "--key", "2.03s=frame:400", "--fps", "25"]);
    let (new, old) = (clip(&folder, "new.bvh"), clip(&folder, "person.bvh"));
    // 2.03 s is frame 61 of 30 a second, and nearest to frame 51 of 25.
    let same = |frame: usize| {
        let pairs = new.rotations(frame).iter().zip(old.rotations(400)).skip(1);
        pairs.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max)
    };
    assert!(same(51) < 2e-3, "{}", same(51));
}

#[test]
fn exact_keys_survive_another_rate_of_a_loop() {
    let (_keep, folder) = desk();
    let keys = ["--key", "0s=frame:90", "--key", "2.03s=frame:400", "--key", "3.96s=frame:91"];
    for (rate, places) in [("24", [0, 49, 95]), ("50", [0, 102, 198]), ("30", [0, 61, 119])] {
        let arguments = [&["--curve", "circles.csv", "--loop", "--fps", rate][..], &keys].concat();
        let report = report(&folder, &arguments);
        let (new, old) = (clip(&folder, "new.bvh"), clip(&folder, "person.bvh"));
        assert_eq!(new.frames(), 4 * rate.parse::<usize>().unwrap());
        for (index, (place, frame)) in places.into_iter().zip([90, 400, 91]).enumerate() {
            let pairs = new.rotations(place).iter().zip(old.rotations(frame)).skip(1);
            let far = pairs.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max);
            assert!(far < 2e-3, "{rate} frames a second, frame {place}: {far}");
            let row = &report["keys"][index];
            let seconds = row["seconds"].as_f64().unwrap();
            assert!((seconds - place as f64 / new.frame_rate()).abs() < 1e-6, "{row}");
            assert!(row["rotation_error"].as_f64().unwrap() < 1e-3, "{row}");
        }
        assert!(report["keys"][1]["jump"].as_f64().unwrap() < 3.0);
    }
    // Two poses that fall on one frame cannot both be there, and the report says so.
    let near = ["--key", "2s=frame:90", "--key", "2.04s=frame:400", "--fps", "10"];
    let report = report(&folder, &[&["--curve", "circles.csv", "--loop"][..], &near].concat());
    let worst = |index: usize| report["keys"][index]["rotation_error"].as_f64().unwrap();
    assert!(worst(0).max(worst(1)) > 0.05, "{}", report["keys"]);
}

/// An animator likes a part of a first result, and has the rest made anew with another seed.
#[test]
fn a_fixed_part_stays_byte_for_byte() {
    let (_keep, folder) = desk();
    report(&folder, &["--curve", "circles.csv"]);
    std::fs::rename(folder.join("new.bvh"), folder.join("first.bvh")).unwrap();
    let fix = ["--curve", "circles.csv", "--uniform", "--seed", "5", "--fix", "1s..2s", "--fix", "90..105"];
    let report = report(&folder, &[&fix[..], &["--fix-from", "first.bvh", "--preview", "p.html"]].concat());
    let (first, second) = (rows(&folder, "first.bvh"), rows(&folder, "new.bvh"));
    assert_eq!(second.len(), 120);
    assert_eq!(first[30..60], second[30..60]);
    assert_eq!(first[90..105], second[90..105]);
    assert!(first[..30] != second[..30] && first[60..90] != second[60..90]);
    for row in report["keys"].as_array().unwrap() {
        assert!(row["kind"] == "fixed" && row["jump"].as_f64().unwrap() <= 2.0, "{row}");
    }
    // Places and turns run on over the borders.
    let new = clip(&folder, "new.bvh");
    let places = new.track(0).unwrap();
    assert!(places.windows(2).all(|pair| pair[0].distance(pair[1]) < 0.15));
    // From a key file, and at another rate of the clip than of the first result.
    std::fs::write(folder.join("keys.json"), r#"[{"fix": "1s..2s", "from": "first.bvh"}]"#).unwrap();
    let again = ["--curve", "circles.csv", "--seed", "5", "--key-file", "keys.json"];
    super::controls::report(&folder, &again);
    assert_eq!(first[30..60], rows(&folder, "new.bvh")[30..60]);
    let more = [&again[..], &["--fps", "60"]].concat();
    assert!(complaint(&folder, &more).contains("give --fps 30"));
    let twice = [&again[..], &["--fix", "1.5s..3s", "--fix-from", "first.bvh"]].concat();
    assert!(complaint(&folder, &twice).contains("overlap"));
    let beyond = ["--curve", "circles.csv", "--fix", "90s..95s", "--fix-from", "first.bvh"];
    assert!(complaint(&folder, &beyond).contains("it ends at 4.00 s"));
    let inside = [&again[..], &["--key", "1.5s=frame:100"]].concat();
    assert!(complaint(&folder, &inside).contains("drop the key, or keep another part"));
}
