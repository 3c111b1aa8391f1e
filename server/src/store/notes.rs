//! What people say about runs.

use super::runs::{exists, now};
use super::{NoteRecord, Store, StoreError};
use jointbench_procedure::RunId;

type Row = (i64, Option<f64>, String, String);

impl Store {
    /// In the order in which they were written.
    pub async fn notes(&self, run: RunId) -> Result<Vec<NoteRecord>, StoreError> {
        let mut reader = self.readers.begin().await?;
        exists(&mut reader, run).await?;
        let rows: Vec<Row> = sqlx::query_as("SELECT id, at_s, text, created_at FROM notes WHERE run = ? ORDER BY id")
            .bind(run)
            .fetch_all(&mut *reader)
            .await?;
        Ok(rows.into_iter().map(record).collect())
    }

    /// Keeps a note, about a moment of the run where one is given.
    pub async fn save_note(&self, run: RunId, at_s: Option<f64>, text: &str) -> Result<NoteRecord, StoreError> {
        let mut writer = self.writer.begin().await?;
        exists(&mut writer, run).await?;
        let row: Row = sqlx::query_as(
            "INSERT INTO notes (run, at_s, text, created_at) VALUES (?, ?, ?, ?) RETURNING id, at_s, text, created_at",
        )
        .bind(run)
        .bind(at_s)
        .bind(text)
        .bind(now())
        .fetch_one(&mut *writer)
        .await?;
        writer.commit().await?;
        Ok(record(row))
    }

    /// The run has these tags from now on, and no others.
    pub async fn set_tags(&self, run: RunId, tags: &[String]) -> Result<(), StoreError> {
        let mut writer = self.writer.begin().await?;
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

    /// Every tag in use, the most used first.
    pub async fn tags(&self) -> Result<Vec<String>, StoreError> {
        Ok(sqlx::query_scalar("SELECT tag FROM tags GROUP BY tag ORDER BY COUNT(*) DESC, tag")
            .fetch_all(&self.readers)
            .await?)
    }
}

fn record((id, at_s, text, created_at): Row) -> NoteRecord {
    NoteRecord { id, at_s, text, created_at }
}
