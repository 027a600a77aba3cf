//! The HTTP interface. What it is stands in `openapi.json`, made from here.

mod clips;
mod events;
mod info;
mod live;
mod problem;
mod project;
mod request;
mod results;
mod sounds;
mod storyboard;
mod take_home;

pub(crate) use live::places as live_places;
pub(crate) use problem::{ApiError, ErrorBody};
pub(crate) use request::{Blocking, read_body};

use crate::server::App;
use axum::Router;
use axum::routing::get;
use std::sync::Arc;
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};

#[derive(OpenApi)]
#[openapi(
    info(title = "inkrig studio", description = "What the studio's page and its server say to each other."),
    components(schemas(
        ErrorBody,
        crate::events::Event,
        live::FromPage,
        live::ToPage,
        crate::document::Command,
        crate::engine::drawings::As
    ))
)]
struct Description;

/// The routes below `/api`, and their description.
pub(crate) fn routes() -> (Router<Arc<App>>, utoipa::openapi::OpenApi) {
    let (router, mut description) = OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(info::info))
        .routes(routes!(project::state))
        .routes(routes!(project::commands))
        .routes(routes!(project::undo))
        .routes(routes!(project::redo))
        .routes(routes!(clips::add))
        .routes(routes!(clips::upload))
        .routes(routes!(clips::sample))
        .routes(routes!(clips::detail))
        .routes(routes!(clips::poses))
        .routes(routes!(clips::file))
        .routes(routes!(sounds::add))
        .routes(routes!(sounds::file))
        .routes(routes!(sounds::outline))
        .routes(routes!(sounds::drawing))
        .routes(routes!(sounds::wave))
        .routes(routes!(results::begin_job))
        .routes(routes!(results::job, results::cancel_job))
        .routes(routes!(results::facts))
        .routes(routes!(results::skeleton))
        .routes(routes!(results::poses))
        .routes(routes!(results::plan))
        .routes(routes!(results::suggestions))
        .routes(routes!(storyboard::state, storyboard::keep, storyboard::make))
        .routes(routes!(take_home::lock))
        .routes(routes!(take_home::export))
        .routes(routes!(take_home::retarget))
        .routes(routes!(take_home::command_line))
        .split_for_parts();
    // A version of the program is no version of the interface.
    description.info.version = "1".into();
    let router = router.route("/api/events", get(events::events)).route("/api/live", get(live::live));
    (router, description)
}

/// The interface as OpenAPI, JSON with line breaks.
pub fn openapi() -> String {
    let mut text = routes().1.to_pretty_json().unwrap_or_default();
    text.push('\n');
    text
}
