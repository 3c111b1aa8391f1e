//! `jointbench serve`.

use super::arguments::{Place, Serve};
use super::exit::{Done, Exit};
use super::secrets;
use crate::config::{self, BenchDescription, Description};
use crate::daemon::{Daemon, DaemonSettings, Network, shutdown_signal};
use crate::job::{GIB, Limits};
use crate::listener::TlsFiles;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub fn serve(arguments: Serve) -> Done {
    let description = describe(&arguments.config)?;
    let runtime = runtime()?;
    let done = runtime.block_on(async {
        let daemon = Daemon::start(settings(arguments.place, "jointbench-data", description)?).await?;
        println!("dashboard and API on {}://{}  (Ctrl-C to exit)", daemon.scheme, daemon.address);
        shutdown_signal().await;
        daemon.stop().await;
        Ok(())
    });
    // All important data is stored: do not wait for threads that read or pack.
    runtime.shutdown_timeout(LAST_MOMENT);
    done
}

/// Reads a description from a file or by the name of a ready-made one.
pub(super) fn describe(config: &str) -> Result<Description, Exit> {
    let ready_made = config::READY_MADE.iter().find(|(name, _)| *name == config);
    let description = match ready_made {
        Some((name, text)) => config::parse(name, text),
        None => config::read(Path::new(config)),
    };
    description.map_err(|errors| Exit::bad_input(errors.to_string()))
}

pub(super) fn settings(place: Place, data: &str, description: Description) -> Result<DaemonSettings, Exit> {
    let Description { mut benches, notify, archive } = description;
    if let Some(folder) = &place.record {
        benches.iter_mut().for_each(|bench| bench.record = Some(folder.join(&bench.name)));
    }
    let [token, read_token] = secrets::of_daemon(&place.tokens)?;
    let tls = place.tls_cert.zip(place.tls_key).map(|(certificate, key)| TlsFiles { certificate, key });
    let analysis = Limits {
        memory_bytes: (place.analysis_memory * GIB as f64) as u64,
        is_idle: benches.iter().any(BenchDescription::is_real_time),
        ..Limits::default()
    };
    Ok(DaemonSettings {
        listen: place.listen,
        data: place.data.unwrap_or_else(|| PathBuf::from(data)),
        token,
        read_token,
        network: Network { tls, behind_proxy: place.behind_proxy, ..Network::default() },
        benches,
        notify,
        archive,
        program: crate::program::path(),
        analysis,
    })
}

/// Limit of the threads for blocking work: files, and packing of columns. Each has a stack of 2 MiB, and a daemon may
/// be limited to an address space of 1 GiB.
const BLOCKING_THREADS: usize = 32;
const LAST_MOMENT: Duration = Duration::from_millis(500);

pub(super) fn runtime() -> Result<tokio::runtime::Runtime, Exit> {
    let mut runtime = tokio::runtime::Builder::new_multi_thread();
    let runtime = runtime.enable_all().max_blocking_threads(BLOCKING_THREADS).build();
    runtime.map_err(|fault| Exit::failed(format!("no threads available from the system: {fault}")))
}
