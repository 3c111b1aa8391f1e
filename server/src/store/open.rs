//! Opening: one daemon for each data folder, one schema, durable commits.

use super::full_disk::{limit, release_pages};
use super::health::StoreHealth;
use super::keeper::{Keeper, PATIENCE, Signal, Signals, find_loss, losses};
use super::lock::FolderLock;
use super::migrations::Migrations;
use super::{Store, StoreError};
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{ConnectOptions, Connection, SqliteConnection, SqlitePool};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, RwLock};
use std::time::Duration;

/// Identifies the file as a store of jointbench: "JBen".
const APPLICATION_ID: i64 = 0x4a42_656e;
/// With pages of this size, 99 % of the recorder's commits need less than 1 ms.
const PAGE_BYTES: u32 = 16_384;
pub(super) const FILE_NAME: &str = "jointbench.db";
/// For each connection. Five connections and all other memory must fit into an address space of 1 GiB.
const MAPPED_BYTES: &str = "33554432";
const READERS: u32 = 4;
/// Waiting time of a reader in a separate process, which runs only when the daemon leaves processor time: longer than the
/// time limit of a computation, which ends the process.
const READER_PATIENCE: Duration = Duration::from_secs(3600);

impl Store {
    /// Opens the store in `folder`. Creates the folder if it is missing.
    pub async fn open(folder: &Path) -> Result<Store, StoreError> {
        let lock = FolderLock::take(folder)?;
        let file = folder.join(FILE_NAME);
        let options = SqliteConnectOptions::new()
            .filename(&file)
            .create_if_missing(true)
            .foreign_keys(true)
            .busy_timeout(PATIENCE)
            .pragma("mmap_size", MAPPED_BYTES)
            .disable_statement_logging();

        let mut first = options.clone().connect().await.map_err(|fault| not_ours(fault, &file))?;
        check_ours(&mut first, &file).await?;
        first.close().await?;

        let options = options.page_size(PAGE_BYTES).journal_mode(SqliteJournalMode::Wal);
        let options = options.synchronous(SqliteSynchronous::Full);
        let is_full = Arc::<AtomicBool>::default();
        let (signals, _) = tokio::sync::watch::channel(Signal::Commits(0));
        let writer = writer(is_full.clone(), signals.clone());
        let writer = writer.connect_with(options.clone()).await.map_err(|fault| not_ours(fault, &file))?;
        migrate(&writer, &file).await?;
        release_pages(&mut *writer.acquire().await?).await?;
        let missing = find_loss(&mut *writer.acquire().await?, folder).await?;
        let keeper = Keeper::start(&options, writer.clone(), folder.into(), signals).await?;
        let readers = pool(READERS).connect_with(options.read_only(true)).await?;
        let lost = losses(&mut *readers.acquire().await?).await?;
        let health = Arc::new(RwLock::new(StoreHealth { lost, ..StoreHealth::default() }));
        let (lock, keeper) = (Some(Arc::new(lock)), Some(Arc::new(keeper)));
        Ok(Store { writer, readers, lock, keeper, health, missing, is_full })
    }

    /// Opens the store read-only, also while a daemon uses it. All committed data is visible.
    pub async fn open_to_read(folder: &Path) -> Result<Store, StoreError> {
        let file = folder.join(FILE_NAME);
        let options = SqliteConnectOptions::new()
            .filename(&file)
            .read_only(true)
            .busy_timeout(PATIENCE)
            .pragma("mmap_size", MAPPED_BYTES)
            .disable_statement_logging();
        let readers = pool(2).acquire_timeout(READER_PATIENCE).connect_with(options).await;
        let readers = readers.map_err(|fault| not_ours(fault, &file))?;
        let health = Arc::default();
        Ok(Store {
            writer: readers.clone(),
            readers,
            lock: None,
            keeper: None,
            health,
            missing: None,
            is_full: Arc::default(),
        })
    }

    /// Whether the folder contains a store.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(FILE_NAME).is_file()
    }

    /// Waits for work in progress and closes the file. A store that is not closed keeps all committed data.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
        if let Some(keeper) = &self.keeper {
            keeper.end().await;
        }
        // Clones of the store may remain, for example in requests; the folder is released anyway.
        if let Some(Err(fault)) = self.lock.as_ref().map(|lock| lock.release()) {
            tracing::warn!(%fault, "the data folder stays locked until the process ends");
        }
    }
}

/// A read-only connection, also while a daemon uses the folder.
pub(super) async fn to_read(folder: &Path) -> Result<SqliteConnection, StoreError> {
    if !Store::is_in(folder) {
        return Err(StoreError::NoStore { folder: folder.into() });
    }
    file_to_read(&folder.join(FILE_NAME)).await
}

/// The same for a database file at any path.
pub(super) async fn file_to_read(file: &Path) -> Result<SqliteConnection, StoreError> {
    let options = SqliteConnectOptions::new().filename(file).read_only(true).busy_timeout(PATIENCE);
    let connected = options.disable_statement_logging().connect().await;
    let mut database = connected.map_err(|fault| not_ours(fault, file))?;
    check_ours(&mut database, file).await?;
    Ok(database)
}

fn pool(most: u32) -> SqlitePoolOptions {
    SqlitePoolOptions::new().max_connections(most).idle_timeout(None).max_lifetime(None).acquire_timeout(PATIENCE)
}

/// The one writer connection. On a full disk SQLite may end a transaction by itself. sqlx does not notice this and
/// could begin no other transaction, so such a connection is replaced.
fn writer(is_full: Arc<AtomicBool>, signals: Signals) -> SqlitePoolOptions {
    let writer = pool(1).after_connect(move |connection, _| {
        let (full, signals) = (is_full.load(Ordering::Acquire), signals.clone());
        Box::pin(async move {
            limit(connection, full).await?;
            connection.lock_handle().await?.set_commit_hook(move || {
                signals.send_modify(|signal| *signal = signal.next());
                true
            });
            Ok(())
        })
    });
    writer.after_release(|connection, _| {
        Box::pin(async move {
            // Waits for the rollback of an abandoned transaction.
            connection.ping().await?;
            Ok(!connection.is_in_transaction())
        })
    })
}

fn not_ours(fault: sqlx::Error, file: &Path) -> StoreError {
    match StoreError::from(fault) {
        passing @ (StoreError::Held | StoreError::DiskFull) => passing,
        StoreError::Damaged(_) => StoreError::Foreign { file: file.into() },
        other => StoreError::Unwritable { folder: file.into(), what: other.to_string() },
    }
}

/// Refuses a file of another program.
async fn check_ours(connection: &mut SqliteConnection, file: &Path) -> Result<(), StoreError> {
    let foreign = |fault: sqlx::Error| not_ours(fault, file);
    let mark: i64 = sqlx::query_scalar("PRAGMA application_id").fetch_one(&mut *connection).await.map_err(foreign)?;
    let tables: i64 =
        sqlx::query_scalar("SELECT COUNT(*) FROM sqlite_schema").fetch_one(connection).await.map_err(foreign)?;
    match (mark, tables) {
        (APPLICATION_ID, _) | (0, 0) => Ok(()),
        _ => Err(StoreError::Foreign { file: file.into() }),
    }
}

async fn migrate(writer: &SqlitePool, file: &Path) -> Result<(), StoreError> {
    let migrator = Migrator::new(Migrations).await.map_err(|fault| StoreError::Database(fault.to_string()))?;
    migrator.run(writer).await.map_err(|fault| match fault {
        MigrateError::VersionMissing(schema) => StoreError::Newer { file: file.into(), schema },
        MigrateError::VersionMismatch(_) | MigrateError::VersionTooOld(..) | MigrateError::Dirty(_) => {
            StoreError::Old { file: file.into(), what: fault.to_string() }
        }
        MigrateError::Execute(fault) => fault.into(),
        other => StoreError::Database(other.to_string()),
    })?;
    // 0x4a42656e: a pragma accepts no parameters.
    sqlx::query("PRAGMA application_id = 1245865326").execute(writer).await?;
    Ok(())
}
