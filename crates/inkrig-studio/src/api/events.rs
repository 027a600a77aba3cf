//! Progress and changes, as they happen.

use crate::events::Event;
use crate::server::App;
use axum::extract::State;
use axum::response::sse::{self, KeepAlive, Sse};
use futures_util::{Stream, stream};
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;

/// Server-sent events: `project`, `job`, `result`, `problem`.
pub(crate) async fn events(
    State(app): State<Arc<App>>,
) -> Sse<impl Stream<Item = Result<sse::Event, Infallible>>> {
    let listening = app.studio.events.listen();
    let stream = stream::unfold(listening, |mut listening| async move {
        loop {
            match listening.recv().await {
                Ok(event) => return Some((Ok(as_text(&event)), listening)),
                // Who is too slow misses progress, and loads the project again at the next change.
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return None,
            }
        }
    });
    Sse::new(stream).keep_alive(KeepAlive::new().interval(Duration::from_secs(15)))
}

fn as_text(event: &Event) -> sse::Event {
    sse::Event::default().event(event.name()).data(serde_json::to_string(event).unwrap_or_default())
}
