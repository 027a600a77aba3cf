//! Clips: uploaded, described, shown.

use super::request::Query;
use super::{ApiError, Blocking, ErrorBody, read_body};
use crate::StudioError;
use crate::document::{ClipEntry, ClipRole, Control};
use crate::engine::drawings;
use crate::engine::media::MOST_UPLOAD;
use crate::engine::poses::{PoseHead, PoseKind, encode};
use crate::project::{HistoryState, Kind};
use crate::server::App;
use crate::studio::{Applied, UploadOptions};
use axum::Json;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use inkrig_formats::{Import, Severity};
use inkrig_motion::capsules::{Body as Capsules, Side};
use inkrig_motion::{Clip, lead_in, rig};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// What an upload came to.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Added {
    /// The clips that are new.
    clips: Vec<ClipInfo>,
    /// The new revision.
    revision: u32,
    history: HistoryState,
    /// What is odd in the file.
    warnings: Vec<String>,
    /// Of a drawing: what it is, to be set by a command.
    control: Option<Control>,
}

/// A clip in a few numbers.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ClipInfo {
    id: String,
    name: String,
    file: String,
    /// Which clip of the file.
    take: Option<String>,
    /// All clips of the file; none for formats of one.
    takes: Vec<String>,
    format: &'static str,
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    joints: usize,
    role: ClipRole,
    /// Whether the file holds more than a skeleton, which `/file` gives.
    has_skin: bool,
}

/// A clip and all that is needed to draw it.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ClipDetail {
    #[serde(flatten)]
    info: ClipInfo,
    #[serde(flatten)]
    figure: Figure,
    findings: Vec<FindingInfo>,
    /// Frames at the beginning that are a calibration pose, and are not used.
    rest_pose_frames: usize,
}

/// A character and how it is drawn.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Figure {
    skeleton: SkeletonInfo,
    /// Capsules that it is drawn as.
    limbs: Vec<LimbInfo>,
}

/// A character.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SkeletonInfo {
    /// Parents before children.
    joints: Vec<JointInfo>,
    /// The joint that the camera follows.
    travel_joint: usize,
    /// Size of the character, metres.
    height: f32,
}

/// A joint at rest, where nothing is turned.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct JointInfo {
    name: String,
    /// -1 for none.
    parent: i32,
    /// From the parent, metres.
    #[schema(value_type = (f32, f32, f32))]
    offset: [f32; 3],
    end_site: bool,
    /// It only steers others and is not drawn.
    hidden: bool,
}

/// A tapered capsule; a ball when both ends are the same joint.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct LimbInfo {
    /// Index of a joint.
    from: usize,
    /// Index of a joint.
    to: usize,
    /// Metres.
    from_radius: f32,
    /// Metres.
    to_radius: f32,
    side: SideName,
}

/// Sides of a body.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) enum SideName {
    Left,
    Right,
    Middle,
}

/// Something to know about a file.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct FindingInfo {
    code: &'static str,
    severity: SeverityName,
    message: String,
}

/// How much a finding matters.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) enum SeverityName {
    Info,
    Warning,
}

/// The id of a companion file.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Uploaded {
    upload: String,
}

/// The name of an upload.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Named {
    /// The file's name; its ending says what it is.
    name: String,
}

/// Adds a motion file. The first one is arranged.
#[utoipa::path(post, operation_id = "addClip", path = "/api/clips", params(UploadOptions), request_body(content = inline(Vec<u8>), content_type = "application/octet-stream"), responses((status = 200, body = Added), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn add(
    State(app): State<Arc<App>>,
    Query(options): Query<UploadOptions>,
    body: Body,
) -> Result<Json<Added>, ApiError> {
    let _turn = app.upload_turn().await?;
    let bytes = read_body(body, MOST_UPLOAD).await?;
    Blocking::run(move || added(app.studio.add_clip(&bytes, &options)?)).await
}

/// Keeps a companion file (a skeleton, a buffer) until the motion comes that it belongs to.
#[utoipa::path(post, path = "/api/uploads", params(Named), request_body(content = inline(Vec<u8>), content_type = "application/octet-stream"), responses((status = 200, body = Uploaded), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn upload(
    State(app): State<Arc<App>>,
    Query(Named { name }): Query<Named>,
    body: Body,
) -> Result<Json<Uploaded>, ApiError> {
    let _turn = app.upload_turn().await?;
    let bytes = read_body(body, MOST_UPLOAD).await?;
    Ok(Json(Uploaded { upload: app.studio.keep_upload(&name, bytes) }))
}

/// Adds a sample. Of a drawing only `control` is given back, to be set by a command.
#[utoipa::path(post, path = "/api/samples/{name}", params(("name" = String, Path)), responses((status = 200, body = Added), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn sample(
    State(app): State<Arc<App>>,
    Path(name): Path<String>,
) -> Result<Json<Added>, ApiError> {
    Blocking::run(move || {
        let sample = inkrig_samples::find(&name).ok_or_else(|| StudioError::unknown("sample", &name))?;
        if inkrig_samples::curves().iter().any(|curve| curve.name == sample.name) {
            let (control, note) = drawings::read(sample.bytes, sample.file_name, drawings::As::Curve)?;
            let project = app.studio.project();
            let (revision, history) = (project.revision(), project.history());
            let warnings = note.into_iter().collect();
            return Ok(Json(Added {
                clips: Vec::new(),
                revision,
                history,
                warnings,
                control: Some(control),
            }));
        }
        let options = UploadOptions { name: sample.file_name.into(), ..UploadOptions::default() };
        added(app.studio.add_clip(sample.bytes, &options)?)
    })
    .await
}

/// A clip and all that is needed to draw it.
#[utoipa::path(get, path = "/api/clips/{id}", params(("id" = String, Path)), responses((status = 200, body = ClipDetail), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn detail(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<ClipDetail>, ApiError> {
    Blocking::run(move || {
        let (entry, import) = find(&app, &id)?;
        Ok(Json(ClipDetail {
            info: info(&entry, &import),
            figure: figure(&import.clip),
            findings: import
                .findings
                .iter()
                .map(|finding| FindingInfo {
                    code: finding.code,
                    severity: match finding.severity {
                        Severity::Info => SeverityName::Info,
                        Severity::Warning => SeverityName::Warning,
                    },
                    message: finding.message.clone(),
                })
                .collect(),
            rest_pose_frames: lead_in::rest_pose_frames(&import.clip),
        }))
    })
    .await
}

/// The poses of a clip, as the description of poses says.
#[utoipa::path(get, operation_id = "clipPoses", path = "/api/clips/{id}/poses", params(("id" = String, Path)), responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn poses(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, ApiError> {
    let bytes = Blocking::run(move || {
        let (_, import) = find(&app, &id)?;
        Ok(encode(&import.clip, &PoseHead::of(PoseKind::Clip, 0, false), &[]))
    });
    Ok(([(CONTENT_TYPE, "application/octet-stream")], bytes.await?))
}

/// The file as it was uploaded.
#[utoipa::path(get, operation_id = "clipFile", path = "/api/clips/{id}/file", params(("id" = String, Path)), responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn file(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, ApiError> {
    let bytes = Blocking::run(move || {
        let (document, _) = app.studio.now();
        let entry = document.clip(&id).ok_or_else(|| StudioError::unknown("clip", &id))?;
        let folder = app.studio.project().folder().clone();
        folder.kept(Kind::Clip, &entry.file, MOST_UPLOAD)
    });
    // Never shown as a page of ours, whatever is in it.
    Ok(([(CONTENT_TYPE, "application/octet-stream"), (CONTENT_DISPOSITION, "attachment")], bytes.await?))
}

fn find(app: &App, id: &str) -> Result<(ClipEntry, Arc<Import>), StudioError> {
    let (document, _) = app.studio.now();
    let entry = document.clip(id).ok_or_else(|| StudioError::unknown("clip", id))?;
    let folder = app.studio.project().folder().clone();
    let import = app.studio.media.clip(&folder, entry)?;
    Ok((entry.clone(), import))
}

fn added((entry, import, applied): (ClipEntry, Arc<Import>, Applied)) -> Result<Json<Added>, StudioError> {
    let warnings = import.findings.iter().filter(|finding| finding.severity == Severity::Warning);
    let warnings = warnings.map(|finding| finding.message.clone()).collect();
    let Applied { revision, history } = applied;
    Ok(Json(Added { clips: vec![info(&entry, &import)], revision, history, warnings, control: None }))
}

fn info(entry: &ClipEntry, import: &Import) -> ClipInfo {
    let clip = &import.clip;
    ClipInfo {
        id: entry.id.clone(),
        name: entry.name.clone(),
        file: entry.file.clone(),
        take: import.clip_index.and_then(|index| import.clips.get(index)).map(|clip| clip.name.clone()),
        takes: import.clips.iter().map(|clip| clip.name.clone()).collect(),
        format: import.source.format.extension(),
        frames: clip.frames(),
        frame_rate: clip.frame_rate(),
        seconds: clip.duration(),
        joints: clip.skeleton().len(),
        role: entry.role,
        has_skin: import.source.original.is_some(),
    }
}

/// A character as the page draws it.
pub(super) fn figure(clip: &Clip) -> Figure {
    const MOST: usize = 400;
    let hidden = rig::controls(clip.skeleton());
    let body = Capsules::of(clip, MOST);
    let joint = |place: usize| body.joints.get(place).copied().unwrap_or(0);
    let limbs = body.limbs.iter().map(|limb| LimbInfo {
        from: joint(limb.from),
        to: joint(limb.to),
        from_radius: limb.from_radius,
        to_radius: limb.to_radius,
        side: match limb.side {
            Side::Left => SideName::Left,
            Side::Right => SideName::Right,
            Side::Middle => SideName::Middle,
        },
    });
    let joints = clip.skeleton().joints().iter().zip(hidden).map(|(joint, hidden)| JointInfo {
        name: joint.name.clone(),
        parent: joint.parent.map_or(-1, |parent| parent as i32),
        offset: joint.offset.to_array(),
        end_site: joint.end_site,
        hidden,
    });
    let skeleton =
        SkeletonInfo { joints: joints.collect(), travel_joint: body.travel_joint, height: body.size };
    Figure { limbs: limbs.collect(), skeleton }
}
