//! What was worked out of a model version: once, then only read. Its runs and its fit never change.

use super::{Store, StoreError};

/// Another release may work it out otherwise.
const SOFTWARE: &str = env!("CARGO_PKG_VERSION");
const LEVEL: i32 = 3;

impl Store {
    /// Keeps an answer as the API tells it.
    pub async fn keep(&self, model: i64, what: &str, json: &[u8]) -> Result<(), StoreError> {
        let packed = zstd::encode_all(json, LEVEL).map_err(|fault| StoreError::Damaged(fault.to_string()))?;
        sqlx::query("INSERT OR REPLACE INTO kept (model, what, software, packed) VALUES (?, ?, ?, ?)")
            .bind(model)
            .bind(what)
            .bind(SOFTWARE)
            .bind(packed)
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    /// `None` where it has to be worked out.
    pub async fn kept(&self, model: i64, what: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let packed: Option<Vec<u8>> =
            sqlx::query_scalar("SELECT packed FROM kept WHERE model = ? AND what = ? AND software = ?")
                .bind(model)
                .bind(what)
                .bind(SOFTWARE)
                .fetch_optional(&self.readers)
                .await?;
        packed
            .map(|packed| zstd::decode_all(&packed[..]).map_err(|fault| StoreError::Damaged(fault.to_string())))
            .transpose()
    }
}
