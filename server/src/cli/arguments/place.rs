//! Address and data folder of a daemon.

use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Where a daemon lives.
#[derive(Debug, Args)]
pub struct Place {
    /// Folder of the store; created if missing [default: jointbench-data, or jointbench-data/demo for the demo]
    #[arg(long, value_name = "DIR", env = "JOINTBENCH_DATA")]
    pub data: Option<PathBuf>,
    /// Memory limit of a fit, a diagnosis or an import, each in its own process [GiB]
    #[arg(long, value_name = "GIB", default_value_t = 4.0, value_parser = gibibytes)]
    pub analysis_memory: f64,
    /// Record the traffic of all instruments in this folder, for inspection and replay
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Address and port of API and dashboard; port 0 selects a free port. An address other than loopback requires a
    /// token, and TLS or --behind-proxy (docs/network.md)
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8080", value_parser = address)]
    pub listen: SocketAddr,
    #[command(flatten)]
    pub tokens: ServedTokens,
    /// Certificate (PEM, including intermediate certificates): the daemon serves HTTPS only. It loads a new certificate
    /// within one minute after the files are replaced
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TLS_CERT", requires = "tls_key")]
    pub tls_cert: Option<PathBuf>,
    /// Private key of the certificate (PEM)
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TLS_KEY", requires = "tls_cert")]
    pub tls_key: Option<PathBuf>,
    /// A reverse proxy with TLS is the only client of this daemon: it may listen on other addresses than loopback
    /// without TLS
    #[arg(long)]
    pub behind_proxy: bool,
}

#[derive(Debug, Args)]
pub struct ServedTokens {
    /// The token, at least 16 characters; prefer a file or the variable, because other users can see arguments
    #[arg(long, env = "JOINTBENCH_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
    /// File with the token for full access; takes precedence over --token. Clients send it as `Authorization: Bearer
    /// TOKEN`. Further named tokens are created and revoked on the settings page of the dashboard [default: the systemd
    /// credential jointbench-token]
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TOKEN_FILE")]
    pub token_file: Option<PathBuf>,
    /// A second token for read access; it can also press the software stop
    #[arg(long, value_name = "TOKEN", env = "JOINTBENCH_READ_TOKEN", hide_env_values = true)]
    pub read_token: Option<String>,
    /// File with the second token [default: the systemd credential jointbench-read-token]
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_READ_TOKEN_FILE")]
    pub read_token_file: Option<PathBuf>,
}

/// Less than a quarter holds no run of a usual length.
fn gibibytes(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(size) if (0.25..=1024.0).contains(&size) => Ok(size),
        _ => Err("expected a number of GiB from 0.25 to 1024, such as 4".to_owned()),
    }
}

fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| "expected an address and a port, such as 127.0.0.1:8203".to_owned())
}

/// How to reach a running daemon.
#[derive(Debug, Args)]
pub struct Reach {
    /// Address of the daemon [default: http://127.0.0.1:8080]
    #[arg(long, global = true, value_name = "URL", env = "JOINTBENCH_URL")]
    pub daemon: Option<String>,
    /// Token of a daemon that requires one; prefer a file or the variable, because other users can see arguments
    #[arg(long, global = true, env = "JOINTBENCH_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
    /// File with the token; takes precedence over --token
    #[arg(long, global = true, value_name = "FILE", env = "JOINTBENCH_TOKEN_FILE")]
    pub token_file: Option<PathBuf>,
    /// Certificate (PEM) to trust for a daemon at https://, its own or that of its authority [default: the public
    /// authorities]
    #[arg(long, global = true, value_name = "FILE", env = "JOINTBENCH_CA_FILE")]
    pub ca_file: Option<PathBuf>,
}
