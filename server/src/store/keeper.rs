//! A task beside the writer: it marks the last durable change, and moves the write-ahead file into the database when a run
//! has ended. No commit waits for it.

use super::mark::{Mark, MarkFile};
use super::runs::now;
use super::{Store, StoreError};
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection, SqliteConnection};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tokio::sync::{Mutex, watch};
use tokio::task::JoinHandle;
use utoipa::ToSchema;

/// The hook runs before its commit is on the disk: the change is looked for again after these pauses, twice as long each time.
const FIRST_PAUSE: Duration = Duration::from_millis(2);
const LOOKS: u32 = 12;
/// A checkpoint that a reader or a writer was in the way of is tried again.
const RETRY: Duration = Duration::from_millis(250);

/// What the writer's commits tell the keeper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// So many transactions have been committed, or are about to be.
    Commits(u64),
    End,
}

impl Signal {
    /// What one more transaction tells; an end stays one.
    pub fn next(self) -> Signal {
        match self {
            Signal::Commits(count) => Signal::Commits(count + 1),
            Signal::End => Signal::End,
        }
    }
}

pub type Signals = watch::Sender<Signal>;

/// The handle to the task.
#[derive(Debug)]
pub struct Keeper {
    signals: Signals,
    task: Mutex<Option<JoinHandle<()>>>,
}

impl Keeper {
    pub async fn start(options: &SqliteConnectOptions, folder: PathBuf, signals: Signals) -> Result<Self, StoreError> {
        // A checkpoint never waits while it keeps the writer out.
        let database = options.clone().busy_timeout(Duration::ZERO).connect().await?;
        let file =
            MarkFile::open(&folder).map_err(|fault| StoreError::Unwritable { folder, what: fault.to_string() })?;
        let mut work = Work { database, file, marked: -1, ended: 0, is_due: true };
        work.look().await?;
        work.checkpoint().await?;
        let task = tokio::spawn(work.go_on(signals.subscribe()));
        Ok(Self { signals, task: Mutex::new(Some(task)) })
    }

    /// The last one on the database: with it the write-ahead file goes.
    pub async fn end(&self) {
        self.signals.send_replace(Signal::End);
        if let Some(task) = self.task.lock().await.take()
            && let Err(fault) = task.await
        {
            tracing::warn!(%fault, "the last change was not marked");
        }
    }
}

struct Work {
    database: SqliteConnection,
    file: MarkFile,
    /// The last change that was marked.
    marked: i64,
    /// Runs that had ended at the last look.
    ended: i64,
    /// Whether a checkpoint is due.
    is_due: bool,
}

impl Work {
    async fn go_on(mut self, mut signals: watch::Receiver<Signal>) {
        loop {
            tokio::select! {
                told = signals.changed() => if told.is_err() { break },
                () = tokio::time::sleep(RETRY), if self.is_due => {}
            }
            let ends = *signals.borrow_and_update() == Signal::End;
            if let Err(fault) = self.turn(ends).await {
                tracing::warn!(%fault, "the last change was not marked");
            }
            if ends {
                break;
            }
        }
        if let Err(fault) = self.database.close().await {
            tracing::warn!(%fault, "the database was not closed in an orderly way");
        }
    }

    async fn turn(&mut self, ends: bool) -> Result<(), StoreError> {
        let mut pause = FIRST_PAUSE;
        let looks = if ends || self.is_due { 1 } else { LOOKS };
        for look in 1..=looks {
            if self.look().await? || look == looks {
                break;
            }
            tokio::time::sleep(pause).await;
            pause *= 2;
        }
        if self.is_due {
            self.checkpoint().await?;
        }
        Ok(())
    }

    /// Whether there was a new change, which is marked then. What a reader sees is on the disk.
    async fn look(&mut self) -> Result<bool, StoreError> {
        let (store, changes, ended) = state(&mut self.database).await?;
        self.is_due |= ended > self.ended;
        self.ended = ended;
        if changes == self.marked {
            return Ok(false);
        }
        let written = self.file.write(&Mark { store, changes });
        written.map_err(|fault| StoreError::Database(format!("jointbench.mark: {fault}")))?;
        self.marked = changes;
        Ok(true)
    }

    async fn checkpoint(&mut self) -> Result<(), StoreError> {
        self.is_due = !checkpoint(&mut self.database).await?;
        Ok(())
    }
}

/// Moves the write-ahead file into the database and empties it; `false` where somebody is in the way.
pub async fn checkpoint(database: &mut SqliteConnection) -> Result<bool, StoreError> {
    let (busy, _, _): (i64, i64, i64) = sqlx::query_as("PRAGMA wal_checkpoint(TRUNCATE)").fetch_one(database).await?;
    Ok(busy == 0)
}

async fn state(database: &mut SqliteConnection) -> Result<(String, i64, i64), StoreError> {
    Ok(sqlx::query_as("SELECT store, changes, ended FROM store_log").fetch_one(database).await?)
}

/// Changes that were acknowledged and are not there any more.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Loss {
    /// Number of the first one, counted from the beginning of the store.
    pub first: i64,
    pub last: i64,
    /// When that was noticed; `null` where no daemon has been started since.
    #[schema(format = DateTime)]
    pub noticed_at: Option<String>,
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "changes {} to {} of the store are missing: jointbench.db-wal was removed or cut, or an older jointbench.db was \
             put in its place. Restore a backup if there is a newer one",
            self.first, self.last
        )
    }
}

/// What is missing, by the mark that was read before the database.
pub async fn missing(database: &mut SqliteConnection, mark: Option<&Mark>) -> Result<Option<Loss>, StoreError> {
    let (store, changes, _) = state(database).await?;
    let ahead = mark.filter(|mark| mark.store == store && mark.changes > changes);
    Ok(ahead.map(|mark| Loss { first: changes + 1, last: mark.changes, noticed_at: None }))
}

/// Losses that were noticed at a start, oldest first.
pub async fn losses(database: &mut SqliteConnection) -> Result<Vec<Loss>, StoreError> {
    let rows: Vec<(i64, i64, String)> =
        sqlx::query_as("SELECT first, last, noticed_at FROM store_losses ORDER BY id").fetch_all(database).await?;
    let loss = |(first, last, at)| Loss { first, last, noticed_at: Some(at) };
    Ok(rows.into_iter().map(loss).collect())
}

impl Store {
    /// Losses that were noticed at a start, oldest first.
    pub async fn losses(&self) -> Result<Vec<Loss>, StoreError> {
        losses(&mut *self.readers.acquire().await?).await
    }
}

/// To be called when the store is opened, before anything is written: says what is missing, keeps that, and blocks every
/// bench, since a stop may be among it.
pub(super) async fn look_back(database: &mut SqliteConnection, folder: &Path) -> Result<(), StoreError> {
    let mark = Mark::read(folder);
    let (store, ..) = state(database).await?;
    if let Some(other) = mark.as_ref().filter(|mark| mark.store != store) {
        tracing::error!(
            changes = other.changes,
            "jointbench.db is not the store that this folder held: that one was removed"
        );
    }
    let Some(loss) = missing(database, mark.as_ref()).await? else { return Ok(()) };
    tracing::error!("{loss}");
    let mut writer = database.begin_with("BEGIN IMMEDIATE").await?;
    sqlx::query("INSERT INTO store_losses (first, last, noticed_at) VALUES (?, ?, ?)")
        .bind(loss.first)
        .bind(loss.last)
        .bind(now())
        .execute(&mut *writer)
        .await?;
    // No number is given twice.
    sqlx::query("UPDATE store_log SET changes = ?").bind(loss.last).execute(&mut *writer).await?;
    let benches: Vec<String> =
        sqlx::query_scalar("SELECT bench FROM bench_safety UNION SELECT bench FROM runs WHERE procedure <> 'import'")
            .fetch_all(&mut *writer)
            .await?;
    let reason = format!("{loss}. A stop may be among them: look at the bench before it is released");
    for bench in benches {
        super::safety::block(&mut writer, &bench, &reason).await?;
    }
    Ok(writer.commit().await?)
}
