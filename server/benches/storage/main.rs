//! Cost of the store and of its peers in the same run. Prints the table of docs/benchmarks.md.
//!
//! `cargo bench -p jointbench --bench storage [-- ROWS]`: default: 10 million rows. Needs 4 GB of memory and
//! 1 GB in the folder for temporary files, which should lie on a disk: on one in memory, "durable" costs nothing.

mod peers;
mod signals;
mod timing;

use jointbench::store::{NewRun, Store};
use jointbench_instrument::Trace;
use jointbench_procedure::{RunId, RunState};
use signals::Signals;
use std::hint::black_box;
use std::path::Path;
use timing::{quantile, seconds};

const ROWS: usize = 10_000_000;
/// Rows in one commit of the ingest; the recorder's commits have 500.
const COMMIT_ROWS: usize = 65_536;
const RECORDER_ROWS: usize = 500;
const RECORDER_COMMITS: usize = 400;
const PX: usize = 2_000;

#[tokio::main]
async fn main() {
    let rows = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(ROWS);
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    eprintln!("{rows} rows in {}", folder.path().display());
    let signals = Signals::generate(rows);
    let floor = signals.entropy_floor();

    let mut table = Table::default();
    let store = Store::open(&folder.path().join("store")).await.expect("a fresh store opens");
    let (run, ingest_s) = ingest(&store, &signals, rows).await;
    let ingest_rows_per_s = rows as f64 / ingest_s;
    let recorder = recorder(&store, &signals).await;
    let reads = reads(&store, run).await;
    store.close().await;
    let bytes_per_row = sizes(&folder.path().join("store"), run, rows).await;

    table.held("into the store, synchronous=FULL, commits of 65,536", "rows/s", ingest_rows_per_s, Bar::AtLeast(2e6));
    table.row("commit of 500 rows as the recorder's, p50", "ms", recorder.0 * 1e3);
    table.row("the same, p99", "ms", recorder.1 * 1e3);
    table.held("bytes for each row, whole file", "B", bytes_per_row.0, Bar::AtMost(12.0));
    table.row("of that the samples", "B", bytes_per_row.1);
    table.row("entropy of first differences", "B", floor);
    table.held("samples / entropy", "", bytes_per_row.1 / floor, Bar::AtMost(1.15));
    table.held(
        "all rows × 12 channels read back, for each 10 million",
        "s",
        reads.all_s * 1e7 / rows as f64,
        Bar::AtMost(0.6),
    );
    table.row("one channel read back", "rows/s", rows as f64 / reads.one_s);
    table.held("view of 2,000 px, all channels, p50", "ms", reads.view_s * 1e3, Bar::AtMost(10.0));
    table.row("the same, p99", "ms", reads.view_p99_s * 1e3);
    table.held("decode and min-max / view", "×", reads.decode_s / reads.view_s, Bar::AtLeast(100.0));

    let peer_rows = rows / 10;
    let peer = peers::row_table(folder.path(), &signals, peer_rows).await;
    table.row("a row for each sample: one INSERT a row", "rows/s", peer.single_rows_per_s);
    table.row("the same, 2,000 rows a statement", "rows/s", peer.rows_per_s);
    table.row("the same, bytes for each row", "B", peer.bytes_per_row);
    table.row("the same, view of 2,000 px of a tenth of the rows", "ms", peer.view_s * 1e3);
    table.row("store / row table, ingest", "×", ingest_rows_per_s / peer.rows_per_s);

    for (layout, name) in [("table", "one table"), ("columns", "a data set a channel")] {
        let Some(hdf5) = peers::hdf5(folder.path(), &signals, layout) else {
            eprintln!("python3 has no h5py: no figures of HDF5");
            break;
        };
        let what = format!("HDF5 ({name}, int32 counts, shuffle + gzip 4)");
        table.row(&format!("{what}, append without fsync"), "rows/s", hdf5.rows_per_s);
        table.row(&format!("{what}, bytes for each row"), "B", hdf5.bytes_per_row);
        table.row(&format!("{what}, all channels read back"), "s", hdf5.read_all_s);
        let ratios = [
            ("bytes of samples / HDF5", "", bytes_per_row.1 / hdf5.bytes_per_row, Bar::AtMost(0.6)),
            ("ingest / HDF5", "×", ingest_rows_per_s / hdf5.rows_per_s, Bar::AtLeast(4.0)),
            ("read one channel / HDF5", "×", hdf5.read_one_s / reads.one_s, Bar::AtLeast(20.0)),
        ];
        for (ratio, unit, value, bar) in ratios {
            // The bars are about the way in which rows are logged.
            match layout {
                "table" => table.held(&format!("{ratio}, {name}"), unit, value, bar),
                _ => table.row(&format!("{ratio}, {name}"), unit, value),
            }
        }
    }
    table.print();
}

async fn ingest(store: &Store, signals: &Signals, rows: usize) -> (RunId, f64) {
    let run = store.create_run(&NewRun::default()).await.expect("a run is made");
    let mut total_s = 0.0;
    for first in (0..rows).step_by(COMMIT_ROWS) {
        let last = rows.min(first + COMMIT_ROWS);
        let trace = signals.trace(first..last);
        let state = if last == rows { RunState::Completed } else { RunState::Running };
        let (commit_s, done) = seconds(store.commit(run, state, &[], trace)).await;
        done.expect("rows go in");
        total_s += commit_s;
    }
    (run, total_s)
}

/// p50 and p99 of a commit.
async fn recorder(store: &Store, signals: &Signals) -> (f64, f64) {
    let run = store.create_run(&NewRun::default()).await.expect("a run is made");
    let mut measured = Vec::new();
    for commit in 0..RECORDER_COMMITS.min(signals.counts[0].len() / RECORDER_ROWS) {
        let trace = signals.trace(commit * RECORDER_ROWS..(commit + 1) * RECORDER_ROWS);
        let (commit_s, done) = seconds(store.commit(run, RunState::Running, &[], trace)).await;
        done.expect("rows go in");
        measured.push(commit_s);
    }
    (quantile(&mut measured, 0.5), quantile(&mut measured, 0.99))
}

struct Reads {
    all_s: f64,
    one_s: f64,
    view_s: f64,
    view_p99_s: f64,
    /// Cost of a window without a pyramid.
    decode_s: f64,
}

async fn reads(store: &Store, run: RunId) -> Reads {
    let (mut all, mut one, mut decode, mut view) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for _ in 0..5 {
        let (all_s, trace) = seconds(store.trace(run, None, 0..u64::MAX)).await;
        let trace = trace.expect("rows come back");
        let (reduce_s, _) = seconds(async { black_box(min_max(&trace)) }).await;
        all.push(all_s);
        decode.push(all_s + reduce_s);
        drop(trace);
        let name = ["motor_current_a".to_owned()];
        let (one_s, trace) = seconds(store.trace(run, Some(&name), 0..u64::MAX)).await;
        black_box(trace.expect("rows come back"));
        one.push(one_s);
    }
    for _ in 0..100 {
        let (view_s, seen) = seconds(store.window(run, None, None, None, PX)).await;
        black_box(seen.expect("a view is drawn"));
        view.push(view_s);
    }
    Reads {
        all_s: quantile(&mut all, 0.5),
        one_s: quantile(&mut one, 0.5),
        view_s: quantile(&mut view, 0.5),
        view_p99_s: quantile(&mut view, 0.99),
        decode_s: quantile(&mut decode, 0.5),
    }
}

fn min_max(trace: &Trace) -> Vec<(f64, f64)> {
    let bin = trace.len().div_ceil(PX).max(1);
    let bins = trace.columns().iter().flat_map(|column| column.chunks(bin));
    bins.map(|bin| bin.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (v.min(min), v.max(max))))
        .collect()
}

/// Bytes for each row: the whole file, and the samples alone.
async fn sizes(folder: &Path, run: RunId, rows: usize) -> (f64, f64) {
    let path = folder.join("jointbench.db");
    let whole = std::fs::metadata(&path).expect("the store is a file").len();
    let file = sqlx::SqlitePool::connect(&format!("sqlite://{}", path.display())).await.expect("the file opens");
    let samples: i64 = sqlx::query_scalar("SELECT SUM(length(data)) FROM blocks WHERE run = ?")
        .bind(run)
        .fetch_one(&file)
        .await
        .expect("blocks are there");
    file.close().await;
    (whole as f64 / rows as f64, samples as f64 / rows as f64)
}

enum Bar {
    AtLeast(f64),
    AtMost(f64),
}

/// A table in Markdown, printed whole at the end.
#[derive(Default)]
struct Table(Vec<[String; 3]>);

impl Table {
    fn row(&mut self, what: &str, unit: &str, value: f64) {
        self.0.push([what.to_owned(), shown(value, unit), String::new()]);
    }

    fn held(&mut self, what: &str, unit: &str, value: f64, bar: Bar) {
        let (held, bar) = match bar {
            Bar::AtLeast(least) => (value >= least, format!("≥ {}", shown(least, unit))),
            Bar::AtMost(most) => (value <= most, format!("≤ {}", shown(most, unit))),
        };
        let bar = if held { bar } else { format!("{bar}, **missed**") };
        self.0.push([what.to_owned(), shown(value, unit), bar]);
    }

    fn print(&self) {
        println!("| what | measured | required |\n| --- | --- | --- |");
        for [what, value, bar] in &self.0 {
            println!("| {what} | {value} | {bar} |");
        }
    }
}

fn shown(value: f64, unit: &str) -> String {
    let text = match value {
        _ if value >= 1e6 => format!("{:.2} million", value / 1e6),
        _ if value >= 100.0 => format!("{value:.0}"),
        _ if value >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    };
    format!("{text} {unit}").trim_end().to_owned()
}
