//! Jobs, results, and what helps to understand them.

use super::clips::{Figure, figure};
use super::request::{Json as JsonBody, Query};
use super::{ApiError, Blocking, ErrorBody};
use crate::StudioError;
use crate::engine::results::{Finished, ResultFacts};
use crate::engine::suggest::{Suggestions, suggestions as suggest};
use crate::events::{JobKind, JobState};
use crate::server::App;
use axum::Json;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use serde::Deserialize;
use std::sync::Arc;

/// The size of a picture.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct PictureSize {
    /// Control samples, 1 to 2000; 300 without.
    width: Option<usize>,
    /// Source frames, 1 to 2000; 150 without.
    height: Option<usize>,
}

/// How many poses to suggest.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Count {
    /// 1 to 64; 8 without.
    count: Option<usize>,
}

/// Begins a job. Solving follows every change by itself; this one is for when it was stopped.
#[utoipa::path(post, path = "/api/jobs", request_body = JobKind, responses((status = 200, body = JobState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn begin_job(
    State(app): State<Arc<App>>,
    JsonBody(kind): JsonBody<JobKind>,
) -> Result<Json<JobState>, ApiError> {
    Blocking::run(move || {
        if let JobKind::Alternatives { most } = kind
            && !(2..=8).contains(&most)
        {
            return Err(StudioError::invalid("2 to 8 solutions can be looked for"));
        }
        let (document, revision) = app.studio.now();
        if document.source.clips.is_empty() {
            return Err(StudioError::NoSource);
        }
        if document.control.is_none() {
            return Err(StudioError::NoControl);
        }
        Ok(Json(app.studio.solver.begin(kind, document, revision)))
    })
    .await
}

/// How far a job is.
#[utoipa::path(get, path = "/api/jobs/{id}", params(("id" = String, Path)), responses((status = 200, body = JobState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn job(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<JobState>, ApiError> {
    let state = app.studio.solver.job(&id).or_else(|| app.studio.boards.job(&id));
    let state = state.ok_or_else(|| StudioError::unknown("job", &id))?;
    Ok(Json(state))
}

/// Stops a job.
#[utoipa::path(delete, path = "/api/jobs/{id}", params(("id" = String, Path)), responses((status = 200, body = JobState), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn cancel_job(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<JobState>, ApiError> {
    let state = app.studio.solver.cancel(&id).or_else(|| app.studio.boards.cancel(&id));
    let state = state.ok_or_else(|| StudioError::unknown("job", &id))?;
    Ok(Json(state))
}

/// What is told of a result.
#[utoipa::path(get, path = "/api/results/{id}", params(("id" = String, Path)), responses((status = 200, body = ResultFacts), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn facts(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<ResultFacts>, ApiError> {
    Ok(Json(find(&app, &id)?.facts.clone()))
}

/// The character of a result: that of the source, but for a root bone.
#[utoipa::path(get, path = "/api/results/{id}/skeleton", params(("id" = String, Path)), responses((status = 200, body = Figure), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn skeleton(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<Figure>, ApiError> {
    let result = find(&app, &id)?;
    Blocking::run(move || Ok(Json(figure(&result.clip)))).await
}

/// The poses of a result.
#[utoipa::path(get, operation_id = "resultPoses", path = "/api/results/{id}/poses", params(("id" = String, Path)), responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn poses(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, ApiError> {
    let result = find(&app, &id)?;
    let bytes = Blocking::run(move || Ok(result.poses())).await?;
    Ok(([(CONTENT_TYPE, "application/octet-stream")], bytes))
}

/// The plan of a result as a picture.
#[utoipa::path(get, path = "/api/results/{id}/plan", params(("id" = String, Path), PictureSize), responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn plan(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    Query(size): Query<PictureSize>,
) -> Result<impl IntoResponse, ApiError> {
    let result = find(&app, &id)?;
    let side = |asked: Option<usize>, usual| asked.unwrap_or(usual).clamp(1, 2000);
    let (width, height) = (side(size.width, 300), side(size.height, 150));
    let bytes = Blocking::run(move || {
        let plan = result.plan.as_ref().ok_or_else(|| StudioError::unknown("plan of", &result.facts.id))?;
        Ok(plan.encode(width, height))
    });
    Ok(([(CONTENT_TYPE, "application/octet-stream")], bytes.await?))
}

/// Poses worth a key, and the map of the source.
#[utoipa::path(get, path = "/api/suggestions", params(Count), responses((status = 200, body = Suggestions), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn suggestions(
    State(app): State<Arc<App>>,
    Query(Count { count }): Query<Count>,
) -> Result<Json<Suggestions>, ApiError> {
    let count = count.unwrap_or(8).clamp(1, 64);
    Blocking::run(move || {
        let (document, _) = app.studio.now();
        let folder = app.studio.project().folder().clone();
        suggest(&document, &folder, &app.studio.media, count).map(Json)
    })
    .await
}

fn find(app: &App, id: &str) -> Result<Arc<Finished>, StudioError> {
    app.studio.solver.results().get(id).ok_or_else(|| StudioError::unknown("result", id))
}
