//! What the daemon remembers: one SQLite file in the data folder.
//!
//! Rows, events and state of a run go in together, in one transaction that is on the disk when [`Store::commit`] returns.
//! Samples lie in coded columns ([`codec`]) of [`BLOCK_ROWS`] rows with a min/max [`pyramid`]; until a block is full, the
//! rows of each commit lie in the `tail` as they came. What was measured never changes: the schema's triggers refuse it.

mod autopilots;
mod backup;
mod calibrations;
pub mod codec;
mod commit;
mod error;
mod faults;
mod full_disk;
mod keeper;
mod kept;
mod lock;
mod mark;
mod migrations;
mod models;
mod notes;
mod open;
mod order;
mod own_effects;
pub mod pyramid;
mod records;
mod runs;
mod safety;
mod samples;
pub mod seal;
mod search;
#[cfg(test)]
mod tests;
mod tokens;
mod verify;
mod view;

pub use backup::{backup, restore};
pub use commit::RunCommit;
pub use error::StoreError;
pub use keeper::Loss;
pub use kept::{Subject, packed, unpacked};
pub use order::Order;
pub use records::{
    AutopilotRecord, CalibrationRecord, DiagnosisRecord, EventRecord, ModelRecord, NewModel, NewRun, NoteRecord,
    OwnEffectRecord, RunFilter, RunRecord, SafetyRecord, TokenRecord, VersionRecord, View, ViewColumn,
};
pub use search::Search;
pub use verify::{DamagedRecord, Readable, StoreHealth, VerifyReport, verify};

use keeper::Keeper;
use lock::FolderLock;
use sqlx::SqlitePool;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, RwLock};

/// Rows of a full block.
pub const BLOCK_ROWS: usize = 32_768;

/// A handle to the store; clones share it. The data folder is let go with the last one.
#[derive(Debug, Clone)]
pub struct Store {
    /// One connection: SQLite has one writer.
    writer: SqlitePool,
    /// Readers see the last commit and never wait for the writer.
    readers: SqlitePool,
    /// Held for as long as the store is open: one daemon for each data folder. `None` where it only reads.
    lock: Option<Arc<FolderLock>>,
    /// `None` where it only reads.
    keeper: Option<Arc<Keeper>>,
    /// What was missing when it was opened.
    missing: Option<Loss>,
    /// What the last check has found.
    health: Arc<RwLock<StoreHealth>>,
    /// Whether a mock bench has a full disk.
    is_full: Arc<AtomicBool>,
}
