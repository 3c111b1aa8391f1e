//! The files of the dashboard, embedded in the binary.

use super::problem::Problem;
use crate::lab::Lab;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointbench_ui::Asset;

/// A file of the dashboard, or its page for every other address.
pub async fn serve(State(lab): State<Lab>, request: Request) -> Response {
    if !request.method().is_safe() {
        return Problem::no_route(request.uri().path()).into_response();
    }
    let path = request.uri().path().trim_start_matches('/');
    match jointbench_ui::asset(path) {
        Some(asset) => answer(asset, &request),
        None if path.starts_with("assets/") => Problem::no_route(request.uri().path()).into_response(),
        None => answer(page(lab.tokens().are_needed()), &request),
    }
}

/// If a token is required, the page contains this, and a browser asks for the token before its first request.
fn page(asks: bool) -> Asset {
    let mut page = jointbench_ui::page();
    if asks {
        let text = String::from_utf8_lossy(&page.bytes).replacen("<html", "<html data-token", 1);
        page.bytes = text.into_bytes().into();
        page.sha256 += "-token";
    }
    page
}

fn answer(asset: Asset, request: &Request) -> Response {
    // Weak, because the file may be compressed or not.
    let etag = format!("W/\"{}\"", asset.sha256);
    let cache = if asset.immutable { "public, max-age=31536000, immutable" } else { "no-cache" };
    let known = request.headers().get(header::IF_NONE_MATCH).and_then(|value| value.to_str().ok());
    let headers = [
        (header::ETAG, etag.clone()),
        (header::CACHE_CONTROL, cache.to_owned()),
        (header::VARY, "Accept-Encoding".to_owned()),
        (header::CONTENT_TYPE, asset.mime),
    ];
    if known.is_some_and(|known| known.split(',').any(|tag| tag.trim() == etag)) {
        return (StatusCode::NOT_MODIFIED, headers).into_response();
    }
    let body = if request.method() == Method::HEAD { Body::empty() } else { Body::from(asset.bytes.into_owned()) };
    (headers, body).into_response()
}
