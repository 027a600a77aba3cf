//! Who may ask: the page itself, on this machine; with `--lan` also who has shown the token.
//!
//! A browser runs pages of anybody beside ours. Host says by which name it came here (a name that others point at this machine
//! is refused), Origin and Sec-Fetch-Site which page asks, and a content type that no form can send keeps simple requests out.

mod headers;
mod host;
mod token;

pub(crate) use headers::with_headers;
pub(crate) use token::Tokens;

use crate::api::ApiError;
use crate::server::{App, Connection};
use axum::extract::{Request, State};
use axum::http::header::{CONTENT_TYPE, COOKIE, HOST, LOCATION, ORIGIN, SET_COOKIE, UPGRADE};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use host::Hosts;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// What is let in.
#[derive(Debug)]
pub(crate) struct Guard {
    hosts: Hosts,
    /// With `--lan` only.
    tokens: Option<Tokens>,
}

impl Guard {
    /// For the names under which the studio is opened at a port.
    pub(crate) fn new(port: u16, names: Vec<String>, tokens: Option<Tokens>) -> Self {
        Self { hosts: Hosts::new(port, names, tokens.is_some()), tokens }
    }

    /// Whether others on the network may draw.
    pub(crate) fn is_lan(&self) -> bool {
        self.tokens.is_some()
    }

    /// Whether a request comes from our own page, or from no page.
    fn check(&self, method: &Method, headers: &HeaderMap) -> Result<(), ApiError> {
        let forbidden = |code, message: &str| ApiError::new(StatusCode::FORBIDDEN, code, message);
        let host =
            one(headers, &HOST).ok_or_else(|| forbidden("host", "the request names no host, or several"))?;
        if !self.hosts.knows(host) {
            let hint = "open the address that the program printed";
            return Err(forbidden("host", "the studio is not known by this name").hint(hint));
        }
        if headers.contains_key(ORIGIN) {
            let own = one(headers, &ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
            if own.is_none_or(|origin| !origin.eq_ignore_ascii_case(host)) {
                return Err(forbidden("origin", "another page may not use the studio"));
            }
        }
        if headers.contains_key("sec-fetch-site") {
            let site = headers.get("sec-fetch-site").and_then(|site| site.to_str().ok());
            let navigates = headers.get("sec-fetch-mode").is_some_and(|mode| mode == "navigate");
            let safe = *method == Method::GET || *method == Method::HEAD;
            let good = match site {
                Some("same-origin") => true,
                // Typed by hand, or opened from a bookmark.
                Some("none") => safe,
                // A link on another page may lead here, to look only.
                Some("same-site" | "cross-site") => navigates && safe && !headers.contains_key(UPGRADE),
                _ => false,
            };
            if !good {
                return Err(forbidden("site", "another page may not use the studio"));
            }
        }
        if headers.contains_key(UPGRADE) && *method != Method::GET {
            return Err(forbidden("upgrade", "only a GET becomes a WebSocket"));
        }
        if *method != Method::GET && *method != Method::HEAD {
            let kind =
                one(headers, &CONTENT_TYPE).map(|kind| kind.split(';').next().unwrap_or_default().trim());
            if !matches!(kind, Some("application/json" | "application/octet-stream")) {
                let message = "send this as application/json or application/octet-stream";
                return Err(ApiError::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "content_type", message));
            }
        }
        Ok(())
    }
}

/// Lets a request through, or says why not.
pub(crate) async fn guard(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    if let Err(error) = app.guard.check(request.method(), request.headers()) {
        return with_headers(error.into_response(), app.guard.is_lan());
    }
    if let Some(tokens) = &app.guard.tokens
        && !cookie(request.headers()).is_some_and(|cookie| tokens.is_known(cookie))
    {
        return with_headers(welcome(tokens, &request), true);
    }
    if let Some(connection) = request.extensions().get::<Arc<Connection>>() {
        connection.proven.store(true, Ordering::Release);
    }
    with_headers(next.run(request).await, app.guard.is_lan())
}

/// Takes a token for a cookie; who has none is told how to get one.
fn welcome(tokens: &Tokens, request: &Request) -> Response {
    let mut pairs = request.uri().query().unwrap_or_default().split('&');
    let token = pairs.find_map(|pair| pair.strip_prefix("token="));
    let page = request.method() == Method::GET && request.uri().path() == "/";
    if let Some(cookie) = token.filter(|_| page).and_then(|token| tokens.exchange(token)) {
        let cookie = format!("{COOKIE_NAME}={cookie}; HttpOnly; SameSite=Strict; Path=/; Max-Age=604800");
        let mut response = StatusCode::SEE_OTHER.into_response();
        if let Ok(value) = HeaderValue::from_str(&cookie) {
            response.headers_mut().insert(SET_COOKIE, value);
        }
        response.headers_mut().insert(LOCATION, HeaderValue::from_static("/"));
        return response;
    }
    // After a link from elsewhere a browser does not send the cookie; from our own page it does.
    let site = request.headers().get("sec-fetch-site").and_then(|site| site.to_str().ok());
    if request.uri().path().starts_with("/api") || site == Some("same-origin") {
        let message = "open the address that the program printed, token included";
        return ApiError::new(StatusCode::UNAUTHORIZED, "token", message).into_response();
    }
    // Who came by a link of another page has the cookie, but it is sent only from here on.
    let text = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>inkrig studio</title>\
        <p>This studio lets in only who opens the whole address that the program printed, or scans its code. \
        Every code is good for one device.</p><p><a href=\"/\">Try again</a></p>\n";
    (StatusCode::UNAUTHORIZED, [(CONTENT_TYPE, "text/html; charset=utf-8")], text).into_response()
}

const COOKIE_NAME: &str = "inkrig";

fn cookie(headers: &HeaderMap) -> Option<&str> {
    let all = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
    let mut own = all
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().strip_prefix(COOKIE_NAME)?.strip_prefix('='));
    own.next()
}

/// The value of a header that is there once.
fn one<'a>(headers: &'a HeaderMap, name: &axum::http::HeaderName) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?;
    if values.next().is_some() { None } else { value.to_str().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(method: &Method, pairs: &[(&str, &str)]) -> Result<(), u16> {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            let name: axum::http::HeaderName = name.parse().unwrap();
            headers.append(name, value.parse().unwrap());
        }
        let guard = Guard::new(4747, Vec::new(), None);
        guard.check(method, &headers).map_err(|error| error.into_response().status().as_u16())
    }

    #[test]
    fn our_own_page_comes_in() {
        let host = ("host", "127.0.0.1:4747");
        let own = [
            host,
            ("origin", "http://127.0.0.1:4747"),
            ("sec-fetch-site", "same-origin"),
            ("content-type", "application/json"),
        ];
        assert_eq!(check(&Method::GET, &own), Ok(()));
        assert_eq!(check(&Method::POST, &own), Ok(()));
        assert_eq!(check(&Method::GET, &[host]), Ok(()), "a program");
        assert_eq!(
            check(&Method::GET, &[("host", "localhost:4747"), ("sec-fetch-site", "none")]),
            Ok(()),
            "typed"
        );
        let link = [host, ("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")];
        assert_eq!(check(&Method::GET, &link), Ok(()), "a link");
    }

    #[test]
    fn others_do_not() {
        let host = ("host", "127.0.0.1:4747");
        let json = ("content-type", "application/json");
        type Try<'a> = (Method, &'a [(&'a str, &'a str)], u16);
        let bad: &[Try<'_>] = &[
            (Method::GET, &[], 403),
            (Method::GET, &[("host", "evil.example")], 403),
            (Method::GET, &[("host", "evil.example:4747")], 403),
            (Method::GET, &[("host", "127.0.0.1:1")], 403),
            (Method::GET, &[host, ("host", "evil.example")], 403),
            (Method::GET, &[host, ("origin", "http://evil.example")], 403),
            (Method::GET, &[host, ("origin", "null")], 403),
            (Method::GET, &[host, ("origin", "http://localhost:4747")], 403),
            (Method::GET, &[host, ("origin", "https://127.0.0.1:4747")], 403),
            (Method::GET, &[host, ("sec-fetch-site", "cross-site")], 403),
            (
                Method::GET,
                &[
                    host,
                    ("sec-fetch-site", "cross-site"),
                    ("sec-fetch-mode", "navigate"),
                    ("upgrade", "websocket"),
                ],
                403,
            ),
            (
                Method::POST,
                &[host, json, ("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")],
                403,
            ),
            (Method::POST, &[host, json, ("sec-fetch-site", "none")], 403),
            (Method::POST, &[host], 415),
            (Method::POST, &[host, ("content-type", "text/plain")], 415),
            (Method::POST, &[host, ("content-type", "application/x-www-form-urlencoded")], 415),
            (Method::DELETE, &[host, ("content-type", "multipart/form-data; boundary=x")], 415),
        ];
        for (method, headers, status) in bad {
            assert_eq!(check(method, headers), Err(*status), "{method} {headers:?}");
        }
    }
}
