//! Reads samples, bit by bit as they were stored.

use super::archive::refuse_dropped;
use super::codec::{self, Broken};
use super::pyramid;
use super::runs::{channels, exists};
use super::seal::{BLOCKS, TAIL};
use super::{BLOCK_ROWS, Store, StoreError};
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::RunId;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};
use std::ops::Range;
use std::sync::Arc;

impl Store {
    /// Rows of a run, counted from 0; the range may exceed the run. `names` selects channels and their order; `None`
    /// selects all.
    pub async fn trace(&self, run: RunId, names: Option<&[String]>, rows: Range<u64>) -> Result<Trace, StoreError> {
        let mut reader = self.readers.begin().await?;
        let chosen = choose(&mut reader, run, names).await?;
        let rows = rows.start.min(i64::MAX as u64) as i64..rows.end.min(i64::MAX as u64) as i64;
        read(&mut reader, run, chosen, rows).await
    }
}

/// A channel with its index in the run.
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
    if !rows.is_empty() {
        refuse_dropped(reader, run).await?;
    }
    let tail = Arc::new(tail(reader, run, rows.clone()).await?);
    let threads = std::thread::available_parallelism().map_or(1, usize::from).div_ceil(chosen.len().max(1));
    let mut columns = Vec::new();
    // While one channel is unpacked on a blocking thread, the next one is read.
    for (place, _) in &chosen {
        let (place, rows, tail) = (*place, rows.clone(), tail.clone());
        let blocks = blocks(reader, run, place, &rows).await?;
        columns.push(tokio::task::spawn_blocking(move || {
            let tail = tail.iter().map(|piece| Ok(Piece::of_tail(piece, place)));
            let pieces = blocks.iter().map(Piece::of_block).chain(tail).collect::<Result<Vec<_>, StoreError>>()?;
            unpack(&pieces, &rows, threads).map_err(|fault| fault.within(run, "blocks"))
        }));
    }
    let mut unpacked = Vec::new();
    for column in columns {
        unpacked.push(column.await.map_err(|fault| StoreError::Database(fault.to_string()))??);
    }
    Ok(Trace::from_columns(chosen.into_iter().map(|(_, channel)| channel).collect(), unpacked))
}

async fn blocks(
    reader: &mut SqliteConnection,
    run: RunId,
    place: usize,
    rows: &Range<i64>,
) -> Result<Vec<SqliteRow>, StoreError> {
    let rows = sqlx::query(
        "SELECT run, channel, first_row, rows, data, checksum FROM blocks \
         WHERE run = ? AND channel = ? AND first_row > ? AND first_row < ? ORDER BY first_row",
    )
    .bind(run)
    .bind(place as i64)
    .bind(rows.start.saturating_sub(BLOCK_ROWS as i64))
    .bind(rows.end)
    .fetch_all(reader);
    rows.await.map_err(|fault| StoreError::from(fault).within(run, "blocks"))
}

/// Packed rows of one channel, either a block or part of a commit with several channels.
struct Piece<'a> {
    first_row: i64,
    rows: i64,
    data: &'a [u8],
    /// Index among the columns of `data`, if it holds several.
    place: Option<usize>,
}

impl<'a> Piece<'a> {
    fn of_block(row: &'a SqliteRow) -> Result<Self, StoreError> {
        BLOCKS.check(row)?;
        let (first_row, rows) = (row.try_get("first_row")?, row.try_get("rows")?);
        Ok(Piece { first_row, rows, data: row.try_get("data")?, place: None })
    }

    fn of_tail(tail: &'a TailPiece, place: usize) -> Self {
        Piece { first_row: tail.first_row, rows: tail.rows, data: &tail.data, place: Some(place) }
    }

    /// The rows of the piece in the range, relative to the start of the piece.
    fn within(&self, rows: &Range<i64>) -> Range<usize> {
        let in_piece = |row: i64| row.saturating_sub(self.first_row).clamp(0, self.rows) as usize;
        in_piece(rows.start)..in_piece(rows.end).max(in_piece(rows.start))
    }

    fn unpack(&self, rows: &Range<i64>, values: &mut [f64]) -> Result<(), Broken> {
        let whole = |values: &mut [f64]| match self.place {
            None => codec::unpack(self.data, values),
            Some(place) => pyramid::unpack_column(self.data, place, values),
        };
        if values.len() as i64 == self.rows {
            return whole(values);
        }
        let mut all = vec![0.0; self.rows as usize];
        whole(&mut all)?;
        values.copy_from_slice(&all[self.within(rows)]);
        Ok(())
    }
}

fn unpack(pieces: &[Piece<'_>], rows: &Range<i64>, threads: usize) -> Result<Vec<f64>, StoreError> {
    let mut column = vec![0.0; pieces.iter().map(|piece| piece.within(rows).len()).sum()];
    std::thread::scope(|scope| {
        let mut rest = &mut column[..];
        let mut shares = Vec::new();
        for share in pieces.chunks(pieces.len().div_ceil(threads).max(1)) {
            let (here, behind) = rest.split_at_mut(share.iter().map(|piece| piece.within(rows).len()).sum());
            rest = behind;
            shares.push((share, here));
        }
        // This thread unpacks the last share itself; with one share no thread is started.
        let last = shares.pop();
        let started: Vec<_> =
            shares.into_iter().map(|(share, values)| scope.spawn(move || unpack_share(share, rows, values))).collect();
        if let Some((share, values)) = last {
            unpack_share(share, rows, values)?;
        }
        started.into_iter().try_for_each(|share| share.join().unwrap_or(Err(Broken)))
    })?;
    Ok(column)
}

fn unpack_share(share: &[Piece<'_>], rows: &Range<i64>, mut values: &mut [f64]) -> Result<(), Broken> {
    for piece in share {
        let (here, behind) = std::mem::take(&mut values).split_at_mut(piece.within(rows).len());
        piece.unpack(rows, here)?;
        values = behind;
    }
    Ok(())
}

/// The rows of one commit, all channels, before they become part of a block.
#[derive(Debug)]
pub(super) struct TailPiece {
    pub first_row: i64,
    pub rows: i64,
    /// Time of the last row.
    pub to_s: Option<f64>,
    pub data: Vec<u8>,
}

/// The pieces of the tail that overlap the range, in order.
pub(super) async fn tail(
    reader: &mut SqliteConnection,
    run: RunId,
    rows: Range<i64>,
) -> Result<Vec<TailPiece>, StoreError> {
    let rows =
        sqlx::query("SELECT * FROM tail WHERE run = ? AND first_row + rows > ? AND first_row < ? ORDER BY first_row")
            .bind(run)
            .bind(rows.start)
            .bind(rows.end)
            .fetch_all(reader);
    let rows = rows.await.map_err(|fault| StoreError::from(fault).within(run, "tail"))?;
    rows.iter().map(TailPiece::of).collect()
}

impl TailPiece {
    fn of(row: &SqliteRow) -> Result<Self, StoreError> {
        TAIL.check(row)?;
        Ok(Self {
            first_row: row.try_get("first_row")?,
            rows: row.try_get("rows")?,
            to_s: row.try_get("to_s")?,
            data: row.try_get("data")?,
        })
    }
}

impl From<Broken> for StoreError {
    fn from(fault: Broken) -> Self {
        StoreError::damaged(fault)
    }
}
