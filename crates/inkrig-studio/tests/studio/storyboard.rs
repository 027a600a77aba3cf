//! Storyboards: kept, made, stopped, whatever makes them.

use crate::client::Studio;
use inkrig_sketch::storyboard::Storyboard;
use inkrig_studio::storyboard::{
    BoardExact, BoardProgress, MadeBoard, MadeFrame, MadeWay, NotMade, ReadJoint, Storyboarder,
};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const JSON: [(&str, &str); 1] = [("Content-Type", "application/json")];

/// Makes the same motion of every storyboard: at once, or in a second a frame where the word is `slow`.
#[derive(Debug, Default)]
struct Fake {
    /// Frames that were made.
    frames: AtomicUsize,
}

impl Storyboarder for Fake {
    fn words(&self) -> Vec<String> {
        vec!["kick".into(), "walk".into()]
    }

    fn make(
        &self,
        board: &Storyboard,
        exact: BoardExact,
        watch: &mut dyn FnMut(BoardProgress) -> ControlFlow<()>,
    ) -> Result<MadeBoard, NotMade> {
        let mut frames = Vec::new();
        for (at, frame) in board.frames.iter().enumerate() {
            let (total, count) = (board.frames.len(), board.frames.len());
            let step = BoardProgress { done: at, total, frame: at + 1, frames: count };
            if watch(step).is_break() {
                return Err(NotMade::Stopped);
            }
            match frame.word.as_str() {
                "slow" => std::thread::sleep(Duration::from_millis(300)),
                "panic" => panic!("a model that fails"),
                "fly" => return Err(NotMade::Failed("frame 1: `fly` is not known. Try jump".into())),
                _ => {}
            }
            self.frames.fetch_add(1, Ordering::SeqCst);
            let joint = ReadJoint { name: "head".into(), x: 1.0, y: 2.0, confidence: 0.5, pinned: false };
            let way = MadeWay { joint: "right_foot".into(), figure: "start".into(), first: 0, frames: 20 };
            let mean_miss = if exact == BoardExact::Pin { 0.001 } else { 0.05 };
            let (joints, ways) = (vec![joint], vec![way]);
            frames.push(MadeFrame {
                begins: 40 * at,
                frames: 40,
                joints,
                ways,
                mean_miss,
                ..MadeFrame::default()
            });
        }
        let bvh = inkrig_samples::find("person").unwrap().bytes.to_vec();
        Ok(MadeBoard { bvh, frames, notes: vec!["a note".into()] })
    }
}

fn studio(fake: &Arc<Fake>) -> Studio {
    Studio::on(tempfile::tempdir().unwrap(), false, None, Some(fake.clone()))
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
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(&file, folder.path().join("storyboard.json")).unwrap();
    std::fs::copy(first.folder.path().join("project.json"), folder.path().join("project.json")).unwrap();
    let second = Studio::on(folder, false, None, None);
    let state = second.get("/api/storyboard").good();
    assert_eq!(state["board"]["frames"][0]["word"], "kick");
    assert_eq!(state["available"], false);
    let none = second.post("/api/storyboard", &drawn);
    assert_eq!(none.status, 422);
    assert!(none.json()["error"]["message"].as_str().unwrap().contains("built without a model"));
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
