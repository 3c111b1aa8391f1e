//! Commits: rows, events and state of a run in one transaction.
//!
//! A commit of the recorder (2 s of a 250 Hz run are 500 rows) becomes one row of `tail`. When the tail and the new
//! rows fill a block, or the run ends, they are packed again as blocks, one column each. The same transaction deletes
//! the tail, so each committed row exists exactly once after a power failure.

use super::codec;
use super::pyramid::{self, COARSE_ROWS, FINE_ROWS};
use super::runs::{channels, insert_events, insert_run, seal_state};
use super::samples::{TailPiece, tail};
use super::seal::{BLOCKS, CHANNELS, COARSE, Cell, FINE, SPANS, TAIL};
use super::values::now;
use super::{BLOCK_ROWS, NewRun, Store, StoreError};
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::{Event, RunId, RunState};
use serde::{Deserialize, Serialize};
use sqlx::{QueryBuilder, Sqlite, SqliteConnection};
use std::ops::Range;
use std::sync::Arc;
use tokio::sync::mpsc;

/// Rows, events and state of a run that are stored together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunCommit {
    pub run: RunId,
    /// Counts from 1 for each run.
    pub number: u64,
    pub state: RunState,
    pub events: Vec<Event>,
    pub rows: Trace,
}

impl Store {
    /// Appends rows and events to a run and sets `state`. The data is durable when this returns.
    ///
    /// Every commit with rows has the same channels; the first channel is the time. A final state closes the run.
    pub async fn commit(&self, run: RunId, state: RunState, events: &[Event], rows: Trace) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        append(&mut writer, run, state, events, rows).await?;
        Ok(writer.commit().await?)
    }

    /// Stores the next commits of runs, all of them or none. A commit that is already stored is skipped, so a caller
    /// can repeat the call when its outcome is unknown.
    ///
    /// # Errors
    /// [`StoreError::CommitMissing`] if the previous commit is missing.
    pub async fn commit_all(&self, commits: &[&RunCommit]) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        for RunCommit { run, number, state, events, rows } in commits {
            let there: Option<i64> = sqlx::query_scalar("SELECT commits FROM runs WHERE id = ?")
                .bind(run)
                .fetch_optional(&mut *writer)
                .await?;
            let there = there.ok_or(StoreError::NoRun(*run))? as u64;
            if *number <= there {
                continue;
            }
            if *number != there + 1 {
                return Err(StoreError::CommitMissing { run: *run, number: there + 1 });
            }
            append(&mut writer, *run, *state, events, rows.clone()).await?;
            let count = sqlx::query("UPDATE runs SET commits = ? WHERE id = ?");
            count.bind(*number as i64).bind(run).execute(&mut *writer).await?;
        }
        Ok(writer.commit().await?)
    }

    /// Imports a run that arrives in parts with the same channels. All parts are stored, or none.
    pub async fn import_parts(
        &self,
        new: &NewRun,
        mut parts: mpsc::Receiver<std::io::Result<Trace>>,
    ) -> Result<RunId, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let run = insert_run(&mut writer, new).await?;
        while let Some(part) = parts.recv().await {
            let part = part.map_err(|fault| StoreError::Database(format!("a part cannot be read: {fault}")))?;
            append(&mut writer, run, RunState::Running, &[], part).await?;
        }
        append(&mut writer, run, RunState::Completed, &[], Trace::default()).await?;
        writer.commit().await?;
        Ok(run)
    }

    /// Imports a complete run, such as a file. All of it is stored, or nothing.
    pub async fn import(&self, new: &NewRun, events: &[Event], rows: Trace) -> Result<RunId, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let run = insert_run(&mut writer, new).await?;
        append(&mut writer, run, RunState::Completed, events, rows).await?;
        writer.commit().await?;
        Ok(run)
    }
}

/// [`Store::commit`] within an open transaction.
pub(super) async fn append(
    writer: &mut SqliteConnection,
    run: RunId,
    state: RunState,
    events: &[Event],
    rows: Trace,
) -> Result<(), StoreError> {
    let found: Option<(i64, String)> =
        sqlx::query_as("SELECT rows, state FROM runs WHERE id = ?").bind(run).fetch_optional(&mut *writer).await?;
    let (kept, before) = found.ok_or(StoreError::NoRun(run))?;
    let before: RunState = serde_json::from_value(before.into())?;
    if before.is_final() {
        return Err(StoreError::RunOver { run, state: before });
    }

    let total = kept + rows.len() as i64;
    let closes = state.is_final();
    if !rows.is_empty() || closes {
        keep_rows(writer, run, kept, rows, closes).await?;
    }
    insert_events(writer, run, events).await?;
    let now = now();
    sqlx::query(
        "UPDATE runs SET state = ?, rows = ?, finished_at = ?, \
         started_at = CASE WHEN ? THEN COALESCE(started_at, ?) ELSE started_at END WHERE id = ?",
    )
    .bind(state.name())
    .bind(total)
    .bind(closes.then_some(&now))
    .bind(state != RunState::Queued)
    .bind(&now)
    .bind(run)
    .execute(&mut *writer)
    .await?;
    seal_state(writer, run).await
}

async fn keep_rows(
    writer: &mut SqliteConnection,
    run: RunId,
    kept: i64,
    mut rows: Trace,
    closes: bool,
) -> Result<(), StoreError> {
    let there = channels(writer, run).await?;
    if rows.is_empty() {
        // The run ends: the rows of the tail become its last block.
        rows = Trace::new(there);
    } else if there.is_empty() {
        insert_channels(writer, run, rows.channels()).await?;
    } else if there != rows.channels() {
        return Err(StoreError::OtherChannels { run });
    }

    let waiting: i64 = sqlx::query_scalar("SELECT COALESCE(SUM(rows), 0) FROM tail WHERE run = ?")
        .bind(run)
        .fetch_one(&mut *writer)
        .await?;
    let gathered = waiting as usize + rows.len();
    if gathered < BLOCK_ROWS && !closes {
        return insert_tail(writer, run, kept, rows).await;
    }
    let first_row = kept - waiting;
    let pieces = if waiting > 0 { tail(writer, run, 0..i64::MAX).await? } else { Vec::new() };
    let rows = with_tail(pieces, rows)?;

    let full = if closes { rows.len() } else { rows.len() / BLOCK_ROWS * BLOCK_ROWS };
    let rows = Arc::new(rows);
    // The blocking threads pack the blocks in parallel while the first blocks are written.
    let blocks: Vec<_> = (0..full)
        .step_by(BLOCK_ROWS)
        .map(|start| {
            let (rows, range) = (rows.clone(), start..full.min(start + BLOCK_ROWS));
            tokio::task::spawn_blocking(move || PackedBlock::of(&rows, range))
        })
        .collect();
    for block in blocks {
        let block = block.await.map_err(|fault| StoreError::Database(fault.to_string()))?;
        block.insert(writer, run, first_row).await?;
    }
    if waiting > 0 {
        sqlx::query("DELETE FROM tail WHERE run = ?").bind(run).execute(&mut *writer).await?;
    }
    if full < rows.len() {
        let columns = rows.columns().iter().map(|column| column[full..].to_vec()).collect();
        let rest = Trace::from_columns(rows.channels().to_vec(), columns);
        insert_tail(writer, run, first_row + full as i64, rest).await?;
    }
    Ok(())
}

fn with_tail(pieces: Vec<TailPiece>, rows: Trace) -> Result<Trace, StoreError> {
    if pieces.is_empty() {
        return Ok(rows);
    }
    let channels = rows.channels().to_vec();
    let columns = rows.columns().iter().enumerate().map(|(place, new)| {
        let waiting: usize = pieces.iter().map(|piece| piece.rows as usize).sum();
        let mut column = vec![0.0; waiting + new.len()];
        let mut rest = &mut column[..];
        for piece in &pieces {
            let (here, behind) = rest.split_at_mut(piece.rows as usize);
            pyramid::unpack_column(&piece.data, place, here)?;
            rest = behind;
        }
        rest.copy_from_slice(new);
        Ok(column)
    });
    Ok(Trace::from_columns(channels, columns.collect::<Result<_, StoreError>>()?))
}

async fn insert_channels(writer: &mut SqliteConnection, run: RunId, channels: &[Channel]) -> Result<(), StoreError> {
    let mut insert = QueryBuilder::<Sqlite>::new("INSERT INTO channels (run, place, name, resolution, checksum) ");
    insert.push_values(channels.iter().enumerate(), |mut row, (place, channel)| {
        let cells = [run.into(), (place as i64).into(), (&channel.name).into(), channel.resolution.into()];
        row.push_bind(run).push_bind(place as i64).push_bind(channel.name.clone()).push_bind(channel.resolution);
        row.push_bind(CHANNELS.seal(&cells));
    });
    insert.build().execute(writer).await?;
    Ok(())
}

async fn insert_tail(writer: &mut SqliteConnection, run: RunId, first_row: i64, rows: Trace) -> Result<(), StoreError> {
    let (from_s, to_s) = ends(&rows.columns()[0]);
    let count = rows.len() as i64;
    let data = tokio::task::spawn_blocking(move || pyramid::pack_columns(rows.columns(), &resolutions(&rows)));
    let data = data.await.map_err(|fault| StoreError::Database(fault.to_string()))?;
    let cells = [run.into(), first_row.into(), count.into(), from_s.into(), to_s.into(), data[..].into()];
    let checksum = TAIL.seal(&cells);
    sqlx::query("INSERT INTO tail (run, first_row, rows, from_s, to_s, data, checksum) VALUES (?, ?, ?, ?, ?, ?, ?)")
        .bind(run)
        .bind(first_row)
        .bind(count)
        .bind(from_s)
        .bind(to_s)
        .bind(data)
        .bind(checksum)
        .execute(writer)
        .await?;
    Ok(())
}

fn ends(time_s: &[f64]) -> (Option<f64>, Option<f64>) {
    (time_s.first().copied(), time_s.last().copied())
}

fn resolutions(rows: &Trace) -> Vec<Option<f64>> {
    rows.channels().iter().map(|channel| channel.resolution).collect()
}

/// A block of rows, packed for the database.
struct PackedBlock {
    /// Range in the trace that was packed.
    rows: Range<usize>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    columns: Vec<Vec<u8>>,
    coarse: Vec<u8>,
    fine: Vec<u8>,
}

impl PackedBlock {
    fn of(trace: &Trace, rows: Range<usize>) -> PackedBlock {
        let resolutions = resolutions(trace);
        let columns: Vec<&[f64]> = trace.columns().iter().map(|column| &column[rows.clone()]).collect();
        let fine: Vec<_> = columns.iter().map(|column| pyramid::extremes(column, FINE_ROWS)).collect();
        let coarse: Vec<_> = fine.iter().map(|fine| pyramid::widen(fine, COARSE_ROWS / FINE_ROWS)).collect();
        let (from_s, to_s) = ends(columns[0]);
        PackedBlock {
            from_s,
            to_s,
            columns: columns.iter().zip(&resolutions).map(|(column, step)| codec::pack(column, *step)).collect(),
            coarse: pyramid::pack_coarse(&coarse),
            fine: pyramid::pack_fine(&fine, &resolutions),
            rows,
        }
    }

    async fn insert(self, writer: &mut SqliteConnection, run: RunId, offset: i64) -> Result<(), StoreError> {
        let (first_row, rows) = (offset + self.rows.start as i64, self.rows.len() as i64);
        let mut insert =
            QueryBuilder::<Sqlite>::new("INSERT INTO blocks (run, channel, first_row, rows, data, checksum) ");
        insert.push_values(self.columns.into_iter().enumerate(), |mut row, (channel, data)| {
            let cells = [run.into(), (channel as i64).into(), first_row.into(), rows.into(), data[..].into()];
            let checksum = BLOCKS.seal(&cells);
            row.push_bind(run).push_bind(channel as i64).push_bind(first_row).push_bind(rows).push_bind(data);
            row.push_bind(checksum);
        });
        insert.build().execute(&mut *writer).await?;
        let place: [Cell<'_>; 3] = [run.into(), first_row.into(), rows.into()];
        let ends = SPANS.seal(&[&place[..], &[self.from_s.into(), self.to_s.into()]].concat());
        let coarse = COARSE.seal(&[&place[..], &[self.coarse[..].into()]].concat());
        let fine = FINE.seal(&[&place[..], &[self.fine[..].into()]].concat());
        sqlx::query(
            "INSERT INTO spans (run, first_row, rows, from_s, to_s, coarse, fine, checksum, coarse_checksum, fine_checksum) \
             VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        )
        .bind(run)
        .bind(first_row)
        .bind(rows)
        .bind(self.from_s)
        .bind(self.to_s)
        .bind(self.coarse)
        .bind(self.fine)
        .bind(ends)
        .bind(coarse)
        .bind(fine)
        .execute(writer)
        .await?;
        Ok(())
    }
}
