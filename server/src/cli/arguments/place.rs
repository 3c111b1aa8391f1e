//! Where a daemon lives, and how it is reached.

use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Where a daemon lives.
#[derive(Debug, Args)]
pub struct Place {
    /// Folder of the store; made where it is missing [default: jointbench-data, or jointbench-data/demo for the demo]
    #[arg(long, value_name = "DIR", env = "JOINTBENCH_DATA")]
    pub data: Option<PathBuf>,
    /// Memory that a fit, a diagnosis or an import may take, each in a process of its own [GiB]
    #[arg(long, value_name = "GIB", default_value_t = 4.0, value_parser = gibibytes)]
    pub analysis_memory: f64,
    /// Write the traffic of every instrument down in this folder, to read and to replay
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Address and port of API and dashboard; port 0 takes a free one. Beyond loopback it needs a token, and TLS or
    /// --behind-proxy (docs/network.md)
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8080", value_parser = address)]
    pub listen: SocketAddr,
    #[command(flatten)]
    pub tokens: ServedTokens,
    /// Certificate (PEM, with those between it and the authority): the daemon answers by HTTPS only. A new one is taken
    /// within a minute after the files were exchanged
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TLS_CERT", requires = "tls_key")]
    pub tls_cert: Option<PathBuf>,
    /// Private key of the certificate (PEM)
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TLS_KEY", requires = "tls_cert")]
    pub tls_key: Option<PathBuf>,
    /// A reverse proxy with TLS is in front, and nothing else reaches this daemon: it may listen beyond loopback without TLS
    #[arg(long)]
    pub behind_proxy: bool,
}

#[derive(Debug, Args)]
pub struct ServedTokens {
    /// The token itself, of 16 characters and more; better in a file or in the variable, since arguments are seen by others
    #[arg(long, env = "JOINTBENCH_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
    /// File with the token that lets its holder do everything; outweighs --token. Callers send it as `Authorization: Bearer
    /// TOKEN`, and make and revoke further ones, a name for each, on the dashboard's page of settings [default: the
    /// systemd credential jointbench-token]
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TOKEN_FILE")]
    pub token_file: Option<PathBuf>,
    /// A second token, for those who only look; it can press the software stop, too
    #[arg(long, value_name = "TOKEN", env = "JOINTBENCH_READ_TOKEN", hide_env_values = true)]
    pub read_token: Option<String>,
    /// File with that second token [default: the systemd credential jointbench-read-token]
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
    #[arg(long, value_name = "URL", env = "JOINTBENCH_URL")]
    pub daemon: Option<String>,
    /// Token of a daemon that asks for one; better in a file or in the variable, since arguments are seen by others
    #[arg(long, env = "JOINTBENCH_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
    /// File with that token; outweighs --token
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_TOKEN_FILE")]
    pub token_file: Option<PathBuf>,
    /// Certificate (PEM) that a daemon at https:// is trusted by, its own or of its authority [default: the public authorities]
    #[arg(long, value_name = "FILE", env = "JOINTBENCH_CA_FILE")]
    pub ca_file: Option<PathBuf>,
}
