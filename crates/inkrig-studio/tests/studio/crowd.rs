//! Many clients, and clients that say nothing, do not stop who draws.

use crate::client::{Studio, spiral};
use serde_json::json;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

#[test]
fn a_crowd_and_a_slow_loris_do_not_stop_a_drawing_user() {
    let studio = Studio::open();
    studio.post("/api/samples/person", &json!({})).good();
    let mut live = studio.live();
    live.text("hello");
    // More connections that never say what they want than there are places, in part with half a request.
    let mut loris: Vec<TcpStream> = Vec::new();
    for index in 0..600 {
        let mut stream = studio.connect();
        if index % 2 == 0 {
            let _ = stream.write_all(b"GET /api/project HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ");
        }
        loris.push(stream);
    }
    // Uploads that stand still.
    for _ in 0..3 {
        let mut stream = studio.connect();
        let head = format!(
            "POST /api/clips?name=a.bvh HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/octet-stream\r\nContent-Length: 1000000\r\n\r\nHIER",
            studio.port
        );
        let _ = stream.write_all(head.as_bytes());
        loris.push(stream);
    }
    live.say(json!({"type": "begin", "stroke": 1, "mode": "draw"}));
    let points = spiral(5.0);
    let mut slowest = Duration::ZERO;
    std::thread::scope(|scope| {
        let crowd: Vec<_> = (0..200).map(|_| scope.spawn(|| studio.get("/api/project").status)).collect();
        for (index, chunk) in points.chunks(30).enumerate() {
            let begin = Instant::now();
            live.say(json!({"type": "points", "stroke": 1, "points": chunk}));
            if index >= 2 {
                live.poses(|poses| poses.message == index as u32 + 1);
                slowest = slowest.max(begin.elapsed());
            }
        }
        for one in crowd {
            assert_eq!(one.join().unwrap(), 200);
        }
    });
    live.say(json!({"type": "end", "stroke": 1}));
    live.text("committed");
    println!("slowest answer to ink: {slowest:?}");
    assert!(slowest < Duration::from_secs(5), "{slowest:?}");
    // The first of them had to make room.
    let mut gone = 0;
    for stream in &mut loris {
        stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
        gone += usize::from(
            matches!(stream.read(&mut [0; 1]), Ok(0))
                || matches!(stream.read(&mut [0; 1]), Err(error) if error.kind() == std::io::ErrorKind::ConnectionReset),
        );
    }
    assert!(gone >= 80, "{gone}");
}
