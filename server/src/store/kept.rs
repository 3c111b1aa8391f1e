//! What was worked out of a model version or of a complete run: once, then only read. Runs and fits never change.

use super::seal::KEPT;
use super::{Store, StoreError};
use sqlx::{Row, SqliteConnection};

/// Another release may work it out otherwise.
const SOFTWARE: &str = env!("CARGO_PKG_VERSION");
const LEVEL: i32 = 3;

/// Of what it was worked out.
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
    /// Keeps an answer as the API tells it.
    pub async fn keep(&self, subject: Subject, what: &str, json: &[u8]) -> Result<(), StoreError> {
        self.keep_packed(subject, what, &packed(json)?).await
    }

    /// The same, where it was [`packed`] before.
    pub async fn keep_packed(&self, subject: Subject, what: &str, packed: &[u8]) -> Result<(), StoreError> {
        keep(&mut *self.writer.acquire().await?, subject, what, packed).await
    }

    /// `None` where it has to be worked out, also because what was kept is damaged.
    pub async fn kept(&self, subject: Subject, what: &str) -> Result<Option<Vec<u8>>, StoreError> {
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

/// An answer as it is kept.
pub fn packed(json: &[u8]) -> Result<Vec<u8>, StoreError> {
    zstd::encode_all(json, LEVEL).map_err(|fault| StoreError::Damaged(fault.to_string()))
}

/// The answer that was [`packed`].
pub fn unpacked(packed: &[u8]) -> Result<Vec<u8>, StoreError> {
    zstd::decode_all(packed).map_err(|fault| StoreError::Damaged(fault.to_string()))
}

pub(super) async fn keep(
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
