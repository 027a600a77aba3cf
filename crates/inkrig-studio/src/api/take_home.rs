//! What leaves the studio: files, motions of other characters, a line for the shell; and what stays as it is.

use super::request::Json as JsonBody;
use super::{ApiError, Blocking, ErrorBody};
use crate::StudioError;
use crate::document::{ClipEntry, ClipRole, FixedPart, Key, KeyKind};
use crate::engine::command_line::command_line as line;
use crate::engine::results::KeyFacts;
use crate::engine::take_home::{Bake, CertificateFacts, Motion, file, retarget as carry_over};
use crate::engine::{Prepared, clip};
use crate::project::Kind;
use crate::server::App;
use crate::studio::Applied;
use axum::Json;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use inkrig_formats::{ExportOptions, Format, write_motion};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// A part of a result that stays.
#[derive(Debug, Deserialize, ToSchema)]
pub(crate) struct LockAsked {
    result: String,
    /// Seconds.
    from: f64,
    /// Seconds.
    to: f64,
}

/// A file that is asked for.
#[derive(Debug, Deserialize, ToSchema)]
pub(crate) struct ExportAsked {
    /// Id of a result or a clip.
    of: String,
    /// Ending of the format.
    format: String,
    /// Frames a second; that of the settings, else its own without.
    #[serde(default)]
    fps: Option<f64>,
    /// What it is called in the file.
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    bake: Bake,
}

/// A motion for another character.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) struct RetargetAsked {
    /// Id of a result or a clip.
    of: String,
    /// Id of a clip of the character.
    onto: String,
    /// Feet that stand are kept from sliding; they are without.
    #[serde(default)]
    keep_feet: Option<bool>,
    /// Length of the character over that of the one in the motion; measured without.
    #[serde(default)]
    scale: Option<f64>,
}

/// A motion on another character.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct RetargetDone {
    /// Id of the result.
    result: String,
    certificate: CertificateFacts,
}

/// What a shell makes the same result with.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct CommandLine {
    /// To be run in the project's folder.
    text: String,
    /// What was drawn, as the files that the line names.
    files: Vec<NamedText>,
}

/// A small text file.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct NamedText {
    name: String,
    text: String,
}

/// Keeps a part of a result as it is: the result becomes a clip of the project, and a key says what of it stays.
#[utoipa::path(post, path = "/api/locks", request_body = LockAsked, responses((status = 200, body = Applied), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn lock(
    State(app): State<Arc<App>>,
    JsonBody(asked): JsonBody<LockAsked>,
) -> Result<Json<Applied>, ApiError> {
    Blocking::run(move || {
        let LockAsked { result, from, to } = asked;
        let finished = app.studio.solver.results().get(&result);
        let finished = finished.ok_or_else(|| StudioError::unknown("result", &result))?;
        let name = format!("Kept {from:.1} s to {to:.1} s");
        let options = ExportOptions::in_format(Format::Bvh, &finished.written_as);
        let written = write_motion(&finished.clip, Format::Bvh, &options)?;
        let (id, file) = {
            let mut project = app.studio.project();
            let id = project.new_id('c')?;
            let file = project.folder().keep(Kind::Clip, &id, "kept.bvh", &written.bytes)?;
            (id, file)
        };
        let unit = Some(options.metres_per_unit);
        let clip = ClipEntry {
            id: id.clone(),
            name: name.clone(),
            file,
            role: ClipRole::Locked,
            unit,
            ..ClipEntry::default()
        };
        let applied = app.studio.change(&name, None, |document| {
            let (mut from, mut to) = (from, to);
            // A part that was kept when this result was made is in it as it was: what overlaps becomes one part.
            document.keys.retain(|key| {
                let known = |facts: &KeyFacts| facts.id == key.id && facts.waits.is_none();
                match &key.fixed {
                    Some(part)
                        if part.from < to && from < part.to && finished.facts.keys.iter().any(known) =>
                    {
                        (from, to) = (from.min(part.from), to.max(part.to));
                        false
                    }
                    _ => true,
                }
            });
            document.keys.push(Key {
                id: format!("keep-{id}"),
                enabled: true,
                kind: KeyKind::Fixed,
                place: None,
                pose: None,
                weight: None,
                distance: None,
                radius: None,
                fixed: Some(FixedPart { clip: id, from, to }),
            });
            document.clips.push(clip);
            Ok(())
        })?;
        Ok(Json(applied))
    })
    .await
}

/// Writes a file.
#[utoipa::path(post, path = "/api/export", request_body = ExportAsked, responses((status = 200, content_type = "application/octet-stream", body = inline(Vec<u8>)), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn export(
    State(app): State<Arc<App>>,
    JsonBody(asked): JsonBody<ExportAsked>,
) -> Result<impl IntoResponse, ApiError> {
    let (name, bytes) = Blocking::run(move || {
        let known = "files are written as .bvh, .glb, .fbx, .usda and .vrma, and into a .gltf or .vrm that was dropped";
        let format = Format::from_extension(&asked.format).filter(|format| format.is_written());
        let format = format.ok_or_else(|| StudioError::Kind { name: asked.format.chars().take(20).collect(), known })?;
        let motion = find(&app, &asked.of)?;
        let fps = asked.fps.or(app.studio.now().0.settings.fps);
        let name = asked.name.unwrap_or_else(|| motion.name.clone());
        let bytes = file(motion, format, fps, &name, asked.bake)?;
        Ok((format!("{}.{}", plain(&name), format.extension()), bytes))
    })
    .await?;
    let disposition = format!("attachment; filename=\"{name}\"");
    Ok(([(CONTENT_TYPE, "application/octet-stream".to_string()), (CONTENT_DISPOSITION, disposition)], bytes))
}

/// Puts a motion on another character, with a certificate. Exported as a GLB, the result is a copy of the character's own file.
#[utoipa::path(post, path = "/api/retarget", request_body = RetargetAsked, responses((status = 200, body = RetargetDone), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn retarget(
    State(app): State<Arc<App>>,
    JsonBody(asked): JsonBody<RetargetAsked>,
) -> Result<Json<RetargetDone>, ApiError> {
    Blocking::run(move || {
        let motion = find(&app, &asked.of)?;
        let (document, revision) = app.studio.now();
        let folder = app.studio.project().folder().clone();
        let character = clip(&document, &folder, &app.studio.media, &asked.onto)?;
        let id = app.studio.solver.results().new_id();
        let options = (asked.keep_feet.unwrap_or(true), asked.scale);
        let (finished, certificate) =
            carry_over(&motion, &character, options, (id.clone(), revision, asked.onto))?;
        app.studio.solver.results().put(Arc::new(finished));
        Ok(Json(RetargetDone { result: id, certificate }))
    })
    .await
}

/// The line of a shell that makes the result of the document as it is.
#[utoipa::path(get, path = "/api/command-line", responses((status = 200, body = CommandLine), (status = "4XX", body = ErrorBody)))]
pub(crate) async fn command_line(State(app): State<Arc<App>>) -> Result<Json<CommandLine>, ApiError> {
    Blocking::run(move || {
        let (document, _) = app.studio.now();
        let folder = app.studio.project().folder().clone();
        let prepared = Prepared::source(&document, &folder, &app.studio.media)?;
        let (text, files) = line(&document, &prepared.map)?;
        let files = files.into_iter().map(|(name, text)| NamedText { name, text }).collect();
        Ok(Json(CommandLine { text, files }))
    })
    .await
}

/// A result or a clip.
fn find(app: &App, id: &str) -> Result<Motion, StudioError> {
    let (document, _) = app.studio.now();
    let result = app.studio.solver.results().get(id);
    if let Some(result) = result {
        return Ok(Motion {
            clip: result.clip.clone(),
            written_as: result.written_as.clone(),
            is_loop: result.facts.cyclic,
            name: document.name.clone(),
            keys: result.key_rows.clone(),
        });
    }
    let folder = app.studio.project().folder().clone();
    let import = clip(&document, &folder, &app.studio.media, id)?;
    let name = document.clip(id).map(|entry| entry.name.clone()).unwrap_or_default();
    Ok(Motion {
        clip: import.clip.clone(),
        written_as: import.source.clone(),
        is_loop: false,
        name,
        keys: Vec::new(),
    })
}

/// A name for a header and for any file system.
fn plain(name: &str) -> String {
    let kept: String = name
        .chars()
        .filter(|letter| letter.is_ascii_alphanumeric() || "-_ ".contains(*letter))
        .take(60)
        .collect();
    let kept = kept.trim().replace(' ', "-");
    if kept.is_empty() { "motion".into() } else { kept }
}
