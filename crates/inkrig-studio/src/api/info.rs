//! What the program can do.

use super::ErrorBody;
use crate::engine::media::MOST_UPLOAD;
use crate::server::App;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use std::sync::Arc;
use utoipa::ToSchema;

/// What the program can do.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Info {
    /// Of the program.
    version: &'static str,
    /// Whether others on the network may draw.
    lan: bool,
    /// Motion files.
    formats: Vec<FormatInfo>,
    /// What can be begun with.
    samples: Vec<SampleInfo>,
    limits: LimitsInfo,
}

/// A motion format.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct FormatInfo {
    extension: &'static str,
    name: &'static str,
    read: bool,
    write: bool,
}

/// A motion or a drawing that is free for any use.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct SampleInfo {
    name: &'static str,
    kind: SampleKind,
    description: &'static str,
}

/// Kinds of samples.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) enum SampleKind {
    Motion,
    Curve,
}

/// Limits that the page should know.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct LimitsInfo {
    upload_bytes: usize,
    message_bytes: usize,
    points: usize,
}

/// What the program can do.
#[utoipa::path(get, path = "/api/info", responses((status = 200, body = Info), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn info(State(app): State<Arc<App>>) -> Json<Info> {
    use inkrig_formats::Format as F;
    let read = |format| !matches!(format, F::Usda);
    let all = [F::Bvh, F::Glb, F::Fbx, F::Usda, F::Vrma, F::Gltf, F::Vrm, F::Amc, F::DeepMimic];
    let formats = all.map(|format| FormatInfo {
        extension: format.extension(),
        name: format.name(),
        read: read(format),
        write: format.is_written(),
    });
    let of = |kind: fn() -> SampleKind| {
        move |sample: &inkrig_samples::Sample| SampleInfo {
            name: sample.name,
            kind: kind(),
            description: sample.description,
        }
    };
    let motions = inkrig_samples::motions().iter().map(of(|| SampleKind::Motion));
    Json(Info {
        version: env!("CARGO_PKG_VERSION"),
        lan: app.guard.is_lan(),
        formats: formats.into_iter().collect(),
        samples: motions.chain(inkrig_samples::curves().iter().map(of(|| SampleKind::Curve))).collect(),
        limits: LimitsInfo {
            upload_bytes: MOST_UPLOAD,
            message_bytes: super::live::MOST_MESSAGE,
            points: crate::document::MOST_POINTS,
        },
    })
}
