//! Data that a worker could not send to the store because the server part of the daemon had ended. A file in the data
//! folder holds it; the next start stores the data and removes the file.

use super::wire::{Entry, receive, send};
use crate::store::{SafetyRecord, Store, StoreError};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FOLDER: &str = "unstored";
const ENDING: &str = "msgpack";
/// Extension of an incomplete file.
const UNFINISHED: &str = "part";
const LOST_STOP: &str =
    "a file in the folder unstored is damaged or unfinished; a stop may be lost: inspect the bench before the reset";
/// Extension of a file with commits that the store refused. It is kept for a person and not read again.
const NO_PLACE: &str = "no-place";

#[derive(Serialize, Deserialize)]
struct Leftovers {
    bench: String,
    block: Option<SafetyRecord>,
    entries: Vec<Arc<Entry>>,
}

/// Writes unstored data, if any, to a file and returns its path. A write error is logged and the data is lost.
pub(super) fn leave(data: &Path, bench: &str, block: Option<SafetyRecord>, entries: &[Arc<Entry>]) -> Option<PathBuf> {
    if block.is_none() && entries.is_empty() {
        return None;
    }
    let rows: usize = entries.iter().map(|entry| entry.commit.rows.len()).sum();
    let left = Leftovers { bench: bench.to_owned(), block, entries: entries.to_vec() };
    match write(&data.join(FOLDER), &left) {
        Ok(path) => {
            tracing::warn!(bench, rows, file = %path.display(), "kept in a file until the store has it");
            Some(path)
        }
        Err(fault) => {
            tracing::error!(bench, rows, %fault, "what is not yet stored cannot be written to a file");
            None
        }
    }
}

/// Atomic: writes data and digest to a temporary file, and renames it after it is on the disk.
fn write(folder: &Path, left: &Leftovers) -> io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let mut body = Vec::new();
    send(&mut body, left)?;
    let stamp = Timestamp::now().strftime("%Y%m%dT%H%M%S%6fZ");
    let path = folder.join(format!("{}-{stamp}.{ENDING}", file_name(&left.bench)));
    let unfinished = path.with_extension(UNFINISHED);
    let mut file = File::create(&unfinished)?;
    file.write_all(&Sha256::digest(&body))?;
    file.write_all(&body)?;
    file.sync_all()?;
    fs::rename(&unfinished, &path)?;
    File::open(folder)?.sync_all()?;
    Ok(path)
}

/// The name of a bench as a file name.
pub(super) fn file_name(bench: &str) -> String {
    percent_encoding::utf8_percent_encode(bench, percent_encoding::NON_ALPHANUMERIC).to_string()
}

fn read(path: &Path) -> io::Result<Leftovers> {
    let bytes = fs::read(path)?;
    let damaged = || io::Error::new(ErrorKind::InvalidData, "its checksum is wrong");
    let (digest, body) = bytes.split_at_checked(Sha256::output_size()).ok_or_else(damaged)?;
    if digest != Sha256::digest(body).as_slice() {
        return Err(damaged());
    }
    receive(&mut &*body)?.ok_or_else(damaged)
}

/// Stores the files that workers left in the data folder. A file with refused commits, a damaged file and an incomplete
/// file are renamed. After the latter two, a stop may be lost: the benches are blocked.
///
/// # Errors
/// Errors of the store; the file remains for the next start.
pub async fn store_all(data: &Path, store: &Store) -> Result<(), StoreError> {
    let Ok(found) = fs::read_dir(data.join(FOLDER)) else { return Ok(()) };
    let mut files: Vec<PathBuf> = found.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == ENDING || ending == UNFINISHED));
    files.sort();
    for path in files {
        let finished = path.extension().is_some_and(|ending| ending == ENDING);
        let left = if finished { read(&path) } else { Err(ErrorKind::UnexpectedEof.into()) };
        match left {
            Ok(left) => {
                let done = match store_one(left, store).await? {
                    true => fs::remove_file(&path),
                    false => fs::rename(&path, path.with_extension(NO_PLACE)),
                };
                if let Err(fault) = done {
                    tracing::warn!(file = %path.display(), %fault, "the file remains and is read again at the next start");
                }
            }
            Err(fault) => {
                tracing::error!(file = %path.display(), %fault, "what a worker has left cannot be read");
                store.block_benches(LOST_STOP).await?;
                if let Err(fault) = fs::rename(&path, path.with_extension(NO_PLACE)) {
                    tracing::warn!(file = %path.display(), %fault, "not set aside");
                }
            }
        }
    }
    Ok(())
}

/// Whether the store accepted every commit.
async fn store_one(left: Leftovers, store: &Store) -> Result<bool, StoreError> {
    use StoreError as E;
    let Leftovers { bench, block, entries } = left;
    let mut all_placed = true;
    for entry in &entries {
        match store.commit_all(&[&entry.commit]).await {
            // The run is already ended, or an earlier commit is missing. The daemon starts anyway.
            Err(fault @ (E::RunOver { .. } | E::NoRun(_) | E::CommitMissing { .. } | E::OtherChannels { .. })) => {
                tracing::error!(run.id = entry.commit.run, %fault, "what a worker has left has no place");
                all_placed = false;
            }
            done => done?,
        }
    }
    if let Some(block) = block {
        store.keep_block(&bench, &block).await?;
    }
    tracing::warn!(bench, entries = entries.len(), all_placed, "what a worker had left is stored");
    Ok(all_placed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::RunCommit;
    use jointbench_instrument::{Channel, Trace};
    use jointbench_procedure::RunState;

    fn entry(number: u64) -> Arc<Entry> {
        let rows = Trace::from_columns(vec![Channel::new("time_s")], vec![vec![0.0, 0.1]]);
        Arc::new(Entry {
            number,
            commit: RunCommit { run: 1, number, state: RunState::Running, events: Vec::new(), rows },
        })
    }

    #[test]
    fn leftovers_are_read_back_and_a_damaged_file_is_refused() {
        let data = tempfile::tempdir().unwrap();
        leave(data.path(), "a/b", None, &[]);
        assert!(!data.path().join(FOLDER).exists(), "nothing is left where nothing waits");
        leave(data.path(), "a/b", None, &[entry(1), entry(2)]);
        let path = fs::read_dir(data.path().join(FOLDER)).unwrap().next().unwrap().unwrap().path();
        let left = read(&path).unwrap();
        assert_eq!((left.bench.as_str(), left.entries), ("a/b", vec![entry(1), entry(2)]));
        let mut bytes = fs::read(&path).unwrap();
        *bytes.last_mut().unwrap() ^= 1;
        fs::write(&path, bytes).unwrap();
        assert!(read(&path).is_err());
    }

    #[tokio::test]
    async fn refused_leftovers_are_set_aside_and_the_daemon_starts() {
        let data = tempfile::tempdir().unwrap();
        let store = Store::open(data.path()).await.unwrap();
        leave(data.path(), "a", None, &[entry(1), entry(3)]);
        store_all(data.path(), &store).await.unwrap();
        let left: Vec<PathBuf> =
            fs::read_dir(data.path().join(FOLDER)).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert_eq!(left.len(), 1, "{left:?}");
        assert_eq!(left[0].extension().unwrap(), NO_PLACE);
        assert_eq!(read(&left[0]).unwrap().entries.len(), 2, "nothing of it is lost");
        store_all(data.path(), &store).await.unwrap();
    }

    #[tokio::test]
    async fn a_file_that_was_never_finished_blocks_the_benches_once() {
        let data = tempfile::tempdir().unwrap();
        let store = Store::open(data.path()).await.unwrap();
        store.block_bench("a", None, "stop").await.unwrap();
        let count = async || store.safety("a", 99).await.unwrap().len();
        fs::create_dir_all(data.path().join(FOLDER)).unwrap();
        fs::write(data.path().join(FOLDER).join("a-1.part"), b"cut").unwrap();
        store_all(data.path(), &store).await.unwrap();
        assert_eq!(count().await, 2);
        assert_eq!(store.safety("a", 1).await.unwrap()[0].reason, LOST_STOP);
        store_all(data.path(), &store).await.unwrap();
        assert_eq!(count().await, 2, "it is set aside");
    }
}
