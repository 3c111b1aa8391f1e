//! Samples out, exactly as they went in.

use super::codec::{self, Broken};
use super::pyramid;
use super::runs::{channels, exists};
use super::{BLOCK_ROWS, Store, StoreError};
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::RunId;
use sqlx::SqliteConnection;
use std::ops::Range;
use std::sync::Arc;

impl Store {
    /// Rows of a run, from 0; the range may reach beyond its end. All channels where `names` is `None`, else those
    /// named, in that order.
    pub async fn trace(&self, run: RunId, names: Option<&[String]>, rows: Range<u64>) -> Result<Trace, StoreError> {
        let mut reader = self.readers.begin().await?;
        let chosen = choose(&mut reader, run, names).await?;
        let rows = rows.start.min(i64::MAX as u64) as i64..rows.end.min(i64::MAX as u64) as i64;
        read(&mut reader, run, chosen, rows).await
    }
}

/// A channel with its place in the run.
pub(super) type Chosen = (usize, Channel);

pub(super) async fn choose(
    reader: &mut SqliteConnection,
    run: RunId,
    names: Option<&[String]>,
) -> Result<Vec<Chosen>, StoreError> {
    exists(reader, run).await?;
    let all: Vec<Chosen> = channels(reader, run).await?.into_iter().enumerate().collect();
    let Some(names) = names else { return Ok(all) };
    let find = |name: &String| {
        let there = || all.iter().map(|(_, channel)| channel.name.clone()).collect();
        let found = all.iter().find(|(_, channel)| channel.name == *name).cloned();
        found.ok_or_else(|| StoreError::NoChannel { run, name: name.clone(), there: there() })
    };
    names.iter().map(find).collect()
}

pub(super) async fn read(
    reader: &mut SqliteConnection,
    run: RunId,
    chosen: Vec<Chosen>,
    rows: Range<i64>,
) -> Result<Trace, StoreError> {
    let tail = Arc::new(tail(reader, run, rows.clone()).await?);
    let mut columns = Vec::new();
    // While one channel is unpacked on a blocking thread, the next is read.
    for (place, _) in &chosen {
        let (place, rows, tail) = (*place, rows.clone(), tail.clone());
        let blocks = blocks(reader, run, place, &rows).await?;
        columns.push(tokio::task::spawn_blocking(move || unpack(&blocks, &tail, place, &rows)));
    }
    let mut unpacked = Vec::new();
    for column in columns {
        unpacked.push(column.await.map_err(|fault| StoreError::Database(fault.to_string()))??);
    }
    Ok(Trace::from_columns(chosen.into_iter().map(|(_, channel)| channel).collect(), unpacked))
}

/// One packed column of a block: first row, rows, data.
type Block = (i64, i64, Vec<u8>);

async fn blocks(
    reader: &mut SqliteConnection,
    run: RunId,
    place: usize,
    rows: &Range<i64>,
) -> Result<Vec<Block>, StoreError> {
    Ok(sqlx::query_as(
        "SELECT first_row, rows, data FROM blocks \
         WHERE run = ? AND channel = ? AND first_row > ? AND first_row < ? ORDER BY first_row",
    )
    .bind(run)
    .bind(place as i64)
    .bind(rows.start.saturating_sub(BLOCK_ROWS as i64))
    .bind(rows.end)
    .fetch_all(reader)
    .await?)
}

fn unpack(blocks: &[Block], tail: &[TailPiece], place: usize, rows: &Range<i64>) -> Result<Vec<f64>, StoreError> {
    let within = |first: i64, count: i64| rows.end.min(first + count) - rows.start.max(first);
    let expected: i64 = blocks.iter().map(|(first, count, _)| within(*first, *count).max(0)).sum::<i64>()
        + tail.iter().map(|piece| within(piece.first_row, piece.rows).max(0)).sum::<i64>();
    let mut column = Vec::with_capacity(expected as usize);
    for (first, count, data) in blocks {
        cut(*first, *count, rows, &mut column, |column| codec::unpack(data, *count as usize, column))?;
    }
    for piece in tail {
        cut(piece.first_row, piece.rows, rows, &mut column, |column| {
            pyramid::unpack_column(&piece.data, piece.rows as usize, place, column)
        })?;
    }
    Ok(column)
}

/// Appends the rows that were asked for of a piece that starts at `first`.
fn cut(
    first: i64,
    count: i64,
    rows: &Range<i64>,
    column: &mut Vec<f64>,
    unpack: impl FnOnce(&mut Vec<f64>) -> Result<(), Broken>,
) -> Result<(), StoreError> {
    if first >= rows.start && first + count <= rows.end {
        return Ok(unpack(column)?);
    }
    let mut whole = Vec::with_capacity(count as usize);
    unpack(&mut whole)?;
    let (from, to) = ((rows.start - first).clamp(0, count), (rows.end - first).clamp(0, count));
    column.extend_from_slice(&whole[from as usize..to.max(from) as usize]);
    Ok(())
}

/// The rows of one commit, all channels, before they are part of a block.
#[derive(Debug, sqlx::FromRow)]
pub(super) struct TailPiece {
    pub first_row: i64,
    pub rows: i64,
    pub data: Vec<u8>,
}

impl TailPiece {
    pub fn unpack(&self, place: usize, column: &mut Vec<f64>) -> Result<(), StoreError> {
        Ok(pyramid::unpack_column(&self.data, self.rows as usize, place, column)?)
    }
}

/// The pieces of the tail that share a row with the range, in order.
pub(super) async fn tail(
    reader: &mut SqliteConnection,
    run: RunId,
    rows: Range<i64>,
) -> Result<Vec<TailPiece>, StoreError> {
    Ok(sqlx::query_as(
        "SELECT first_row, rows, data FROM tail WHERE run = ? AND first_row + rows > ? AND first_row < ? ORDER BY first_row",
    )
    .bind(run)
    .bind(rows.start)
    .bind(rows.end)
    .fetch_all(reader)
    .await?)
}

impl From<Broken> for StoreError {
    fn from(fault: Broken) -> Self {
        StoreError::Damaged(fault.to_string())
    }
}
