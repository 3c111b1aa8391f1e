//! Authentication: on loopback every local program has access, elsewhere every client with a token. A browser has access
//! only from the page of the daemon.
//!
//! A page of another site can send requests to a loopback port, and a foreign name can point to it. Therefore the `Host`
//! of a daemon without token must be a loopback name. The `Origin` of the live stream and of every changing request must
//! be the daemon or absent (programs send none). Browsers differ in the requests that they refuse themselves.

use super::METRICS;
use super::problem::Problem;
use super::rights::reader_may;
use super::throttle::{Throttle, Throttled};
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

/// Connection between the clients and the daemon.
#[derive(Debug, Clone, Copy, Default)]
pub struct Transport {
    /// Clients connect by TLS.
    pub tls: bool,
    /// Clients connect through a reverse proxy, which adds their address.
    pub behind_proxy: bool,
}

/// Cheap to clone.
#[derive(Clone)]
pub struct Auth {
    lab: Lab,
    transport: Transport,
    throttle: Arc<Throttle>,
}

impl Auth {
    pub fn new(lab: Lab, transport: Transport) -> Self {
        Self { lab, transport, throttle: Arc::default() }
    }

    /// Address of the client.
    fn source(&self, request: &Request) -> IpAddr {
        // A proxy appends the address of its client to the addresses in the request of the client.
        let forwarded = text(request.headers(), HeaderName::from_static("x-forwarded-for"));
        let forwarded = forwarded.and_then(|list| list.rsplit(',').next()?.trim().parse().ok());
        let peer = request.extensions().get::<ConnectInfo<SocketAddr>>().map(|peer| peer.0.ip());
        forwarded.filter(|_| self.transport.behind_proxy).or(peer).unwrap_or(Ipv4Addr::UNSPECIFIED.into())
    }
}

/// `route`: the matching pattern of the router.
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
        None if tokens.are_needed() && (uri.path().starts_with("/api") || uri.path() == METRICS) => {
            return Err(Problem::unauthorized());
        }
        None => Caller::local(),
    };
    match caller.access {
        Access::Read if !reader_may(method, route) => Err(Problem::forbidden(
            "read token: allows viewing and the software stop, but no other command and no access to tokens",
        )),
        _ => Ok(caller),
    }
}

/// Middleware: refuses a request before its handler, and passes the caller to the handler.
pub async fn guard(State(auth): State<Auth>, mut request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map(MatchedPath::as_str);
    let checked = check(auth.lab.tokens(), request.method(), request.uri(), request.headers(), route);
    let problem = match checked {
        Ok(caller) => {
            auth.lab.record_token_use(&caller);
            request.extensions_mut().insert(caller);
            return next.run(request).await;
        }
        Err(problem) => problem,
    };
    let is_wrong = problem.status == 401 && secret(request.headers(), request.uri()).is_some();
    if is_wrong && auth.throttle.delay_refusal(auth.source(&request)).await == Throttled::TooMany {
        return Problem::too_many("too many wrong tokens; a valid token is accepted immediately").into_response();
    }
    problem.into_response()
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// A value that is not a text counts as present.
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

/// `Authorization: Bearer`. On the live stream, where a browser cannot set headers, also the subprotocol `token.TOKEN`
/// or `?token=TOKEN`, both percent-encoded.
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
        let tokens = Tokens::default();
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
            // A foreign name that points to loopback.
            (Method::GET, vec![("host", "evil.example:8080")], Some(403)),
        ] {
            assert_eq!(refusal(&tokens, method.clone(), "/api/v1/bench", &headers), refused, "{method} {headers:?}");
        }
    }

    #[test]
    fn beyond_loopback_a_token_is_needed() {
        let tokens = Tokens::given(Some("s3cret"), None);
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
            assert_eq!(refusal(&tokens, Method::GET, path, &headers), refused, "{path} {headers:?}");
        }
    }

    #[test]
    fn a_token_that_reads_looks_and_stops() {
        let tokens = Tokens::given(Some("s3cret"), Some("looker"));
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
            assert_eq!(refusal(&tokens, method.clone(), path, &headers), refused, "{method} {path}");
        }
    }
}
