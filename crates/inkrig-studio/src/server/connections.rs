//! Connections: how many, and how long each may take to say what it wants.
//!
//! A connection that has not yet asked anything that was let in is on probation. When all places are taken, the one that has
//! been on probation longest has to go: whoever opens connections and says nothing never keeps a drawing user out.

use crate::StudioError;
use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use hyper::body::Incoming;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::AbortHandle;

/// Connections at once.
const MOST: usize = 512;
/// How long the head of a request may take, and how long a connection may say nothing.
const HEAD: Duration = Duration::from_secs(10);

/// One connection.
#[derive(Debug, Default)]
pub(crate) struct Connection {
    /// It has asked something that was let in.
    pub(crate) proven: AtomicBool,
}

type Waiting = Arc<Mutex<VecDeque<(Arc<Connection>, AbortHandle)>>>;

/// Serves for ever.
pub(super) async fn serve(listener: TcpListener, router: Router) -> Result<(), StudioError> {
    let places = Arc::new(Semaphore::new(MOST));
    let waiting = Waiting::default();
    loop {
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(error) => {
                // Out of files, or a connection that was gone before it was here.
                tracing::warn!("a connection could not be taken: {error}");
                tokio::time::sleep(Duration::from_millis(20)).await;
                continue;
            }
        };
        let place = match places.clone().try_acquire_owned() {
            Ok(place) => place,
            Err(_) => {
                make_room(&waiting);
                // The one that has to go gives its place back as it ends.
                let freed = tokio::time::timeout(Duration::from_millis(200), places.clone().acquire_owned());
                match freed.await {
                    Ok(Ok(place)) => place,
                    _ => continue,
                }
            }
        };
        let connection = Arc::new(Connection::default());
        let task = tokio::spawn(talk(stream, router.clone(), connection.clone(), place));
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.retain(|(other, task)| !other.proven.load(Ordering::Acquire) && !task.is_finished());
        waiting.push_back((connection, task.abort_handle()));
    }
}

fn make_room(waiting: &Waiting) {
    let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
    while let Some((connection, task)) = waiting.pop_front() {
        if !connection.proven.load(Ordering::Acquire) && !task.is_finished() {
            task.abort();
            return;
        }
    }
}

async fn talk(stream: TcpStream, router: Router, connection: Arc<Connection>, place: OwnedSemaphorePermit) {
    // Poses are many small answers to many small messages.
    let _ = stream.set_nodelay(true);
    let service = service_fn(move |request: hyper::Request<Incoming>| {
        let (router, connection) = (router.clone(), connection.clone());
        async move {
            let mut request: Request = request.map(Body::new);
            request.extensions_mut().insert(connection);
            let response = tower_call(router, request).await;
            Ok::<_, Infallible>(response)
        }
    });
    let served = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_headers(64)
        .max_buf_size(64 << 10)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades()
        .await;
    if let Err(error) = served {
        tracing::debug!("a connection ended: {error}");
    }
    drop(place);
}

async fn tower_call(mut router: Router, request: Request) -> axum::response::Response {
    use axum::response::IntoResponse as _;
    use tower_service::Service as _;
    match router.call(request).await {
        Ok(response) => response,
        Err(never) => never.into_response(),
    }
}
