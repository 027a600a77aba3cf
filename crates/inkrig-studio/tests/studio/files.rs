//! Files in and out, and where they lie.

use crate::client::Studio;
use inkrig_formats::{ExportOptions, ImportOptions, read_bvh, write_glb};
use serde_json::json;

#[test]
fn uploads_stay_in_the_project_whatever_they_are_called() {
    let studio = Studio::open();
    let bytes = inkrig_samples::find("snake").unwrap().bytes;
    let added = studio.upload("/api/clips?name=..%2F..%2F..%2Fetc%2Fcron.d%2Fsnake.bvh", bytes).good();
    let clip = &added["clips"][0];
    assert_eq!(clip["file"], format!("{}-snake.bvh", clip["id"].as_str().unwrap()));
    let kept: Vec<_> = std::fs::read_dir(studio.folder.path().join("clips"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(kept, [clip["file"].as_str().unwrap()]);
    let back = studio.get(&format!("/api/clips/{}/file", clip["id"].as_str().unwrap()));
    assert_eq!(back.body, bytes);
    assert_eq!(back.header("content-type"), Some("application/octet-stream"));
    assert_eq!(back.header("x-content-type-options"), Some("nosniff"));
    let detail = studio.get(&format!("/api/clips/{}", clip["id"].as_str().unwrap())).good();
    assert_eq!(
        detail["skeleton"]["joints"].as_array().unwrap().len() as u64,
        detail["joints"].as_u64().unwrap()
    );
    assert!(!detail["limbs"].as_array().unwrap().is_empty());
}

#[test]
fn what_cannot_be_read_changes_nothing() {
    let studio = Studio::open();
    let revision = studio.get("/api/project").good()["revision"].clone();
    let bad = [
        studio.upload("/api/clips?name=walk.bvh", b"HIERARCHY\nROOT x\n{\n"),
        studio.upload("/api/clips?name=walk.exe", b"MZ"),
        studio.upload("/api/clips?name=walk.glb", b"glTF\x02\0\0\0\xff\xff\xff\xff"),
        studio.upload("/api/sounds?name=a.wav", b"RIFF\0\0\0\0WAVE"),
        studio.upload("/api/clips?name=walk.amc&beside=u7", b":FULLY-SPECIFIED\n"),
        studio.post("/api/samples/nobody", &json!({})),
        studio.post("/api/export", &json!({"of": "r99", "format": "bvh"})),
        studio.post("/api/export", &json!({"of": "../../project.json", "format": "bvh"})),
        studio.get("/api/clips/..%2f..%2fproject.json/file"),
        studio.get("/api/results/r1/plan"),
    ];
    for answer in bad {
        assert!((400..500).contains(&answer.status), "{answer:?}");
        let error = &answer.json()["error"];
        assert!(error["message"].as_str().unwrap().len() > 10 && error["code"].is_string(), "{error}");
    }
    assert_eq!(studio.get("/api/project").good()["revision"], revision);
    assert_eq!(std::fs::read_dir(studio.folder.path().join("clips")).unwrap().count(), 0);
}

#[test]
fn a_motion_goes_onto_a_dropped_character() {
    let studio = Studio::open();
    let person = inkrig_samples::find("person").unwrap().bytes;
    let motion = studio.upload("/api/clips?name=walk.bvh", person).good()["clips"][0]["id"].clone();
    let clip = read_bvh(person, &ImportOptions::default()).unwrap().clip;
    let glb = write_glb(&clip, &ExportOptions::default()).unwrap().bytes;
    let character = studio.upload("/api/clips?name=hero.glb", &glb).good()["clips"][0].clone();
    assert_eq!(character["hasSkin"], true);
    let done = studio.post("/api/retarget", &json!({"of": motion, "onto": character["id"]})).good();
    assert_eq!(done["certificate"]["verdict"], "good", "{}", done["certificate"]["broken"]);
    assert!(done["certificate"]["pairs"].as_array().unwrap().len() > 10);
    let file = studio.post("/api/export", &json!({"of": done["result"], "format": "glb", "name": "walk"}));
    assert_eq!(file.status, 200);
    assert!(file.body.len() > glb.len(), "a copy of the character with a clip more");
    let snake = studio.post("/api/samples/snake", &json!({})).good()["clips"][0]["id"].clone();
    let no = studio.post("/api/retarget", &json!({"of": motion, "onto": snake}));
    assert_eq!((no.status, no.json()["error"]["code"].as_str()), (422, Some("cannot_retarget")));
}

#[test]
fn the_page_is_served_packed_and_nothing_beside_it() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("secret.txt"), "secret").unwrap();
    let page = place.path().join("dist");
    std::fs::create_dir_all(page.join("assets")).unwrap();
    std::fs::write(page.join("index.html"), "<!doctype html><title>page</title>").unwrap();
    std::fs::write(page.join("assets/a.js"), "1").unwrap();
    let studio = Studio::with(false, Some(&page));
    let index = studio.get("/");
    assert_eq!((index.status, index.header("content-type")), (200, Some("text/html; charset=utf-8")));
    let policy = index.header("content-security-policy").unwrap();
    assert!(
        policy.contains("default-src 'none'")
            && policy.contains("frame-ancestors 'none'")
            && !policy.contains("unsafe-eval")
    );
    assert_eq!(index.header("x-frame-options"), Some("DENY"));
    assert_eq!(index.header("cross-origin-opener-policy"), Some("same-origin"));
    assert_eq!(studio.get("/assets/a.js").body, b"1");
    for path in [
        "/../secret.txt",
        "/assets/../../secret.txt",
        "/%2e%2e/secret.txt",
        "//etc/passwd",
        "/..%2fsecret.txt",
        "/assets/..\\..\\secret.txt",
        "/nothing.js",
    ] {
        let answer = studio.get(path);
        assert!(answer.status == 404 || answer.status == 400, "{path}: {answer:?}");
        assert!(!String::from_utf8_lossy(&answer.body).contains("secret"), "{path}");
    }
    let missing = studio.get("/api/nothing");
    assert_eq!((missing.status, missing.json()["error"]["code"].as_str()), (404, Some("no_route")));
}
