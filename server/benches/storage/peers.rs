//! The same rows elsewhere: a table with a row for each sample, and HDF5.

use crate::signals::Signals;
use crate::timing::seconds;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{ConnectOptions, Connection, QueryBuilder, Sqlite, SqliteConnection};
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// Rows in one transaction.
const COMMIT_ROWS: usize = 4_000;
/// SQLite takes 32,766 values in a statement.
const STATEMENT_ROWS: usize = 2_000;

pub struct RowTable {
    pub single_rows_per_s: f64,
    pub rows_per_s: f64,
    pub bytes_per_row: f64,
    pub view_s: f64,
}

/// SQLite with the store's own settings and one row for each sample; `rows` fewer than the store's, it is that slow.
pub async fn row_table(folder: &Path, signals: &Signals, rows: usize) -> RowTable {
    let single = rows / 20;
    let mut file = open(&folder.join("single.db")).await;
    let single_s = insert(&mut file, signals, single, 1).await;
    file.close().await.expect("the table closes");

    let path = folder.join("rows.db");
    let mut file = open(&path).await;
    let all_s = insert(&mut file, signals, rows, STATEMENT_ROWS).await;
    let columns: Vec<String> = (1..12).map(|c| format!("MIN(c{c}), MAX(c{c})")).collect();
    let sql = format!("SELECT MIN(c0), {} FROM samples GROUP BY row * 2000 / {rows}", columns.join(", "));
    let (view_s, _) = seconds(sqlx::query(sqlx::AssertSqlSafe(sql)).fetch_all(&mut file)).await;
    file.close().await.expect("the table closes");
    let bytes = std::fs::metadata(&path).expect("the file is there").len();
    RowTable {
        single_rows_per_s: single as f64 / single_s,
        rows_per_s: rows as f64 / all_s,
        bytes_per_row: bytes as f64 / rows as f64,
        view_s,
    }
}

async fn open(path: &Path) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(path).create_if_missing(true).page_size(16_384);
    let options = options.journal_mode(SqliteJournalMode::Wal).synchronous(SqliteSynchronous::Full);
    let mut file = options.disable_statement_logging().connect().await.expect("a fresh database opens");
    let columns: Vec<String> = (0..12).map(|c| format!("c{c} REAL")).collect();
    let create = format!("CREATE TABLE samples (row INTEGER PRIMARY KEY, {})", columns.join(", "));
    sqlx::query(sqlx::AssertSqlSafe(create)).execute(&mut file).await.expect("the table is made");
    file
}

async fn insert(file: &mut SqliteConnection, signals: &Signals, rows: usize, at_once: usize) -> f64 {
    let trace = signals.trace(0..rows);
    let work = async {
        for first in (0..rows).step_by(COMMIT_ROWS) {
            let last = rows.min(first + COMMIT_ROWS);
            let mut transaction = file.begin().await.expect("a transaction begins");
            for from in (first..last).step_by(at_once) {
                let mut statement = QueryBuilder::<Sqlite>::new("INSERT INTO samples ");
                statement.push_values(from..last.min(from + at_once), |mut values, row| {
                    values.push_bind(row as i64);
                    trace.columns().iter().for_each(|column| {
                        values.push_bind(column[row]);
                    });
                });
                statement.build().execute(&mut *transaction).await.expect("rows go in");
            }
            transaction.commit().await.expect("the transaction ends");
        }
    };
    seconds(work).await.0
}

/// Results of `hdf5.py`.
pub struct Hdf5 {
    pub rows_per_s: f64,
    pub bytes_per_row: f64,
    pub read_one_s: f64,
    pub read_all_s: f64,
}

/// `layout`: `table` or `columns`. `None` where Python has no h5py.
pub fn hdf5(folder: &Path, signals: &Signals, layout: &str) -> Option<Hdf5> {
    let raw = folder.join("counts.i32");
    let mut file = std::io::BufWriter::new(std::fs::File::create(&raw).ok()?);
    for column in &signals.counts {
        let bytes: Vec<u8> = column.iter().flat_map(|count| count.to_le_bytes()).collect();
        file.write_all(&bytes).ok()?;
    }
    file.flush().ok()?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/storage/hdf5.py");
    let done = Command::new("python3").arg(script).arg(layout).arg(&raw).arg(folder.join("run.h5")).output().ok()?;
    let output = String::from_utf8_lossy(&done.stdout);
    let figures: Vec<f64> = output.split_whitespace().filter_map(|figure| figure.parse().ok()).collect();
    std::fs::remove_file(raw).ok()?;
    match figures[..] {
        [rows_per_s, bytes_per_row, read_one_s, read_all_s] => {
            Some(Hdf5 { rows_per_s, bytes_per_row, read_one_s, read_all_s })
        }
        _ => {
            eprintln!("no HDF5 figures: {}", String::from_utf8_lossy(&done.stderr));
            None
        }
    }
}
