//! Requests of clients, including clients that disconnect.

use serde_json::{Value, json};
use socket2::SockRef;
use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Longer than any operation here, including a worker that secures its bench after the loss of the server.
const PATIENCE: Duration = Duration::from_secs(90);

/// A request to the daemon.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    pub method: &'static str,
    pub path: String,
    pub content_type: String,
    pub body: String,
}

impl Request {
    pub fn get(path: impl Into<String>) -> Self {
        Self { method: "GET", path: path.into(), content_type: String::new(), body: String::new() }
    }

    /// A request without a body. Such a request may be executed even if it is cut off after its head.
    pub fn bare(method: &'static str, path: impl Into<String>) -> Self {
        Self { method, ..Self::get(path) }
    }

    pub fn json(method: &'static str, path: impl Into<String>, body: &Value) -> Self {
        Self { method, path: path.into(), content_type: "application/json".into(), body: body.to_string() }
    }

    pub fn post(path: impl Into<String>, body: &Value) -> Self {
        Self::json("POST", path, body)
    }

    /// Imports a table of `rows` samples of a friction run with this name.
    pub fn import(name: &str, rows: usize) -> Self {
        const EDGE: &str = "jointbench-fault-suite";
        let mut table = String::from("time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a\n");
        for row in 0..rows {
            let at_s = row as f64 * 0.01;
            table.push_str(&format!("{at_s:.3},{:.5},{:.5},{:.5}\n", at_s * 2.0, 2.0, 0.4 + 0.01 * (at_s * 7.0).sin()));
        }
        let meta = json!({ "kind": "friction", "torque_constant_nm_per_a": 0.064, "gear_ratio": 50 });
        let body = format!(
            "--{EDGE}\r\ncontent-disposition: form-data; name=\"meta\"\r\n\r\n{meta}\r\n\
             --{EDGE}\r\ncontent-disposition: form-data; name=\"file\"; filename=\"{name}.csv\"\r\n\r\n{table}\r\n--{EDGE}--\r\n"
        );
        let content_type = format!("multipart/form-data; boundary={EDGE}");
        Self { method: "POST", path: format!("/runs/import?name={name}"), content_type, body }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    Answered {
        status: u16,
        body: Value,
    },
    /// The request may have been executed.
    Unknown,
    /// The server does not listen.
    NotSent,
}

impl Outcome {
    /// The answer of an acknowledged operation.
    pub fn acknowledged(&self) -> Option<&Value> {
        match self {
            Outcome::Answered { status, body } if (200..300).contains(status) => Some(body),
            _ => None,
        }
    }

    /// Whether the request was refused without effect.
    pub fn refused(&self) -> bool {
        matches!(self, Outcome::Answered { status: 400..500, .. } | Outcome::NotSent)
    }
}

/// A client with a token.
#[derive(Debug, Clone)]
pub struct Client {
    pub address: SocketAddr,
    pub token: String,
}

impl Client {
    pub fn send(&self, request: &Request) -> Outcome {
        // Uses a new connection: a kept one may lead to a server that has ended.
        let config = ureq::Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(PATIENCE))
            .max_idle_connections(0)
            .build();
        let asked = ureq::http::Request::builder()
            .method(request.method)
            .uri(format!("http://{}/api/v1{}", self.address, request.path))
            .header("authorization", format!("Bearer {}", self.token));
        let asked = match request.content_type.as_str() {
            "" => asked,
            content_type => asked.header("content-type", content_type),
        };
        let agent = ureq::Agent::new_with_config(config);
        match agent.run(asked.body(request.body.clone()).expect("a request")) {
            Ok(mut answer) => {
                let status = answer.status().as_u16();
                match answer.body_mut().with_config().limit(1 << 30).read_to_string() {
                    Ok(text) => {
                        Outcome::Answered { status, body: serde_json::from_str(&text).unwrap_or(Value::String(text)) }
                    }
                    Err(_) => Outcome::Unknown,
                }
            }
            Err(ureq::Error::Io(fault)) if fault.kind() == std::io::ErrorKind::ConnectionRefused => Outcome::NotSent,
            Err(ureq::Error::ConnectionFailed) => Outcome::NotSent,
            Err(_) => Outcome::Unknown,
        }
    }

    /// A GET request that must succeed.
    pub fn get(&self, path: &str) -> Value {
        match self.send(&Request::get(path)) {
            Outcome::Answered { status: 200, body } => body,
            other => panic!("GET {path}: {other:?}"),
        }
    }

    pub fn post(&self, path: &str, body: &Value) -> Outcome {
        self.send(&Request::post(path, body))
    }

    /// Sends `share` of the request, waits, and resets the connection. Returns whether all of it was sent.
    pub fn hang_up(&self, request: &Request, share: f64, after: Duration) -> bool {
        let Ok(mut stream) = TcpStream::connect(self.address) else { return false };
        let bytes = self.bytes(request);
        let count = ((bytes.len() as f64 * share).ceil() as usize).min(bytes.len());
        let sent = stream.write_all(&bytes[..count]).is_ok();
        std::thread::sleep(after);
        // An error means that the server was faster.
        let _ = SockRef::from(&stream).set_linger(Some(Duration::ZERO));
        sent && count == bytes.len()
    }

    fn bytes(&self, request: &Request) -> Vec<u8> {
        let Request { method, path, content_type, body } = request;
        let mut head = format!("{method} /api/v1{path} HTTP/1.1\r\nhost: {}\r\n", self.address);
        head.push_str(&format!("authorization: Bearer {}\r\ncontent-length: {}\r\n", self.token, body.len()));
        if !content_type.is_empty() {
            head.push_str(&format!("content-type: {content_type}\r\n"));
        }
        [head.as_bytes(), b"\r\n", body.as_bytes()].concat()
    }
}
