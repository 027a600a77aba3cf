//! Keys: those that count, those that have to wait, and what is left of exact ones in a file.

use crate::client::Studio;
use crate::drawing::{draw, settled};
use inkrig_formats::{ExportOptions, Format, ImportOptions, no_files, read_bvh, read_gltf, write_motion};
use inkrig_motion::glam::Quat;
use inkrig_motion::{Clip, TranslationTrack, time};
use serde_json::{Value, json};

fn hard(id: &str, clip: &Value, seconds: f64, frame: usize) -> Value {
    let place = json!({"kind": "time", "seconds": seconds});
    json!({"id": id, "kind": "hard", "place": place, "pose": {"clip": clip, "frame": frame}})
}

fn put(studio: &Studio, keys: &[Value]) {
    let commands: Vec<Value> = keys.iter().map(|key| json!({"type": "putKey", "key": key})).collect();
    studio.post("/api/project/commands", &json!({"label": "Keys", "commands": commands})).good();
}

fn key<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["keys"].as_array().unwrap().iter().find(|key| key["id"] == id).unwrap()
}

#[test]
fn keys_that_cannot_count_wait_and_the_rest_is_solved() {
    let studio = Studio::open();
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    let other = studio.post("/api/samples/quadruped", &json!({})).good()["clips"][0]["id"].clone();
    draw(&studio, 6.0);
    let first = settled(&studio);
    studio.post("/api/locks", &json!({"result": first["id"], "from": 1.0, "to": 3.0})).good();
    put(
        &studio,
        &[
            hard("counts", &clip, 4.0, 300),
            hard("inside-kept", &clip, 2.0, 100),
            hard("at-once", &clip, 4.0, 310),
            hard("beyond-the-end", &clip, 60.0, 100),
            hard("another-character", &other, 5.0, 10),
            json!({"id": "label", "kind": "soft", "place": {"kind": "label", "label": "A"}, "pose": {"clip": clip, "frame": 9}}),
        ],
    );
    let result = settled(&studio);
    let why = |id: &str| key(&result, id)["waits"].as_str().unwrap_or_default().to_string();
    assert_eq!(why("counts"), "");
    assert_eq!(key(&result, "counts")["met"], "good");
    assert!(why("inside-kept").contains("from 1.00 s to 3.00 s"), "{result}");
    assert!(why("at-once").contains("another exact key"), "{}", why("at-once"));
    assert!(why("beyond-the-end").contains("ends at 6.0"), "{}", why("beyond-the-end"));
    assert!(why("another-character").contains("another character"), "{}", why("another-character"));
    assert!(why("label").contains("another kind of control"), "{}", why("label"));
    assert_eq!(
        result["keys"].as_array().unwrap().len(),
        7,
        "in the order of the document, the kept part too"
    );
    // A control that is set by a command keeps the exact key, and a label is a place again.
    let control =
        json!({"kind": "labels", "segments": [{"name": "A", "seconds": 3.0}, {"name": "B", "seconds": 4.0}]});
    let command = json!({"label": "Labels", "commands": [{"type": "setControl", "control": control}]});
    studio.post("/api/project/commands", &command).good();
    let result = settled(&studio);
    assert!(
        key(&result, "counts")["waits"].is_null() && key(&result, "label")["waits"].is_null(),
        "{result}"
    );
}

#[test]
fn what_contradicts_a_forbidden_pose_waits() {
    let studio = Studio::open();
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    draw(&studio, 6.0);
    let never =
        |id: &str, frame: &Value| json!({"id": id, "kind": "never", "pose": {"clip": clip, "frame": frame}});
    put(&studio, &[hard("exact", &clip, 5.0, 500), never("never", &json!(500))]);
    let result = settled(&studio);
    let why = |result: &Value, id: &str| key(result, id)["waits"].as_str().unwrap_or_default().to_string();
    assert!(why(&result, "exact").contains("must not appear"), "{}", why(&result, "exact"));
    assert_eq!(why(&result, "never"), "");
    // A part that stays stays, whatever is forbidden later.
    studio.post("/api/locks", &json!({"result": result["id"], "from": 1.0, "to": 3.0})).good();
    let used = result["used"]["frame"][60].clone();
    put(&studio, &[never("late", &used)]);
    let result = settled(&studio);
    assert!(why(&result, "late").contains("must not appear"), "{}", why(&result, "late"));
    assert_eq!(why(&result, "never"), "");
}

#[test]
fn parts_that_are_kept_one_after_the_other_become_one() {
    let studio = Studio::open();
    studio.post("/api/samples/snake", &json!({})).good();
    draw(&studio, 6.0);
    for (from, to) in [(1.0, 3.0), (2.0, 4.0)] {
        let result = settled(&studio);
        studio.post("/api/locks", &json!({"result": result["id"], "from": from, "to": to})).good();
    }
    let result = settled(&studio);
    assert_eq!(result["keys"].as_array().unwrap().len(), 1);
    let state = studio.get("/api/project").good();
    let fixed = &state["document"]["keys"][0]["fixed"];
    assert_eq!((fixed["from"].as_f64(), fixed["to"].as_f64()), (Some(1.0), Some(4.0)));
}

#[test]
fn a_stroke_is_followed_before_it_reaches_a_key() {
    let studio = Studio::open();
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    put(&studio, &[hard("late", &clip, 5.0, 300)]);
    // Poses come from the second second on, and none of them is a problem.
    let seen = draw(&studio, 6.0);
    assert!(seen.len() >= 4);
    assert!(key(&settled(&studio), "late")["waits"].is_null());
}

#[test]
fn an_exact_pose_is_in_the_file_whatever_its_rate_and_keys() {
    let studio = Studio::open();
    let bytes = inkrig_samples::find("person").unwrap().bytes;
    let source = read_bvh(bytes, &ImportOptions::default()).unwrap().clip;
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    draw(&studio, 6.0);
    let rate = source.frame_rate();
    // Half a frame beside every frame of the slower file.
    let slower = rate * 0.8;
    let seconds = 62.0 / rate;
    put(&studio, &[hard("k", &clip, seconds, 300)]);
    let result = settled(&studio);
    let turned = |file: &Clip, rate: f64| {
        let at = (seconds * rate).round() as usize;
        let travels = source.travel_joint();
        let joints = (0..source.skeleton().len()).filter(|joint| *joint != travels);
        let turns = joints
            .map(|joint| file.rotations(at)[joint].angle_between(source.rotations(300)[joint]).to_degrees());
        turns.fold(0.0, f32::max)
    };
    let export = |more: Value| {
        let mut asked = json!({"of": result["id"], "format": "bvh"});
        asked.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        studio.post("/api/export", &asked)
    };
    for (more, rate) in [
        (json!({}), rate),
        (json!({"fps": slower}), slower),
        (json!({"bake": {"kind": "stepped", "frames": 7.0}}), rate),
    ] {
        let answer = export(more.clone());
        let file = read_bvh(&answer.body, &ImportOptions::default()).unwrap().clip;
        let far = turned(&file, rate);
        println!("{more}: {far:.4} degrees");
        assert!(far < 0.05, "{more}: {far} degrees");
    }
    let few = json!({"format": "glb", "bake": {"kind": "sparse", "millimetres": 50.0, "degrees": 20.0}});
    let file = read_gltf(&export(few).body, &ImportOptions::default(), &no_files).unwrap().clip;
    let at = (seconds * rate).round() as usize;
    let knee =
        |clip: &Clip, frame: usize, name: &str| clip.rotations(frame)[clip.skeleton().find(name).unwrap()];
    let names = ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"];
    for name in names.into_iter().filter(|name| source.skeleton().find(name).is_some()) {
        let far = knee(&file, at, name).angle_between(knee(&source, 300, name)).to_degrees();
        assert!(far < 0.1, "{name}: {far} degrees");
    }
}

#[test]
fn the_plan_and_the_frames_that_are_used_say_the_same() {
    let studio = Studio::open();
    // As captures are: quick, and beginning with a calibration pose.
    let bytes = inkrig_samples::find("person").unwrap().bytes;
    let import = read_bvh(bytes, &ImportOptions::default()).unwrap();
    let quick = with_rest_pose(&time::resample(&import.clip, 120.0).unwrap(), 120);
    let file =
        write_motion(&quick, Format::Bvh, &ExportOptions::in_format(Format::Bvh, &import.source)).unwrap();
    let id = studio.upload("/api/clips?name=capture.bvh", &file.bytes).good()["clips"][0]["id"].clone();
    let detail = studio.get(&format!("/api/clips/{}", id.as_str().unwrap())).good();
    assert_eq!(detail["restPoseFrames"], 120);
    draw(&studio, 6.0);
    let result = settled(&studio);
    let used: Vec<f64> =
        result["used"]["frame"].as_array().unwrap().iter().map(|frame| frame.as_f64().unwrap()).collect();
    let (width, height) = (used.len(), 400);
    let id = result["id"].as_str().unwrap();
    let plan = studio.get(&format!("/api/results/{id}/plan?width={width}&height={height}")).body;
    let row = quick.frames() as f64 / height as f64;
    let mut apart: Vec<f64> = (0..width)
        .map(|sample| {
            let cell = |y: usize| plan[16 + y * width + sample];
            let most = (0..height).max_by_key(|&y| cell(y)).unwrap();
            (most as f64 + 0.5) * row - used[sample]
        })
        .collect();
    apart.sort_by(f64::total_cmp);
    let median = apart[apart.len() / 2];
    println!("the plan's largest entries lie {median:.1} frames from the frames that are used");
    assert!(median.abs() < row, "{median} frames");
    // Frames of the calibration pose are used by nobody.
    let unused = (100.0 / row) as usize;
    assert!(plan[16..16 + unused * width].iter().all(|&cell| cell == 0));
}

fn with_rest_pose(clip: &Clip, frames: usize) -> Clip {
    let rest = vec![Quat::IDENTITY; frames * clip.skeleton().len()];
    let moving = (0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied());
    let rotations = rest.into_iter().chain(moving).collect();
    let tracks = clip.translations().iter().map(|track| {
        let first = std::iter::repeat_n(track.values[0], frames);
        TranslationTrack { joint: track.joint, values: first.chain(track.values.iter().copied()).collect() }
    });
    Clip::new(clip.skeleton().clone(), clip.frame_rate(), rotations, tracks.collect()).unwrap()
}
