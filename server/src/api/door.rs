//! Who may come in: on loopback every local program, elsewhere whoever has the token; a browser only from our own page.
//!
//! A page of another site can send requests to a loopback port, and a foreign name can be made to point to it. So the
//! `Host` of a daemon without token must be a loopback name, and the `Origin` of the live stream and of every changing
//! request must be ours or absent (programs send none). Browsers differ in what they refuse by themselves.

use super::problem::Problem;
use super::rights::reader_may;
use super::tries::{Slowed, Tries};
use crate::lab::{Caller, Lab, Tokens};
use crate::view::Access;
use axum::extract::{ConnectInfo, MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderName, Method, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;

/// What is around the daemon, as far as its doors have to know.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surroundings {
    /// Clients come by TLS.
    pub tls: bool,
    /// Clients come through a reverse proxy, which says where from.
    pub behind_proxy: bool,
}

/// Cheap to clone.
#[derive(Clone)]
pub struct Door {
    lab: Lab,
    surroundings: Surroundings,
    tries: Arc<Tries>,
}

impl Door {
    pub fn new(lab: Lab, surroundings: Surroundings) -> Self {
        Self { lab, surroundings, tries: Arc::default() }
    }

    /// Where a request comes from.
    fn source(&self, request: &Request) -> IpAddr {
        // A proxy adds the address of its client behind those that the client claims.
        let told = text(request.headers(), HeaderName::from_static("x-forwarded-for"));
        let told = told.and_then(|list| list.rsplit(',').next()?.trim().parse().ok());
        let peer = request.extensions().get::<ConnectInfo<SocketAddr>>().map(|peer| peer.0.ip());
        told.filter(|_| self.surroundings.behind_proxy).or(peer).unwrap_or(Ipv4Addr::UNSPECIFIED.into())
    }
}

/// `route`: the pattern of the router that the request has met.
fn check(
    tokens: &Tokens,
    method: &Method,
    uri: &Uri,
    headers: &HeaderMap,
    route: Option<&str>,
) -> Result<Caller, Problem> {
    let host = text(headers, header::HOST).or_else(|| uri.authority().map(|a| a.as_str()));
    if !tokens.are_needed() && host.is_some_and(|host| !is_loopback(host)) {
        let detail = "this daemon accepts loopback connections only; open http://127.0.0.1 or http://localhost";
        return Err(Problem::forbidden(detail));
    }
    let upgrades = headers.contains_key(header::UPGRADE);
    if (upgrades || !method.is_safe())
        && let Some(origin) = text_or_garbage(headers, header::ORIGIN)
        && !same_origin(origin, host)
    {
        return Err(Problem::forbidden(format!(
            "the page at {origin} is not allowed to control this bench; open the dashboard of the daemon"
        )));
    }
    let caller = match secret(headers, uri).and_then(|secret| tokens.holder(&secret)) {
        Some(caller) => caller,
        None if tokens.are_needed() && uri.path().starts_with("/api") => return Err(Problem::unauthorized()),
        None => Caller::local(),
    };
    match caller.access {
        Access::Read if !reader_may(method, route) => Err(Problem::forbidden(
            "read token: allows viewing and the software stop, but no other command and no access to tokens",
        )),
        _ => Ok(caller),
    }
}

/// Middleware: refuses before anything is looked at, and tells handlers who calls.
pub async fn guard(State(door): State<Door>, mut request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map(MatchedPath::as_str);
    let checked = check(door.lab.tokens(), request.method(), request.uri(), request.headers(), route);
    let problem = match checked {
        Ok(caller) => {
            door.lab.came_in(&caller);
            request.extensions_mut().insert(caller);
            return next.run(request).await;
        }
        Err(problem) => problem,
    };
    let is_wrong = problem.status == 401 && secret(request.headers(), request.uri()).is_some();
    if is_wrong && door.tries.slow(door.source(&request)).await == Slowed::TooMany {
        return Problem::too_many("too many wrong tokens; a valid token is accepted immediately").into_response();
    }
    problem.into_response()
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// A value that is no text is there all the same.
fn text_or_garbage(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
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

/// `Authorization: Bearer`; on the live stream, where a browser cannot set headers, also as the subprotocol `token.TOKEN` or as
/// `?token=TOKEN`, percent-encoded both.
fn secret<'r>(headers: &'r HeaderMap, uri: &'r Uri) -> Option<Cow<'r, str>> {
    if let Some(bearer) = text(headers, header::AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer ")) {
        return Some(Cow::Borrowed(bearer.trim()));
    }
    headers.get(header::UPGRADE)?;
    let offered = text(headers, header::SEC_WEBSOCKET_PROTOCOL).unwrap_or_default().split(',');
    let asked = uri.query().unwrap_or_default().split('&');
    let offered = offered.filter_map(|one| one.trim().strip_prefix("token."));
    let encoded = offered.chain(asked.filter_map(|pair| pair.strip_prefix("token="))).next()?;
    percent_decode_str(encoded).decode_utf8().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(tokens: &Tokens, method: Method, path: &str, headers: &[(&str, &str)]) -> Option<u16> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(HeaderName::from_bytes(name.as_bytes()).unwrap(), value.parse().unwrap());
        }
        check(tokens, &method, &path.parse().unwrap(), &map, Some(path)).err().map(|problem| problem.status)
    }

    #[test]
    fn a_local_program_comes_in_and_a_foreign_page_does_not() {
        let door = Tokens::default();
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
            assert_eq!(refusal(&door, method.clone(), "/api/v1/bench", &headers), refused, "{method} {headers:?}");
        }
    }

    #[test]
    fn beyond_loopback_a_token_is_needed() {
        let door = Tokens::given(Some("s3cret"), None);
        let host = ("host", "bench.lab:8080");
        for (path, headers, refused) in [
            ("/api/v1/bench", vec![host], Some(401)),
            ("/api/v1/bench", vec![host, ("authorization", "Bearer wrong!")], Some(401)),
            ("/api/v1/bench", vec![host, ("authorization", "Bearer s3cret")], None),
            ("/api/v1/bench?token=s3cret", vec![host], Some(401)),
            ("/api/v1/events?token=s3cret", vec![host, ("upgrade", "websocket")], None),
            (
                "/api/v1/events",
                vec![host, ("upgrade", "websocket"), ("sec-websocket-protocol", "jointbench, token.s3cret")],
                None,
            ),
            (
                "/api/v1/events",
                vec![host, ("upgrade", "websocket"), ("sec-websocket-protocol", "token.s3%63ret")],
                None,
            ),
            (
                "/api/v1/events",
                vec![host, ("upgrade", "websocket"), ("sec-websocket-protocol", "token.wrong")],
                Some(401),
            ),
            ("/api/v1/bench", vec![host, ("sec-websocket-protocol", "token.s3cret")], Some(401)),
            ("/", vec![host], None),
        ] {
            assert_eq!(refusal(&door, Method::GET, path, &headers), refused, "{path} {headers:?}");
        }
    }

    #[test]
    fn a_token_that_reads_looks_and_stops() {
        let door = Tokens::given(Some("s3cret"), Some("looker"));
        let headers = [("host", "bench.lab:8080"), ("authorization", "Bearer looker")];
        for (method, path, refused) in [
            (Method::GET, "/api/v1/bench", None),
            (Method::GET, "/api/v1/tokens", Some(403)),
            (Method::POST, "/api/v1/bench/{bench}/stop", None),
            (Method::POST, "/api/v1/procedures/{id}/preview", None),
            (Method::POST, "/api/v1/bench/{bench}/acknowledge", Some(403)),
            (Method::POST, "/api/v1/runs", Some(403)),
            (Method::POST, "/api/v1/runs/{id}/stop", None),
            (Method::POST, "/api/v1/runs/{id}/resume", Some(403)),
            (Method::DELETE, "/api/v1/effects/{kind}/{id}", Some(403)),
        ] {
            assert_eq!(refusal(&door, method.clone(), path, &headers), refused, "{method} {path}");
        }
    }
}
