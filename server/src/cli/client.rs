//! REST client of a running daemon.

use super::arguments::Reach;
use super::exit::Exit;
use super::secrets;
use crate::api::Problem;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use std::sync::Arc;
use ureq::http::Response;
use ureq::tls::{PemItem, RootCerts, TlsConfig, parse_pem};
use ureq::typestate::WithBody;
use ureq::{Agent, Body, RequestBuilder};

const DEFAULT_DAEMON: &str = "http://127.0.0.1:8080";

pub struct Client {
    agent: Agent,
    base: String,
    bearer: Option<String>,
}

impl Client {
    pub fn new(reach: &Reach) -> Result<Self, Exit> {
        let tls = TlsConfig::builder().root_certs(trusted(reach.ca_file.as_deref())?).build();
        let agent = Agent::new_with_config(Agent::config_builder().http_status_as_error(false).tls_config(tls).build());
        let address = reach.daemon.as_deref().unwrap_or(DEFAULT_DAEMON).trim_end_matches('/');
        let base = match address.contains("://") {
            true => format!("{address}/api/v1"),
            false => format!("http://{address}/api/v1"),
        };
        Ok(Self { agent, base, bearer: secrets::of_client(reach)?.map(|token| format!("Bearer {token}")) })
    }

    /// A page of the dashboard.
    pub fn page(&self, path: &str) -> String {
        format!("{}{path}", self.base.trim_end_matches("/api/v1"))
    }

    /// Whether a daemon answers; its answer is ignored.
    pub fn is_answered(&self) -> bool {
        self.agent.get(format!("{}/health", self.base)).call().is_ok()
    }

    pub fn get<T: DeserializeOwned>(&self, path: &str) -> Result<T, Exit> {
        self.json(&self.get_bytes(path)?)
    }

    pub fn get_bytes(&self, path: &str) -> Result<Vec<u8>, Exit> {
        let mut request = self.agent.get(format!("{}{path}", self.base));
        if let Some(bearer) = &self.bearer {
            request = request.header("authorization", bearer);
        }
        self.answer(request.call())
    }

    pub fn post<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> Result<T, Exit> {
        let body = serde_json::to_vec(body).map_err(|fault| Exit::failed(fault.to_string()))?;
        self.post_bytes(path, "application/json", &body)
    }

    pub fn post_bytes<T: DeserializeOwned>(&self, path: &str, media_type: &str, body: &[u8]) -> Result<T, Exit> {
        let request = self.agent.post(format!("{}{path}", self.base));
        self.send(request, &[("content-type", media_type)], body)
    }

    /// A request that the daemon executes once, even if it is repeated.
    pub fn post_once<T: DeserializeOwned>(&self, path: &str, key: &str, body: &impl Serialize) -> Result<T, Exit> {
        let body = serde_json::to_vec(body).map_err(|fault| Exit::failed(fault.to_string()))?;
        let request = self.agent.post(format!("{}{path}", self.base));
        self.send(request, &[("content-type", "application/json"), ("idempotency-key", key)], &body)
    }

    pub fn put<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> Result<T, Exit> {
        let body = serde_json::to_vec(body).map_err(|fault| Exit::failed(fault.to_string()))?;
        let request = self.agent.put(format!("{}{path}", self.base));
        self.send(request, &[("content-type", "application/json")], &body)
    }

    pub fn delete<T: DeserializeOwned>(&self, path: &str) -> Result<T, Exit> {
        let mut request = self.agent.delete(format!("{}{path}", self.base));
        if let Some(bearer) = &self.bearer {
            request = request.header("authorization", bearer);
        }
        self.json(&self.answer(request.call())?)
    }

    fn send<T: DeserializeOwned>(
        &self,
        mut request: RequestBuilder<WithBody>,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Result<T, Exit> {
        let bearer = self.bearer.as_deref().map(|bearer| ("authorization", bearer));
        for (name, value) in headers.iter().copied().chain(bearer) {
            request = request.header(name, value);
        }
        self.json(&self.answer(request.send(body))?)
    }

    fn answer(&self, answer: Result<Response<Body>, ureq::Error>) -> Result<Vec<u8>, Exit> {
        let mut response = answer.map_err(|fault| {
            let base = self.base.trim_end_matches("/api/v1");
            Exit::bad_input(format!(
                "no daemon answers at {base} ({fault}): start it with `jointbench serve`, or give its address with \
                 --daemon"
            ))
        })?;
        let status = response.status();
        let bytes = response
            .body_mut()
            .with_config()
            .limit(u64::MAX)
            .read_to_vec()
            .map_err(|fault| Exit::failed(format!("the answer of the daemon was interrupted: {fault}")))?;
        if status.is_success() {
            return Ok(bytes);
        }
        Err(match serde_json::from_slice::<Problem>(&bytes) {
            Ok(problem) => Exit { code: problem.exit_code(), message: problem.detail },
            Err(_) => Exit::failed(format!(
                "{} answered {status}: check that a jointbench daemon runs at this address",
                self.base
            )),
        })
    }

    fn json<T: DeserializeOwned>(&self, bytes: &[u8]) -> Result<T, Exit> {
        serde_json::from_slice(bytes)
            .map_err(|fault| Exit::failed(format!("the daemon uses another version of the API: {fault}")))
    }
}

/// Certificates that are trusted for a daemon at https://.
fn trusted(file: Option<&Path>) -> Result<RootCerts, Exit> {
    let Some(file) = file else { return Ok(RootCerts::WebPki) };
    let pem = super::files::read(file)?;
    let certificates: Vec<_> = parse_pem(&pem)
        .filter_map(|item| match item {
            Ok(PemItem::Certificate(certificate)) => Some(certificate),
            _ => None,
        })
        .collect();
    match certificates.is_empty() {
        true => {
            Err(Exit::bad_input(format!("{}: contains no PEM certificate: give another --ca-file", file.display())))
        }
        false => Ok(RootCerts::Specific(Arc::new(certificates))),
    }
}
