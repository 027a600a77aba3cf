//! The project: loaded, changed, undone.

use super::request::Json as Body;
use super::{ApiError, Blocking, ErrorBody};
use crate::document::Command;
use crate::server::App;
use crate::studio::{Applied, ProjectState};
use axum::Json;
use axum::extract::State;
use serde::Deserialize;
use std::sync::Arc;
use utoipa::ToSchema;

/// Changes that are one step.
#[derive(Debug, Deserialize, ToSchema)]
pub(crate) struct Commands {
    /// What the step is called.
    label: String,
    /// In order; all or none.
    commands: Vec<Command>,
    /// Steps of one gesture that follow each other are one.
    #[serde(default)]
    gesture: Option<String>,
}

/// The project as it is.
#[utoipa::path(get, path = "/api/project", responses((status = 200, body = ProjectState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn state(State(app): State<Arc<App>>) -> Result<Json<ProjectState>, ApiError> {
    Blocking::run(move || Ok(Json(app.studio.state()))).await
}

/// Changes it as one step that can be undone. It is on the disk before the answer.
#[utoipa::path(post, path = "/api/project/commands", request_body = Commands, responses((status = 200, body = Applied), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn commands(
    State(app): State<Arc<App>>,
    Body(body): Body<Commands>,
) -> Result<Json<Applied>, ApiError> {
    let Commands { label, commands, gesture } = body;
    Blocking::run(move || app.studio.commands(&label, gesture.as_deref(), commands).map(Json)).await
}

/// Takes the last step back.
#[utoipa::path(post, path = "/api/project/undo", responses((status = 200, body = ProjectState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn undo(State(app): State<Arc<App>>) -> Result<Json<ProjectState>, ApiError> {
    step(app, true).await
}

/// Takes the last undone step again.
#[utoipa::path(post, path = "/api/project/redo", responses((status = 200, body = ProjectState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn redo(State(app): State<Arc<App>>) -> Result<Json<ProjectState>, ApiError> {
    step(app, false).await
}

async fn step(app: Arc<App>, back: bool) -> Result<Json<ProjectState>, ApiError> {
    Blocking::run(move || {
        app.studio.step(back)?;
        Ok(Json(app.studio.state()))
    })
    .await
}
