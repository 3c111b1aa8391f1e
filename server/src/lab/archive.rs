//! The archive: one task writes what ended runs owe, one table after the other. No run, stop or request waits for it.

use super::background::{LOOK, Tasks, pause};
use super::computation::json;
use super::{Answer, Lab, LabError};
use crate::config::{Archive, ArchiveContent};
use crate::job::{ArchiveRequest, ArchivedFile, Job};
use crate::store::{ArchiveEnd, ArchiveRecord, Store};
use crate::view::{ArchiveState, ArchivedTable, archived_table, reread};
use jiff::{SignedDuration, Timestamp};
use tokio::sync::Notify;

/// A table that exceeds the limit of memory or time as often as this is given up.
const MOST_TOO_LARGE: u32 = 8;

/// The archive and its task.
#[derive(Default)]
pub(super) struct Archiving {
    archive: Option<Archive>,
    task: Tasks,
    /// A person asked for an attempt now.
    released: Notify,
}

impl Archiving {
    /// From now on each run that ends owes the tables of the archive.
    pub async fn open(archive: Option<Archive>, store: &Store) -> Answer<Self> {
        let contents = archive.as_ref().map_or(&[][..], Archive::contents);
        let contents: Vec<String> = contents.iter().map(|content| content.name().to_owned()).collect();
        let removed = store.set_archive_contents(&contents).await?;
        if removed > 0 {
            tracing::warn!(removed, "tables that the bench description no longer archives");
        }
        Ok(Self { archive, ..Self::default() })
    }

    pub fn abort(&self) {
        self.task.abort();
    }
}

impl Lab {
    pub(super) fn open_archive(&self) {
        let lab = self.clone();
        self.inner.archiving.task.spawn(async move {
            if let Err(fault) = lab.inner.store.complete_drops().await {
                tracing::error!(%fault, "the removal of archived samples is not complete");
            }
            if let Some(archive) = lab.inner.archiving.archive.clone() {
                lab.serve_archive(&archive).await;
            }
        });
    }

    async fn serve_archive(&self, archive: &Archive) {
        // Failed attempts since the last success: an archive that is away gets few attempts, also for many tables.
        let mut failures = 0;
        loop {
            let wait = match self.archive_next(archive).await {
                Ok(None) => LOOK,
                Ok(Some(true)) => {
                    failures = 0;
                    continue;
                }
                Ok(Some(false)) => {
                    failures += 1;
                    pause(failures - 1)
                }
                Err(fault) => {
                    tracing::error!(%fault, "the archive waits");
                    LOOK
                }
            };
            tokio::select! {
                () = tokio::time::sleep(wait) => {}
                () = self.inner.archiving.released.notified() => failures = 0,
            }
        }
    }

    /// One attempt for the table that is due. Returns whether it has ended; `None` if no table is due.
    async fn archive_next(&self, archive: &Archive) -> Answer<Option<bool>> {
        let store = &self.inner.store;
        let Some(record) = store.next_archive().await? else { return Ok(None) };
        let ArchiveRecord { run, content, attempts, .. } = record;
        let request = ArchiveRequest { run, content: reread(&content)?, folder: archive.folder.clone() };
        let end = match self.compute(Job::Archive(request)).await {
            Ok(end) => end,
            Err(LabError::Conflict(reason)) => ArchiveEnd::Failed(reason),
            Err(LabError::TooLarge(reason)) if attempts + 1 >= MOST_TOO_LARGE => ArchiveEnd::Failed(reason),
            Err(fault) => {
                tracing::warn!(run.id = run, content, %fault, "not archived, it is repeated");
                store.retry_archive(run, &content, Timestamp::now() + pause(attempts), &fault.to_string()).await?;
                return Ok(Some(false));
            }
        };
        match &end {
            ArchiveEnd::Archived { path, bytes, .. } => tracing::info!(run.id = run, path, bytes, "archived"),
            ArchiveEnd::Empty(reason) => tracing::info!(run.id = run, content, reason, "nothing to archive"),
            ArchiveEnd::Failed(reason) => tracing::error!(run.id = run, content, reason, "not archived"),
        }
        while let Err(fault) = store.end_archive(run, &content, &end).await {
            tracing::error!(%fault, "the result of the archive is not yet stored");
            tokio::time::sleep(LOOK).await;
        }
        Ok(Some(true))
    }

    pub async fn archive(&self) -> Answer<ArchiveState> {
        let counts = self.inner.store.archive_counts().await?;
        let archive = self.inner.archiving.archive.as_ref();
        Ok(ArchiveState {
            url: archive.map(|archive| archive.url.clone()),
            raw: archive.is_some_and(|archive| archive.raw),
            owed: counts.owed,
            archived: counts.archived,
            empty: counts.empty,
            failed: counts.failed,
            dropped: counts.dropped,
            oldest_owed: counts.oldest_owed,
            last_error: counts.last_error,
        })
    }

    /// Tries all tables that are owed or failed again, now.
    pub async fn retry_archive(&self) -> Answer<ArchiveState> {
        self.inner.store.release_archive().await?;
        self.inner.archiving.released.notify_one();
        self.archive().await
    }

    pub(super) async fn archive_of(&self, run: i64) -> Answer<Vec<ArchivedTable>> {
        let records = self.inner.store.archive_of(run).await?;
        Ok(records.into_iter().map(archived_table).collect::<Result<_, _>>()?)
    }

    /// Archived samples that the store still holds, of runs that ended at least this time ago.
    pub async fn droppable_samples(&self, older_than_s: f64) -> Answer<Vec<ArchivedTable>> {
        let age = SignedDuration::try_from_secs_f64(older_than_s).ok().filter(|age| !age.is_negative());
        let before = age.and_then(|age| Timestamp::now().checked_sub(age).ok());
        let before = before.ok_or_else(|| {
            LabError::Invalid(format!("older_than_s = {older_than_s}: enter a time in seconds, such as 7776000"))
        })?;
        let mut tables = Vec::new();
        for record in self.inner.store.droppable_samples(before).await? {
            if !self.is_needed(record.run).await? {
                tables.push(archived_table(record)?);
            }
        }
        Ok(tables)
    }

    /// Reads the file of the archive once more, then removes the samples from the store. The result is kept.
    pub async fn drop_samples(&self, id: i64, by: &str) -> Answer<ArchivedTable> {
        if self.is_needed(id).await? {
            return Err(LabError::Conflict(format!("other runs need the samples of run {id}: they stay")));
        }
        let records = self.inner.store.archive_of(id).await?;
        let samples = records.into_iter().find(|record| record.content == ArchiveContent::Samples.name());
        let Some(ArchiveRecord { folder: Some(folder), path: Some(path), sha256: Some(sha256), dropped_at, .. }) =
            samples
        else {
            return Err(LabError::Conflict(format!(
                "the samples of run {id} are not archived: they stay in the store"
            )));
        };
        let mut result = None;
        if dropped_at.is_none() {
            result = match self.identification(id).await {
                Ok(found) => Some(json(&found)?),
                // Such as a run that was stopped before its measurement.
                Err(LabError::NotFound(_) | LabError::Invalid(_)) => None,
                Err(fault) => return Err(fault),
            };
            self.compute::<()>(Job::CheckArchived(ArchivedFile { folder, path, sha256 })).await?;
            tracing::warn!(run.id = id, by, "archived samples are removed from the store");
        }
        self.inner.store.drop_samples(id, result.as_deref()).await?;
        let tables = self.archive_of(id).await?;
        let dropped = tables.into_iter().find(|table| table.content == ArchiveContent::Samples);
        dropped.ok_or_else(|| LabError::no_run(id))
    }
}
