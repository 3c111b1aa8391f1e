//! A full disk as the bad day of a mock bench. SQLite itself refuses to write, as it does on a disk that is full.

use super::{Store, StoreError};
use sqlx::{AssertSqlSafe, SqliteConnection};
use std::sync::atomic::Ordering;

/// SQLite's own default.
const MOST_PAGES: u32 = 0xffff_fffe;

impl Store {
    /// From now on the database finds no page to grow by; or it does again. What fits into the pages that it has is still kept.
    pub async fn fill_disk(&self, full: bool) -> Result<(), StoreError> {
        if self.is_full.swap(full, Ordering::AcqRel) == full {
            return Ok(());
        }
        let mut writer = self.writer.acquire().await?;
        limit(&mut writer, full).await?;
        if full { take_free_pages(&mut writer).await } else { give_back(&mut writer).await }
    }
}

pub(super) async fn limit(writer: &mut SqliteConnection, full: bool) -> sqlx::Result<()> {
    // SQLite takes 1 as the number of pages that there are: a database is never cut.
    let most = if full { 1 } else { MOST_PAGES };
    sqlx::query(AssertSqlSafe(format!("PRAGMA max_page_count = {most}"))).execute(writer).await?;
    Ok(())
}

/// Pages that are free within the file would be room for a while, on another data folder for longer than on a new one.
async fn take_free_pages(writer: &mut SqliteConnection) -> Result<(), StoreError> {
    let free: i64 = sqlx::query_scalar("PRAGMA freelist_count").fetch_one(&mut *writer).await?;
    let page: i64 = sqlx::query_scalar("PRAGMA page_size").fetch_one(&mut *writer).await?;
    // The first of them is the table's own, and each of the others begins with the number of the next.
    let bytes = (free - 1) * (page - 4);
    if bytes > 0 {
        let fill = format!("CREATE TABLE full_disk AS SELECT zeroblob({bytes})");
        sqlx::query(AssertSqlSafe(fill)).execute(writer).await?;
    }
    Ok(())
}

/// Also what a daemon left that was killed on such a day.
pub(super) async fn give_back(writer: &mut SqliteConnection) -> Result<(), StoreError> {
    sqlx::query("DROP TABLE IF EXISTS full_disk").execute(writer).await?;
    Ok(())
}
