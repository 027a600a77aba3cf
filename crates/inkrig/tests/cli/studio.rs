//! The studio as it is started, killed and started again.

use crate::desk;
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;

struct Studio {
    child: Child,
    port: u16,
    // A closed pipe would end the words, not the program.
    _words: BufReader<ChildStdout>,
}

impl Studio {
    fn start(folder: &Path, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_inkrig"))
            .current_dir(folder)
            .args([&["studio", "--port", "0"], more].concat())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut words = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        words.read_line(&mut line).unwrap();
        let port = line.trim().trim_end_matches('/').rsplit(':').next().unwrap().parse();
        assert!(port.is_ok(), "{line}");
        let port = port.unwrap();
        Self { child, port, _words: words }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    fn ask(&self, method: &str, path: &str, body: &Value) -> Value {
        let body = body.to_string();
        let mut stream = self.connect();
        let (port, length) = (self.port, body.len());
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n"
        );
        stream.write_all((head + &body).as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        serde_json::from_str(answer.split_once("\r\n\r\n").unwrap().1).unwrap()
    }

    fn project(&self) -> Value {
        self.ask("GET", "/api/project", &json!({}))
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        // The hardest end there is.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_kill_in_the_middle_of_a_drag_and_of_a_stroke_loses_nothing() {
    let (_keep, folder) = desk();
    let studio = Studio::start(&folder, &["person.bvh", "circles.csv"]);
    let state = studio.project();
    assert_eq!(state["document"]["clips"][0]["name"], "person");
    assert_eq!(state["document"]["control"]["kind"], "curve");
    for step in 1..=7 {
        let seed = json!([{"type": "setSettings", "settings": {"seed": step}}]);
        let body = json!({"label": "Seed", "gesture": "drag-1", "commands": seed});
        studio.ask("POST", "/api/project/commands", &body);
    }
    let mut request = format!("ws://localhost:{}/api/live", studio.port).into_client_request().unwrap();
    let origin = format!("http://localhost:{}", studio.port);
    request.headers_mut().insert("Origin", origin.parse().unwrap());
    let (mut live, _) = tungstenite::client(request, studio.connect()).unwrap();
    let mut say = |message: Value| live.send(Message::text(message.to_string())).unwrap();
    say(json!({"type": "begin", "stroke": 1, "mode": "draw"}));
    for part in 0..10 {
        let points: Vec<[f64; 4]> = (0..12)
            .map(|index| f64::from(part * 12 + index) / 60.0)
            .map(|t| [(4.0 * t).cos(), (5.0 * t).sin(), t, 0.5])
            .collect();
        say(json!({"type": "points", "stroke": 1, "points": points}));
    }
    // Poses of all of it: it has arrived.
    loop {
        if let Message::Binary(bytes) = live.read().unwrap()
            && bytes[12..20] == [1, 0, 0, 0, 10, 0, 0, 0]
        {
            break;
        }
    }
    drop(studio);

    let studio = Studio::start(&folder, &[]);
    let state = studio.project();
    let points = |state: &Value| state["document"]["control"]["strokes"][0].as_array().map_or(0, Vec::len);
    assert_eq!((points(&state), &state["document"]["settings"]["seed"]), (120, &json!(7)));
    let steps: Vec<&str> =
        state["history"]["undo"].as_array().unwrap().iter().map(|label| label.as_str().unwrap()).collect();
    assert_eq!(steps, ["Add person", "Follow circles.csv", "Seed", "Draw"]);
    let undo = || studio.ask("POST", "/api/project/undo", &json!({}));
    let drawn = &state["document"]["control"]["strokes"][0][7];
    assert_ne!(&undo()["document"]["control"]["strokes"][0][7], drawn, "the circles again");
    assert_eq!(undo()["document"]["settings"]["seed"], 0, "a drag is one step");
}

#[test]
fn a_file_that_is_not_there_leaves_no_project() {
    let (_keep, folder) = desk();
    let arguments = ["studio", "--project", "fresh", "missing.bvh", "--port", "0"];
    let done = crate::inkrig(&folder, &arguments);
    assert!(!done.status.success() && !folder.join("fresh").exists());
}

#[test]
fn a_new_project_begins_with_a_character_and_stays_locked() {
    let folder = tempfile::tempdir().unwrap();
    let studio = Studio::start(folder.path(), &["--project", "walk"]);
    let state = studio.project();
    assert_eq!(state["document"]["clips"][0]["name"], "person");
    assert_eq!(state["history"]["undo"], json!([]));
    let second = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(folder.path())
        .args(["studio", "--port", "0", "--project", "walk"])
        .output()
        .unwrap();
    assert!(!second.status.success());
    let words = String::from_utf8_lossy(&second.stderr).replace('\n', " ");
    assert!(words.contains("open already"), "{words}");
}
