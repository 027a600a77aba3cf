//! Storyboards: kept, made, stopped, whatever makes them.

use crate::client::Studio;
use inkrig_sketch::storyboard::Storyboard;
use inkrig_studio::storyboard::{
    BoardAsked, BoardExact, BoardProgress, MadeBoard, MadeFrame, MadeTransition, MadeWay, NotMade, ReadJoint,
    Storyboarder,
};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const JSON: [(&str, &str); 1] = [("Content-Type", "application/json")];

/// Makes the same motion of every storyboard: at once, or in a second a frame where the word is `slow`.
#[derive(Debug, Default)]
struct Fake {
    /// Frames that were made.
    frames: AtomicUsize,
    /// On how many threads.
    threads: Mutex<Vec<usize>>,
}

impl Storyboarder for Fake {
    fn words(&self) -> Vec<String> {
        vec!["kick".into(), "walk".into()]
    }

    fn make(
        &self,
        board: &Storyboard,
        asked: BoardAsked,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<(), usize>,
    ) -> Result<MadeBoard, NotMade> {
        let mut frames = Vec::new();
        for (at, frame) in board.frames.iter().enumerate() {
            if asked.frame.is_some_and(|only| only != at + 1) {
                continue;
            }
            let (total, count) = (board.frames.len(), board.frames.len());
            let step = BoardProgress { done: at, total, frame: at + 1, frames: count };
            match watch(step) {
                ControlFlow::Break(()) => return Err(NotMade::Stopped),
                ControlFlow::Continue(threads) => self.threads.lock().unwrap().push(threads),
            }
            match frame.word.as_str() {
                "slow" => std::thread::sleep(Duration::from_millis(300)),
                "panic" => panic!("a model that fails"),
                "fly" => return Err(NotMade::Failed("frame 1: `fly` is not known. Try jump".into())),
                _ => {}
            }
            self.frames.fetch_add(1, Ordering::SeqCst);
            let joint = ReadJoint { name: "head".into(), x: 1.0, y: 2.0, confidence: 0.5, pinned: false };
            let way = MadeWay {
                joint: "right_foot".into(),
                figure: "start".into(),
                first: 0,
                frames: 20,
                points: vec![[0.0, 0.1, 0.2]],
            };
            let mean_miss = if asked.exact == BoardExact::Pin { 0.001 } else { 0.05 };
            let (joints, ways) = (vec![joint], vec![way]);
            frames.push(MadeFrame {
                number: at + 1,
                begins: Some(40 * frames.len()),
                frames: 40,
                joints,
                ways,
                mean_miss,
                ..MadeFrame::default()
            });
        }
        let bvh = inkrig_samples::find("person").unwrap().bytes.to_vec();
        let transitions = vec![MadeTransition { begins: 35, frames: 10 }; frames.len().saturating_sub(1)];
        Ok(MadeBoard { bvh, frames, transitions, notes: vec!["a note".into()] })
    }
}

fn studio(fake: &Arc<Fake>) -> Studio {
    Studio::on(tempfile::tempdir().unwrap(), false, None, Some(fake.clone()))
}

/// A folder with the files of a studio's storyboard.
fn like(studio: &Studio) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["project.json", "storyboard.json", "storyboard-made.json"] {
        let _ = std::fs::copy(studio.folder.path().join(name), folder.path().join(name));
    }
    folder
}

fn board(words: &[&str]) -> Value {
    let frame = |word: &&str| json!({"word": word, "body": [[[0, 0], [0, 100]]]});
    json!({"inkrig_storyboard": 1, "title": "Kick", "frames": words.iter().map(frame).collect::<Vec<_>>()})
}

/// The state of a job once it is over.
fn over(studio: &Studio, job: &Value) -> Value {
    let path = format!("/api/jobs/{}", job["id"].as_str().unwrap());
    let begun = Instant::now();
    loop {
        let state = studio.get(&path).good();
        if state["state"] != "running" {
            return state;
        }
        assert!(begun.elapsed() < Duration::from_secs(30), "{state}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn an_animation_becomes_the_clip_that_is_shown() {
    let studio = studio(&Arc::default());
    let empty = studio.get("/api/storyboard").good();
    assert_eq!((empty["available"].clone(), empty["board"].clone()), (json!(true), json!(null)));
    assert_eq!(empty["words"], json!(["kick", "walk"]));
    let job = studio.post("/api/storyboard?exact=pin", &board(&["kick", "walk"])).good();
    assert_eq!((job["kind"].as_str(), job["state"].as_str()), (Some("storyboard"), Some("running")));
    let job = over(&studio, &job);
    assert_eq!(job["state"], "done", "{job}");
    let state = studio.get("/api/storyboard").good();
    assert_eq!(state["made"]["clip"], job["result"]);
    let frames = state["made"]["frames"].as_array().unwrap();
    assert_eq!((frames.len(), frames[1]["begins"].as_u64()), (2, Some(40)));
    assert_eq!(frames[0]["joints"][0]["name"], "head");
    assert_eq!(frames[0]["ways"][0]["joint"], "right_foot");
    assert!(frames[0]["meanMiss"].as_f64().unwrap() < 0.01, "pin was asked for: {}", frames[0]);
    let document = studio.get("/api/project").good()["document"].clone();
    assert_eq!(document["source"]["clips"], json!([job["result"]]));
    assert_eq!(document["clips"][0]["name"], "Kick");
    let file = studio.post("/api/export", &json!({"of": job["result"], "format": "bvh", "name": "kick"}));
    assert_eq!(file.status, 200);
    assert!(file.body.starts_with(b"HIERARCHY"));
    studio.post("/api/project/undo", &json!({})).good();
    assert_eq!(studio.get("/api/project").good()["document"]["clips"], json!([]), "one step");
}

#[test]
fn a_storyboard_is_kept_with_the_project() {
    let fake = Arc::new(Fake::default());
    let first = studio(&fake);
    let drawn = board(&["kick"]);
    let kept = first.ask("PUT", "/api/storyboard", &JSON, drawn.to_string().as_bytes()).good();
    assert_eq!(kept["frames"], 1);
    let file = first.folder.path().join("storyboard.json");
    let text = std::fs::read(&file).unwrap();
    inkrig_sketch::storyboard::read_storyboard(&text).unwrap();
    for bad in [json!({"frames": []}), json!({"inkrig_storyboard": 1, "frames": [{"bodi": []}]}), json!([])] {
        for method in ["PUT", "POST"] {
            let answer = first.ask(method, "/api/storyboard", &JSON, bad.to_string().as_bytes());
            assert_eq!(answer.status, 422, "{answer:?}");
            assert_eq!(answer.json()["error"]["code"], "drawing_unreadable");
        }
    }
    let large = vec![b' '; 9 << 20];
    assert_eq!(first.ask("PUT", "/api/storyboard", &JSON, &large).status, 413);
    assert_eq!(std::fs::read(&file).unwrap(), text, "what is wrong changes nothing");
    // Another studio on a folder like it.
    let second = Studio::on(like(&first), false, None, None);
    let state = second.get("/api/storyboard").good();
    assert_eq!(state["board"]["frames"][0]["word"], "kick");
    assert_eq!(state["available"], false);
    let none = second.post("/api/storyboard", &drawn);
    assert_eq!(none.status, 422);
    assert!(none.json()["error"]["message"].as_str().unwrap().contains("built without a model"));
}

#[test]
fn what_was_made_is_there_after_a_restart() {
    let fake = Arc::new(Fake::default());
    let first = studio(&fake);
    over(&first, &first.post("/api/storyboard", &board(&["kick", "walk"])).good());
    let before = first.get("/api/storyboard").good();
    assert_eq!((&before["of"], &before["still"]), (&json!([0, 1]), &json!([true, true])));
    // Frames change places, one is new, one is gone: whatever is drawn as it was is still known.
    let mut moved = board(&["run", "kick"]);
    moved["frames"][1]["number"] = json!(1);
    moved["frames"][0]["number"] = json!(2);
    first.ask("PUT", "/api/storyboard", &JSON, moved.to_string().as_bytes()).good();
    let now = first.get("/api/storyboard").good();
    assert_eq!((&now["of"], &now["still"]), (&json!([1, 0]), &json!([true, false])));
    let second = Studio::on(like(&first), false, None, Some(fake));
    let after = second.get("/api/storyboard").good();
    assert_eq!((&after["made"], &after["still"]), (&before["made"], &json!([true, false])));
    // What was kept by others, or half, is no reason not to open.
    let folder = like(&second);
    std::fs::write(folder.path().join("storyboard-made.json"), b"{\"made\": 5").unwrap();
    let third = Studio::on(folder, false, None, None);
    assert_eq!(third.get("/api/storyboard").good()["made"], json!(null));
}

#[test]
fn one_frame_is_made_and_the_others_are_still_known() {
    let fake = Arc::new(Fake::default());
    let studio = studio(&fake);
    over(&studio, &studio.post("/api/storyboard", &board(&["kick", "walk", "run"])).good());
    let drawn = board(&["kick", "jump", "run"]);
    assert_eq!(studio.post("/api/storyboard?frame=4", &drawn).status, 422);
    assert_eq!(studio.post("/api/storyboard?frame=0", &drawn).status, 422);
    over(&studio, &studio.post("/api/storyboard?frame=2", &drawn).good());
    assert_eq!(fake.frames.load(Ordering::SeqCst), 4);
    let state = studio.get("/api/storyboard").good();
    let frames = state["made"]["frames"].as_array().unwrap();
    let places: Vec<(&Value, &Value)> =
        frames.iter().map(|frame| (&frame["number"], &frame["begins"])).collect();
    let (one, two, three, none, zero) = (json!(1), json!(2), json!(3), json!(null), json!(0));
    assert_eq!(places, [(&one, &none), (&two, &zero), (&three, &none)]);
    assert_eq!(frames[0]["joints"][0]["name"], "head", "what was read of it holds");
    assert_eq!(state["still"], json!([true, true, true]));
}

#[test]
fn an_animation_takes_the_place_of_the_one_before_unless_that_is_used() {
    let studio = studio(&Arc::default());
    let make = || over(&studio, &studio.post("/api/storyboard", &board(&["kick"])).good());
    let clips = || -> Vec<String> {
        let document = studio.get("/api/project").good()["document"].clone();
        let id = |clip: &Value| clip["id"].as_str().unwrap().to_owned();
        document["clips"].as_array().unwrap().iter().map(id).collect()
    };
    let first = make();
    studio.post("/api/samples/snake", &json!({}));
    assert_eq!(clips().len(), 2);
    let second = make();
    assert_ne!(first["result"], second["result"], "a clip never changes: what shows it knows it by its id");
    assert_eq!(clips()[0], second["result"].as_str().unwrap(), "it stands where the other stood");
    assert_eq!(clips().len(), 2);
    studio.post("/api/project/undo", &json!({})).good();
    assert_eq!(clips()[0], first["result"].as_str().unwrap());
    studio.post("/api/project/redo", &json!({})).good();
    // A drawn result is made of it now.
    let control = json!({"kind": "curve", "strokes": [[[0, 0, 0, 0.5], [1, 1, 1, 0.5]]], "timing": "pen"});
    let draw = json!({"label": "Draw", "commands": [{"type": "setControl", "control": control}]});
    studio.post("/api/project/commands", &draw).good();
    make();
    assert_eq!(clips().len(), 3, "{:?}", clips());
    assert_eq!(clips()[0], second["result"].as_str().unwrap());
}

#[test]
fn a_core_is_left_to_who_draws() {
    let fake = Arc::new(Fake::default());
    let studio = studio(&fake);
    over(&studio, &studio.post("/api/storyboard", &board(&["kick"])).good());
    let all = fake.threads.lock().unwrap().pop().unwrap();
    studio.ask("PUT", "/api/storyboard", &JSON, board(&["walk"]).to_string().as_bytes()).good();
    over(&studio, &studio.post("/api/storyboard", &board(&["walk"])).good());
    let fewer = fake.threads.lock().unwrap().pop().unwrap();
    assert!(all >= 2, "the test's studio has two threads at least: {all}");
    assert_eq!(fewer, all - 1);
}

#[test]
fn one_that_is_stopped_makes_no_clip() {
    let fake = Arc::new(Fake::default());
    let studio = studio(&fake);
    let job = studio.post("/api/storyboard", &board(&["slow"; 20])).good();
    assert_eq!(studio.post("/api/storyboard", &board(&["kick"])).status, 422, "one at a time");
    // Everything else goes on meanwhile.
    assert_eq!(studio.post("/api/samples/snake", &json!({})).status, 200);
    let path = format!("/api/jobs/{}", job["id"].as_str().unwrap());
    let stopped = studio.ask("DELETE", &path, &JSON, b"").good();
    assert_eq!(stopped["state"], "cancelled");
    // The next one waits for the frame that is made just now.
    let next = over(&studio, &studio.post("/api/storyboard", &board(&["kick"])).good());
    assert_eq!(next["state"], "done");
    assert!(fake.frames.load(Ordering::SeqCst) < 10, "it went on after it was stopped");
    assert_eq!(studio.get(&path).good()["state"], "cancelled");
    let document = studio.get("/api/project").good()["document"].clone();
    assert_eq!(document["clips"].as_array().unwrap().len(), 2, "the snake and one animation");
}

#[test]
fn what_cannot_be_made_says_why() {
    let studio = studio(&Arc::default());
    let job = over(&studio, &studio.post("/api/storyboard", &board(&["fly"])).good());
    assert_eq!(job["state"], "failed");
    assert_eq!(job["error"], "frame 1: `fly` is not known. Try jump");
    let job = over(&studio, &studio.post("/api/storyboard", &board(&["panic"])).good());
    assert_eq!(job["state"], "failed", "a model that fails takes nothing with it");
    let job = over(&studio, &studio.post("/api/storyboard", &board(&["kick"])).good());
    assert_eq!(job["state"], "done");
}
