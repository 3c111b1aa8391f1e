//! `jointbench serve`.

use super::arguments::{Place, Serve};
use super::exit::{Done, Exit};
use super::secrets;
use crate::config::{self, BenchDescription};
use crate::daemon::{Daemon, DaemonSettings, Network, asked_to_end};
use crate::listener::TlsFiles;
use std::path::{Path, PathBuf};

pub fn serve(arguments: Serve) -> Done {
    let benches = describe(&arguments.config)?;
    runtime()?.block_on(async {
        let daemon = Daemon::start(settings(arguments.place, "jointbench-data", benches)?).await?;
        println!("dashboard and API on {}://{}  (Ctrl-C ends)", daemon.scheme, daemon.address);
        asked_to_end().await;
        daemon.stop().await;
        Ok(())
    })
}

/// A description from a file, or a ready-made one by its name.
pub(super) fn describe(config: &str) -> Result<Vec<BenchDescription>, Exit> {
    let ready_made = config::READY_MADE.iter().find(|(name, _)| *name == config);
    let benches = match ready_made {
        Some((name, text)) => config::parse(name, text),
        None => config::read(Path::new(config)),
    };
    benches.map_err(|mistakes| Exit::bad_input(mistakes.to_string()))
}

pub(super) fn settings(place: Place, data: &str, mut benches: Vec<BenchDescription>) -> Result<DaemonSettings, Exit> {
    if let Some(folder) = &place.record {
        benches.iter_mut().for_each(|bench| bench.record = Some(folder.join(&bench.name)));
    }
    let [token, read_token] = secrets::of_daemon(&place.tokens)?;
    let tls = place.tls_cert.zip(place.tls_key).map(|(certificate, key)| TlsFiles { certificate, key });
    Ok(DaemonSettings {
        listen: place.listen,
        data: place.data.unwrap_or_else(|| PathBuf::from(data)),
        token,
        read_token,
        network: Network { tls, behind_proxy: place.behind_proxy, ..Network::default() },
        benches,
        program: crate::program::own(),
    })
}

pub(super) fn runtime() -> Result<tokio::runtime::Runtime, Exit> {
    tokio::runtime::Runtime::new().map_err(|fault| Exit::failed(format!("the system gives no threads: {fault}")))
}
