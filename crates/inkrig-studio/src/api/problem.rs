//! Errors as the page gets them.

use crate::StudioError;
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

/// Every answer with a status of 400 or more.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(crate) struct ErrorBody {
    /// What went wrong.
    pub(crate) error: ErrorFacts,
}

/// What went wrong.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(crate) struct ErrorFacts {
    /// A stable name.
    pub(crate) code: &'static str,
    /// What is wrong, and where.
    pub(crate) message: String,
    /// What to do.
    pub(crate) hint: Option<String>,
}

/// An error on its way to the page.
#[derive(Debug)]
pub(crate) struct ApiError {
    status: StatusCode,
    code: &'static str,
    message: String,
    hint: Option<String>,
}

impl ApiError {
    pub(crate) fn new(status: StatusCode, code: &'static str, message: impl Into<String>) -> Self {
        Self { status, code, message: message.into(), hint: None }
    }

    pub(crate) fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

impl From<StudioError> for ApiError {
    fn from(error: StudioError) -> Self {
        use StudioError as E;
        let (status, code) = match &error {
            E::Unknown { .. } => (StatusCode::NOT_FOUND, "unknown"),
            E::TooMuch { .. } => (StatusCode::UNPROCESSABLE_ENTITY, "too_much"),
            E::Invalid { .. } => (StatusCode::UNPROCESSABLE_ENTITY, "invalid"),
            E::NoStep("undo") => (StatusCode::CONFLICT, "nothing_to_undo"),
            E::NoStep(_) => (StatusCode::CONFLICT, "nothing_to_redo"),
            E::NoSource => (StatusCode::CONFLICT, "no_source"),
            E::NoControl => (StatusCode::CONFLICT, "no_control"),
            E::Kind { .. } => (StatusCode::UNPROCESSABLE_ENTITY, "unknown_kind"),
            E::Clip { .. } => (StatusCode::UNPROCESSABLE_ENTITY, "clip_unreadable"),
            E::Sketch(_) => (StatusCode::UNPROCESSABLE_ENTITY, "drawing_unreadable"),
            E::Sound(_) => (StatusCode::UNPROCESSABLE_ENTITY, "sound_unreadable"),
            E::Align(_) => (StatusCode::UNPROCESSABLE_ENTITY, "cannot_align"),
            E::Retarget(_) => (StatusCode::UNPROCESSABLE_ENTITY, "cannot_retarget"),
            E::Motion(_) | E::Format(_) => (StatusCode::UNPROCESSABLE_ENTITY, "cannot_write"),
            E::File { .. } | E::Folder { .. } => (StatusCode::INTERNAL_SERVER_ERROR, "project_folder"),
            E::Listen { .. } | E::Internal(_) => (StatusCode::INTERNAL_SERVER_ERROR, "failed"),
        };
        Self::new(status, code, error.to_string())
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let Self { status, code, message, hint } = self;
        (status, Json(ErrorBody { error: ErrorFacts { code, message, hint } })).into_response()
    }
}
