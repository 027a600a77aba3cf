//! The page: taken in when the program was built, or from a folder while it is made.

use crate::server::App;
use axum::extract::{Request, State};
use axum::http::header::{ACCEPT_ENCODING, CACHE_CONTROL, CONTENT_ENCODING, CONTENT_TYPE, VARY};
use axum::http::{HeaderValue, Method, StatusCode};
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;
use inkrig_formats::read_in_folder;
use std::io::Read as _;
use std::sync::Arc;

/// Name, bytes, whether they are packed.
type Asset = (&'static str, &'static [u8], bool);

static PAGE: &[Asset] = include!(concat!(env!("OUT_DIR"), "/page.rs"));

const MOST_ASSET: usize = 64 << 20;

/// What a program without a page says.
const WITHOUT: &str = "This inkrig was built without its studio's page: build it with `cargo xtask studio`, which needs Node and npm.\n";

/// Whether the program has its page.
pub(crate) fn is_there() -> bool {
    !PAGE.is_empty()
}

/// Whatever is no part of the API.
pub(crate) async fn page(State(app): State<Arc<App>>, request: Request) -> Response {
    let path = request.uri().path();
    if path.starts_with("/api/") {
        let message = format!("there is nothing at {}", path.chars().take(200).collect::<String>());
        return crate::api::ApiError::new(StatusCode::NOT_FOUND, "no_route", message).into_response();
    }
    if *request.method() != Method::GET && *request.method() != Method::HEAD {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let packs = request.headers().get_all(ACCEPT_ENCODING).iter().any(|value| {
        value
            .to_str()
            .unwrap_or_default()
            .split(',')
            .any(|kind| kind.split(';').next().map(str::trim) == Some("gzip"))
    });
    let found = match &app.page {
        Some(folder) => {
            let (folder, name) = (folder.clone(), name.to_string());
            let read = tokio::task::spawn_blocking(move || read_in_folder(&folder, &name, MOST_ASSET)).await;
            read.ok().and_then(Result::ok).map(|bytes| (bytes.into_response(), false))
        }
        None if PAGE.is_empty() && name == "index.html" => {
            return (StatusCode::OK, [(CONTENT_TYPE, "text/plain; charset=utf-8")], WITHOUT).into_response();
        }
        None => PAGE.iter().find(|asset| asset.0 == name).map(|&(_, bytes, packed)| match (packed, packs) {
            (true, false) => (unpacked(bytes).into_response(), false),
            (packed, _) => (bytes.into_response(), packed),
        }),
    };
    let Some((mut response, packed)) = found else { return StatusCode::NOT_FOUND.into_response() };
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(kind(name)));
    headers.insert(VARY, HeaderValue::from_static("accept-encoding"));
    // Names of assets change with what is in them.
    let keep = if name.starts_with("assets/") && app.page.is_none() {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    };
    headers.insert(CACHE_CONTROL, HeaderValue::from_static(keep));
    if packed {
        headers.insert(CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    }
    response
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let _ = GzDecoder::new(bytes).take(MOST_ASSET as u64).read_to_end(&mut out);
    out
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" => "application/json",
        "webmanifest" => "application/manifest+json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "wasm" => "application/wasm",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
