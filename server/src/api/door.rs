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
use std::sync::Arc;

/// How the daemon's door is kept.
#[derive(Clone, Default)]
pub struct Door {
    /// Needed for every call of the API where the daemon listens beyond loopback.
    token: Option<Arc<str>>,
}

impl Door {
    /// On loopback.
    pub fn local() -> Self {
        Self::default()
    }

    pub fn with_token(token: &str) -> Self {
        Self { token: Some(token.into()) }
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
        match &self.token {
            Some(token) if uri.path().starts_with("/api") && !is_known(token, headers, uri) => {
                Err(Problem::unauthorized())
            }
            _ => Ok(()),
        }
    }
}

/// Middleware: refuses before anything is read.
pub async fn guard(State(door): State<Door>, request: Request, next: Next) -> Response {
    match door.check(request.method(), request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
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
        let door = Door::with_token("s3cret");
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
}
