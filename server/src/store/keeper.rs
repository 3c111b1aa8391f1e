//! A background task: it marks the last durable change, and checkpoints the write-ahead log after a run has ended. No
//! commit waits for it.

use super::mark::{Mark, MarkFile};
use super::values::now;
use super::{Store, StoreError};
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, SqliteConnection, SqlitePool};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tokio::sync::{Mutex, watch};
use tokio::task::JoinHandle;
use utoipa::ToSchema;

/// Waiting time for a database that another program has locked, and for the one writer connection.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// The hook runs before its commit is on the disk. The keeper checks after this pause and doubles it each time.
const FIRST_PAUSE: Duration = Duration::from_millis(2);
/// Limit of the pause, for transactions that change nothing that is counted.
const LONGEST_PAUSE: Duration = Duration::from_secs(4);
/// Interval between attempts while a reader or a writer prevents the checkpoint.
const RETRY: Duration = Duration::from_millis(250);

/// Message of the writer's commits to the keeper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Number of transactions that are committed or about to be.
    Commits(u64),
    End,
}

impl Signal {
    /// The signal after one more transaction; `End` remains.
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
    pub async fn start(
        options: &SqliteConnectOptions,
        writer: SqlitePool,
        folder: PathBuf,
        signals: Signals,
    ) -> Result<Self, StoreError> {
        let database = options.connect().await?;
        let file =
            MarkFile::open(&folder).map_err(|fault| StoreError::Unwritable { folder, what: fault.to_string() })?;
        let mut work = Work { database, writer, file, marked: -1, ended: 0, is_due: true };
        work.turn().await?;
        let task = tokio::spawn(work.run(signals.subscribe()));
        Ok(Self { signals, task: Mutex::new(Some(task)) })
    }

    /// Ends the task. Its connection is the last one: closing it removes the write-ahead log.
    pub async fn end(&self) {
        self.signals.send_replace(Signal::End);
        if let Some(task) = self.task.lock().await.take()
            && let Err(fault) = task.await
        {
            tracing::warn!(%fault, "the last change was not marked");
        }
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        if let Some(task) = self.task.get_mut().take() {
            task.abort();
        }
    }
}

struct Work {
    /// Only for reading.
    database: SqliteConnection,
    writer: SqlitePool,
    file: MarkFile,
    /// The last change that was marked.
    marked: i64,
    /// Number of runs that had ended at the last check.
    ended: i64,
    is_due: bool,
}

impl Work {
    async fn run(mut self, mut signals: watch::Receiver<Signal>) {
        // Time until the next check, while a commit may be in progress.
        let mut pause = None;
        loop {
            tokio::select! {
                changed = signals.changed() => {
                    if changed.is_err() {
                        break;
                    }
                    pause = Some(FIRST_PAUSE);
                }
                () = tokio::time::sleep(pause.unwrap_or(RETRY)), if pause.is_some() || self.is_due => {}
            }
            let ends = *signals.borrow_and_update() == Signal::End;
            if let Err(fault) = self.turn().await {
                tracing::warn!(%fault, "the last change was not marked");
            }
            // The change that was found may be older than the signal: continue to check.
            pause = pause.map(|pause| pause * 2).filter(|pause| *pause <= LONGEST_PAUSE);
            if ends {
                break;
            }
        }
        if let Err(fault) = self.database.close().await {
            tracing::warn!(%fault, "the database was not closed in an orderly way");
        }
    }

    async fn turn(&mut self) -> Result<(), StoreError> {
        self.mark_last_change().await?;
        // Uses the writer's own connection, so that no transaction of it finds the database locked.
        if self.is_due
            && let Some(mut writer) = self.writer.try_acquire()
        {
            self.is_due = !checkpoint(&mut writer).await?;
        }
        Ok(())
    }

    /// Marks the last change. A change that a reader sees is on the disk.
    async fn mark_last_change(&mut self) -> Result<(), StoreError> {
        let (store, changes, ended) = state(&mut self.database).await?;
        self.is_due |= ended > self.ended;
        self.ended = ended;
        if changes == self.marked {
            return Ok(());
        }
        let written = self.file.write(&Mark { store, changes });
        written.map_err(|fault| StoreError::Database(format!("jointbench.mark: {fault}")))?;
        self.marked = changes;
        Ok(())
    }
}

/// Moves the write-ahead log into the database and empties it. `false` if a reader is active.
async fn checkpoint(writer: &mut SqliteConnection) -> Result<bool, StoreError> {
    sqlx::query("PRAGMA busy_timeout = 0").execute(&mut *writer).await?;
    let done = sqlx::query_as::<_, (i64, i64, i64)>("PRAGMA wal_checkpoint(TRUNCATE)").fetch_one(&mut *writer).await;
    let patience = format!("PRAGMA busy_timeout = {}", PATIENCE.as_millis());
    sqlx::query(AssertSqlSafe(patience)).execute(writer).await?;
    let (busy, _, _) = done?;
    Ok(busy == 0)
}

async fn state(database: &mut SqliteConnection) -> Result<(String, i64, i64), StoreError> {
    Ok(sqlx::query_as("SELECT store, changes, ended FROM store_log").fetch_one(database).await?)
}

/// Acknowledged changes that were lost.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Loss {
    /// Number of the first lost change, counted from the creation of the store.
    pub first: i64,
    pub last: i64,
    /// Time of detection; `null` before the next start of the daemon.
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

/// The changes that are missing, according to a mark that was read before the database.
pub async fn missing(database: &mut SqliteConnection, mark: Option<&Mark>) -> Result<Option<Loss>, StoreError> {
    let (store, changes, _) = state(database).await?;
    let ahead = mark.filter(|mark| mark.store == store && mark.changes > changes);
    Ok(ahead.map(|mark| Loss { first: changes + 1, last: mark.changes, noticed_at: None }))
}

/// Losses that were detected when the store was opened, oldest first.
pub async fn losses(database: &mut SqliteConnection) -> Result<Vec<Loss>, StoreError> {
    let rows: Vec<(i64, i64, String)> =
        sqlx::query_as("SELECT first, last, noticed_at FROM store_losses ORDER BY id").fetch_all(database).await?;
    let loss = |(first, last, at)| Loss { first, last, noticed_at: Some(at) };
    Ok(rows.into_iter().map(loss).collect())
}

impl Store {
    pub async fn losses(&self) -> Result<Vec<Loss>, StoreError> {
        losses(&mut *self.readers.acquire().await?).await
    }

    /// Blocks these benches too if changes were lost: the store may not know them.
    pub async fn block_where_missing(&self, benches: impl IntoIterator<Item = &str>) -> Result<(), StoreError> {
        let Some(loss) = &self.missing else { return Ok(()) };
        for bench in benches {
            if self.bench_block(bench).await?.is_none() {
                self.block_bench(bench, None, &reason(loss)).await?;
            }
        }
        Ok(())
    }
}

/// Call it when the store is opened, before the first write. It logs and stores the missing changes and blocks every
/// bench, because a stop may be missing.
pub(super) async fn find_loss(database: &mut SqliteConnection, folder: &Path) -> Result<Option<Loss>, StoreError> {
    let mark = Mark::read(folder);
    let (store, ..) = state(database).await?;
    if let Some(other) = mark.as_ref().filter(|mark| mark.store != store) {
        tracing::error!(
            changes = other.changes,
            "jointbench.db is not the store that this folder held: that one was removed"
        );
    }
    let Some(loss) = missing(database, mark.as_ref()).await? else { return Ok(None) };
    tracing::error!("{loss}");
    let mut writer = database.begin_with("BEGIN IMMEDIATE").await?;
    sqlx::query("INSERT INTO store_losses (first, last, noticed_at) VALUES (?, ?, ?)")
        .bind(loss.first)
        .bind(loss.last)
        .bind(now())
        .execute(&mut *writer)
        .await?;
    // The numbers of lost changes are not used again.
    sqlx::query("UPDATE store_log SET changes = ?").bind(loss.last).execute(&mut *writer).await?;
    super::safety::block_all(&mut writer, &reason(&loss)).await?;
    writer.commit().await?;
    Ok(Some(loss))
}

fn reason(loss: &Loss) -> String {
    format!("{loss}. A stop may be among them: look at the bench before it is released")
}
