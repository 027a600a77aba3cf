//! Live strokes: ink in, poses out. Only the newest poses are sent; ink is on the disk before it is solved.

use crate::StudioError;
use crate::document::{Control, CurveTiming, PenPoint};
use crate::engine::solver::Shown;
use crate::project::HistoryState;
use crate::server::App;
use crate::strokes::StrokeMode;
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tokio::sync::{Notify, mpsc};
use utoipa::ToSchema;

/// Most bytes of a message of the page.
pub(crate) const MOST_MESSAGE: usize = 256 << 10;
/// Most pages that draw or watch at once.
const MOST_CLIENTS: usize = 32;
/// Between two states of a curve that is drawn over.
const DRAWING: Duration = Duration::from_millis(50);
/// Between two questions whether the page is still there.
const PING: Duration = Duration::from_secs(20);
/// How long poses wait for a page to say that it has seen the last ones.
const UNSEEN: Duration = Duration::from_secs(1);
/// How long a page may take with a message.
const SLOW: Duration = Duration::from_secs(20);

/// What the page says.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(tag = "type", rename_all = "camelCase")]
pub(crate) enum FromPage {
    /// The pen is set down.
    Begin {
        /// Rises.
        stroke: u32,
        mode: StrokeMode,
        #[serde(default)]
        timing: Option<CurveTiming>,
    },
    /// More ink.
    Points {
        stroke: u32,
        /// Only what is new: `[x, y, t, p]`, t in seconds since the beginning of the stroke; `[t, v]` of a wave.
        points: Vec<Vec<Option<f64>>>,
    },
    /// The pen is lifted.
    End { stroke: u32 },
    /// As if nothing had happened.
    Cancel { stroke: u32 },
    /// The newest poses have come. A page that says so once is sent no more before it has said it again: a page that is
    /// slower than the solver is then behind by one answer, not by all that wait on the line.
    Seen,
}

/// What the page is told.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(tag = "type", rename_all = "camelCase")]
pub(crate) enum ToPage {
    /// The first message.
    Hello { revision: u32 },
    /// The stroke is a step of the project.
    Committed { stroke: u32, revision: u32, history: HistoryState, control: Option<Control> },
    /// The curve while it is drawn over.
    Drawing { stroke: u32, control: Control },
    /// Too little to be solved yet.
    Waiting { stroke: u32, message: String },
    /// It cannot be solved, or was not understood.
    Problem { message: String, hint: Option<String> },
}

/// The page's end of a live stroke.
pub(crate) async fn live(State(app): State<Arc<App>>, upgrade: WebSocketUpgrade) -> Response {
    upgrade
        .max_message_size(MOST_MESSAGE)
        .max_frame_size(MOST_MESSAGE)
        .on_upgrade(move |socket| serve(app, socket))
}

async fn serve(app: Arc<App>, socket: WebSocket) {
    static CLIENTS: AtomicU64 = AtomicU64::new(1);
    let client = CLIENTS.fetch_add(1, Ordering::Relaxed);
    let (mut sink, stream) = socket.split();
    let Ok(_place) = app.live_places.clone().try_acquire_owned() else {
        let _ = sink.send(close(1013, "too many windows are open")).await;
        return;
    };
    let (texts, inbox) = mpsc::channel(64);
    let hello = ToPage::Hello { revision: app.studio.now().1 };
    let _ = texts.send(Message::text(serde_json::to_string(&hello).unwrap_or_default())).await;
    let pace = Arc::new(Pace::default());
    let writer = tokio::spawn(write(app.clone(), sink, inbox, pace.clone()));
    read(&app, client, stream, &texts, &pace).await;
    drop(texts);
    // A page that is gone has lifted its pen.
    let left = app.clone();
    let _ = tokio::task::spawn_blocking(move || left.studio.end_stroke(client, None)).await;
    writer.abort();
}

/// How far a page is behind.
#[derive(Debug, Default)]
struct Pace {
    /// Poses were sent that the page has not seen.
    unseen: AtomicBool,
    /// The page says when it has seen poses.
    says: AtomicBool,
    seen: Notify,
}

impl Pace {
    fn see(&self) {
        self.says.store(true, Ordering::Release);
        self.unseen.store(false, Ordering::Release);
        self.seen.notify_one();
    }

    fn ready(&self) -> bool {
        !self.says.load(Ordering::Acquire) || !self.unseen.load(Ordering::Acquire)
    }
}

/// Places for pages at once.
pub(crate) fn places() -> Arc<tokio::sync::Semaphore> {
    Arc::new(tokio::sync::Semaphore::new(MOST_CLIENTS))
}

async fn read(
    app: &Arc<App>,
    client: u64,
    mut stream: SplitStream<WebSocket>,
    texts: &mpsc::Sender<Message>,
    pace: &Pace,
) {
    let mut drawn = Instant::now();
    let mut mode = StrokeMode::Draw;
    loop {
        let message = tokio::time::timeout(3 * PING, stream.next()).await;
        let arrived = Instant::now();
        let text = match message {
            Ok(Some(Ok(Message::Text(text)))) => text,
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => continue,
            Ok(Some(Ok(Message::Binary(_)))) => {
                let _ = texts.send(close(1003, "messages are text")).await;
                return;
            }
            Ok(Some(Err(error))) => {
                let too_large = error.to_string().to_lowercase().contains("too long")
                    || error.to_string().to_lowercase().contains("too large")
                    || error.to_string().to_lowercase().contains("capacity");
                if too_large {
                    let _ = texts.send(close(1009, "the message is too large")).await;
                    // Time for the last word.
                    tokio::time::sleep(Duration::from_millis(200)).await;
                }
                return;
            }
            Ok(Some(Ok(Message::Close(_))) | None) | Err(_) => return,
        };
        let said: Result<FromPage, _> = serde_json::from_str(&text);
        let answer = match said {
            Err(error) => Some(ToPage::Problem {
                message: format!("the message was not understood: {error}"),
                hint: None,
            }),
            Ok(FromPage::Seen) => {
                pace.see();
                None
            }
            Ok(said) => {
                if let FromPage::Begin { mode: begun, .. } = &said {
                    mode = *begun;
                }
                let redraws = mode == StrokeMode::Redraw && drawn.elapsed() >= DRAWING;
                let studio = app.clone();
                let done =
                    tokio::task::spawn_blocking(move || act(&studio, client, said, arrived, redraws)).await;
                match done {
                    Ok(Ok(answer)) => {
                        if matches!(answer, Some(ToPage::Drawing { .. })) {
                            drawn = Instant::now();
                        }
                        answer
                    }
                    Ok(Err(error)) => Some(ToPage::Problem { message: error.to_string(), hint: None }),
                    Err(_) => return,
                }
            }
        };
        if let Some(answer) = answer {
            let text = serde_json::to_string(&answer).unwrap_or_default();
            if texts.send(Message::text(text)).await.is_err() {
                return;
            }
        }
    }
}

fn act(
    app: &App,
    client: u64,
    said: FromPage,
    arrived: Instant,
    redraws: bool,
) -> Result<Option<ToPage>, StudioError> {
    match said {
        FromPage::Begin { stroke, mode, timing } => {
            app.studio.begin_stroke(client, stroke, mode, timing)?;
            Ok(None)
        }
        FromPage::Points { stroke, points } => {
            let points: Option<Vec<PenPoint>> = points.iter().map(|point| pen_point(point)).collect();
            let points =
                points.ok_or_else(|| StudioError::invalid("a point is [x, y], [x, y, t] or [x, y, t, p]"))?;
            let control = app.studio.push_points(client, stroke, &points, arrived)?;
            Ok(control.filter(|_| redraws).map(|control| ToPage::Drawing { stroke, control }))
        }
        FromPage::End { stroke } => {
            let done = app.studio.end_stroke(client, Some(stroke))?;
            Ok(done.map(|(stroke, applied, control)| ToPage::Committed {
                stroke,
                revision: applied.revision,
                history: applied.history,
                control,
            }))
        }
        FromPage::Cancel { stroke } => {
            app.studio.cancel_stroke(client, stroke)?;
            Ok(None)
        }
        FromPage::Seen => Ok(None),
    }
}

fn pen_point(point: &[Option<f64>]) -> Option<PenPoint> {
    match *point {
        [Some(x), Some(y)] => Some((x, y, None, None)),
        [Some(x), Some(y), t] => Some((x, y, t, None)),
        [Some(x), Some(y), t, p] => Some((x, y, t, p)),
        _ => None,
    }
}

/// Sends what is to be said, and the newest poses.
async fn write(
    app: Arc<App>,
    mut sink: SplitSink<WebSocket, Message>,
    mut inbox: mpsc::Receiver<Message>,
    pace: Arc<Pace>,
) {
    let mut shown = app.studio.solver.shown();
    shown.mark_changed();
    let mut ping = tokio::time::interval(PING);
    loop {
        let ready = pace.ready();
        let message = tokio::select! {
            biased;
            text = inbox.recv() => match text {
                Some(text) => text,
                None => return,
            },
            () = pace.seen.notified(), if !ready => continue,
            () = tokio::time::sleep(UNSEEN), if !ready => {
                pace.unseen.store(false, Ordering::Release);
                continue;
            }
            changed = shown.changed(), if ready => {
                if changed.is_err() {
                    return;
                }
                let newest = shown.borrow_and_update().clone();
                match newest {
                    Some(Shown::Poses(bytes)) => {
                        pace.unseen.store(true, Ordering::Release);
                        Message::Binary(Bytes::from_owner(SharedBytes(bytes)))
                    }
                    Some(Shown::Not { stroke, message, waiting: true }) => {
                        text_of(&ToPage::Waiting { stroke, message })
                    }
                    Some(Shown::Not { message, .. }) => text_of(&ToPage::Problem { message, hint: None }),
                    None => continue,
                }
            },
            _ = ping.tick() => Message::Ping(Bytes::new()),
        };
        let last = matches!(message, Message::Close(_));
        let sent = tokio::time::timeout(SLOW, sink.send(message)).await;
        if last || !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}

/// Poses that all pages share.
struct SharedBytes(Arc<Vec<u8>>);

impl AsRef<[u8]> for SharedBytes {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

fn text_of(message: &ToPage) -> Message {
    Message::text(serde_json::to_string(message).unwrap_or_default())
}

fn close(code: u16, reason: &'static str) -> Message {
    Message::Close(Some(CloseFrame { code, reason: reason.into() }))
}
