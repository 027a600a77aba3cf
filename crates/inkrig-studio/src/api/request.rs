//! What requests bring, within limits of size and time.

use super::ApiError;
use crate::StudioError;
use axum::body::Body;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::StatusCode;
use axum::http::request::Parts;
use http_body_util::BodyExt as _;
use serde::de::DeserializeOwned;
use std::time::Duration;

/// Most bytes of a body of JSON.
pub(super) const MOST_JSON: usize = 8 << 20;
/// How long a body may pause.
const PAUSE: Duration = Duration::from_secs(10);
/// How long all of a body may take.
const WHOLE: Duration = Duration::from_secs(300);

/// A body of JSON.
pub(crate) struct Json<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequest<S> for Json<T> {
    type Rejection = ApiError;

    async fn from_request(request: Request, _: &S) -> Result<Self, ApiError> {
        let bytes = read_body(request.into_body(), MOST_JSON).await?;
        let bytes = if bytes.is_empty() { b"{}".to_vec() } else { bytes };
        let bad =
            |error: serde_json::Error| ApiError::new(StatusCode::BAD_REQUEST, "bad_json", error.to_string());
        serde_json::from_slice(&bytes).map(Self).map_err(bad)
    }
}

/// The part of the address behind the question mark.
pub(crate) struct Query<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, ApiError> {
        let query = axum::extract::Query::<T>::try_from_uri(&parts.uri);
        let bad = |error: axum::extract::rejection::QueryRejection| {
            ApiError::new(StatusCode::BAD_REQUEST, "bad_query", error.body_text())
        };
        query.map(|query| Self(query.0)).map_err(bad)
    }
}

/// Reads a body of at most `most` bytes. One that does not come is given up.
pub(crate) async fn read_body(body: Body, most: usize) -> Result<Vec<u8>, ApiError> {
    let whole = tokio::time::timeout(WHOLE, read(body, most));
    whole.await.unwrap_or_else(|_| Err(slow()))
}

async fn read(mut body: Body, most: usize) -> Result<Vec<u8>, ApiError> {
    use axum::body::HttpBody as _;
    let too_large = || {
        let message = format!("the upload has more than {most} bytes");
        ApiError::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", message).hint("cut it into shorter files")
    };
    // Said in advance, it is refused in advance.
    if body.size_hint().lower() > most as u64 {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    loop {
        let frame = tokio::time::timeout(PAUSE, body.frame()).await.map_err(|_| slow())?;
        let Some(frame) = frame else { return Ok(bytes) };
        let broken =
            |error: axum::Error| ApiError::new(StatusCode::BAD_REQUEST, "broken_upload", error.to_string());
        let Ok(data) = frame.map_err(broken)?.into_data() else { continue };
        if bytes.len() + data.len() > most {
            return Err(too_large());
        }
        bytes.extend_from_slice(&data);
    }
}

fn slow() -> ApiError {
    ApiError::new(StatusCode::REQUEST_TIMEOUT, "too_slow", "the upload stood still and was given up")
}

/// Work that reads files or computes, away from the threads that answer.
pub(crate) struct Blocking;

impl Blocking {
    pub(crate) async fn run<T: Send + 'static>(
        work: impl FnOnce() -> Result<T, StudioError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let done = tokio::task::spawn_blocking(work).await;
        let done = done.unwrap_or_else(|error| Err(StudioError::Internal(error.to_string())));
        done.map_err(ApiError::from)
    }
}
