//! Tokens that were created while the daemon ran. The store receives only hashes of their secrets.

use super::seal::intact_records;
use super::values::now;
use super::{Store, StoreError, TokenRecord};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

fn record(row: &SqliteRow) -> Result<TokenRecord, StoreError> {
    Ok(TokenRecord {
        id: row.try_get("id")?,
        name: row.try_get("name")?,
        access: row.try_get("access")?,
        hash: row.try_get("hash")?,
        made_at: row.try_get("made_at")?,
        made_by: row.try_get("made_by")?,
        used_at: row.try_get("used_at")?,
    })
}

impl Store {
    /// Valid tokens, oldest first. A damaged one gives no access and is logged.
    pub async fn tokens(&self) -> Result<Vec<TokenRecord>, StoreError> {
        let rows =
            sqlx::query("SELECT * FROM tokens WHERE revoked_at IS NULL ORDER BY id").fetch_all(&self.readers).await?;
        Ok(intact_records(&rows, record))
    }

    /// Created and revoked tokens: time, text and person.
    pub async fn token_events(&self) -> Result<Vec<(String, String, String)>, StoreError> {
        let query = "SELECT made_at, 'token ' || name || ' made', made_by FROM tokens \
            UNION ALL SELECT revoked_at, 'token ' || name || ' revoked', revoked_by FROM tokens WHERE revoked_at IS NOT NULL";
        Ok(sqlx::query_as(query).fetch_all(&self.readers).await?)
    }

    /// Uses a transaction: the row is returned before the commit, which may fail.
    pub async fn save_token(&self, name: &str, access: &str, hash: &[u8], by: &str) -> Result<TokenRecord, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let saved =
            sqlx::query("INSERT INTO tokens (name, access, hash, made_at, made_by) VALUES (?, ?, ?, ?, ?) RETURNING *")
                .bind(name)
                .bind(access)
                .bind(hash)
                .bind(now())
                .bind(by)
                .fetch_one(&mut *writer)
                .await;
        let is_taken = |fault: &sqlx::Error| fault.as_database_error().is_some_and(|fault| fault.is_unique_violation());
        let row = match saved {
            Err(fault) if is_taken(&fault) => return Err(StoreError::TokenExists(name.to_owned())),
            saved => saved?,
        };
        writer.commit().await?;
        record(&row)
    }

    pub async fn token_used(&self, id: i64, at: &str) -> Result<(), StoreError> {
        let query = "UPDATE tokens SET used_at = ? WHERE id = ? AND revoked_at IS NULL";
        sqlx::query(query).bind(at).bind(id).execute(&self.writer).await?;
        Ok(())
    }

    pub async fn revoke_token(&self, id: i64, by: &str) -> Result<(), StoreError> {
        let query = "UPDATE tokens SET revoked_at = ?, revoked_by = ? WHERE id = ? AND revoked_at IS NULL";
        let done = sqlx::query(query).bind(now()).bind(by).bind(id).execute(&self.writer).await?;
        if done.rows_affected() == 0 { Err(StoreError::NoToken(id)) } else { Ok(()) }
    }
}
