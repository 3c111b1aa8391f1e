//! Backup of the store into one file, and restore from it.

use super::lock::FolderLock;
use super::open::{FILE_NAME, file_to_read, to_read};
use super::verify::{VerifyReport, verify_file};
use super::{Store, StoreError};
use jiff::Timestamp;
use sqlx::Connection;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Writes all committed data to a new file, also during a run, and checks the copy.
///
/// # Errors
/// [`StoreError::Copy`] if the file exists already or cannot be written.
pub async fn backup(folder: &Path, file: &Path) -> Result<VerifyReport, StoreError> {
    let cannot = |what: String| StoreError::Copy { file: file.into(), what };
    if file.exists() {
        return Err(cannot("it exists already: choose another name".into()));
    }
    let mut database = to_read(folder).await?;
    let target = file.to_str().ok_or_else(|| cannot("its name is not UTF-8".into()))?;
    sqlx::query("VACUUM INTO ?").bind(target).execute(&mut database).await?;
    database.close().await?;
    File::open(file).and_then(|file| file.sync_all()).map_err(|fault| cannot(fault.to_string()))?;
    verify_file(file).await
}

/// Replaces the store by a backup, in a folder that no daemon uses. Moves the old store into a subfolder and returns
/// the path of that subfolder. Blocks every bench if the backup lacks changes that the folder has held.
///
/// # Errors
/// [`StoreError::InUse`] if a daemon uses the folder; [`StoreError::Damaged`] if the backup is damaged.
pub async fn restore(folder: &Path, file: &Path) -> Result<Option<PathBuf>, StoreError> {
    file_to_read(file).await?.close().await?;
    let report = verify_file(file).await?;
    if let Some(first) = report.damaged.first() {
        let (table, what) = (&first.table, &first.what);
        return Err(StoreError::damaged(what).at(|| format!("{}: {table}", file.display())));
    }
    let lock = FolderLock::take(folder)?;
    let aside = move_aside(folder).and_then(|aside| put_in_place(folder, file).map(|()| aside));
    let aside = aside.map_err(|fault| StoreError::Unwritable { folder: folder.into(), what: fault.to_string() })?;
    drop(lock);
    // Opening detects the changes that the backup lacks.
    Store::open(folder).await?.close().await;
    Ok(aside)
}

fn move_aside(folder: &Path) -> io::Result<Option<PathBuf>> {
    let names = ["", "-wal", "-shm"].map(|ending| format!("{FILE_NAME}{ending}"));
    let there: Vec<&String> = names.iter().filter(|name| folder.join(name).exists()).collect();
    if there.is_empty() {
        return Ok(None);
    }
    let aside = folder.join(format!("replaced-{}", Timestamp::now().strftime("%Y%m%dT%H%M%S%3fZ")));
    fs::create_dir(&aside)?;
    there.into_iter().try_for_each(|name| fs::rename(folder.join(name), aside.join(name)))?;
    Ok(Some(aside))
}

fn put_in_place(folder: &Path, file: &Path) -> io::Result<()> {
    let part = folder.join(format!("{FILE_NAME}.part"));
    fs::copy(file, &part)?;
    File::open(&part)?.sync_all()?;
    fs::rename(part, folder.join(FILE_NAME))?;
    #[cfg(unix)]
    File::open(folder)?.sync_all()?;
    Ok(())
}
