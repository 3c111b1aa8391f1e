//! The daemon: a lab with a network interface.

use crate::api::{self, Transport};
use crate::config::{Archive, BenchDescription, Notify};
use crate::job;
use crate::lab::{Lab, LabError, Tokens, weakness};
use crate::listener::{self, Limits, Tls, TlsFiles};
use std::net::SocketAddr;
use std::path::PathBuf;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

#[derive(Debug, Clone)]
pub struct DaemonSettings {
    pub listen: SocketAddr,
    pub data: PathBuf,
    /// Required if `listen` is not a loopback address.
    pub token: Option<String>,
    /// Allows its owner to read and to stop, nothing else.
    pub read_token: Option<String>,
    pub network: Network,
    pub benches: Vec<BenchDescription>,
    pub notify: Notify,
    pub archive: Option<Archive>,
    /// Path of the `jointbench` executable, for parts of the daemon in separate processes.
    pub program: PathBuf,
    /// Limits of one computation on whole runs.
    pub analysis: job::Limits,
}

/// Network settings of the daemon.
#[derive(Debug, Clone, Default)]
pub struct Network {
    /// Required if `listen` is not a loopback address, unless a proxy is in front.
    pub tls: Option<TlsFiles>,
    /// Only a reverse proxy with TLS can reach the daemon.
    pub behind_proxy: bool,
    pub limits: Limits,
}

pub struct Daemon {
    pub lab: Lab,
    /// Address of the listener; for port 0 it contains the assigned port.
    pub address: SocketAddr,
    /// `http` or `https`.
    pub scheme: &'static str,
    server: JoinHandle<()>,
}

impl Daemon {
    /// Opens the port and the store, secures the benches, then accepts requests. [`LabError::Setup`] contains the
    /// obstacle.
    pub async fn start(settings: DaemonSettings) -> Result<Daemon, LabError> {
        let tokens = tokens(&settings)?;
        let Network { tls, behind_proxy, limits } = settings.network.clone();
        let tls = tls.map(Tls::open).transpose().map_err(LabError::Setup)?;
        refuse_plain(&settings)?;
        let listener = TcpListener::bind(settings.listen).await.map_err(|fault| taken(settings.listen, &fault))?;
        let address = listener.local_addr().map_err(|fault| taken(settings.listen, &fault))?;
        let scheme = if tls.is_some() { "https" } else { "http" };
        let mut notify = settings.notify;
        // An address such as 0.0.0.0 is no link.
        if notify.dashboard.is_none() && !address.ip().is_unspecified() {
            notify.dashboard = Some(format!("{scheme}://{address}"));
        }
        let (data, benches, program) = (&settings.data, settings.benches, settings.program);
        let lab = Lab::open(data, benches, tokens, program, settings.analysis, notify, settings.archive).await?;
        let router = api::router(lab.clone(), Transport { tls: tls.is_some(), behind_proxy });
        let server = tokio::spawn(listener::serve(listener, router, tls, limits));
        tracing::info!(%address, scheme, data = %settings.data.display(), "listening");
        Ok(Daemon { lab, address, scheme, server })
    }

    /// Ends all runs, secures all benches, closes the store.
    pub async fn stop(self) {
        // Requests are still answered while the benches are secured, so that a page shows the progress.
        self.lab.shut_down().await;
        self.server.abort();
        tracing::info!("stopped");
    }
}

/// Returns on Ctrl-C, a termination request of a service manager, or the end of the terminal.
#[cfg(unix)]
pub async fn shutdown_signal() {
    use tokio::signal::unix::SignalKind;
    tokio::select! {
        _ = tokio::signal::ctrl_c() => {}
        () = signalled(SignalKind::terminate()) => {}
        () = signalled(SignalKind::hangup()), if !ignores_hangup() => {}
    }
}

#[cfg(unix)]
async fn signalled(kind: tokio::signal::unix::SignalKind) {
    match tokio::signal::unix::signal(kind) {
        Ok(mut signal) => drop(signal.recv().await),
        Err(fault) => {
            tracing::warn!(%fault, "a signal to end will not be heard");
            std::future::pending().await
        }
    }
}

/// Whether the daemon shall outlive its terminal, as with `nohup`: signal 1 is ignored.
#[cfg(unix)]
fn ignores_hangup() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

/// Returns on Ctrl-C.
#[cfg(not(unix))]
pub async fn shutdown_signal() {
    drop(tokio::signal::ctrl_c().await);
}

fn tokens(settings: &DaemonSettings) -> Result<Tokens, LabError> {
    let refused = |why: String| Err(LabError::Setup(why));
    let token = settings.token.as_deref().map(str::trim);
    let read_token = settings.read_token.as_deref().map(str::trim);
    for (what, token) in [("the token", token), ("the read token", read_token)] {
        if let Some(why) = token.and_then(weakness) {
            return refused(format!("{what} {why}"));
        }
    }
    match token {
        None if read_token.is_some() => refused(format!("a read token requires a token with full access: {GIVE}")),
        Some(_) if token == read_token => {
            refused("read token and full token are equal: use two different tokens".into())
        }
        Some(token) => Ok(Tokens::given(Some(token), read_token)),
        None if settings.network.behind_proxy => refused(format!("a proxy allows access from other machines: {GIVE}")),
        None if settings.listen.ip().is_loopback() => Ok(Tokens::default()),
        None => {
            refused(format!("{} is reachable from other machines: {GIVE}, or listen on 127.0.0.1", settings.listen))
        }
    }
}

const GIVE: &str = "give a token with --token-file or JOINTBENCH_TOKEN";

/// An unencrypted token can be read by others in the network.
fn refuse_plain(settings: &DaemonSettings) -> Result<(), LabError> {
    let Network { tls, behind_proxy, .. } = &settings.network;
    if settings.listen.ip().is_loopback() || *behind_proxy || tls.is_some() {
        return Ok(());
    }
    Err(LabError::Setup(format!(
        "{} is reachable from other machines, which would send tokens unencrypted: give --tls-cert and --tls-key, use \
         --behind-proxy with a TLS proxy, or listen on 127.0.0.1 (docs/network.md)",
        settings.listen
    )))
}

fn taken(address: SocketAddr, fault: &std::io::Error) -> LabError {
    LabError::Setup(match fault.kind() {
        std::io::ErrorKind::AddrInUse => {
            format!(
                "port {} is in use: stop the other program, or choose another port with --listen {}:0",
                address.port(),
                address.ip()
            )
        }
        _ => format!("cannot listen on {address} ({fault}): choose another address with --listen"),
    })
}
