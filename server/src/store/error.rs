//! Errors of the store. Each message includes the remedy.

use jointbench_procedure::{RunId, RunState};
use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("the data folder {} cannot be written ({what}): choose another with --data, or change its permissions", .folder.display())]
    Unwritable { folder: PathBuf, what: String },
    #[error("the data folder {} is in use by another jointbench{}: stop that one, or choose another folder with --data", .folder.display(), .process.map_or_else(String::new, |process| format!(" (process {process})")))]
    InUse { folder: PathBuf, process: Option<u32> },
    #[error("{} is not a database of jointbench: move it away, or choose another folder with --data", .file.display())]
    Foreign { file: PathBuf },
    #[error("{} was written by a newer jointbench (schema {schema}): update this one, or choose another folder with --data", .file.display())]
    Newer { file: PathBuf, schema: i64 },
    #[error("{} was written by an older jointbench that cannot be carried over ({what}): move it away, or choose another folder with --data", .file.display())]
    Old { file: PathBuf, what: String },
    #[error("{}: {what}", .file.display())]
    Copy { file: PathBuf, what: String },
    #[error("there is no store in {}: name its folder with --data", .folder.display())]
    NoStore { folder: PathBuf },
    #[error("the disk is full: free some space and try again")]
    DiskFull,
    #[error(
        "the database did not answer in time: another program holds jointbench.db in the data folder, or the disk does not \
         answer; close that program (`fuser jointbench.db` names it)"
    )]
    Held,
    #[error("run {run}: commit {number} was never stored")]
    CommitMissing { run: RunId, number: u64 },
    #[error("name: {0} already exists, choose another name")]
    TokenExists(String),
    #[error("token {0} does not exist or is already revoked")]
    NoToken(i64),
    #[error("there is no run {0}")]
    NoRun(RunId),
    #[error("search term {term}: {what}")]
    Search { term: String, what: String },
    #[error(
        "the runs have no column {name:?} to sort by: choose {known}; a minus sign in front lists the largest first"
    )]
    Order { name: String, known: String },
    #[error("there is no model version {0}")]
    NoModel(i64),
    #[error("there is no diagnosis {0}")]
    NoDiagnosis(i64),
    #[error("there is no effect {0} that a user wrote; GET /api/v1/effects lists them with their definitions")]
    NoEffect(String),
    #[error("effect {effect} is used by model version {model}: it stays, but a new version of it can be defined")]
    EffectUsed { effect: String, model: i64 },
    #[error("there is no autopilot {0}")]
    NoAutopilot(i64),
    #[error("there is no queue entry {0}")]
    NoQueueEntry(i64),
    #[error("run {run} has no channel {name}: it has {}", .there.join(", "))]
    NoChannel { run: RunId, name: String, there: Vec<String> },
    #[error(
        "the samples of run {run} are only in the archive: import {file} with `jointbench import`, and use the imported run"
    )]
    Dropped { run: RunId, file: String },
    #[error("run {run} is {state}: nothing can be added to it")]
    RunOver { run: RunId, state: RunState },
    #[error("run {run}: the channels of this commit are not those of the run")]
    OtherChannels { run: RunId },
    #[error("model version {parent} belongs to another run than {run}")]
    OtherRun { parent: i64, run: RunId },
    #[error("the database is damaged ({0}): `jointbench verify` lists all that is damaged; restore it from a backup")]
    Damaged(Damage),
    #[error("the database refused: {0}")]
    Database(String),
}

/// Damage in the database. SQLite itself and decoders do not know its place.
#[derive(Debug, Clone)]
pub struct Damage {
    place: Option<String>,
    what: String,
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.what),
            None => f.write_str(&self.what),
        }
    }
}

impl StoreError {
    pub(super) fn damaged(what: impl ToString) -> Self {
        StoreError::Damaged(Damage { place: None, what: what.to_string() })
    }

    /// Adds the place to damage without one.
    pub(super) fn at(self, place: impl FnOnce() -> String) -> Self {
        match self {
            StoreError::Damaged(Damage { place: None, what }) => {
                StoreError::Damaged(Damage { place: Some(place()), what })
            }
            other => other,
        }
    }

    /// Adds run and table to the damage that SQLite itself found.
    pub(super) fn within(self, run: RunId, table: &str) -> Self {
        self.at(|| format!("table {table}, run {run}"))
    }

    /// Whether the daemon cannot start with this setup.
    pub fn is_setup(&self) -> bool {
        use StoreError as E;
        matches!(
            self,
            E::Unwritable { .. }
                | E::InUse { .. }
                | E::Foreign { .. }
                | E::Newer { .. }
                | E::Old { .. }
                | E::NoStore { .. }
                | E::Copy { .. }
        )
    }

    /// Whether a later retry with the same data may succeed.
    pub fn may_pass(&self) -> bool {
        matches!(self, StoreError::DiskFull | StoreError::Held | StoreError::Database(_))
    }

    /// Whether the named object does not exist.
    pub fn is_not_found(&self) -> bool {
        use StoreError as E;
        matches!(
            self,
            E::NoRun(_)
                | E::NoToken(_)
                | E::NoModel(_)
                | E::NoDiagnosis(_)
                | E::NoEffect(_)
                | E::NoAutopilot(_)
                | E::NoQueueEntry(_)
                | E::NoChannel { .. }
        )
    }
}

/// Primary result codes of SQLite: sqlite.org/rescode.html.
const SQLITE_BUSY: i32 = 5;
const SQLITE_CORRUPT: i32 = 11;
const SQLITE_FULL: i32 = 13;
const SQLITE_NOTADB: i32 = 26;

impl From<sqlx::Error> for StoreError {
    fn from(fault: sqlx::Error) -> Self {
        if matches!(fault, sqlx::Error::PoolTimedOut) {
            return StoreError::Held;
        }
        // A value of another type than its column, or text that is not UTF-8.
        if matches!(fault, sqlx::Error::ColumnDecode { .. } | sqlx::Error::Decode(_)) {
            return StoreError::damaged(fault);
        }
        let code = fault.as_database_error().and_then(|fault| fault.code()?.parse::<i32>().ok());
        // The low byte of the extended code is the primary code.
        match code.map(|code| code & 0xff) {
            Some(SQLITE_BUSY) => StoreError::Held,
            Some(SQLITE_FULL) => StoreError::DiskFull,
            Some(SQLITE_CORRUPT | SQLITE_NOTADB) => StoreError::damaged(fault),
            _ => StoreError::Database(fault.to_string()),
        }
    }
}

impl From<serde_json::Error> for StoreError {
    fn from(fault: serde_json::Error) -> Self {
        StoreError::damaged(fault)
    }
}
