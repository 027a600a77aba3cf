//! The storyboard: kept with the project, made an animation.

use super::request::{MOST_JSON, Query};
use super::{ApiError, Blocking, ErrorBody, read_body};
use crate::StudioError;
use crate::events::JobState;
use crate::server::App;
use crate::storyboard::{BoardAsked, BoardMade, Boards};
use axum::Json;
use axum::body::Body;
use axum::extract::State;
use inkrig_sketch::storyboard::read_storyboard;
use serde::Serialize;
use std::sync::Arc;
use utoipa::ToSchema;

/// The storyboard and what is known of it.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct BoardState {
    /// Whether this program makes animations of storyboards.
    available: bool,
    /// Words that it knows.
    words: Vec<String>,
    /// The storyboard's file; none where nothing was drawn.
    #[schema(value_type = Option<Object>)]
    board: Option<serde_json::Value>,
    /// The job that runs.
    job: Option<JobState>,
    /// The newest animation.
    made: Option<BoardMade>,
    /// For each of its frames, which frame of the storyboard (from 0) it is; none where that is gone or has another figure.
    of: Vec<Option<usize>>,
    /// For each of its frames, whether that is drawn as it was then.
    still: Vec<bool>,
}

/// A storyboard that was kept.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct BoardKept {
    /// How many frames it has.
    frames: usize,
}

/// The storyboard of the project.
#[utoipa::path(get, operation_id = "storyboard", path = "/api/storyboard", responses((status = 200, body = BoardState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn state(State(app): State<Arc<App>>) -> Result<Json<BoardState>, ApiError> {
    Blocking::run(move || {
        let boards = &app.studio.boards;
        let words = boards.words();
        let folder = app.studio.project().folder().clone();
        let made = boards.made();
        let mut known = Vec::new();
        let board = match folder.board()? {
            Some(bytes) => {
                known = made.known(&read_storyboard(&bytes)?);
                Some(
                    serde_json::from_slice(&bytes)
                        .map_err(|cause| StudioError::Internal(cause.to_string()))?,
                )
            }
            None => None,
        };
        Ok(Json(BoardState {
            available: words.is_some(),
            words: words.unwrap_or_default(),
            board,
            job: boards.current(),
            made: made.newest().cloned(),
            of: known.iter().map(|known| known.map(|(at, _)| at)).collect(),
            still: known.iter().map(|known| known.is_some_and(|(_, still)| still)).collect(),
        }))
    })
    .await
}

/// Keeps the storyboard with the project. It is on the disk before the answer.
#[utoipa::path(put, operation_id = "keepStoryboard", path = "/api/storyboard", request_body(content = Object, content_type = "application/json"), responses((status = 200, body = BoardKept), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn keep(State(app): State<Arc<App>>, body: Body) -> Result<Json<BoardKept>, ApiError> {
    let bytes = read_body(body, MOST_JSON).await?;
    Blocking::run(move || {
        let board = read_storyboard(&bytes)?;
        let folder = app.studio.project().folder().clone();
        folder.keep_board(&board)?;
        app.studio.boards.drawn_on();
        Ok(Json(BoardKept { frames: board.frames.len() }))
    })
    .await
}

/// Keeps the storyboard, and begins to make one animation of it, which becomes a clip that is shown.
#[utoipa::path(post, operation_id = "makeStoryboard", path = "/api/storyboard", params(BoardAsked), request_body(content = Object, content_type = "application/json"), responses((status = 200, body = JobState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn make(
    State(app): State<Arc<App>>,
    Query(asked): Query<BoardAsked>,
    body: Body,
) -> Result<Json<JobState>, ApiError> {
    let bytes = read_body(body, MOST_JSON).await?;
    Blocking::run(move || {
        let board = read_storyboard(&bytes)?;
        let folder = app.studio.project().folder().clone();
        folder.keep_board(&board)?;
        Boards::begin(&app.studio, board, asked).map(Json)
    })
    .await
}
