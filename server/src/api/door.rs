//! Who may come in: on loopback every local program, elsewhere whoever has the token; a browser only from our own page.
//!
//! A page of another site can send requests to a loopback port, and a foreign name can be made to point to it. So the
//! `Host` of a daemon without token must be a loopback name, and the `Origin` of the live stream and of every changing
//! request must be ours or absent (programs send none). Browsers differ in what they refuse by themselves.

use super::problem::Problem;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// What a caller may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// Everything: the daemon answers this computer only, and asks for no token.
    Open,
    /// Everything.
    Full,
    /// Look, and stop.
    Read,
}

/// How the daemon's door is kept.
#[derive(Clone, Default)]
pub struct Door {
    /// Needed for every call of the API where the daemon listens beyond loopback.
    token: Option<Arc<str>>,
    /// Whoever has this one looks, and can stop.
    read_token: Option<Arc<str>>,
}

impl Door {
    /// On loopback.
    pub fn local() -> Self {
        Self::default()
    }

    pub fn with_tokens(token: &str, read_token: Option<&str>) -> Self {
        Self { token: Some(token.into()), read_token: read_token.map(Into::into) }
    }

    fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Problem> {
        let host = text(headers, header::HOST).or_else(|| uri.authority().map(|a| a.as_str()));
        if self.token.is_none() && host.is_some_and(|host| !is_loopback(host)) {
            let detail = "this daemon answers on loopback only; open it as http://127.0.0.1 or http://localhost";
            return Err(Problem::forbidden(detail));
        }
        let upgrades = headers.contains_key(header::UPGRADE);
        if (upgrades || !method.is_safe())
            && let Some(origin) = text_or_garbage(headers, header::ORIGIN)
            && !same_origin(origin, host)
        {
            return Err(Problem::forbidden(format!(
                "the page at {origin} may not steer this bench; open the dashboard of the daemon itself"
            )));
        }
        let Some(token) = self.token.as_deref().filter(|_| uri.path().starts_with("/api")) else { return Ok(()) };
        if is_known(token, headers, uri) {
            return Ok(());
        }
        match self.read_token.as_deref().is_some_and(|token| is_known(token, headers, uri)) {
            true if method.is_safe() || changes_nothing(uri.path()) => Ok(()),
            true => Err(Problem::forbidden("this token only reads: it looks and stops, and starts or changes nothing")),
            false => Err(Problem::unauthorized()),
        }
    }

    /// What the token of a request may do.
    pub fn access(&self, headers: &HeaderMap, uri: &Uri) -> Access {
        let reads = self.read_token.as_deref().is_some_and(|token| is_known(token, headers, uri));
        match &self.token {
            None => Access::Open,
            Some(_) if reads => Access::Read,
            Some(_) => Access::Full,
        }
    }
}

/// Stopping, which everybody may do, and questions that need a body.
fn changes_nothing(path: &str) -> bool {
    ["/stop", "/preview", "/effects/check", "/diagnoses", "/evaluate"].iter().any(|end| path.ends_with(end))
}

/// Middleware: refuses before anything is read, and tells handlers what the caller may do.
pub async fn guard(State(door): State<Door>, mut request: Request, next: Next) -> Response {
    match door.check(request.method(), request.uri(), request.headers()) {
        Ok(()) => {
            let access = door.access(request.headers(), request.uri());
            request.extensions_mut().insert(access);
            next.run(request).await
        }
        Err(problem) => problem.into_response(),
    }
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// A value that is no text is there all the same.
fn text_or_garbage(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name).map(|value| value.to_str().unwrap_or("an unreadable origin"))
}

fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.rsplit_once(':').map_or(host, |(name, _)| name),
    };
    name.eq_ignore_ascii_case("localhost")
        || name.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback())
}

fn same_origin(origin: &str, host: Option<&str>) -> bool {
    let authority = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    matches!((authority, host), (Some(authority), Some(host)) if authority.eq_ignore_ascii_case(host))
}

/// `Authorization: Bearer`, or `?token=` where a browser opens the live stream and cannot set headers.
fn is_known(token: &str, headers: &HeaderMap, uri: &Uri) -> bool {
    let bearer = text(headers, header::AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
    let in_query = || uri.query()?.split('&').find_map(|pair| pair.strip_prefix("token="));
    let in_query = if headers.contains_key(header::UPGRADE) { in_query() } else { None };
    bearer.or(in_query).is_some_and(|given| same_bytes(given.trim().as_bytes(), token.as_bytes()))
}

/// Takes the same time wherever the difference is.
fn same_bytes(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |sum, (x, y)| sum | (x ^ y)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(door: &Door, method: Method, path: &str, headers: &[(&str, &str)]) -> Option<u16> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(header::HeaderName::from_bytes(name.as_bytes()).unwrap(), value.parse().unwrap());
        }
        door.check(&method, &path.parse().unwrap(), &map).err().map(|problem| problem.status)
    }

    #[test]
    fn a_local_program_comes_in_and_a_foreign_page_does_not() {
        let door = Door::local();
        let host = ("host", "127.0.0.1:8080");
        for (method, headers, refused) in [
            (Method::GET, vec![host], None),
            (Method::POST, vec![host], None),
            (Method::POST, vec![host, ("origin", "http://127.0.0.1:8080")], None),
            (Method::POST, vec![("host", "localhost:8080"), ("origin", "http://localhost:8080")], None),
            (Method::POST, vec![("host", "[::1]:8080"), ("origin", "http://[::1]:8080")], None),
            (Method::POST, vec![host, ("origin", "http://evil.example")], Some(403)),
            (Method::POST, vec![host, ("origin", "http://127.0.0.1:9090")], Some(403)),
            (Method::POST, vec![host, ("origin", "null")], Some(403)),
            (Method::GET, vec![host, ("origin", "http://evil.example")], None),
            (Method::GET, vec![host, ("origin", "http://evil.example"), ("upgrade", "websocket")], Some(403)),
            // A foreign name that was made to point to loopback.
            (Method::GET, vec![("host", "evil.example:8080")], Some(403)),
        ] {
            assert_eq!(check(&door, method.clone(), "/api/v1/bench", &headers), refused, "{method} {headers:?}");
        }
    }

    #[test]
    fn beyond_loopback_a_token_is_needed() {
        let door = Door::with_tokens("s3cret", None);
        let host = ("host", "bench.lab:8080");
        for (path, headers, refused) in [
            ("/api/v1/bench", vec![host], Some(401)),
            ("/api/v1/bench", vec![host, ("authorization", "Bearer wrong!")], Some(401)),
            ("/api/v1/bench", vec![host, ("authorization", "Bearer s3cret")], None),
            ("/api/v1/bench?token=s3cret", vec![host], Some(401)),
            ("/api/v1/events?token=s3cret", vec![host, ("upgrade", "websocket")], None),
            ("/", vec![host], None),
        ] {
            assert_eq!(check(&door, Method::GET, path, &headers), refused, "{path} {headers:?}");
        }
    }

    #[test]
    fn a_token_that_reads_looks_and_stops() {
        let door = Door::with_tokens("s3cret", Some("looker"));
        let headers = [("host", "bench.lab:8080"), ("authorization", "Bearer looker")];
        for (method, path, refused) in [
            (Method::GET, "/api/v1/bench", None),
            (Method::POST, "/api/v1/bench/a/stop", None),
            (Method::POST, "/api/v1/procedures/friction/preview", None),
            (Method::POST, "/api/v1/bench/a/acknowledge", Some(403)),
            (Method::POST, "/api/v1/runs", Some(403)),
            (Method::POST, "/api/v1/runs/1/stop", None),
            (Method::POST, "/api/v1/runs/1/resume", Some(403)),
            (Method::DELETE, "/api/v1/effects/friction/rub", Some(403)),
        ] {
            assert_eq!(check(&door, method.clone(), path, &headers), refused, "{method} {path}");
        }
    }
}
