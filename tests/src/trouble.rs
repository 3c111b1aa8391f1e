//! Simulated faults around a bench.

use crate::client::{Client, Request};
use crate::lab::Lab;
use serde_json::json;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection};
use std::fs::{self, File};
use std::io::Write;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread::JoinHandle;
use std::time::Duration;
use tempfile::TempDir;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    Quiet,
    DatabaseHeld,
    SlowSync,
    FullDisk,
    Fits,
    StalledConnections,
}

impl Trouble {
    pub const ALL: [Trouble; 6] = [
        Trouble::Quiet,
        Trouble::DatabaseHeld,
        Trouble::SlowSync,
        Trouble::FullDisk,
        Trouble::Fits,
        Trouble::StalledConnections,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Trouble::Quiet => "store without load",
            Trouble::DatabaseHeld => "database locked by another program",
            Trouble::SlowSync => "3 s for each fsync",
            Trouble::FullDisk => "full disk",
            Trouble::Fits => "fits on every core",
            Trouble::StalledConnections => "200 stalled connections",
        }
    }

    /// The longest permitted stop time in the long suite on an idle machine.
    pub fn bound(self) -> Duration {
        Duration::from_millis(if self == Trouble::Quiet { 50 } else { 100 })
    }

    /// Starts a lab in which this fault is possible; `None`, with a message, if this machine does not permit it.
    pub fn lab(self) -> Option<(Lab, Option<SmallDisk>)> {
        let disk = match self {
            Trouble::FullDisk => Some(SmallDisk::mount()?),
            _ => None,
        };
        let mut lab = Lab::new(disk.as_ref().map(|disk| disk.folder.path().join("data")));
        if self == Trouble::SlowSync {
            lab.preload = Some(slow_sync(lab.folder())?);
        }
        lab.start();
        Some((lab, disk))
    }

    /// The fault lasts until the result is dropped.
    pub fn begin(self, lab: &Lab) -> Box<dyn Ongoing> {
        match self {
            Trouble::Quiet => Box::new(Nothing),
            Trouble::DatabaseHeld => Box::new(Held::hold(&lab.database())),
            Trouble::SlowSync => Box::new(Switch::on(lab.folder().join(SWITCH))),
            Trouble::FullDisk => Box::new(Filler::fill(&lab.data)),
            Trouble::Fits => Box::new(Fits::run(&lab.client())),
            Trouble::StalledConnections => Box::new(Stalled::connect(lab)),
        }
    }
}

/// A fault that ends on drop.
pub trait Ongoing {}

impl Ongoing for Nothing {}
impl Ongoing for Held {}
impl Ongoing for Switch {}
impl Ongoing for Filler {}
impl Ongoing for Fits {}
impl Ongoing for Stalled {}

struct Nothing;

/// Another program that locks the database for writing.
pub struct Held {
    release: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Held {
    /// Returns when the database is locked.
    pub fn hold(database: &Path) -> Self {
        let (release, released) = mpsc::channel();
        let (ready, is_ready) = mpsc::channel();
        let options = SqliteConnectOptions::new().filename(database).busy_timeout(Duration::from_secs(30));
        let thread = std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
            runtime.block_on(async {
                let mut visitor = options.connect().await.expect("the database can be opened");
                sqlx::raw_sql("BEGIN IMMEDIATE").execute(&mut visitor).await.expect("the database can be held");
                ready.send(()).expect("somebody waits");
                // An error means that the fault has ended, too.
                let _ = released.recv();
                sqlx::raw_sql("ROLLBACK").execute(&mut visitor).await.expect("nothing was written");
                visitor.close().await.expect("the database is let go");
            });
        });
        is_ready.recv().expect("the database is held");
        Self { release: Some(release), thread: Some(thread) }
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.release.take();
        if let Some(thread) = self.thread.take() {
            // Its panic is already printed.
            let _ = thread.join();
        }
    }
}

const SWITCH: &str = "slow";

/// A library that delays the `fsync` calls of the daemon. Needs a C compiler.
fn slow_sync(folder: &Path) -> Option<PathBuf> {
    let library = folder.join("slow_sync.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/slow_sync.c");
    let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&library).arg(source).arg("-ldl").status();
    if !built.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: slow fsync needs a C compiler (cc)");
        return None;
    }
    Some(library)
}

/// Environment variables of the library.
pub fn slow_sync_settings(folder: &Path) -> [(&'static str, PathBuf); 2] {
    [("FAULT_SYNC_WHILE", folder.join(SWITCH)), ("FAULT_SYNC_S", PathBuf::from("3"))]
}

struct Switch(PathBuf);

impl Switch {
    fn on(path: PathBuf) -> Self {
        File::create(&path).expect("the switch can be made");
        Self(path)
    }
}

impl Drop for Switch {
    fn drop(&mut self) {
        fs::remove_file(&self.0).expect("the switch is there");
    }
}

/// A small file system in memory.
pub struct SmallDisk {
    pub folder: TempDir,
}

impl SmallDisk {
    /// Requires root.
    fn mount() -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let mount = ["-t", "tmpfs", "-o", "size=24m", "tmpfs"];
        let mounted = Command::new("mount").args(mount).arg(folder.path()).output();
        if !mounted.is_ok_and(|output| output.status.success()) {
            eprintln!("SKIPPED: a full disk needs a tmpfs of its own, and that root");
            return None;
        }
        Some(Self { folder })
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // Lazy unmount: the daemon may still use it.
        let unmounted = Command::new("umount").arg("-l").arg(self.folder.path()).status();
        if !unmounted.is_ok_and(|status| status.success()) {
            eprintln!("{} stays mounted", self.folder.path().display());
        }
    }
}

struct Filler(PathBuf);

impl Filler {
    fn fill(folder: &Path) -> Self {
        let path = folder.join("filler");
        let mut file = File::create(&path).expect("there is room for a name");
        // The loop ends with the error of a full disk.
        for size in [1 << 20, 1 << 12, 1] {
            while file.write_all(&vec![0; size]).is_ok() {}
        }
        Self(path)
    }
}

impl Drop for Filler {
    fn drop(&mut self) {
        fs::remove_file(&self.0).expect("the filler is there");
    }
}

/// Clients that request fits and diagnoses in sequence.
struct Fits {
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// More than the number of cores.
const FITTERS: usize = 4;
/// Large enough for a diagnosis of some seconds.
const IMPORTED_ROWS: usize = 40_000;
const IMPORTED: &str = "big";

impl Fits {
    fn run(client: &Client) -> Self {
        let run = imported(client);
        let over = Arc::<AtomicBool>::default();
        let fitter = |_| {
            let (over, client) = (over.clone(), client.clone());
            std::thread::spawn(move || {
                let model = json!({ "run": run, "effects": ["inertia", "coulomb", "viscous"], "tried": true });
                while !over.load(Ordering::Acquire) {
                    client.post("/models", &model);
                }
            })
        };
        let threads = (0..FITTERS).map(fitter).collect();
        Self { over, threads }
    }
}

impl Drop for Fits {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        for thread in self.threads.drain(..) {
            // Its panic is already printed.
            let _ = thread.join();
        }
    }
}

/// Imported once for each store.
fn imported(client: &Client) -> i64 {
    let all = client.get("/runs?search=procedure:import");
    let there = all["runs"].as_array().and_then(|runs| runs.iter().find(|run| run["bench"] == IMPORTED));
    if let Some(run) = there {
        return run["id"].as_i64().expect("a number");
    }
    let outcome = client.send(&Request::import(IMPORTED, IMPORTED_ROWS));
    outcome.acknowledged().and_then(|run| run["id"].as_i64()).unwrap_or_else(|| panic!("not imported: {outcome:?}"))
}

const CONNECTIONS: usize = 200;

/// Connections that send half a request and then nothing.
struct Stalled(#[allow(dead_code, reason = "held open until it is dropped")] Vec<TcpStream>);

impl Stalled {
    fn connect(lab: &Lab) -> Self {
        let connect = |_| {
            let mut stream = TcpStream::connect(lab.address).ok()?;
            stream.write_all(b"POST /api/v1/runs HTTP/1.1\r\nhost: 127.0.0.1\r\ncontent-le").ok()?;
            Some(stream)
        };
        Self((0..CONNECTIONS).filter_map(connect).collect())
    }
}
