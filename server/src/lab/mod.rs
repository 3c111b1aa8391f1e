//! The one service layer: REST API, demo and command line access benches and runs only through a [`Lab`].

mod archive;
mod archive_files;
mod autopilot;
mod autopilot_task;
mod background;
mod benches;
mod blocking;
mod calibrations;
mod computation;
mod control_chart;
mod derived;
mod exclusions;
mod experiment;
mod export;
mod identifications;
mod leases;
mod log;
mod memory;
mod metrics;
mod model_overlay;
mod models;
pub mod names;
mod notes;
mod notifications;
mod parameter_settings;
mod queue;
mod queue_task;
mod report;
mod resume;
mod revisions;
mod run_comparison;
mod runs;
mod spreadsheet;
mod statistics;
mod tables;
mod tokens;
mod transfer;
mod trends;
mod unit_changes;
mod units;
mod user_effects;

pub use crate::error::LabError;
pub use crate::job::{ARROW_STREAM, Alignment, Encoding, ExportRequest, FileFormat, ImportRequest, Offer, PointLimit};
pub use crate::store::{Order, RunFilter};
pub use experiment::next_run;
pub use log::OF_TOKENS;
pub use models::diagnose;
pub use tables::TableFormat;
pub use tokens::{Caller, LOCAL, Tokens, weakness};
pub use transfer::{ATTENTION, COPY_OF, UNDERSTOOD};

use crate::bench::{BenchHandle, InitialState, store_leftovers, worker};
use crate::config::{Archive, BenchDescription, Notify};
use crate::job::{Jobs, Limits};
use crate::live::Hub;
use crate::store::{Store, StoreHealth};
use crate::view::{AutopilotState, word};
use archive::Archiving;
use autopilot::ActiveAutopilots;
use computation::Turns;
use jointbench_procedure::{RunState, Safe};
use leases::Leases;
use notifications::Notifications;
use queue::Queues;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

type Answer<T> = Result<T, LabError>;

/// Benches, store and live stream. Cheap to clone.
#[derive(Clone)]
pub struct Lab {
    inner: Arc<Inner>,
}

struct Inner {
    store: Store,
    hub: Hub,
    benches: Vec<BenchHandle>,
    tokens: Tokens,
    /// Path of the `jointbench` executable.
    program: PathBuf,
    active_autopilots: ActiveAutopilots,
    queues: Queues,
    leases: Leases,
    notifications: Notifications,
    archiving: Archiving,
    /// Worker processes for computations on whole runs; `None` computes in this process.
    jobs: Option<Jobs>,
    turns: Turns,
}

impl Lab {
    /// Opens the store, ends the runs that another daemon left open, and starts one thread for each bench, which
    /// secures it. Interrupted runs do not restart.
    pub async fn open(
        data: &Path,
        descriptions: Vec<BenchDescription>,
        tokens: Tokens,
        program: PathBuf,
        analysis: Limits,
        notify: Notify,
        archive: Option<Archive>,
    ) -> Answer<Lab> {
        let store = Store::open(data).await?;
        let notifications = Notifications::open(notify, &store).await?;
        let archiving = Archiving::open(archive, &store).await?;
        store.block_where_missing(descriptions.iter().map(|description| description.name.as_str())).await?;
        wait_for_workers(data).await;
        store_leftovers(data, &store).await?;
        clear_uploads(data)?;
        interrupt_autopilots(&store).await?;
        let mut interrupted: BTreeMap<String, Vec<i64>> = BTreeMap::new();
        for run in store.interrupt_open_runs().await? {
            interrupted.entry(run.bench).or_default().push(run.id);
        }
        let hub = Hub::new();
        let mut benches = Vec::new();
        for description in descriptions {
            let interrupted = interrupted.remove(&description.name).unwrap_or_default();
            let block = store.bench_block(&description.name).await?;
            let name = description.name.clone();
            let beginning = InitialState { description, block, interrupted };
            let bench = BenchHandle::start(beginning, store.clone(), hub.clone(), data, &program)
                .map_err(|fault| LabError::Setup(format!("bench {name} gets no thread: {fault}")))?;
            benches.push(bench);
        }
        block_missing_benches(&store, interrupted).await?;
        let lab = Lab {
            inner: Arc::new(Inner {
                store,
                hub,
                queues: Queues::new(benches.iter()),
                benches,
                tokens,
                jobs: Some(Jobs::new(&program, data, analysis)),
                program,
                active_autopilots: ActiveAutopilots::default(),
                leases: Leases::default(),
                notifications,
                archiving,
                turns: Turns::default(),
            }),
        };
        lab.open_tokens().await?;
        lab.wait_until_secured().await;
        lab.judge_unjudged_runs();
        lab.open_queues().await?;
        lab.open_notifications();
        lab.open_archive();
        tokio::spawn(lab.inner.store.clone().check_daily());
        Ok(lab)
    }

    /// Only the store, for import and export without a daemon. It has no benches and ends no runs.
    pub fn of_store(store: Store) -> Lab {
        Lab {
            inner: Arc::new(Inner {
                store,
                hub: Hub::new(),
                benches: Vec::new(),
                tokens: Tokens::default(),
                program: crate::program::path(),
                active_autopilots: ActiveAutopilots::default(),
                queues: Queues::default(),
                leases: Leases::default(),
                notifications: Notifications::default(),
                archiving: Archiving::default(),
                jobs: None,
                turns: Turns::default(),
            }),
        }
    }

    /// Path of the `jointbench` executable, for parts of the daemon in separate processes.
    pub fn program(&self) -> &Path {
        &self.inner.program
    }

    /// Result of the latest integrity check of the store.
    pub fn store_health(&self) -> StoreHealth {
        self.inner.store.health()
    }

    pub fn hub(&self) -> &Hub {
        &self.inner.hub
    }

    /// Ends all runs, secures all benches and closes the store.
    pub async fn shut_down(&self) {
        self.inner.queues.abort();
        self.inner.notifications.abort();
        self.inner.archiving.abort();
        self.inner.active_autopilots.abort();
        self.inner.jobs.iter().for_each(Jobs::end);
        let benches = self.inner.benches.clone();
        let ended = tokio::task::spawn_blocking(move || benches.iter().for_each(BenchHandle::shut_down)).await;
        if let Err(fault) = ended {
            tracing::error!(%fault, "shutting down failed");
        }
        if let Err(fault) = interrupt_autopilots(&self.inner.store).await {
            tracing::error!(%fault, "that autopilots were interrupted could not be kept");
        }
        self.inner.store.close().await;
    }
}

/// The worker of a killed daemon secures its bench and saves unstored commits: wait until it has ended.
async fn wait_for_workers(data: &Path) {
    let data = data.to_owned();
    let waited = tokio::task::spawn_blocking(move || worker::wait_until_gone(&data)).await;
    if let Err(fault) = waited {
        tracing::error!(%fault, "waiting for earlier workers failed");
    }
}

/// Ends interrupted runs of benches that this daemon does not have.
async fn block_missing_benches(store: &Store, interrupted: BTreeMap<String, Vec<i64>>) -> Answer<()> {
    let reason = "a run was interrupted, and its bench is missing in the bench description of this daemon";
    for (bench, runs) in interrupted {
        store.block_bench(&bench, runs.last().copied(), reason).await?;
        for run in runs {
            store.end_run(run, RunState::Interrupted, Safe::UnsafeUnknown, Some(reason)).await?;
        }
    }
    Ok(())
}

/// Folder of uploaded files that are not yet runs.
const UPLOADS: &str = "uploads";

/// Removes files that a killed daemon had not imported.
fn clear_uploads(data: &Path) -> Answer<()> {
    let folder = data.join(UPLOADS);
    let unwritable = |fault: std::io::Error| {
        LabError::Setup(format!("{} cannot be emptied ({fault}): change its permissions", folder.display()))
    };
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(unwritable)?;
    }
    std::fs::create_dir_all(&folder).map_err(unwritable)
}

async fn interrupt_autopilots(store: &Store) -> Answer<()> {
    let state = word(AutopilotState::Interrupted);
    store.interrupt_open_autopilots(&state, autopilot::INTERRUPTED).await?;
    Ok(())
}
