//! Check of the samples of a run: checksums of blocks, the pyramid, and the number of rows.

use super::super::StoreError;
use super::super::codec;
use super::super::pyramid::Extremes;
use super::super::pyramid::{self, COARSE_ROWS, FINE_ROWS};
use super::super::seal::{BLOCKS, COARSE, FINE, SPANS, Sealed, TAIL};
use super::VerifyReport;
use super::records::what;
use jointbench_procedure::RunId;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};

/// Result of the check of one piece of a run.
#[derive(Default)]
struct Found {
    rows: i64,
    without_checksum: u64,
    whole: u64,
    damaged: Vec<(&'static str, String)>,
}

pub async fn check(database: &mut SqliteConnection, run: RunId, report: &mut VerifyReport) {
    match pieces(database, run, report).await {
        Ok(rows) => report.rows += rows as u64,
        Err(fault) => report.add(Some(run), "blocks", what(&fault)),
    }
}

/// Checks all pieces of a run and returns their number of rows.
async fn pieces(database: &mut SqliteConnection, run: RunId, report: &mut VerifyReport) -> Result<i64, StoreError> {
    let channels: i64 = scalar(database, "SELECT COUNT(*) FROM channels WHERE run = ?", run).await?;
    // These queries use only the index, which is readable if the table is damaged.
    let spans: Vec<i64> =
        first_rows(database, "SELECT first_row FROM spans WHERE run = ? ORDER BY first_row", run).await?;
    let tail: Vec<i64> =
        first_rows(database, "SELECT first_row FROM tail WHERE run = ? ORDER BY first_row", run).await?;
    if is_dropped(database, run).await {
        return check_overview(database, run, &spans, report).await;
    }
    let blocks: i64 = scalar(database, "SELECT COUNT(*) FROM blocks WHERE run = ?", run).await?;
    if blocks != channels * spans.len() as i64 {
        let there = format!("{blocks} blocks where {channels} channels have {} each", spans.len());
        report.add(Some(run), "blocks", there);
    }
    let mut rows = 0;
    for (first_row, is_block) in spans.iter().map(|row| (*row, true)).chain(tail.iter().map(|row| (*row, false))) {
        if first_row != rows {
            report.add(Some(run), "spans", format!("rows {rows} to {} are in no block, or in two", first_row - 1));
        }
        let found = match is_block {
            true => span(database, run, first_row, channels).await?,
            false => tail_piece(database, run, first_row, channels).await?,
        };
        rows = first_row + found.rows;
        report.without_checksum += found.without_checksum;
        let sealed = if is_block { &BLOCKS } else { &TAIL };
        report.count(Some(run), sealed, found.whole, found.damaged.len() as u64);
        found.damaged.into_iter().for_each(|(table, what)| report.add(Some(run), table, what));
    }
    let recorded: i64 = scalar(database, "SELECT rows FROM runs WHERE id = ?", run).await?;
    // An unreadable piece is already reported.
    if recorded != rows && report.damaged.iter().all(|finding| finding.run != Some(run)) {
        report.add(Some(run), "runs", format!("the run has {recorded} rows, and blocks hold {rows}"));
    }
    Ok(rows)
}

/// Whether the samples are only in the archive. A store of an older release has no archive.
async fn is_dropped(database: &mut SqliteConnection, run: RunId) -> bool {
    let sql = "SELECT COUNT(*) FROM archive WHERE run = ? AND dropped_at IS NOT NULL";
    scalar(database, sql, run).await.is_ok_and(|count| count > 0)
}

/// Checks the overview of a run whose samples are only in the archive. The store holds none of its rows.
async fn check_overview(
    database: &mut SqliteConnection,
    run: RunId,
    spans: &[i64],
    report: &mut VerifyReport,
) -> Result<i64, StoreError> {
    let mut found = Found::default();
    for first_row in spans {
        let span = sqlx::query("SELECT * FROM spans WHERE run = ? AND first_row = ?").bind(run).bind(first_row);
        let checked = match span.fetch_one(&mut *database).await {
            Ok(span) => [&SPANS, &COARSE, &FINE].iter().try_for_each(|sealed| check_seal(&span, sealed, &mut found)),
            Err(fault) => Err(fault.into()),
        };
        match checked {
            Ok(()) => found.whole += 1,
            Err(fault) => found.damaged.push(("spans", placed(fault, || format!("first_row {first_row}")))),
        }
    }
    report.without_checksum += found.without_checksum;
    report.count(Some(run), &SPANS, found.whole, found.damaged.len() as u64);
    found.damaged.into_iter().for_each(|(table, what)| report.add(Some(run), table, what));
    Ok(0)
}

async fn scalar(database: &mut SqliteConnection, sql: &'static str, run: RunId) -> Result<i64, StoreError> {
    Ok(sqlx::query_scalar(sql).bind(run).fetch_one(database).await?)
}

async fn first_rows(database: &mut SqliteConnection, sql: &'static str, run: RunId) -> Result<Vec<i64>, StoreError> {
    Ok(sqlx::query_scalar(sql).bind(run).fetch_all(database).await?)
}

/// Checks the blocks of all channels from `first_row` on, with their pyramid.
async fn span(database: &mut SqliteConnection, run: RunId, first_row: i64, channels: i64) -> Result<Found, StoreError> {
    let span = sqlx::query("SELECT * FROM spans WHERE run = ? AND first_row = ?")
        .bind(run)
        .bind(first_row)
        .fetch_one(&mut *database)
        .await;
    let mut blocks = Vec::new();
    for channel in 0..channels {
        let block = sqlx::query("SELECT * FROM blocks WHERE run = ? AND channel = ? AND first_row = ?");
        blocks.push(block.bind(run).bind(channel).bind(first_row).fetch_one(&mut *database).await);
    }
    let checked = tokio::task::spawn_blocking(move || {
        let mut found = Found::default();
        let rows = blocks.iter().flatten().find_map(|block| block.try_get::<i64, _>("rows").ok());
        found.rows = rows.unwrap_or_default();
        let mut columns = Vec::new();
        for (channel, block) in blocks.into_iter().enumerate() {
            let column = block.map_err(StoreError::from).and_then(|block| column(&block, &mut found));
            let place = || format!("channel {channel}, first_row {first_row}");
            match column {
                Ok(values) => columns.push((channel, values)),
                Err(fault) => found.damaged.push(("blocks", placed(fault, place))),
            }
        }
        found.whole = columns.len() as u64;
        let picture = span.map_err(StoreError::from).and_then(|span| picture(&span, &columns, &mut found));
        if let Err(fault) = picture {
            found.damaged.push(("spans", placed(fault, || format!("first_row {first_row}"))));
        }
        found
    });
    checked.await.map_err(|fault| StoreError::Database(fault.to_string()))
}

/// The fault with its place. A missing row is no damage to SQLite, and has no place either.
fn placed(fault: StoreError, place: impl Fn() -> String) -> String {
    match fault {
        StoreError::Damaged(_) => what(&fault.at(place)),
        other => format!("{}: {other}", place()),
    }
}

fn check_seal(row: &SqliteRow, sealed: &Sealed, found: &mut Found) -> Result<(), StoreError> {
    found.without_checksum += u64::from(!sealed.check(row)?);
    Ok(())
}

fn column(block: &SqliteRow, found: &mut Found) -> Result<Vec<f64>, StoreError> {
    check_seal(block, &BLOCKS, found)?;
    let mut values = vec![0.0; block.try_get::<i64, _>("rows")?.max(0) as usize];
    codec::unpack(block.try_get("data")?, &mut values)?;
    Ok(values)
}

/// Checks the pyramid of a block against the samples.
fn picture(span: &SqliteRow, columns: &[(usize, Vec<f64>)], found: &mut Found) -> Result<(), StoreError> {
    for sealed in [&SPANS, &COARSE, &FINE] {
        check_seal(span, sealed, found)?;
    }
    let rows = span.try_get::<i64, _>("rows")?.max(0) as usize;
    let (coarse, fine): (&[u8], &[u8]) = (span.try_get("coarse")?, span.try_get("fine")?);
    for (channel, values) in columns {
        let drawn = pyramid::extremes(values, FINE_ROWS);
        let wide = pyramid::widen(&drawn, COARSE_ROWS / FINE_ROWS);
        let shows = same(&pyramid::unpack_fine(fine, rows, *channel)?, &drawn)
            && same(&pyramid::unpack_coarse(coarse, rows, *channel)?, &wide);
        if values.len() != rows || !shows {
            return Err(SPANS.damaged(span, &format!("the picture of channel {channel} is not that of its samples")));
        }
    }
    Ok(())
}

/// Equal bit by bit, except for NaN and the sign of zero.
fn same(a: &Extremes, b: &Extremes) -> bool {
    let alike =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
    alike(&a.min, &b.min) && alike(&a.max, &b.max)
}

/// Checks the rows of one commit in the tail.
async fn tail_piece(
    database: &mut SqliteConnection,
    run: RunId,
    first_row: i64,
    channels: i64,
) -> Result<Found, StoreError> {
    let row = sqlx::query("SELECT * FROM tail WHERE run = ? AND first_row = ?").bind(run).bind(first_row);
    let mut found = Found::default();
    let checked = match row.fetch_one(database).await {
        Ok(row) => unpack_all(&row, channels, &mut found),
        Err(fault) => Err(fault.into()),
    };
    match checked {
        Ok(()) => found.whole = 1,
        Err(fault) => found.damaged.push(("tail", what(&fault.at(|| format!("first_row {first_row}"))))),
    }
    Ok(found)
}

fn unpack_all(row: &SqliteRow, channels: i64, found: &mut Found) -> Result<(), StoreError> {
    found.rows = row.try_get("rows")?;
    check_seal(row, &TAIL, found)?;
    let (data, mut values): (&[u8], _) = (row.try_get("data")?, vec![0.0; found.rows.max(0) as usize]);
    (0..channels as usize).try_for_each(|place| pyramid::unpack_column(data, place, &mut values))?;
    Ok(())
}
