//! Simulates a full disk for a mock bench. SQLite itself refuses to write, as it does on a disk that is full.

use super::{Store, StoreError};
use sqlx::{AssertSqlSafe, SqliteConnection};
use std::sync::atomic::Ordering;

/// Default of SQLite.
const MOST_PAGES: u32 = 0xffff_fffe;

impl Store {
    /// Stops or allows the growth of the database. Rows that fit into its existing pages are still stored.
    pub async fn fill_disk(&self, full: bool) -> Result<(), StoreError> {
        if self.is_full.swap(full, Ordering::AcqRel) == full {
            return Ok(());
        }
        let mut writer = self.writer.acquire().await?;
        limit(&mut writer, full).await?;
        if full { take_free_pages(&mut writer).await } else { release_pages(&mut writer).await }
    }
}

pub(super) async fn limit(writer: &mut SqliteConnection, full: bool) -> sqlx::Result<()> {
    // SQLite reads 1 as the current number of pages: this limit never truncates a database.
    let most = if full { 1 } else { MOST_PAGES };
    sqlx::query(AssertSqlSafe(format!("PRAGMA max_page_count = {most}"))).execute(writer).await?;
    Ok(())
}

/// Free pages in the file would accept data for a while, more of it in an older data folder.
async fn take_free_pages(writer: &mut SqliteConnection) -> Result<(), StoreError> {
    let free: i64 = sqlx::query_scalar("PRAGMA freelist_count").fetch_one(&mut *writer).await?;
    let page: i64 = sqlx::query_scalar("PRAGMA page_size").fetch_one(&mut *writer).await?;
    // The first free page is the table's own. Each other page begins with the number of the next page.
    let bytes = (free - 1) * (page - 4);
    if bytes > 0 {
        let fill = format!("CREATE TABLE full_disk AS SELECT zeroblob({bytes})");
        sqlx::query(AssertSqlSafe(fill)).execute(writer).await?;
    }
    Ok(())
}

/// Also removes the table that a daemon left when it was killed during a simulated full disk.
pub(super) async fn release_pages(writer: &mut SqliteConnection) -> Result<(), StoreError> {
    sqlx::query("DROP TABLE IF EXISTS full_disk").execute(writer).await?;
    Ok(())
}
