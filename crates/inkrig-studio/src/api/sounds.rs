//! Sounds, drawings and waves: what can be followed.

use super::request::{Json as JsonBody, Query};
use super::{ApiError, Blocking, ErrorBody, read_body};
use crate::StudioError;
use crate::document::Control;
use crate::engine::drawings::{As, RATE, read as read_drawing};
use crate::engine::media::{MOST_UPLOAD, extension};
use crate::project::{HistoryState, Kind};
use crate::server::App;
use axum::Json;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use inkrig_sketch::Wave;
use inkrig_sound::{WaveformKind, waveform};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// A sound that was added.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct SoundAdded {
    sound: SoundInfo,
    /// The new revision.
    revision: u32,
    history: HistoryState,
}

/// A sound in a few numbers.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct SoundInfo {
    id: String,
    name: String,
    seconds: f64,
    /// Samples a second.
    rate: u32,
}

/// The name of an upload.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Named {
    /// The file's name; its ending says what it is.
    name: String,
}

/// How fine an outline shall be.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Fineness {
    /// 10 to 10000; 1000 without.
    points: Option<usize>,
}

/// The outline of a sound.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Outline {
    seconds: f64,
    /// Largest magnitudes, 0..1, evenly over its length.
    peaks: Vec<f32>,
}

/// A drawing file.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct DrawingOptions {
    /// The file's name; its ending says what it is.
    name: String,
    /// What it is read as.
    #[serde(default, rename = "as")]
    kind: As,
}

/// A drawing that was read; nothing has changed.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct DrawingRead {
    /// To be set by a command.
    control: Control,
    /// What had to be guessed.
    note: Option<String>,
}

/// A wave to be seen.
#[derive(Debug, Deserialize, ToSchema)]
pub(crate) struct WaveAsked {
    expression: String,
    /// Its own length without, else ten seconds.
    #[serde(default)]
    seconds: Option<f64>,
}

/// A wave.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct WaveSeen {
    values: Vec<f64>,
    /// Samples a second.
    rate: f64,
}

/// Adds a sound.
#[utoipa::path(post, operation_id = "addSound", path = "/api/sounds", params(Named), request_body(content = inline(Vec<u8>), content_type = "application/octet-stream"), responses((status = 200, body = SoundAdded), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn add(
    State(app): State<Arc<App>>,
    Query(Named { name }): Query<Named>,
    body: Body,
) -> Result<Json<SoundAdded>, ApiError> {
    let _turn = app.upload_turn().await?;
    let bytes = read_body(body, MOST_UPLOAD).await?;
    Blocking::run(move || {
        let (entry, applied) = app.studio.add_sound(&name, &bytes)?;
        let folder = app.studio.project().folder().clone();
        let sound = app.studio.media.sound(&folder, &entry)?;
        let info = SoundInfo { id: entry.id, name: entry.name, seconds: sound.seconds(), rate: sound.rate() };
        Ok(Json(SoundAdded { sound: info, revision: applied.revision, history: applied.history }))
    })
    .await
}

/// The sound as it was uploaded.
#[utoipa::path(get, operation_id = "soundFile", path = "/api/sounds/{id}/file", params(("id" = String, Path)), responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn file(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, ApiError> {
    let (kind, bytes) = Blocking::run(move || {
        let (document, _) = app.studio.now();
        let entry = document.sound(&id).ok_or_else(|| StudioError::unknown("sound", &id))?;
        let kind = match extension(&entry.file).as_str() {
            "wav" => "audio/wav",
            "mp3" => "audio/mpeg",
            "ogg" => "audio/ogg",
            "flac" => "audio/flac",
            _ => "application/octet-stream",
        };
        let folder = app.studio.project().folder().clone();
        Ok((kind, folder.kept(Kind::Sound, &entry.file, MOST_UPLOAD)?))
    })
    .await?;
    Ok(([(CONTENT_TYPE, kind)], bytes))
}

/// The outline of a sound, to be drawn.
#[utoipa::path(get, path = "/api/sounds/{id}/outline", params(("id" = String, Path), Fineness), responses((status = 200, body = Outline), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn outline(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    Query(Fineness { points }): Query<Fineness>,
) -> Result<Json<Outline>, ApiError> {
    let points = points.unwrap_or(1000).clamp(10, 10_000);
    Blocking::run(move || {
        let (document, _) = app.studio.now();
        let entry = document.sound(&id).ok_or_else(|| StudioError::unknown("sound", &id))?;
        let folder = app.studio.project().folder().clone();
        let sound = app.studio.media.sound(&folder, entry)?;
        let seconds = sound.seconds();
        let peaks = waveform(&sound, points as f64 / seconds.max(1e-3), WaveformKind::Peak)?;
        Ok(Json(Outline { seconds, peaks: peaks.values }))
    })
    .await
}

/// Reads a drawing, a wave or labels. Nothing changes.
#[utoipa::path(post, path = "/api/drawings", params(DrawingOptions), request_body(content = inline(Vec<u8>), content_type = "application/octet-stream"), responses((status = 200, body = DrawingRead), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn drawing(
    State(app): State<Arc<App>>,
    Query(DrawingOptions { name, kind }): Query<DrawingOptions>,
    body: Body,
) -> Result<Json<DrawingRead>, ApiError> {
    let _turn = app.upload_turn().await?;
    let bytes = read_body(body, MOST_UPLOAD).await?;
    Blocking::run(move || {
        let (control, note) = read_drawing(&bytes, &name, kind)?;
        Ok(Json(DrawingRead { control, note }))
    })
    .await
}

/// The values of an expression, to be drawn.
#[utoipa::path(post, path = "/api/waves", request_body = WaveAsked, responses((status = 200, body = WaveSeen), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn wave(JsonBody(asked): JsonBody<WaveAsked>) -> Result<Json<WaveSeen>, ApiError> {
    Blocking::run(move || {
        let wave: Wave = asked.expression.parse()?;
        let seconds = asked.seconds.or(wave.duration()).unwrap_or(10.0).clamp(0.1, 600.0);
        let frames = wave.frame_count(RATE).filter(|_| asked.seconds.is_none());
        let frames = frames.unwrap_or((seconds * RATE).round() as usize).clamp(2, 18_000);
        Ok(Json(WaveSeen { values: wave.sample(RATE, frames)?, rate: RATE }))
    })
    .await
}
