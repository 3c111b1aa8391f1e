//! One daemon for each data folder.
//!
//! There are two locks. The file `lock` names the process that uses the folder. The folder itself is locked too,
//! because it cannot be removed without the store. The database is never locked here: closing any descriptor of it
//! would release the locks of SQLite.

use super::StoreError;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::Path;

/// Locks the folder until it is released or dropped.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
    /// `None` if the system cannot lock a folder.
    folder: Option<File>,
}

impl FolderLock {
    /// Creates the folder if it is missing, and locks it.
    pub fn take(path: &Path) -> Result<Self, StoreError> {
        let unwritable = |fault: io::Error| StoreError::Unwritable { folder: path.into(), what: fault.to_string() };
        fs::create_dir_all(path).map_err(unwritable)?;
        let lock = path.join("lock");
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(lock).map_err(unwritable)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(in_use(path, &mut file)),
            Err(TryLockError::Error(fault)) => return Err(unwritable(fault)),
        }
        let folder = match lock_folder(path) {
            Ok(folder) => folder,
            // The holder's lock file was removed.
            Err(TryLockError::WouldBlock) => {
                return Err(StoreError::InUse { folder: path.into(), process: None });
            }
            Err(TryLockError::Error(fault)) => return Err(unwritable(fault)),
        };
        let named = file.set_len(0).and_then(|()| file.rewind()).and_then(|()| write!(file, "{}", std::process::id()));
        named.map_err(unwritable)?;
        Ok(Self { file, folder })
    }

    /// Also works while clones of the store exist.
    pub fn release(&self) -> io::Result<()> {
        self.file.unlock()?;
        self.folder.as_ref().map_or(Ok(()), File::unlock)
    }
}

#[cfg(unix)]
fn lock_folder(path: &Path) -> Result<Option<File>, TryLockError> {
    let folder = File::open(path).map_err(TryLockError::Error)?;
    match folder.try_lock() {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(TryLockError::WouldBlock),
        // Some network file systems lock only files.
        Err(TryLockError::Error(fault)) => {
            tracing::warn!(%fault, "the data folder itself cannot be locked: the file `lock` in it must stay");
            Ok(None)
        }
    }
}

#[cfg(not(unix))]
fn lock_folder(_: &Path) -> Result<Option<File>, TryLockError> {
    Ok(None)
}

fn in_use(folder: &Path, file: &mut File) -> StoreError {
    let mut holder = String::new();
    let process = file.read_to_string(&mut holder).ok().and_then(|_| holder.trim().parse().ok());
    StoreError::InUse { folder: folder.into(), process }
}
