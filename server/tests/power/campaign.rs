//! A campaign that reports its acknowledged steps, and the check of the store afterwards.

use jointbench::store::{NewRun, RunFilter, Store, StoreError, verify};
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::{Event, EventKind, RunState};
use std::path::Path;
use std::time::Duration;

/// Folder of the campaign, and memory limit of SQLite in bytes.
pub const FOLDER: &str = "JOINTBENCH_POWER_FOLDER";
pub const LIMIT: &str = "JOINTBENCH_POWER_LIMIT";
/// Acknowledged steps of a campaign: a run, its commits, three records, its end.
pub const STEPS: usize = 1 + COMMITS + 4 + 1;
const COMMITS: usize = 8;
/// The sixth commit fills a block.
const ROWS: usize = 6_000;
/// A failed step is repeated, as in the recorder.
const ATTEMPTS: usize = 3;
const BENCH: &str = "joint-a";
const SHORT_OF_MEMORY: Duration = Duration::from_secs(5);

fn block_on<T>(work: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap().block_on(work)
}

pub fn make_empty(folder: &Path) {
    block_on(async { Store::open(folder).await.unwrap().close().await });
}

/// The child process: one campaign on the given disk.
#[test]
#[ignore = "started by the other tests, on a disk that fails"]
fn runs_on_this_disk() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    block_on(async {
        let Ok(store) = Store::open(Path::new(&folder)).await else { return };
        if let Ok(limit) = std::env::var(LIMIT) {
            limit_memory(&limit).await;
            // Without memory, connections fail and block: the steps until then are checked.
            tokio::time::timeout(SHORT_OF_MEMORY, campaign(&store)).await.ok();
            std::process::exit(0);
        }
        campaign(&store).await.ok();
        store.close().await;
    });
}

/// The limit applies to the whole process.
async fn limit_memory(bytes: &str) {
    let Ok(memory) = sqlx::SqlitePool::connect("sqlite::memory:").await else { return };
    let limit = sqlx::AssertSqlSafe(format!("PRAGMA hard_heap_limit = {bytes}"));
    sqlx::query(limit).execute(&memory).await.ok();
}

async fn campaign(store: &Store) -> Result<(), StoreError> {
    let new = NewRun { bench: BENCH.into(), procedure: "friction".into(), ..NewRun::default() };
    let run = attempt("run", async || store.create_run(&new).await).await?;
    for commit in 0..COMMITS {
        let event = [note(commit)];
        attempt("commit", async || {
            store.commit(run, RunState::Running, &event, rows(commit * ROWS..(commit + 1) * ROWS)).await
        })
        .await?;
    }
    attempt("note", async || store.save_note(run, None, "smells of ozone").await).await?;
    attempt("token", async || store.save_token("ci", "read", &[7; 32], "local").await).await?;
    attempt("block", async || store.block_bench(BENCH, Some(run), "cover open").await).await?;
    attempt("calibration", async || store.calibrate(BENCH, "brake", Some(run), "local").await).await?;
    attempt("end", async || store.commit(run, RunState::Completed, &[], Trace::default()).await).await
}

async fn attempt<T>(what: &str, step: impl AsyncFn() -> Result<T, StoreError>) -> Result<T, StoreError> {
    let mut last = step().await;
    for _ in 1..ATTEMPTS {
        if last.is_err() {
            last = step().await;
        }
    }
    if last.is_ok() {
        println!("\nacknowledged {what}");
    }
    last
}

fn note(commit: usize) -> Event {
    Event { at_s: commit as f64, kind: EventKind::Note { text: format!("commit {commit}") } }
}

fn rows(range: std::ops::Range<usize>) -> Trace {
    let mut trace = Trace::new(vec![Channel::new("time_s"), Channel::new("link_torque_nm")]);
    range.for_each(|row| trace.push_row(&[row as f64 * 0.004, (row as f64).sqrt().sin()]));
    trace
}

/// The steps that the child had acknowledged.
#[derive(Debug, Default)]
pub struct Acknowledged {
    pub steps: usize,
    runs: usize,
    commits: usize,
    notes: usize,
    tokens: usize,
    blocks: usize,
    calibrations: usize,
    ends: usize,
}

impl Acknowledged {
    pub fn read(output: &str) -> Self {
        let mut acknowledged = Acknowledged::default();
        for what in output.lines().filter_map(|line| line.strip_prefix("acknowledged ")) {
            acknowledged.steps += 1;
            match what {
                "run" => acknowledged.runs += 1,
                "commit" => acknowledged.commits += 1,
                "note" => acknowledged.notes += 1,
                "token" => acknowledged.tokens += 1,
                "block" => acknowledged.blocks += 1,
                "calibration" => acknowledged.calibrations += 1,
                "end" => acknowledged.ends += 1,
                other => panic!("{other}"),
            }
        }
        acknowledged
    }
}

/// Acknowledged data exists once, other data completely or not at all. No data is damaged, and no loss is reported.
pub fn check(folder: &Path, acknowledged: &Acknowledged, how: &str) {
    block_on(async {
        let store = Store::open(folder).await.unwrap_or_else(|fault| panic!("{how}: {fault}"));
        assert_eq!(store.losses().await.unwrap(), [], "{how}: {acknowledged:?}");
        // One more step may be on the disk without its answer. Each attempt to create a run creates one.
        let among = |found: usize, acknowledged: usize, more: usize| {
            assert!(
                (acknowledged..=acknowledged + more).contains(&found),
                "{how}: {found} found, {acknowledged} acknowledged"
            );
        };
        let (total, runs) = store.runs(&RunFilter { limit: 10, ..RunFilter::default() }).await.unwrap();
        among(total as usize, acknowledged.runs, ATTEMPTS);
        for run in &runs {
            let commits = run.rows as usize / ROWS;
            assert_eq!(run.rows as usize, commits * ROWS, "{how}: a commit is whole or absent");
            let kept = store.trace(run.id, None, 0..u64::MAX).await.unwrap();
            assert!(commits == 0 || kept == rows(0..commits * ROWS), "{how}: each row once");
            let events = store.events(run.id, 0).await.unwrap();
            assert_eq!(events.len(), commits, "{how}: the journal is that of the rows");
        }
        let commits: usize = runs.iter().map(|run| run.rows as usize / ROWS).sum();
        among(commits, acknowledged.commits, 1);
        let ended = runs.iter().filter(|run| run.state == RunState::Completed).count();
        among(ended, acknowledged.ends, 1);
        let notes = runs.iter().filter(|run| run.note.is_some()).count();
        among(notes, acknowledged.notes, 1);
        among(store.tokens().await.unwrap().len(), acknowledged.tokens, 1);
        among(store.safety(BENCH, 99).await.unwrap().len(), acknowledged.blocks, ATTEMPTS);
        among(store.calibrations(BENCH).await.unwrap().len(), acknowledged.calibrations, ATTEMPTS);
        let report = verify(folder).await.unwrap();
        assert!(report.is_whole(), "{how}: {report:?}");
        store.close().await;
    });
}
