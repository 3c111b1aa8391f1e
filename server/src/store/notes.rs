//! Notes and tags of runs.

use super::runs::exists;
use super::seal::NOTES;
use super::values::now;
use super::{NoteRecord, Store, StoreError};
use jointbench_procedure::RunId;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

impl Store {
    /// In the order of writing. The text of a damaged note is the error.
    pub async fn notes(&self, run: RunId) -> Result<Vec<NoteRecord>, StoreError> {
        let mut reader = self.readers.begin().await?;
        exists(&mut reader, run).await?;
        let rows =
            sqlx::query("SELECT * FROM notes WHERE run = ? ORDER BY id").bind(run).fetch_all(&mut *reader).await?;
        let damaged = |row: &SqliteRow, fault: StoreError| NoteRecord {
            id: row.try_get("id").unwrap_or_default(),
            at_s: None,
            text: fault.to_string(),
            created_at: row.try_get("created_at").unwrap_or_default(),
        };
        Ok(rows.iter().map(|row| record(row).unwrap_or_else(|fault| damaged(row, fault))).collect())
    }

    /// Stores a note, with a time of the run if one is given.
    pub async fn save_note(&self, run: RunId, at_s: Option<f64>, text: &str) -> Result<NoteRecord, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        exists(&mut writer, run).await?;
        let created_at = now();
        let cells = [run.into(), at_s.into(), text.into(), (&created_at).into()];
        let row = NOTES.insert(&cells).fetch_one(&mut *writer).await?;
        writer.commit().await?;
        record(&row)
    }

    /// Replaces the tags of a run.
    pub async fn set_tags(&self, run: RunId, tags: &[String]) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        exists(&mut writer, run).await?;
        sqlx::query("DELETE FROM tags WHERE run = ?").bind(run).execute(&mut *writer).await?;
        for tag in tags {
            sqlx::query("INSERT OR IGNORE INTO tags (run, tag) VALUES (?, ?)")
                .bind(run)
                .bind(tag)
                .execute(&mut *writer)
                .await?;
        }
        Ok(writer.commit().await?)
    }

    /// All tags in use, most frequent first.
    pub async fn tags(&self) -> Result<Vec<String>, StoreError> {
        Ok(sqlx::query_scalar("SELECT tag FROM tags GROUP BY tag ORDER BY COUNT(*) DESC, tag")
            .fetch_all(&self.readers)
            .await?)
    }
}

fn record(row: &SqliteRow) -> Result<NoteRecord, StoreError> {
    NOTES.check(row)?;
    Ok(NoteRecord {
        id: row.try_get("id")?,
        at_s: row.try_get("at_s")?,
        text: row.try_get("text")?,
        created_at: row.try_get("created_at")?,
    })
}
