//! A window of a run reduced to a plot width: no more points than pixels, and no hidden spikes.

use super::pyramid::{self, COARSE_ROWS, Extremes, FINE_ROWS};
use super::samples::{Chosen, choose, read, tail};
use super::seal::{COARSE, FINE, SPANS};
use super::{Store, StoreError, Window, WindowColumn};
use jointbench_procedure::RunId;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};
use std::ops::Range;

impl Store {
    /// Samples from `from_s` to `to_s`, both included, as at most `px` points with the smallest and largest value of
    /// each channel. If the window has at most `px` rows, each row is a point.
    ///
    /// Points end at bins of the [`pyramid`]: a point may contain rows of its neighbour, less than half a pixel. A run
    /// whose samples are only in the archive has one point for two bins of the finest level.
    pub async fn window(
        &self,
        run: RunId,
        names: Option<&[String]>,
        from_s: Option<f64>,
        to_s: Option<f64>,
        px: usize,
    ) -> Result<Window, StoreError> {
        let mut reader = self.readers.begin().await?;
        let mut chosen = choose(&mut reader, run, names).await?;
        let Some(time) = choose(&mut reader, run, None).await?.into_iter().next() else {
            return Ok(Window { time_s: Vec::new(), columns: Vec::new(), exact: true, rows: 0 });
        };
        let rows = window(&mut reader, run, &time, from_s, to_s).await?;
        // The time is always the first column: its smallest value is the position of the point.
        chosen.insert(0, time);
        let count = (rows.end - rows.start).max(0) as usize;
        let exact = count <= px;
        let columns = match count / px.max(1) {
            _ if exact => exactly(&mut reader, run, chosen.clone(), rows.clone()).await,
            few if few < 2 * FINE_ROWS => from_samples(&mut reader, run, chosen.clone(), rows.clone(), px).await,
            some => from_pyramid(&mut reader, run, chosen.clone(), rows.clone(), px, some >= 2 * COARSE_ROWS).await,
        };
        let (columns, exact) = match columns {
            Err(StoreError::Dropped { .. }) => {
                let px = (count / (2 * FINE_ROWS)).max(1);
                (from_pyramid(&mut reader, run, chosen, rows, px, false).await?, false)
            }
            columns => (columns?, exact),
        };
        let mut columns = columns.into_iter();
        let time_s = columns.next().map(|time| time.min).unwrap_or_default();
        Ok(Window { time_s, columns: columns.collect(), exact, rows: count as u64 })
    }
}

impl Store {
    /// The rows of a run from `from_s` to `to_s`, both included. The defaults are its first and last row.
    pub async fn rows_between(
        &self,
        run: RunId,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Result<Range<u64>, StoreError> {
        let mut reader = self.readers.begin().await?;
        let Some(time) = choose(&mut reader, run, None).await?.into_iter().next() else { return Ok(0..0) };
        let rows = window(&mut reader, run, &time, from_s, to_s).await?;
        Ok(rows.start as u64..rows.end.max(rows.start) as u64)
    }
}

async fn exactly(
    reader: &mut SqliteConnection,
    run: RunId,
    chosen: Vec<Chosen>,
    rows: Range<i64>,
) -> Result<Vec<WindowColumn>, StoreError> {
    let trace = read(reader, run, chosen, rows).await?;
    let columns = trace.channels().iter().zip(trace.columns());
    Ok(columns
        .map(|(channel, values)| WindowColumn { channel: channel.clone(), min: values.clone(), max: values.clone() })
        .collect())
}

async fn window(
    reader: &mut SqliteConnection,
    run: RunId,
    time: &Chosen,
    from_s: Option<f64>,
    to_s: Option<f64>,
) -> Result<Range<i64>, StoreError> {
    let rows: i64 = sqlx::query_scalar("SELECT rows FROM runs WHERE id = ?").bind(run).fetch_one(&mut *reader).await?;
    let mut range = 0..rows;
    if let Some(from_s) = from_s {
        range.start = row_at(reader, run, time, rows, |time_s| time_s < from_s).await?;
    }
    if let Some(to_s) = to_s {
        range.end = row_at(reader, run, time, rows, |time_s| time_s <= to_s).await?;
    }
    Ok(range)
}

/// The first row that is not `before`: first finds the piece by its times, then the row in it.
async fn row_at(
    reader: &mut SqliteConnection,
    run: RunId,
    time: &Chosen,
    rows: i64,
    before: impl Fn(f64) -> bool,
) -> Result<i64, StoreError> {
    let spans =
        sqlx::query("SELECT run, first_row, rows, from_s, to_s, checksum FROM spans WHERE run = ? ORDER BY first_row")
            .bind(run)
            .fetch_all(&mut *reader);
    let spans = spans.await.map_err(|fault| StoreError::from(fault).within(run, "spans"))?;
    let mut pieces = spans.iter().map(ends).collect::<Result<Vec<_>, _>>()?;
    pieces.extend(tail(reader, run, 0..rows).await?.iter().map(|piece| (piece.first_row, piece.rows, piece.to_s)));
    let at = pieces.partition_point(|(_, _, to_s)| to_s.is_some_and(&before));
    let Some((first, count, _)) = pieces.get(at) else { return Ok(rows) };
    let piece = read(reader, run, vec![time.clone()], *first..first + count).await?;
    Ok(first + piece.columns()[0].partition_point(|time_s| before(*time_s)) as i64)
}

/// First row, number of rows, and time of the last row.
fn ends(span: &SqliteRow) -> Result<(i64, i64, Option<f64>), StoreError> {
    SPANS.check(span)?;
    Ok((span.try_get("first_row")?, span.try_get("rows")?, span.try_get("to_s")?))
}

/// The points of one channel during accumulation.
struct Points {
    min: Vec<f64>,
    max: Vec<f64>,
}

/// Maps rows to points.
#[derive(Clone, Copy)]
struct Grid {
    start: i64,
    rows: i64,
    px: i64,
}

impl Grid {
    fn of(rows: &Range<i64>, px: usize) -> Grid {
        Grid { start: rows.start, rows: rows.end - rows.start, px: px as i64 }
    }

    fn point(self, row: i64) -> usize {
        ((row - self.start) as i128 * self.px as i128 / self.rows as i128) as usize
    }

    fn first_row(self, point: usize) -> i64 {
        self.start + ((point as i128 * self.rows as i128 + self.px as i128 - 1) / self.px as i128) as i64
    }
}

impl Points {
    fn new(px: usize) -> Points {
        Points { min: vec![f64::INFINITY; px], max: vec![f64::NEG_INFINITY; px] }
    }

    fn take(&mut self, point: usize, min: f64, max: f64) {
        // A comparison with NaN is false, so NaN is ignored.
        if min < self.min[point] {
            self.min[point] = min;
        }
        if max > self.max[point] {
            self.max[point] = max;
        }
    }

    /// Adds bins from `first_row` on, each of `width` rows.
    fn take_bins(&mut self, grid: Grid, first_row: i64, width: usize, smallest: &[f64], largest: &[f64]) {
        let mut row = first_row;
        let mut point = grid.point(row);
        let mut next = grid.first_row(point + 1);
        for (min, max) in smallest.iter().zip(largest) {
            while row >= next && point + 1 < self.min.len() {
                point += 1;
                next = grid.first_row(point + 1);
            }
            self.take(point, *min, *max);
            row += width as i64;
        }
    }

    fn into_extremes(self) -> Extremes {
        let mut points = Extremes::default();
        self.min.into_iter().zip(self.max).for_each(|(min, max)| points.push(min, max));
        points
    }
}

fn finish(chosen: Vec<Chosen>, points: Vec<Points>) -> Vec<WindowColumn> {
    let columns = chosen.into_iter().zip(points);
    columns
        .map(|((_, channel), points)| {
            let Extremes { min, max } = points.into_extremes();
            WindowColumn { channel, min, max }
        })
        .collect()
}

async fn from_samples(
    reader: &mut SqliteConnection,
    run: RunId,
    chosen: Vec<Chosen>,
    rows: Range<i64>,
    px: usize,
) -> Result<Vec<WindowColumn>, StoreError> {
    let grid = Grid::of(&rows, px);
    let mut points: Vec<Points> = chosen.iter().map(|_| Points::new(px)).collect();
    take_samples(reader, run, &chosen, rows, grid, &mut points).await?;
    Ok(finish(chosen, points))
}

/// A wide plot reads millions of rows: limits the rows in memory.
const ROWS_AT_ONCE: usize = 1 << 16;
const SPANS_AT_ONCE: i64 = 64;

async fn take_samples(
    reader: &mut SqliteConnection,
    run: RunId,
    chosen: &[Chosen],
    rows: Range<i64>,
    grid: Grid,
    points: &mut [Points],
) -> Result<(), StoreError> {
    for first in rows.clone().step_by(ROWS_AT_ONCE) {
        let last = rows.end.min(first + ROWS_AT_ONCE as i64);
        let trace = read(reader, run, chosen.to_vec(), first..last).await?;
        for (values, points) in trace.columns().iter().zip(&mut *points) {
            points.take_bins(grid, first, 1, values, values);
        }
    }
    Ok(())
}

async fn from_pyramid(
    reader: &mut SqliteConnection,
    run: RunId,
    chosen: Vec<Chosen>,
    rows: Range<i64>,
    px: usize,
    coarse: bool,
) -> Result<Vec<WindowColumn>, StoreError> {
    let grid = Grid::of(&rows, px);
    let mut points: Vec<Points> = chosen.iter().map(|_| Points::new(px)).collect();
    // The rows before and after the whole blocks: partial blocks and the tail, sample by sample.
    let mut inner = rows.start..rows.start;
    loop {
        let from = if inner.is_empty() { rows.start } else { inner.end };
        let spans = spans(reader, run, coarse, from..rows.end).await?;
        for (first_row, count, packed) in &spans {
            for ((place, _), points) in chosen.iter().zip(&mut points) {
                let (width, bins) = match coarse {
                    true => (COARSE_ROWS, pyramid::unpack_coarse(packed, *count as usize, *place)?),
                    false => (FINE_ROWS, pyramid::unpack_fine(packed, *count as usize, *place)?),
                };
                points.take_bins(grid, *first_row, width, &bins.min, &bins.max);
            }
        }
        let (Some((first, _, _)), Some((last, count, _))) = (spans.first(), spans.last()) else { break };
        inner = if inner.is_empty() { *first } else { inner.start }..last + count;
    }
    for edge in [rows.start..inner.start, inner.end..rows.end] {
        take_samples(reader, run, &chosen, edge, grid, &mut points).await?;
    }
    Ok(finish(chosen, points))
}

/// First row, number of rows and packed bins of the next whole blocks in a range.
async fn spans(
    reader: &mut SqliteConnection,
    run: RunId,
    coarse: bool,
    rows: Range<i64>,
) -> Result<Vec<(i64, i64, Vec<u8>)>, StoreError> {
    let (sql, sealed, column) = match coarse {
        true => (
            "SELECT run, first_row, rows, coarse, coarse_checksum FROM spans \
             WHERE run = ? AND first_row >= ? AND first_row + rows <= ? ORDER BY first_row LIMIT ?",
            &COARSE,
            "coarse",
        ),
        false => (
            "SELECT run, first_row, rows, fine, fine_checksum FROM spans \
             WHERE run = ? AND first_row >= ? AND first_row + rows <= ? ORDER BY first_row LIMIT ?",
            &FINE,
            "fine",
        ),
    };
    let spans = sqlx::query(sql).bind(run).bind(rows.start).bind(rows.end).bind(SPANS_AT_ONCE).fetch_all(reader);
    let spans = spans.await.map_err(|fault| StoreError::from(fault).within(run, "spans"))?;
    let span = |row: &SqliteRow| {
        sealed.check(row)?;
        Ok((row.try_get("first_row")?, row.try_get("rows")?, row.try_get(column)?))
    };
    spans.iter().map(span).collect()
}
