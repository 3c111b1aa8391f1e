//! Opening: one daemon for each data folder, one schema, settings that keep what was committed.

use super::full_disk::{give_back, limit};
use super::migrations::Migrations;
use super::{Store, StoreError};
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{ConnectOptions, Connection, SqliteConnection, SqlitePool};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Marks the file as ours: "JBen".
const APPLICATION_ID: i64 = 0x4a42_656e;
/// Commits of the recorder stay under 1 ms in 99 of 100 cases with pages of this size.
const PAGE_BYTES: u32 = 16_384;
const FILE_NAME: &str = "jointbench.db";
/// Of each connection. Five of them must fit beside everything else in an address space of 1 GiB.
const MAPPED_BYTES: &str = "33554432";
const READERS: u32 = 4;
/// For a database that another program holds, and for the one connection that writes.
const PATIENCE: Duration = Duration::from_secs(5);

impl Store {
    /// Opens the store in `folder`, which is made where it is missing.
    pub async fn open(folder: &Path) -> Result<Store, StoreError> {
        let lock = lock(folder)?;
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
        let writer = writer(is_full.clone());
        let writer = writer.connect_with(options.clone()).await.map_err(|fault| not_ours(fault, &file))?;
        migrate(&writer, &file).await?;
        give_back(&mut *writer.acquire().await?).await?;
        let readers = pool(READERS).connect_with(options.read_only(true)).await?;
        Ok(Store { writer, readers, lock: Some(Arc::new(lock)), is_full })
    }

    /// Opens the store beside the daemon that has it, to read: what was committed is there, and nothing can be written.
    pub async fn open_to_read(folder: &Path) -> Result<Store, StoreError> {
        let file = folder.join(FILE_NAME);
        let options = SqliteConnectOptions::new()
            .filename(&file)
            .read_only(true)
            .busy_timeout(Duration::from_secs(5))
            .pragma("mmap_size", MAPPED_BYTES)
            .disable_statement_logging();
        let readers = pool(2).connect_with(options).await.map_err(|fault| not_ours(fault, &file))?;
        Ok(Store { writer: readers.clone(), readers, lock: None, is_full: Arc::default() })
    }

    /// Whether a store was made in the folder.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(FILE_NAME).is_file()
    }

    /// Waits for what is under way and lets the file go. A store that is never closed loses nothing that was committed.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
        // Clones of the store may live on, in requests for example: the folder is free all the same.
        if let Some(Err(fault)) = self.lock.as_ref().map(|lock| lock.unlock()) {
            tracing::warn!(%fault, "the data folder stays locked until the process ends");
        }
    }
}

fn pool(most: u32) -> SqlitePoolOptions {
    SqlitePoolOptions::new().max_connections(most).idle_timeout(None).max_lifetime(None).acquire_timeout(PATIENCE)
}

/// The one connection that writes. On a full disk SQLite may end a transaction by itself; to sqlx it is still on then, and none
/// could begin any more: such a connection is exchanged for another.
fn writer(is_full: Arc<AtomicBool>) -> SqlitePoolOptions {
    let writer = pool(1).after_connect(move |connection, _| {
        let full = is_full.load(Ordering::Acquire);
        Box::pin(limit(connection, full))
    });
    writer.after_release(|connection, _| {
        Box::pin(async move {
            // Behind the rollback of what was given up.
            connection.ping().await?;
            Ok(!connection.is_in_transaction())
        })
    })
}

fn lock(folder: &Path) -> Result<File, StoreError> {
    let unwritable = |fault: std::io::Error| StoreError::Unwritable { folder: folder.into(), what: fault.to_string() };
    fs::create_dir_all(folder).map_err(unwritable)?;
    let path = folder.join("lock");
    let mut file =
        OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(unwritable)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let mut holder = String::new();
            let holder = match file.read_to_string(&mut holder) {
                Ok(_) if !holder.trim().is_empty() => format!(" (process {})", holder.trim()),
                _ => String::new(),
            };
            return Err(StoreError::InUse { folder: folder.into(), holder });
        }
        Err(TryLockError::Error(fault)) => return Err(unwritable(fault)),
    }
    let told = file.set_len(0).and_then(|()| file.rewind()).and_then(|()| write!(file, "{}", std::process::id()));
    told.map_err(unwritable)?;
    Ok(file)
}

fn not_ours(fault: sqlx::Error, file: &Path) -> StoreError {
    match StoreError::from(fault) {
        StoreError::Damaged(_) => StoreError::Foreign { file: file.into() },
        other => StoreError::Unwritable { folder: file.into(), what: other.to_string() },
    }
}

/// A file that somebody else's program made is not touched.
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
    // 0x4a42656e; a pragma takes no parameters.
    sqlx::query("PRAGMA application_id = 1245865326").execute(writer).await?;
    Ok(())
}
