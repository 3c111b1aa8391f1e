//! The archive and its files.

use super::{ConversionError, reread};
use crate::config::ArchiveContent;
use crate::store::ArchiveRecord;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// State of the archive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchiveState {
    /// From the bench description; `null` without an archive.
    pub url: Option<String>,
    /// Whether the samples are archived too, not only the means at steady state.
    pub raw: bool,
    /// Tables that wait to be archived.
    pub owed: u64,
    pub archived: u64,
    /// Tables that a run does not have, such as the means of a run without steady states.
    pub empty: u64,
    /// Tables that cannot be archived until a person acts.
    pub failed: u64,
    /// Runs whose samples are only in the archive.
    pub dropped: u64,
    /// End of the first run that waits.
    #[schema(format = DateTime)]
    pub oldest_owed: Option<String>,
    /// Error of the last attempt for a table that is owed or failed.
    pub last_error: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArchiveProgress {
    Owed,
    Archived,
    /// The run has no such table.
    Empty,
    /// A person must act.
    Failed,
}

/// A table of a run in the archive, or on its way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchivedTable {
    pub run: i64,
    pub content: ArchiveContent,
    pub state: ArchiveProgress,
    /// Error of the last attempt, or why there is no table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Path of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// Of the values, as eight bytes each, little endian, column after column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(format = DateTime)]
    pub archived_at: Option<String>,
    /// Since then the samples are only in the archive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(format = DateTime)]
    pub dropped_at: Option<String>,
}

pub fn archived_table(record: ArchiveRecord) -> Result<ArchivedTable, ConversionError> {
    let ArchiveRecord { run, content, state, reason, folder, path, bytes, sha256, archived_at, dropped_at, .. } =
        record;
    let file = folder.zip(path).map(|(folder, path)| format!("{folder}/{path}"));
    let (content, state) = (reread(&content)?, reread(&state)?);
    Ok(ArchivedTable { run, content, state, reason, file, bytes, sha256, archived_at, dropped_at })
}
