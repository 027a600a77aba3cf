//! A server in this process, and clients that can say anything.

use inkrig_studio::storyboard::Storyboarder;
use inkrig_studio::{Invitation, ServeOptions, Server};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

/// A server on a folder that goes with it.
pub(crate) struct Studio {
    pub(crate) port: u16,
    invitations: Mutex<Receiver<Invitation>>,
    pub(crate) folder: tempfile::TempDir,
}

/// What came back.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Studio {
    pub(crate) fn open() -> Self {
        Self::with(false, None)
    }

    pub(crate) fn with(lan: bool, page: Option<&Path>) -> Self {
        Self::on(tempfile::tempdir().unwrap(), lan, page, None)
    }

    pub(crate) fn on(
        folder: tempfile::TempDir,
        lan: bool,
        page: Option<&Path>,
        storyboarder: Option<Arc<dyn Storyboarder>>,
    ) -> Self {
        let server = Server::bind(ServeOptions {
            port: 0,
            lan,
            names: if lan { vec!["studio.test".into()] } else { Vec::new() },
            project: folder.path().to_path_buf(),
            page: page.map(Path::to_path_buf),
            threads: 2,
            storyboarder,
        })
        .unwrap();
        let address = server.address();
        let port = address.trim_end_matches('/').rsplit(':').next().unwrap().parse().unwrap();
        let (sender, invitations) = channel();
        std::thread::spawn(move || {
            server.run(move |invitation| {
                let _ = sender.send(invitation);
            })
        });
        Self { port, invitations: Mutex::new(invitations), folder }
    }

    /// The next invitation.
    pub(crate) fn invitation(&self) -> Invitation {
        self.invitations.lock().unwrap().recv_timeout(Duration::from_secs(20)).unwrap()
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], b"")
    }

    pub(crate) fn post(&self, path: &str, body: &serde_json::Value) -> Answer {
        self.ask("POST", path, &[("Content-Type", "application/json")], body.to_string().as_bytes())
    }

    pub(crate) fn upload(&self, path: &str, bytes: &[u8]) -> Answer {
        self.ask("POST", path, &[("Content-Type", "application/octet-stream")], bytes)
    }

    /// With the host that a browser would send.
    pub(crate) fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let host = format!("127.0.0.1:{}", self.port);
        self.ask_as(&host, method, path, headers, body)
    }

    pub(crate) fn ask_as(
        &self,
        host: &str,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Answer {
        let mut head = format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n");
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        if !body.is_empty() || method != "GET" {
            head += &format!("Content-Length: {}\r\n", body.len());
        }
        head += "\r\n";
        let mut stream = self.connect();
        stream.write_all(head.as_bytes()).unwrap();
        // A server that refuses does not wait for all of it.
        let _ = stream.write_all(body);
        answer(stream)
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    /// A pen's end of the live connection, as our own page opens it.
    pub(crate) fn live(&self) -> Live {
        let origin = format!("http://127.0.0.1:{}", self.port);
        self.try_live(&[("Origin", &origin), ("Sec-Fetch-Site", "same-origin")]).unwrap()
    }

    /// The status where it is refused.
    pub(crate) fn try_live(&self, headers: &[(&'static str, &str)]) -> Result<Live, u16> {
        let mut request = format!("ws://127.0.0.1:{}/api/live", self.port).into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        match tungstenite::client(request, self.connect()) {
            Ok((socket, _)) => Ok(Live { socket }),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(response))) => {
                Err(response.status().as_u16())
            }
            Err(error) => panic!("{error}"),
        }
    }
}

impl Answer {
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("{self:?}"))
    }

    /// The JSON of a good answer.
    pub(crate) fn good(&self) -> serde_json::Value {
        assert_eq!(self.status, 200, "{}", String::from_utf8_lossy(&self.body));
        self.json()
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.head.lines().find_map(|line| {
            let (key, value) = line.split_once(':')?;
            key.eq_ignore_ascii_case(name).then_some(value.trim())
        })
    }
}

pub(crate) fn answer(mut stream: TcpStream) -> Answer {
    let mut bytes = Vec::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) | Err(_) => break,
            Ok(count) => bytes.extend_from_slice(&buffer[..count]),
        }
    }
    let split = bytes.windows(4).position(|window| window == b"\r\n\r\n").unwrap_or(bytes.len());
    let head = String::from_utf8_lossy(&bytes[..split]).into_owned();
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    let body = bytes.get(split + 4..).unwrap_or_default().to_vec();
    let chunked = head.to_ascii_lowercase().contains("transfer-encoding: chunked");
    Answer { status, head, body: if chunked { unchunked(&body) } else { body } }
}

fn unchunked(mut body: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    while let Some(end) = body.windows(2).position(|window| window == b"\r\n") {
        let size = usize::from_str_radix(std::str::from_utf8(&body[..end]).unwrap().trim(), 16).unwrap();
        if size == 0 {
            break;
        }
        out.extend_from_slice(&body[end + 2..end + 2 + size]);
        body = &body[end + 2 + size + 2..];
    }
    out
}

/// The page's end of a live connection.
pub(crate) struct Live {
    socket: WebSocket<TcpStream>,
}

/// What stands before poses.
#[derive(Debug, Clone)]
pub(crate) struct Poses {
    pub(crate) kind: u32,
    pub(crate) stroke: u32,
    pub(crate) message: u32,
    pub(crate) frames: u32,
    pub(crate) level: u16,
    pub(crate) levels: u16,
    pub(crate) milliseconds: f32,
    pub(crate) bytes: Vec<u8>,
}

impl Live {
    pub(crate) fn say(&mut self, message: serde_json::Value) {
        self.socket.send(Message::text(message.to_string())).unwrap();
    }

    pub(crate) fn say_text(&mut self, message: String) {
        let _ = self.socket.send(Message::text(message));
    }

    pub(crate) fn next(&mut self) -> Message {
        loop {
            match self.socket.read() {
                Ok(Message::Ping(_) | Message::Pong(_)) => {}
                Ok(message) => return message,
                Err(error) => panic!("the server is gone: {error}"),
            }
        }
    }

    /// The next text of a type; poses and others are skipped.
    pub(crate) fn text(&mut self, kind: &str) -> serde_json::Value {
        loop {
            if let Message::Text(text) = self.next() {
                let value: serde_json::Value = serde_json::from_str(&text).unwrap();
                if value["type"] == kind {
                    return value;
                }
                assert_ne!(value["type"], "problem", "{value}");
            }
        }
    }

    /// The next poses that `wanted` says yes to.
    pub(crate) fn poses(&mut self, wanted: impl Fn(&Poses) -> bool) -> Poses {
        loop {
            match self.next() {
                Message::Binary(bytes) => {
                    let poses = Poses::of(&bytes);
                    if wanted(&poses) {
                        return poses;
                    }
                }
                Message::Text(text) => assert!(!text.contains("\"problem\""), "{text}"),
                other => panic!("{other:?}"),
            }
        }
    }
}

impl Poses {
    pub(crate) fn of(bytes: &[u8]) -> Self {
        let int = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!(&bytes[..4], b"IKP1");
        Self {
            kind: int(4),
            stroke: int(12),
            message: int(16),
            frames: int(20),
            level: int(36) as u16,
            levels: (int(36) >> 16) as u16,
            milliseconds: f32::from_bits(int(44)),
            bytes: bytes.to_vec(),
        }
    }
}

/// A growing spiral as a pen draws it, 60 samples a second.
pub(crate) fn spiral(seconds: f64) -> Vec<[f64; 4]> {
    let count = (seconds * 60.0) as usize;
    (0..count)
        .map(|index| {
            let t = index as f64 / 60.0;
            let (angle, radius) = (t * 3.0, 0.2 + 0.1 * t);
            [radius * angle.cos(), radius * angle.sin(), t, 0.5]
        })
        .collect()
}
