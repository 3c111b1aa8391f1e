//! Cache of results of a model version or a complete run. Runs and fits never change, so each result is computed once.

use super::seal::KEPT;
use super::{Store, StoreError};
use sqlx::{Row, SqliteConnection};

/// Part of the key: another release may compute another result.
const SOFTWARE: &str = env!("CARGO_PKG_VERSION");
const LEVEL: i32 = 3;

/// Object that a result belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    Model(i64),
    Run(i64),
}

impl Subject {
    fn parts(self) -> (&'static str, i64) {
        match self {
            Subject::Model(id) => ("model", id),
            Subject::Run(id) => ("run", id),
        }
    }
}

impl Store {
    /// Stores a result as the JSON of the API.
    pub async fn cache_result(&self, subject: Subject, what: &str, json: &[u8]) -> Result<(), StoreError> {
        self.cache_packed_result(subject, what, &packed(json)?).await
    }

    /// The same for data that is already [`packed`].
    pub async fn cache_packed_result(&self, subject: Subject, what: &str, packed: &[u8]) -> Result<(), StoreError> {
        insert(&mut *self.writer.acquire().await?, subject, what, packed).await
    }

    /// `None` if the result must be computed, also if the cached one is damaged.
    pub async fn cached_result(&self, subject: Subject, what: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let (subject, id) = subject.parts();
        let row = sqlx::query("SELECT * FROM kept WHERE subject = ? AND id = ? AND what = ? AND software = ?")
            .bind(subject)
            .bind(id)
            .bind(what)
            .bind(SOFTWARE)
            .fetch_optional(&self.readers)
            .await?;
        let Some(row) = row else { return Ok(None) };
        if let Err(fault) = KEPT.check(&row) {
            tracing::warn!(%fault, "worked out anew");
            return Ok(None);
        }
        Ok(unpacked(row.try_get::<&[u8], _>("packed")?).ok())
    }
}

/// Compresses a result for the cache.
pub fn packed(json: &[u8]) -> Result<Vec<u8>, StoreError> {
    zstd::encode_all(json, LEVEL).map_err(StoreError::damaged)
}

/// Reverses [`packed`].
pub fn unpacked(packed: &[u8]) -> Result<Vec<u8>, StoreError> {
    zstd::decode_all(packed).map_err(StoreError::damaged)
}

pub(super) async fn insert(
    writer: &mut SqliteConnection,
    subject: Subject,
    what: &str,
    packed: &[u8],
) -> Result<(), StoreError> {
    let (subject, id) = subject.parts();
    let checksum = KEPT.seal(&[subject.into(), id.into(), what.into(), SOFTWARE.into(), packed.into()]);
    sqlx::query(
        "INSERT OR REPLACE INTO kept (subject, id, what, software, packed, checksum) VALUES (?, ?, ?, ?, ?, ?)",
    )
    .bind(subject)
    .bind(id)
    .bind(what)
    .bind(SOFTWARE)
    .bind(packed)
    .bind(checksum)
    .execute(writer)
    .await?;
    Ok(())
}
