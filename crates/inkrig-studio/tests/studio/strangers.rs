//! Pages of others, names of others, and messages that are too large.

use crate::client::{Studio, answer};
use serde_json::json;
use std::io::Write as _;
use tungstenite::Message;

fn revision(studio: &Studio) -> u64 {
    studio.get("/api/project").good()["revision"].as_u64().unwrap()
}

#[test]
fn a_post_of_another_page_changes_nothing() {
    let studio = Studio::open();
    let before = revision(&studio);
    let body = json!({"label": "x", "commands": [{"type": "setName", "name": "taken"}]}).to_string();
    let own = format!("http://127.0.0.1:{}", studio.port);
    let json = ("Content-Type", "application/json");
    let tries: &[(&[(&str, &str)], u16)] = &[
        (
            &[
                ("Content-Type", "text/plain"),
                ("Origin", "http://evil.example"),
                ("Sec-Fetch-Site", "cross-site"),
            ],
            403,
        ),
        (&[("Content-Type", "text/plain")], 415),
        (&[("Content-Type", "application/x-www-form-urlencoded")], 415),
        (&[], 415),
        (&[json, ("Origin", "http://evil.example")], 403),
        (&[json, ("Origin", "null")], 403),
        (&[json, ("Origin", &own), ("Sec-Fetch-Site", "cross-site")], 403),
        (&[json, ("Origin", &own), ("Sec-Fetch-Site", "same-site")], 403),
    ];
    for (headers, status) in tries {
        let answer = studio.ask("POST", "/api/project/commands", headers, body.as_bytes());
        assert_eq!(answer.status, *status, "{headers:?}");
    }
    assert_eq!(
        studio
            .ask(
                "OPTIONS",
                "/api/project",
                &[("Origin", "http://evil.example"), ("Access-Control-Request-Method", "POST")],
                b""
            )
            .status,
        403
    );
    assert_eq!(revision(&studio), before);
    let good = studio.ask(
        "POST",
        "/api/project/commands",
        &[json, ("Origin", &own), ("Sec-Fetch-Site", "same-origin")],
        body.as_bytes(),
    );
    assert_eq!(good.good()["revision"].as_u64(), Some(before + 1));
}

#[test]
fn a_name_that_others_point_here_is_refused() {
    let studio = Studio::open();
    for host in [
        "evil.example".to_string(),
        format!("evil.example:{}", studio.port),
        "127.0.0.1:1".into(),
        format!("192.168.0.2:{}", studio.port),
    ] {
        for path in ["/", "/api/project", "/api/events", "/api/live"] {
            assert_eq!(studio.ask_as(&host, "GET", path, &[], b"").status, 403, "{host} {path}");
        }
    }
    assert_eq!(
        studio.ask_as(&format!("localhost:{}", studio.port), "GET", "/api/project", &[], b"").status,
        200
    );
    let mut stream = studio.connect();
    write!(stream, "GET /api/project HTTP/1.0\r\n\r\n").unwrap();
    assert_eq!(answer(stream).status, 403, "no host at all");
}

#[test]
fn a_live_connection_is_for_our_own_page() {
    let studio = Studio::open();
    let own = format!("http://127.0.0.1:{}", studio.port);
    let refused: &[&[(&'static str, &str)]] = &[
        &[("Origin", "http://evil.example")],
        &[("Origin", "null")],
        &[("Origin", &own), ("Sec-Fetch-Site", "cross-site")],
        &[("Origin", &own), ("Sec-Fetch-Site", "cross-site"), ("Sec-Fetch-Mode", "navigate")],
        &[("Host", "evil.example")],
    ];
    for headers in refused {
        assert_eq!(studio.try_live(headers).err(), Some(403), "{headers:?}");
    }
    studio.live().text("hello");
}

#[test]
fn uploads_beyond_64_mib_are_refused_before_they_are_read() {
    let studio = Studio::open();
    let head = |length: &str| {
        format!(
            "POST /api/clips?name=a.bvh HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/octet-stream\r\nConnection: close\r\n{length}\r\n\r\n",
            studio.port
        )
    };
    // Announced: refused at once.
    let mut stream = studio.connect();
    stream.write_all(head(&format!("Content-Length: {}", (64 << 20) + 1)).as_bytes()).unwrap();
    let refused = answer(stream);
    assert_eq!((refused.status, refused.json()["error"]["code"].as_str()), (413, Some("too_large")));
    // Not announced: refused when it becomes too large.
    let mut stream = studio.connect();
    stream.write_all(head("Transfer-Encoding: chunked").as_bytes()).unwrap();
    let chunk = vec![b' '; 1 << 20];
    for _ in 0..65 {
        let sent = write!(stream, "{:x}\r\n", chunk.len())
            .and_then(|()| stream.write_all(&chunk))
            .and_then(|()| stream.write_all(b"\r\n"));
        if sent.is_err() {
            break;
        }
    }
    assert_eq!(answer(stream).status, 413);
    // JSON has a limit of its own.
    let long = json!({"label": "x".repeat(9 << 20), "commands": []});
    assert_eq!(studio.post("/api/project/commands", &long).status, 413);
}

#[test]
fn messages_that_are_too_large_close_the_connection() {
    let studio = Studio::open();
    let mut live = studio.live();
    live.text("hello");
    live.say_text(format!("{{\"type\":\"points\",\"x\":\"{}\"}}", "x".repeat(300 << 10)));
    let code = match live.next() {
        Message::Close(Some(frame)) => u16::from(frame.code),
        other => panic!("{other:?}"),
    };
    assert_eq!(code, 1009);
    // What is only wrong is said.
    let mut live = studio.live();
    live.text("hello");
    live.say_text("{\"type\":\"dance\"}".into());
    let Message::Text(text) = live.next() else { panic!("no text") };
    assert!(text.contains("problem") && text.contains("dance"), "{text}");
    live.say(json!({"type": "points", "stroke": 3, "points": [[0.0, 0.0, 0.0, 0.5]]}));
    let Message::Text(text) = live.next() else { panic!("no text") };
    assert!(text.contains("was not begun"), "{text}");
}
