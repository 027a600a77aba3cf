//! From the first stroke to the file.

use crate::client::{Poses, Studio, spiral};
use inkrig_formats::{ImportOptions, no_files, read_bvh, read_gltf};
use inkrig_sketch::{Format, frame_count, read_curve};
use serde_json::json;
use std::io::{BufRead as _, BufReader, Write as _};
use std::time::{Duration, Instant};

/// Draws a spiral; returns the poses that came while the pen was down.
pub(crate) fn draw(studio: &Studio, seconds: f64) -> Vec<Poses> {
    let mut live = studio.live();
    live.text("hello");
    live.say(json!({"type": "begin", "stroke": 1, "mode": "draw"}));
    let mut seen = Vec::new();
    let points = spiral(seconds);
    for (index, chunk) in points.chunks(60).enumerate() {
        live.say(json!({"type": "points", "stroke": 1, "points": chunk}));
        if index > 0 {
            seen.push(live.poses(|poses| poses.message == index as u32 + 1));
        }
    }
    live.say(json!({"type": "end", "stroke": 1}));
    let committed = live.text("committed");
    assert_eq!(committed["stroke"], 1);
    assert_eq!(committed["control"]["strokes"][0].as_array().unwrap().len(), points.len());
    seen
}

/// The result of the document as it is.
pub(crate) fn settled(studio: &Studio) -> serde_json::Value {
    let begin = Instant::now();
    loop {
        let state = studio.get("/api/project").good();
        if let Some(id) = state["result"].as_str() {
            let result = studio.get(&format!("/api/results/{id}")).good();
            if result["revision"] == state["revision"] {
                return result;
            }
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "no result: {state}");
        std::thread::sleep(Duration::from_millis(30));
    }
}

#[test]
fn a_stroke_moves_a_character_while_the_pen_is_down() {
    let studio = Studio::open();
    let added = studio.post("/api/samples/person", &json!({})).good();
    assert_eq!(added["clips"][0]["id"], studio.get("/api/project").good()["document"]["source"]["clips"][0]);
    let seen = draw(&studio, 6.0);
    assert!(seen.len() >= 4);
    for (index, poses) in seen.iter().enumerate() {
        assert_eq!((poses.kind, poses.stroke), (1, 1));
        assert!(poses.level <= poses.levels);
        // Two seconds of ink are two seconds of motion.
        let wanted = 30.0 * (index as f64 + 2.0);
        assert!((f64::from(poses.frames) - wanted).abs() <= 2.0, "{index}: {}", poses.frames);
    }
    let changes = seen.windows(2).filter(|pair| pair[0].bytes != pair[1].bytes).count();
    assert_eq!(changes, seen.len() - 1);
    let mut times: Vec<f32> = seen.iter().map(|poses| poses.milliseconds).collect();
    times.sort_by(f32::total_cmp);
    println!("from ink to poses in the server, milliseconds: {times:.1?}");

    let result = settled(&studio);
    let gauge = |name: &str| {
        result["gauges"].as_array().unwrap().iter().find(|gauge| gauge["name"] == name).unwrap().clone()
    };
    assert!(gauge("structure")["value"].as_f64().unwrap() > 0.5, "{result}");
    assert_eq!(
        result["used"]["frame"].as_array().unwrap().len(),
        result["report"]["control_frames"].as_u64().unwrap() as usize
    );
    let id = result["id"].as_str().unwrap();
    let poses = Poses::of(&studio.get(&format!("/api/results/{id}/poses")).body);
    assert_eq!((poses.kind, u64::from(poses.frames)), (2, result["frames"].as_u64().unwrap()));
    let plan = studio.get(&format!("/api/results/{id}/plan?width=100&height=40")).body;
    assert_eq!((&plan[..4], plan.len()), (b"IKM1".as_slice(), 16 + 4000));
    assert!(plan[16..].contains(&255));

    // Undone, it is gone; taken again, it is there, and so is the result.
    let state = studio.post("/api/project/undo", &json!({})).good();
    assert!(state["document"]["control"].is_null());
    let state = studio.post("/api/project/redo", &json!({})).good();
    assert_eq!(state["document"]["control"]["kind"], "curve");
    let again = settled(&studio);
    assert_eq!(again["report"]["structure_pearson"], result["report"]["structure_pearson"]);

    let file = studio.post("/api/export", &json!({"of": again["id"], "format": "bvh"}));
    assert_eq!(file.status, 200);
    assert!(file.header("content-disposition").unwrap().contains(".bvh"));
    let clip = read_bvh(&file.body, &ImportOptions::default()).unwrap().clip;
    assert_eq!(clip.frames() as u64, again["frames"].as_u64().unwrap());
    let file = studio.post("/api/export", &json!({"of": again["id"], "format": "glb", "fps": 15.0, "bake": {"kind": "sparse", "millimetres": 1.0, "degrees": 0.5}}));
    let clip = read_gltf(&file.body, &ImportOptions::default(), &no_files).unwrap().clip;
    assert!((clip.duration() - again["seconds"].as_f64().unwrap()).abs() < 0.2);
    let line = studio.get("/api/command-line").good();
    assert!(line["text"].as_str().unwrap().starts_with("inkrig align clips/c"), "{line}");
}

#[test]
fn what_stands_beside_the_command_line_is_what_is_followed() {
    let studio = Studio::open();
    studio.post("/api/samples/snake", &json!({})).good();
    let points = spiral(4.0);
    let (first, second) = points.split_at(120);
    // The pen was up for a while, and its clock went back.
    let second: Vec<[f64; 4]> = second.iter().map(|[x, y, t, p]| [*x, *y, t - 1.5, *p]).collect();
    for timing in ["pen", "even"] {
        let control = json!({"kind": "curve", "strokes": [first, second], "timing": timing});
        let commands = json!({"label": "Draw", "commands": [{"type": "setControl", "control": control}]});
        studio.post("/api/project/commands", &commands).good();
        let result = settled(&studio);
        let line = studio.get("/api/command-line").good();
        assert_eq!(line["text"].as_str().unwrap().contains("--uniform"), timing == "even");
        assert_eq!(line["files"][0]["name"], "drawing.csv");
        let text = line["files"][0]["text"].as_str().unwrap();
        let curve = read_curve(text.as_bytes(), Format::Csv).unwrap();
        let rate = result["used"]["rate"].as_f64().unwrap();
        let frames = frame_count(&curve, rate).unwrap();
        assert_eq!(result["report"]["control_frames"].as_u64().unwrap() as usize, frames, "{timing}");
        assert!((curve.duration().unwrap() - 4.0).abs() < 0.1, "{:?}", curve.duration());
        let drawn = points.iter().map(|[x, y, ..]| [*x, *y]);
        assert!(drawn.eq(curve.points().iter().copied()));
    }
}

#[test]
fn keys_are_wishes_that_are_met() {
    let studio = Studio::open();
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    draw(&studio, 6.0);
    let before = settled(&studio);
    let keys = json!([
        {"id": "hard", "kind": "hard", "place": {"kind": "time", "seconds": 2.0}, "pose": {"clip": clip, "frame": 300}},
        {"id": "soft", "kind": "soft", "place": {"kind": "point", "point": [0.2, 0.0]}, "pose": {"clip": clip, "frame": 100}},
        {"id": "never", "kind": "never", "pose": {"clip": clip, "frame": 500}},
        {"id": "off", "enabled": false, "kind": "avoid", "pose": {"clip": clip, "frame": 50}},
    ]);
    let commands = json!({"label": "Keys", "commands": [{"type": "setKeys", "keys": keys}]});
    studio.post("/api/project/commands", &commands).good();
    let after = settled(&studio);
    assert_ne!(before["id"], after["id"]);
    let met = after["keys"].as_array().unwrap();
    assert_eq!(
        met.iter().map(|key| key["id"].as_str().unwrap()).collect::<Vec<_>>(),
        ["hard", "soft", "never"]
    );
    assert!(met[2]["distance"].as_f64().unwrap() >= 0.12, "{met:?}");
    // The exact pose is the clip's.
    let used = &after["used"];
    let sample = (2.0 * used["rate"].as_f64().unwrap()) as usize;
    assert!((used["frame"][sample].as_i64().unwrap() - 300).abs() <= 3, "{}", used["frame"][sample]);
}

#[test]
fn a_part_that_stays_stays() {
    let studio = Studio::open();
    studio.post("/api/samples/person", &json!({})).good();
    draw(&studio, 6.0);
    let after = settled(&studio);
    let result = after["id"].as_str().unwrap();
    studio.post("/api/locks", &json!({"result": result, "from": 1.0, "to": 3.0})).good();
    let settings = json!({"label": "Seed", "commands": [{"type": "setSettings", "settings": {"seed": 5}}]});
    studio.post("/api/project/commands", &settings).good();
    let kept = settled(&studio);
    let frame = |result: &serde_json::Value| {
        let poses = studio.get(&format!("/api/results/{}/poses", result["id"].as_str().unwrap())).body;
        let int = |at: usize| u32::from_le_bytes(poses[at..at + 4].try_into().unwrap()) as usize;
        let (frames, joints, tracks) = (int(20), int(24), int(28));
        let at = (64 + 2 * tracks).next_multiple_of(4) + frames * tracks * 12;
        let frame = 2 * f32::from_bits(int(32) as u32) as usize;
        poses[at + frame * joints * 8..at + (frame + 1) * joints * 8].to_vec()
    };
    let (one, other) = (frame(&after), frame(&kept));
    let far = one.chunks(2).zip(other.chunks(2)).map(|(a, b)| {
        let value = |bytes: &[u8]| i32::from(i16::from_le_bytes([bytes[0], bytes[1]]));
        // A quaternion and its negative are the same turn.
        (value(a).abs() - value(b).abs()).abs()
    });
    assert!(far.max().unwrap() < 40, "the pose at two seconds stays");
}

#[test]
fn progress_is_told_and_jobs_stop() {
    let studio = Studio::open();
    studio.post("/api/samples/quadruped", &json!({})).good();
    let mut stream = studio.connect();
    write!(stream, "GET /api/events HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", studio.port).unwrap();
    let mut lines = BufReader::new(stream).lines().map_while(Result::ok);
    let mut until = |kind: &str| {
        lines.find(|line| line == &format!("event: {kind}")).unwrap();
        let data = lines.next().unwrap();
        serde_json::from_str::<serde_json::Value>(data.strip_prefix("data: ").unwrap()).unwrap()
    };
    draw(&studio, 5.0);
    assert_eq!(until("project")["history"]["undo"].as_array().unwrap().len(), 2);
    let result = until("result");
    assert!(result["job"].is_null());
    let job = studio.post("/api/jobs", &json!({"kind": "alternatives", "most": 3})).good();
    let id = job["id"].as_str().unwrap().to_string();
    let done = loop {
        let state = until("job");
        if state["id"] == id.as_str() && state["state"] != "running" {
            break state;
        }
    };
    assert_eq!(done["state"], "done");
    assert!(!done["results"].as_array().unwrap().is_empty());
    let job = studio.post("/api/jobs", &json!({"kind": "alternatives", "most": 8})).good();
    let path = format!("/api/jobs/{}", job["id"].as_str().unwrap());
    let stopped = studio.ask("DELETE", &path, &[("Content-Type", "application/json")], b"").good();
    assert_eq!(stopped["state"], "cancelled");
    assert_eq!(studio.post("/api/jobs", &json!({"kind": "alternatives", "most": 80})).status, 422);
}

#[test]
fn what_was_redrawn_is_replaced_and_a_lost_page_loses_no_ink() {
    let studio = Studio::open();
    studio.post("/api/samples/snake", &json!({})).good();
    draw(&studio, 4.0);
    {
        let mut live = studio.live();
        live.say(json!({"type": "begin", "stroke": 9, "mode": "redraw"}));
        let part: Vec<[f64; 4]> =
            spiral(4.0)[60..120].iter().map(|[x, y, t, p]| [x * 1.2, y * 1.2, t - 1.0, *p]).collect();
        live.say(json!({"type": "points", "stroke": 9, "points": part}));
        live.poses(|poses| poses.stroke == 9);
        assert!(studio.folder.path().join("stroke.jsonl").exists());
        // The window is closed with the pen down.
    }
    let begin = Instant::now();
    let state = loop {
        let state = studio.get("/api/project").good();
        if state["history"]["undo"].as_array().unwrap().last().unwrap() == "Redraw" {
            break state;
        }
        assert!(begin.elapsed() < Duration::from_secs(30), "{}", state["history"]);
        std::thread::sleep(Duration::from_millis(20));
    };
    let points = state["document"]["control"]["strokes"][0].as_array().unwrap();
    assert!(points.len().abs_diff(240) < 20, "{}", points.len());
    // The project is on the disk, and seen, before the stroke's own file goes.
    while studio.folder.path().join("stroke.jsonl").exists() {
        assert!(begin.elapsed() < Duration::from_secs(30), "the stroke's file stays");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn other_controls_are_followed_too() {
    let studio = Studio::open();
    let clip = studio.post("/api/samples/person", &json!({})).good()["clips"][0]["id"].clone();
    let other = studio.post("/api/samples/quadruped", &json!({})).good()["clips"][0]["id"].clone();
    let controls = [
        json!({"kind": "wave", "expression": "sine(0.5Hz..1.5Hz) for 6s"}),
        json!({"kind": "drawnWave", "points": (0..200).map(|i| [f64::from(i) / 30.0, (f64::from(i) / 9.0).sin()]).collect::<Vec<_>>()}),
        json!({"kind": "labels", "segments": [{"name": "walk", "seconds": 2.0}, {"name": "wave left", "seconds": 2.0, "colour": "#aa0000"}, {"name": "walk", "seconds": 2.0}]}),
        json!({"kind": "motion", "clip": other}),
    ];
    for control in controls {
        let commands = json!({"label": "Follow", "commands": [{"type": "setControl", "control": control}, {"type": "setSettings", "settings": {"root": "inPlace"}}]});
        studio.post("/api/project/commands", &commands).good();
        let result = settled(&studio);
        assert!(result["gauges"].as_array().unwrap().len() >= 7, "{control}");
        assert!(studio.get("/api/command-line").good()["text"].as_str().unwrap().contains("--root in-place"));
    }
    let wave = studio.post("/api/waves", &json!({"expression": "sine(1Hz)", "seconds": 2.0})).good();
    assert_eq!(wave["values"].as_array().unwrap().len(), 60);
    let bad = studio.post("/api/waves", &json!({"expression": "sine(1Hz"}));
    assert_eq!((bad.status, bad.json()["error"]["code"].as_str()), (422, Some("drawing_unreadable")));
    let suggestions = studio.get("/api/suggestions?count=5").good();
    assert_eq!(suggestions["candidates"].as_array().unwrap().len(), 5);
    assert_eq!(suggestions["candidates"][0]["clip"], clip);
    assert!(suggestions["map"]["frames"].as_array().unwrap().len() > 500);
}
