//! The store of the daemon: one SQLite file in the data folder.
//!
//! Rows, events and state of a run are stored in one transaction that is on the disk when [`Store::commit`] returns.
//! Samples are stored as coded columns ([`codec`]) of [`BLOCK_ROWS`] rows with a min/max [`pyramid`]. Until a block is
//! full, the rows of each commit are in the `tail`. Triggers of the schema refuse changes of measured data.

mod archive;
mod autopilots;
mod backup;
mod calibrations;
pub mod codec;
mod commit;
mod ends;
mod error;
mod faults;
mod full_disk;
mod health;
mod keeper;
mod lock;
mod mark;
mod migrations;
mod models;
mod notes;
mod notifications;
mod open;
mod order;
pub mod pyramid;
mod queue;
mod records;
mod result_cache;
mod runs;
mod safety;
mod samples;
pub mod seal;
mod search;
#[cfg(test)]
mod tests;
mod tokens;
mod unit;
mod units;
mod user_effects;
mod values;
mod verify;
mod window;

pub use archive::{ArchiveCounts, ArchiveEnd, ArchiveRecord};
pub use backup::{backup, restore};
pub use commit::RunCommit;
pub use error::StoreError;
pub use health::{DamagedRecord, StoreHealth};
pub use keeper::Loss;
pub use order::Order;
pub use records::{
    AutopilotRecord, CalibrationRecord, DiagnosisRecord, EffectUse, EventRecord, ModelRecord, NewModel, NewQueueEntry,
    NewRun, NoteRecord, NotificationRecord, NotifyCounts, ProceedIf, QueueRecord, QueueState, RunFilter, RunRecord,
    SafetyRecord, TokenRecord, UnitRunRecord, UserEffectRecord, VersionRecord, Window, WindowColumn,
};
pub use result_cache::{Subject, packed, unpacked};
pub use search::Search;
pub use unit::Unit;
pub use verify::{Readable, VerifyReport, verify};

use keeper::Keeper;
use lock::FolderLock;
use sqlx::SqlitePool;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, RwLock};

/// Rows of a full block.
pub const BLOCK_ROWS: usize = 32_768;

/// A handle to the store; clones share it. The last clone releases the data folder.
#[derive(Debug, Clone)]
pub struct Store {
    /// One connection: SQLite has one writer.
    writer: SqlitePool,
    /// Readers see the last commit and never wait for the writer.
    readers: SqlitePool,
    /// Lock of the data folder: one daemon for each. `None` if the store is read-only.
    lock: Option<Arc<FolderLock>>,
    /// `None` if the store is read-only.
    keeper: Option<Arc<Keeper>>,
    /// Changes that were missing when the store was opened.
    missing: Option<Loss>,
    /// Result of the last check.
    health: Arc<RwLock<StoreHealth>>,
    /// Whether a full disk is simulated.
    is_full: Arc<AtomicBool>,
}
